// SPDX-License-Identifier: MIT
#include "ripplenotch/evaluate/comparison.hpp"

#include <cmath>
#include <numbers>
#include <random>

#include "evaluate/contenders.hpp"
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

}  // namespace

TEST_CASE("on a log, attenuation per order is what the method's response says at that speed") {
    const Trace log = steady_log(80.0, 0.0);
    const std::vector<Contender> contenders = {contender("none"), contender("fixed,centers=25Hz:50Hz,q=0.25"),
                                               contender("lowpass,cutoff=13rad/s,order=1")};
    const LogLevels levels = measure_on_log(contenders, {log.view()}, paper_lines);
    REQUIRE(levels.windows > 0);
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
    const LogLevels run_on = measure_on_log(contenders, {log.view()}, paper_lines);
    log.run_starts = {10000};
    const LogLevels split = measure_on_log(contenders, {log.view()}, paper_lines);
    CHECK(split.methods[0].residual_rms_nm.value() < 0.1);
    CHECK(run_on.methods[0].residual_rms_nm.value() > 3.0 * split.methods[0].residual_rms_nm.value());
}

TEST_CASE("a low-pass matched on a log leaves the ripple asked for") {
    const Trace log = steady_log(80.0, 0.05);
    const std::vector<Contender> subject = {contender("fixed,centers=25Hz:50Hz,q=1")};
    const double target = *measure_on_log(subject, {log.view()}, paper_lines).methods[0].ripple_rms_nm;
    for (const int order : {1, 2, 4}) {
        const auto cutoff = cutoff_for_ripple(target, order, {log.view()}, paper_lines);
        REQUIRE(cutoff.has_value());
        const std::vector<Contender> matched = {make_contender(low_pass_spec(*cutoff, order))};
        const LogLevels levels = measure_on_log(matched, {log.view()}, paper_lines);
        CHECK(*levels.methods[0].ripple_rms_nm == Approx(target).epsilon(1e-4));
    }
}

TEST_CASE("no low-pass is found for more ripple than the log has") {
    const Trace log = steady_log(80.0, 0.0);
    CHECK_FALSE(cutoff_for_ripple(5.0, 1, {log.view()}, paper_lines).has_value());
}

TEST_CASE("without a log, the matched low-pass has the combined attenuation asked for") {
    for (const int order : {1, 2, 3, 8}) {
        for (const double wanted_db : {3.0, 22.0, 60.0}) {
            const double gain = std::pow(10.0, -wanted_db / 20.0);
            const auto cutoff = cutoff_for_gain(gain, order, paper_lines, 1000_Hz, 90_deg_s);
            REQUIRE(cutoff.has_value());
            const Cascade cascade =
                contender(low_pass_spec(*cutoff, order).text()).frozen(1000_Hz, 0_deg_s)->cascade;
            CHECK(ripple_gain(cascade, paper_lines, 1000_Hz, 90_deg_s).value() == Approx(gain).epsilon(1e-5));
        }
    }
    // The paper's own low-pass: 21.7 dB at 25 Hz is a first-order filter at 13 rad/s.
    const GearAccount first{GearRatio(100.0), {Order(1.0)}, {}, {}, ""};
    const Cascade papers = contender("lowpass,cutoff=13rad/s,order=1").frozen(1000_Hz, 0_deg_s)->cascade;
    const double gain = ripple_gain(papers, first, 1000_Hz, 90_deg_s).value();
    CHECK(gain == Approx(0.082).margin(0.001));
    CHECK(cutoff_for_gain(gain, 1, first, 1000_Hz, 90_deg_s)->value() ==
          Approx(13.0 / (2.0 * std::numbers::pi)).epsilon(1e-6));
}

TEST_CASE("amplitudes weigh the lines against each other") {
    GearAccount lines = paper_lines;
    lines.amplitude_nm = {0.0, 1.0};
    const GearAccount second{GearRatio(100.0), {Order(2.0)}, {}, {}, ""};
    CHECK(cutoff_for_gain(0.1, 1, lines, 1000_Hz, 90_deg_s)->value() ==
          Approx(cutoff_for_gain(0.1, 1, second, 1000_Hz, 90_deg_s)->value()).epsilon(1e-9));
}

TEST_CASE("no low-pass equals a complete null or a gain of one and more") {
    CHECK_FALSE(cutoff_for_gain(0.0, 1, paper_lines, 1000_Hz, 90_deg_s).has_value());
    CHECK_FALSE(cutoff_for_gain(1.01, 1, paper_lines, 1000_Hz, 90_deg_s).has_value());
    CHECK_THROWS_WITH(cutoff_for_gain(0.1, 1, paper_lines, 40_Hz, 90_deg_s),
                      Catch::Contains("half the sample rate"));
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

TEST_CASE("where no low-pass is equal, the match says why and names none") {
    const LowPassMatch null = match_at_speed("fixed", 0.0, 1, paper_lines, 1000_Hz, 90_deg_s);
    CHECK_FALSE(null.low_pass.has_value());
    CHECK_THAT(null.clause, Catch::Contains("completely") && Catch::Contains("--match-attenuation"));
    const LowPassMatch steep = match_at_speed("120 dB", 1e-6, 1, paper_lines, 1000_Hz, 90_deg_s);
    CHECK_FALSE(steep.low_pass.has_value());
    CHECK_THAT(steep.clause, Catch::Contains("120.00 dB") && Catch::Contains("0.01 to 490 Hz"));
    const Trace log = steady_log(80.0, 0.0);
    const LowPassMatch loud = match_on_log("fixed", 5.0, 1, {log.view()}, paper_lines);
    CHECK_FALSE(loud.low_pass.has_value());
    CHECK_THAT(loud.clause, Catch::Contains("remaining ripple of 5 Nm rms"));
}
