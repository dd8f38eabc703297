// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <random>

#include "evaluate/contenders.hpp"
#include "ripplenotch/core/biquad.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/design/notch.hpp"
#include "ripplenotch/evaluate/comparison.hpp"
#include "ripplenotch/evaluate/contender.hpp"
#include "ripplenotch/evaluate/filter_metrics.hpp"
#include "ripplenotch/evaluate/recommendation.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using namespace ripplenotch::literals;
using namespace ripplenotch::testing;

namespace {

double settle_ms(const Contender& c) {
    return 1e3 * Bench(c, 1000_Hz, 90_deg_s).step(NewtonMeters(10.0)).settle[0].value();
}
double ramp_ms(const Contender& c) { return 1e3 * Bench(c, 1000_Hz, 90_deg_s).ramp(20.0).delay.value(); }

}  // namespace

TEST_CASE(
    "figures of the paper: the notch settles in 147 ms and lags 38.0 ms, its low-pass 408 ms and 76.9 ms") {
    const Contender notch = contender("fixed,centers=25Hz:50Hz,q=0.25");
    CHECK(settle_ms(notch) == Approx(147.0).margin(1.0));
    CHECK(ramp_ms(notch) == Approx(38.0).margin(0.1));
    const Contender mislabelled = contender("lowpass,cutoff=13rad/s,order=1");
    CHECK(settle_ms(mislabelled) == Approx(408.0).margin(1.0));
    CHECK(ramp_ms(mislabelled) == Approx(76.9).margin(0.1));
    const Contender as_printed = contender("lowpass,cutoff=13Hz,order=1");
    CHECK(settle_ms(as_printed) == Approx(65.0).margin(1.0));
    CHECK(ramp_ms(as_printed) == Approx(12.2).margin(0.1));
}

TEST_CASE("the other low-passes of the paper's riddle: ramp delay and settling") {
    CHECK(ramp_ms(contender("lowpass,cutoff=13Hz,order=2")) == Approx(17.3).margin(0.1));
    CHECK(settle_ms(contender("lowpass,cutoff=13Hz,order=2")) == Approx(86.0).margin(1.0));
    CHECK(ramp_ms(contender("lowpass,cutoff=13Hz,order=4")) == Approx(32.0).margin(0.1));
    CHECK(settle_ms(contender("lowpass,cutoff=13Hz,order=4")) == Approx(164.0).margin(1.0));
    CHECK(ramp_ms(contender("lowpass,cutoff=13Hz,order=10")) == Approx(78.2).margin(0.1));
    CHECK(settle_ms(contender("lowpass,cutoff=13Hz,order=10")) == Approx(367.0).margin(1.0));
}

TEST_CASE("the lag measured on a ramp is the group delay at 0 Hz to 1e-4 ms, whatever the filter") {
    std::mt19937 engine(6);
    std::uniform_real_distribution<double> where(2.0, 200.0), quality(-0.7, 1.5);
    for (int i = 0; i < 40; ++i) {
        const std::string text =
            i % 4 == 0 ? fmt::format("lowpass,cutoff={:.6g}Hz,order={}", where(engine), 1 + i % 7)
                       : fmt::format("fixed,centers={:.6g}Hz:{:.6g}Hz,q={:.6g}", where(engine), where(engine),
                                     std::pow(10.0, quality(engine)));
        const Contender c = contender(text);
        const auto frozen = c.frozen(1000_Hz, 90_deg_s);
        REQUIRE(frozen.has_value());
        const double delay_ms = 1e3 * group_delay(frozen->cascade, 0_Hz, SampledAt(1000_Hz)).value();
        INFO(text);
        CHECK(ramp_ms(c) == Approx(delay_ms).margin(1e-4));
    }
}

TEST_CASE("settling and overshoot on the bench are those of the method's sections") {
    std::mt19937 engine(7);
    std::uniform_real_distribution<double> where(2.0, 200.0), quality(-0.7, 1.5);
    for (int i = 0; i < 20; ++i) {
        const Contender c = contender(
            fmt::format("fixed,centers={:.6g}Hz,q={:.6g}", where(engine), std::pow(10.0, quality(engine))));
        const StepMeasurement measured = Bench(c, 1000_Hz, 0_deg_s).step(NewtonMeters(-3.0));
        const Cascade cascade = c.frozen(1000_Hz, 0_deg_s)->cascade;
        for (std::size_t b = 0; b < settle_bands_percent.size(); ++b) {
            const StepFigures expected = measure_step(cascade, 1000_Hz, settle_bands_percent[b]);
            CHECK(measured.settle[b] == expected.settle);
            CHECK(measured.overshoot_percent == Approx(expected.overshoot_percent).margin(1e-6));
        }
    }
}

TEST_CASE("a wide notch first goes the other way: an undershoot of a step, and beyond a ramp's beginning") {
    const Contender wide = contender("fixed,centers=25Hz:50Hz,q=0.25");
    const Bench bench(wide, 1000_Hz, 0_deg_s);
    const Cascade cascade = wide.frozen(1000_Hz, 0_deg_s)->cascade;
    std::vector<BiquadState> states(cascade.size());
    double lowest = 0.0;
    for (int k = 0; k < 1000; ++k) {
        double y = 1.0;
        for (std::size_t i = 0; i < cascade.size(); ++i) y = step(cascade[i], states[i], y);
        lowest = std::min(lowest, y);
    }
    CHECK(lowest < -0.05);
    CHECK(bench.step(NewtonMeters(10.0)).undershoot_percent == Approx(-100.0 * lowest).epsilon(1e-6));
    CHECK(bench.step(NewtonMeters(-10.0)).undershoot_percent == Approx(-100.0 * lowest).epsilon(1e-6));
    CHECK(bench.step(NewtonMeters(10.0)).overshoot_percent == 0.0);
    CHECK(bench.ramp(20.0).overshoot_nm == Approx(bench.ramp(-20.0).overshoot_nm));
    const Contender slow = contender("lowpass,cutoff=13rad/s,order=1");
    CHECK(Bench(slow, 1000_Hz, 0_deg_s).ramp(20.0).overshoot_nm == 0.0);
}

TEST_CASE("a sine on the bench is attenuated as the response says, to 1e-4 dB") {
    for (const char* text : {"fixed,centers=25Hz:50Hz,q=0.25", "fixed,centers=40Hz,q=5,depth=30dB",
                             "lowpass,cutoff=13rad/s,order=1", "lowpass,cutoff=13Hz,order=4"}) {
        const Contender c = contender(text);
        const Bench bench(c, 1000_Hz, 90_deg_s);
        for (const double hz : {0.7, 8.0, 24.0, 40.0, 77.7, 300.0}) {
            const double gain =
                std::abs(response(c.frozen(1000_Hz, 90_deg_s)->cascade, Hertz(hz), SampledAt(1000_Hz)));
            INFO(text << " at " << hz << " Hz");
            CHECK(bench.attenuation_db(Hertz(hz)).value() == Approx(-20.0 * std::log10(gain)).margin(1e-4));
        }
    }
}

TEST_CASE(
    "a complete null is reported as the most that can be measured, a line beyond half the rate as none") {
    const Contender c = contender("fixed,centers=25Hz:50Hz,q=0.25");
    const Bench bench(c, 1000_Hz, 90_deg_s);
    CHECK(bench.attenuation_db(25_Hz) == most_attenuation_db);
    CHECK(bench.attenuation_db(50_Hz) == most_attenuation_db);
    CHECK_FALSE(bench.attenuation_db(500_Hz).has_value());
    CHECK_FALSE(bench.attenuation_db(0_Hz).has_value());
}

TEST_CASE("the control costs nothing and takes nothing away") {
    const Contender c = contender("none");
    const Bench bench(c, 1000_Hz, 90_deg_s);
    const StepMeasurement step = bench.step(NewtonMeters(10.0));
    for (const Seconds settle : step.settle) CHECK(settle.value() == 0.0);
    CHECK(step.overshoot_percent == 0.0);
    CHECK(step.undershoot_percent == 0.0);
    CHECK(bench.ramp(20.0).overshoot_nm == 0.0);
    CHECK(bench.ramp(20.0).delay.value() == 0.0);
    CHECK(bench.attenuation_db(25_Hz).value() == Approx(0.0).margin(1e-9));
}

TEST_CASE("switching on the bench is the band of that speed, in either direction") {
    const auto table = paper_table();
    const Contender c = make_contender(parse_spec("switching,table=table.json"), table);
    for (const double v : {30.0, -90.0, 91.0, 170.0}) {
        const Band& band = table->bands()[static_cast<std::size_t>(table->find(DegPerSec(v)))];
        const Bench bench(c, 1000_Hz, DegPerSec(v));
        CHECK(bench.step(NewtonMeters(10.0)).settle[0] == band.settle);
        CHECK(bench.ramp(20.0).delay.value() == Approx(band.dc_delay.value()).margin(1e-7));
    }
}

TEST_CASE("a step or ramp of nothing is refused") {
    const Contender c = contender("none");
    CHECK_THROWS_WITH(Bench(c, 1000_Hz, 0_deg_s).step(NewtonMeters(0.0)), Catch::Contains("no step"));
    CHECK_THROWS_WITH(Bench(c, 1000_Hz, 0_deg_s).ramp(0.0), Catch::Contains("no ramp"));
}

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

TEST_CASE("the ramp delay of every entry of a ledger, measured on a ramp, is its DC group delay") {
    for (const Contender& method : {contender("switching,table=table.json", paper_table()),
                                    contender("fixed,centers=25Hz:50Hz"), contender("lowpass,cutoff=13rad/s"),
                                    contender("tracking,gear-ratio=100,orders=1:2"), contender("none")}) {
        const auto ledger = delay_ledger(method, 1000_Hz, {});
        REQUIRE_FALSE(ledger.empty());
        for (const LedgerEntry& entry : ledger) {
            CAPTURE(method.text, entry.filter);
            REQUIRE(entry.ramp_delay);
            CHECK(entry.ramp_delay->value() == Approx(entry.dc_delay.value()).margin(1e-7));
            REQUIRE(entry.step);
            for (std::size_t i = 1; i < 4; ++i)
                CHECK(entry.step->settle[i].value() <= entry.step->settle[i - 1].value());
        }
    }
}

TEST_CASE("a table's ledger has one entry a band, with the band's own figures") {
    const auto table = paper_table();
    const auto ledger = delay_ledger(contender("switching,table=table.json", table), 1000_Hz, {12_Hz, true});
    REQUIRE(ledger.size() == 9);
    for (std::size_t i = 0; i < 9; ++i) {
        const Band& band = table->bands()[i];
        CHECK(ledger[i].band == band.number);
        CHECK(ledger[i].from == band.from);
        CHECK(ledger[i].dc_delay == band.dc_delay);
        CHECK(ledger[i].step->settle[0].value() == Approx(band.settle.value()).margin(1.1e-3));
        CHECK(ledger[i].step->overshoot_percent == Approx(band.overshoot_percent).margin(1e-6));
        const auto gain = response(band.cascade(), 12_Hz, SampledAt(1000_Hz));
        CHECK(std::remainder(*ledger[i].phase_lag_deg + degrees_per_radian * std::arg(gain), 360.0) ==
              Approx(0.0).margin(1e-9));
        CHECK(*ledger[i].crossover_db == Approx(20.0 * std::log10(std::abs(gain))).margin(1e-9));
    }
}

TEST_CASE("far below every centre the phase lag is the delay: 0.36 degrees for each hertz and millisecond") {
    const auto figures = [](const Contender& method, double hz) {
        const auto frozen = method.frozen(1000_Hz, 90_deg_s);
        const auto at = at_crossover(frozen->cascade, Hertz(hz), SampledAt(1000_Hz));
        return at.phase_lag_deg /
               (0.36 * hz * 1e3 * group_delay(frozen->cascade, Hertz(0.0), SampledAt(1000_Hz)).value());
    };
    CHECK(figures(contender("fixed,centers=25Hz:50Hz"), 0.05) == Approx(1.0).epsilon(1e-4));
    CHECK(figures(contender("lowpass,cutoff=13Hz,order=4"), 0.05) == Approx(1.0).epsilon(1e-4));
}

TEST_CASE("a long row of notches has the published phase lag, beyond a half turn too") {
    // ArduPilot's regression case with single notches, at 1, 2, 5, 10 Hz: 11.999, 24.015, 60.339, 122.904
    // deg.
    Cascade cascade;
    for (int copy = 0; copy < 8; ++copy) {
        for (int harmonic = 1; harmonic <= 4; ++harmonic) {
            const double f = 46.0 * harmonic, low = f - 11.5 * harmonic;
            cascade.push_back(
                design_notch({Hertz(f), f * low / (f * f - low * low), 60.0, WidthRule::analog}, 2000_Hz));
        }
    }
    CHECK(at_crossover(cascade, 1_Hz, SampledAt(2000_Hz)).phase_lag_deg == Approx(11.999).margin(0.01));
    CHECK(at_crossover(cascade, 10_Hz, SampledAt(2000_Hz)).phase_lag_deg == Approx(122.904).margin(0.01));
    CHECK(at_crossover(cascade, 16_Hz, SampledAt(2000_Hz)).phase_lag_deg > 180.0);
    CHECK_THROWS_AS(at_crossover(cascade, 1000_Hz, SampledAt(2000_Hz)), UsageError);
    CHECK_THROWS_AS(at_crossover(cascade, 0_Hz, SampledAt(2000_Hz)), UsageError);
}

TEST_CASE("the longest delay of a range of speeds is that of the slowest notch in it") {
    const auto table = paper_table();
    const Contender method = contender("switching,table=table.json", table);
    CHECK(longest_delay(method, 1000_Hz, {40_deg_s, 170_deg_s}).delay == table->bands()[1].dc_delay);
    CHECK(longest_delay(method, 1000_Hz, {100_deg_s, 170_deg_s}).delay == table->bands()[4].dc_delay);
    CHECK(longest_delay(contender("none"), 1000_Hz, {0_deg_s, 100_deg_s}).delay.value() == 0.0);
    CHECK(longest_delay(contender("lowpass,cutoff=13rad/s"), 1000_Hz, {0_deg_s, 0_deg_s}).delay.value() ==
          Approx(0.0769).margin(1e-4));
}

TEST_CASE("from the speed that a method names on, it keeps the delay, and just below it does not") {
    const Contender method = contender("tracking,gear-ratio=100,orders=1:2,q=2");
    for (const double ms : {5.0, 10.0, 20.0}) {
        const auto from = within_from(method, 1000_Hz, Seconds(1e-3 * ms));
        REQUIRE(from);
        // 1.5 / (2 pi f1 Q), equation 4
        CHECK(from->value() == Approx(3.6 * 1.5 / (2.0 * std::numbers::pi * 2.0 * 1e-3 * ms)).epsilon(0.03));
        CHECK(longest_delay(method, 1000_Hz, {*from, 300_deg_s}).delay.value() <= 1e-3 * ms);
        CHECK(longest_delay(method, 1000_Hz, {0.97 * *from, 300_deg_s}).delay.value() > 1e-3 * ms);
    }
    CHECK(within_from(contender("none"), 1000_Hz, Seconds(1e-6))->value() == 0.0);
    CHECK_FALSE(within_from(contender("lowpass,cutoff=1Hz"), 1000_Hz, Seconds(1e-3)));
}

namespace {

// 100 samples at 1 kHz. The truth steps from 0 to 10 Nm at sample 10, so that 0.5, 1, 2 and 5 % of its range
// are 0.05, 0.1, 0.2 and 0.5 Nm.
struct Planted {
    std::vector<double> time_s, truth_nm, out_nm;
    std::vector<Switch> changes;
    Planted() {
        for (int k = 0; k < 100; ++k) {
            time_s.push_back(0.001 * k);
            truth_nm.push_back(k < 10 ? 0.0 : 10.0);
        }
        out_nm = truth_nm;
    }
    void add(std::size_t from, std::size_t end, double error_nm) {
        for (std::size_t k = from; k < end; ++k) out_nm[k] += error_nm;
    }
    [[nodiscard]] std::vector<SwitchEntry> ledger(std::size_t block, std::size_t gap_before = 0) const {
        SwitchLedger ledger(truth_nm);
        for (std::size_t at = 0; at < out_nm.size();) {
            if (at > 0 && at == gap_before) ledger.split();
            std::size_t end = std::min(at + block, out_nm.size());
            if (at < gap_before) end = std::min(end, gap_before);
            std::vector<Switch> so_far;  // a filter lists a change once it has put out that sample
            for (const Switch& change : changes) {
                if (change.sample < end) so_far.push_back(change);
            }
            ledger.add(std::span(time_s).subspan(at, end - at), std::span(out_nm).subspan(at, end - at),
                       so_far);
            at = end;
        }
        return ledger.entries();
    }
};

// Two changes: after the first the output is off by 1 Nm for 5 ms, by -2 at 5 ms, 0.3 to 10 ms, 0.08 to 20
// ms.
Planted two_changes() {
    Planted planted;
    planted.changes = {{20, 1, 2, 36.0, 1.25}, {60, 2, 3, 54.0, 0.08}};
    planted.add(19, 20, -0.25);
    planted.add(20, 25, 1.0);
    planted.add(25, 26, -2.0);
    planted.add(26, 30, 0.3);
    planted.add(30, 40, 0.08);
    planted.add(60, 100, 0.08);
    return planted;
}

double ms(const std::optional<Seconds>& time) { return 1e3 * time.value().value(); }

}  // namespace

TEST_CASE("an error planted after a change has the peak and the settling times that were planted") {
    const auto entries = two_changes().ledger(100);
    REQUIRE(entries.size() == 2);
    const SwitchEntry& first = entries[0];
    CHECK(first.change.from_band == 1);
    CHECK(first.time.value() == Approx(0.020));
    CHECK(1e3 * first.stretch.value() == Approx(39.0));  // samples 20 to 59
    CHECK(*first.error_before_nm == Approx(0.25));
    CHECK(*first.peak_error_nm == Approx(2.0));
    CHECK(ms(first.peak_after) == Approx(5.0));
    CHECK(ms(first.settle[0]) == Approx(20.0));  // 0.08 Nm is more than 0.5 % of 10 Nm ...
    CHECK(ms(first.settle[1]) == Approx(10.0));  // ... and less than 1 %
    CHECK(ms(first.settle[2]) == Approx(10.0));  // 0.3 Nm is more than 2 % ...
    CHECK(ms(first.settle[3]) == Approx(6.0));   // ... and less than 5 %
}

TEST_CASE(
    "an error that does not fall until the next change has not settled, one within from the start needs no "
    "time") {
    const SwitchEntry last = two_changes().ledger(100).back();
    CHECK(*last.error_before_nm == 0.0);
    CHECK(*last.peak_error_nm == Approx(0.08));
    CHECK_FALSE(last.settle[0].has_value());
    CHECK(ms(last.settle[1]) == 0.0);
    CHECK(ms(last.settle[3]) == 0.0);
    CHECK(1e3 * last.stretch.value() == Approx(39.0));  // to the end of the log
}

TEST_CASE("what leaves its band again has settled only after that") {
    Planted planted = two_changes();
    planted.add(45, 47, 0.7);
    const SwitchEntry first = planted.ledger(100).front();
    for (const auto& settle : first.settle) CHECK(ms(settle) == Approx(27.0));  // 47 - 20
    CHECK(*first.peak_error_nm == Approx(2.0));
}

TEST_CASE("the switching ledger does not depend on how the log is cut into blocks") {
    const auto whole = two_changes().ledger(100);
    for (const std::size_t block : {1U, 7U, 20U, 33U}) {
        const auto cut = two_changes().ledger(block);
        REQUIRE(cut.size() == whole.size());
        for (std::size_t i = 0; i < whole.size(); ++i) {
            CHECK(cut[i].peak_error_nm == whole[i].peak_error_nm);
            CHECK(cut[i].error_before_nm == whole[i].error_before_nm);
            CHECK(cut[i].settle == whole[i].settle);
            CHECK(cut[i].stretch == whole[i].stretch);
        }
    }
}

TEST_CASE("a gap ends a change's stretch, and what was before it is not before the next change") {
    Planted planted = two_changes();
    planted.add(50, 60, 5.0);  // behind the gap: nobody's
    const auto entries = planted.ledger(100, 50);
    CHECK(*entries[0].peak_error_nm == Approx(2.0));
    CHECK(ms(entries[0].settle[0]) == Approx(20.0));
    CHECK(1e3 * entries[0].stretch.value() == Approx(29.0));
    const auto right_after = planted.ledger(100, 60);
    CHECK_FALSE(right_after[1].error_before_nm.has_value());
}

TEST_CASE("without a truth a change has a time and a jump, and no errors") {
    Planted planted = two_changes();
    planted.truth_nm.clear();
    const auto entries = planted.ledger(100);
    REQUIRE(entries.size() == 2);
    CHECK(entries[0].change.jump_nm == 1.25);
    CHECK(1e3 * entries[0].stretch.value() == Approx(39.0));
    CHECK_FALSE(entries[0].peak_error_nm.has_value());
    CHECK_FALSE(entries[0].settle[3].has_value());
}

TEST_CASE("a twentieth left is 26 dB off, and what a filter should leave is its response's share") {
    const OrderLevel level{1.0, 25.0, {0.8, 0.04}, 0.07};
    CHECK(attenuation_db(level).value() == Approx(20.0 * std::log10(20.0)));
    CHECK_FALSE(attenuation_db({1.0, 25.0, {0.0, 0.0}, {}}).has_value());
    FilterMetrics metrics;
    CHECK_FALSE(predicted_nm(metrics, 0).has_value());
    metrics.gear = GearAccount{GearRatio(100.0), {Order(1.0)}, {}, {}, "test"};
    metrics.measured = LogLevels{};
    metrics.measured->lines.orders = {level};
    metrics.measured->lines.windows = 3;
    // Of what the log shows, unless table or joint say what the ripple is.
    CHECK(predicted_nm(metrics, 0).value() == Approx(0.8 * 0.07));
    metrics.gear->amplitude_nm = {1.2};
    CHECK(predicted_nm(metrics, 0).value() == Approx(1.2 * 0.07));
}
