// SPDX-License-Identifier: MIT
#include "ripplenotch/evaluate/contender.hpp"

#include <fmt/format.h>

#include <cmath>
#include <random>

#include "evaluate/contenders.hpp"
#include "ripplenotch/core/biquad.hpp"
#include "ripplenotch/design/notch.hpp"
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
