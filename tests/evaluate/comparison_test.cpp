// SPDX-License-Identifier: MIT
#include <cmath>
#include <numbers>
#include <random>

#include "evaluate/contenders.hpp"
#include "ripplenotch/evaluate/comparison.hpp"
#include "ripplenotch/evaluate/contender.hpp"
#include "ripplenotch/evaluate/recommendation.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using namespace ripplenotch::literals;
using namespace ripplenotch::testing;

namespace {

const GearAccount paper_lines{GearRatio(100.0), {Order(1.0), Order(2.0)}, {}, {}, ""};

// 20 s at a constant speed: 0.8 Nm of order 1, 0.5 Nm of order 2, an offset, and a little noise.
Trace steady_log(double speed_deg_s, double noise_nm) {
    Trace log;
    log.sample_rate = 1000_Hz;
    std::mt19937 engine(8);
    std::normal_distribution<double> noise(0.0, 1.0);
    for (int k = 0; k < 20000; ++k) {
        const double t = k / 1000.0, position = speed_deg_s * t;
        const double angle = 100.0 * position / degrees_per_radian;
        log.time_s.push_back(t);
        log.velocity_deg_s.push_back(speed_deg_s);
        log.position_deg.push_back(position);
        log.torque_nm.push_back(4.0 + 0.8 * std::sin(angle) + 0.5 * std::cos(2.0 * angle) +
                                noise_nm * noise(engine));
    }
    return log;
}

LogLevels measured(const std::vector<Contender>& contenders, const Trace& log) {
    const TraceView view = log.view();
    return measure_on_log(contenders, {view}, &paper_lines,
                          estimate_ripple({&view, 1}, paper_lines.ratio, paper_lines.orders),
                          BenchSignals{90_deg_s});
}

}  // namespace

TEST_CASE("on a log, attenuation per order is what the method's response says at that speed") {
    const Trace log = steady_log(80.0, 0.0);
    const std::vector<Contender> contenders = {contender("none"), contender("fixed,centers=25Hz:50Hz,q=0.25"),
                                               contender("lowpass,cutoff=13rad/s,order=1")};
    const LogLevels levels = measured(contenders, log);
    REQUIRE(levels.lines.windows > 0);
    REQUIRE(levels.methods.size() == 3);
    for (std::size_t i = 0; i < contenders.size(); ++i) {
        const Cascade cascade = contenders[i].frozen(1000_Hz, 80_deg_s)->cascade;
        REQUIRE(levels.methods[i].attenuation.size() == 2);
        for (const OrderAttenuation& entry : levels.methods[i].attenuation) {
            CHECK(entry.hz == Approx(entry.order * 100.0 * 80.0 / 360.0).epsilon(1e-6));
            const double expected =
                -20.0 * std::log10(std::abs(response(cascade, Hertz(entry.hz), SampledAt(1000_Hz))));
            // The first window holds the filter's transient.
            CHECK(entry.db.value() == Approx(expected).margin(0.5));
        }
    }
    CHECK(levels.methods[0].ripple_rms_nm.value() == Approx(std::sqrt(0.5 * (0.64 + 0.25))).epsilon(1e-3));
    CHECK(levels.methods[0].residual_rms_nm.value() == Approx(std::sqrt(0.5 * (0.64 + 0.25))).epsilon(1e-2));
    CHECK_FALSE(levels.methods[1].switches.has_value());
    double lowest = 0.0, highest = 0.0;
    for (double angle = 0.0; angle < 2.0 * std::numbers::pi; angle += 1e-3) {
        const double ripple = 0.8 * std::sin(angle) + 0.5 * std::cos(2.0 * angle);
        lowest = std::min(lowest, ripple);
        highest = std::max(highest, ripple);
    }
    CHECK(levels.methods[0].residual_peak_to_peak_nm.value() == Approx(highest - lowest).epsilon(0.02));
}

TEST_CASE("a gap restarts every method, so that nothing rings across it") {
    Trace log = steady_log(90.0, 0.0);
    // The torque has another offset after the gap; a filter that ran on would see a step of 50 Nm.
    for (std::size_t k = 10000; k < log.torque_nm.size(); ++k) log.torque_nm[k] += 50.0;
    const std::vector<Contender> contenders = {contender("lowpass,cutoff=13rad/s,order=1")};
    const LogLevels run_on = measured(contenders, log);
    log.run_starts = {10000};
    const LogLevels split = measured(contenders, log);
    CHECK(split.methods[0].residual_rms_nm.value() < 0.1);
    CHECK(run_on.methods[0].residual_rms_nm.value() > 3.0 * split.methods[0].residual_rms_nm.value());
}

TEST_CASE("the moving speed of a log is the median of what moves") {
    Trace log = steady_log(90.0, 0.0);
    for (std::size_t k = 0; k < 15000; ++k) log.velocity_deg_s[k] = 0.1;
    CHECK(median_moving_speed(log.view()).value() == 90.0);
    for (double& v : log.velocity_deg_s) v = -90.0;
    CHECK(median_moving_speed(log.view()).value() == 90.0);
    for (double& v : log.velocity_deg_s) v = 0.0;
    CHECK(median_moving_speed(log.view()).value() == 0.0);
}

namespace {

MethodFigures figures(const std::string& method, std::optional<double> settle_ms,
                      std::optional<double> lag_ms) {
    MethodFigures f;
    f.method = method;
    if (settle_ms) f.settle_ms = {*settle_ms, 0.0, 0.0, 0.0};
    f.ramp_delay_ms = lag_ms;
    return f;
}

Comparison of(std::vector<MethodFigures> methods) {
    Comparison comparison;
    comparison.methods = std::move(methods);
    return comparison;
}

}  // namespace

TEST_CASE("the verdict holds the first method that is no low-pass against the first low-pass") {
    const Comparison comparison =
        of({figures("none", 0.0, 0.0), figures("lowpass,cutoff=13Hz", 65.0, 12.2),
            figures("fixed,centers=25Hz", 130.0, 25.0), figures("switching", 1.0, 1.0)});
    CHECK(comparison.subject()->method == "fixed,centers=25Hz");
    CHECK(comparison.rival()->method == "lowpass,cutoff=13Hz");
    CHECK(verdict(comparison) ==
          "fixed,centers=25Hz settles 2.0 times slower than lowpass,cutoff=13Hz (130 against 65 ms to 0.5 "
          "%), lags 12.8 ms "
          "more (25.0 against 12.2 ms).");
}

TEST_CASE("the verdict does not make much of little") {
    CHECK(verdict(of({figures("a", 100.0, 10.0), figures("b", 100.0, 10.0)})) ==
          "a settles as fast as b (100 against 100 ms to 0.5 %), lags as much (10.0 against 10.0 ms).");
    CHECK(verdict(of({figures("a", 100.0, 10.0), figures("b", 103.0, 10.02)})) ==
          "a settles about as fast as b (100 against 103 ms to 0.5 %), lags as much (10.0 against 10.0 ms).");
    CHECK(verdict(of({figures("a", 0.0, 0.0), figures("b", 103.0, 10.0)})) ==
          "a settles 103 ms earlier than b (0 against 103 ms to 0.5 %), lags 10.0 ms less (0.0 against 10.0 "
          "ms).");
}

TEST_CASE("the verdict says only what was measured") {
    CHECK(verdict(of({figures("none", 0.0, 0.0)})) == "Only the control ran; there is nothing to compare.");
    CHECK(verdict(of({figures("none", 0.0, 0.0), figures("a", std::nullopt, 38.04)})) == "a lags 38.0 ms.");
    CHECK(verdict(of({figures("a", std::nullopt, 10.0), figures("b", std::nullopt, 20.0)})) ==
          "a lags 10.0 ms less than b (10.0 against 20.0 ms).");
    Comparison comparison = of({figures("a", 100.0, std::nullopt), figures("b", 200.0, std::nullopt)});
    comparison.methods[0].ripple_rms_nm = 0.01;
    comparison.methods[1].ripple_rms_nm = 0.2;
    CHECK(verdict(comparison) ==
          "a settles 2.0 times faster than b (100 against 200 ms to 0.5 %). It has a remaining ripple of "
          "0.01 Nm "
          "rms against 0.2.");
}

TEST_CASE("the verdict counts a method's weakest line, and does not put a number on a complete null") {
    Comparison comparison = of({figures("a", std::nullopt, 1.0), figures("b", std::nullopt, 2.0)});
    comparison.methods[0].attenuation = {{1.0, 25.0, 200.0}, {2.0, 50.0, 200.0}};
    comparison.methods[1].attenuation = {{1.0, 25.0, 21.74}, {2.0, 50.0, 27.7}};
    CHECK_THAT(verdict(comparison),
               Catch::Contains("It attenuates its weakest line by more than 200 dB against 21.7 dB."));
    comparison.methods[0].attenuation = {{1.0, 25.0, std::nullopt}};
    CHECK_THAT(verdict(comparison), !Catch::Contains("dB"));
}

TEST_CASE("a long method is told by its name, or by what tells it from others of that name") {
    const std::string crossfade = "switching,table=a/long/path/to/table.json,transition=crossfade";
    const std::string parallel = "switching,table=a/long/path/to/table.json,transition=parallel";
    const std::string tracking = "tracking,q=2,gear-ratio=100,orders=1:2";
    CHECK(verdict(of({figures(crossfade, 100.0, {}), figures(parallel, 50.0, {})})) ==
          "switching,transition=crossfade settles 2.0 times slower than switching,transition=parallel (100 "
          "against "
          "50 ms to 0.5 %).");
    CHECK(verdict(of({figures(crossfade, 100.0, {}), figures(tracking, 50.0, {})})) ==
          "switching settles 2.0 times slower than tracking (100 against 50 ms to 0.5 %).");
}

TEST_CASE("where the truth is known, the verdict names the method that comes nearest to it") {
    Comparison comparison = of({figures("none", std::nullopt, 0.0), figures("a", std::nullopt, 20.0),
                                figures("b", std::nullopt, 10.0), figures("c", std::nullopt, 0.0)});
    const std::string before = "a lags 10.0 ms more than b (20.0 against 10.0 ms).";
    CHECK(verdict(comparison) == before);
    comparison.methods[0].error_rms_nm = 0.9;
    comparison.methods[1].error_rms_nm = 0.7834;
    comparison.methods[2].error_rms_nm = 0.7;
    comparison.methods[3].error_rms_nm = 0.0281;
    CHECK(verdict(comparison) ==
          before + " Smallest error against the true torque: c, 0.0281 Nm rms; a 0.783.");
    comparison.methods[0].error_rms_nm = 0.01;  // where filtering harms, the raw torque is the answer
    CHECK(verdict(comparison) ==
          before + " Smallest error against the true torque: none, 0.01 Nm rms; a 0.783.");
    comparison.methods[1].error_rms_nm = 0.001;
    CHECK(verdict(comparison) == before + " Smallest error against the true torque: a, 0.001 Nm rms.");
    // Of one method there is no nearest.
    comparison = of({figures("none", std::nullopt, 0.0), figures("a", std::nullopt, 20.0)});
    comparison.methods[0].error_rms_nm = 0.9;
    comparison.methods[1].error_rms_nm = 0.1;
    CHECK(verdict(comparison) == "a lags 20.0 ms.");
}
