// SPDX-License-Identifier: MIT
#include "ripplenotch/design/notch.hpp"

#include <cmath>
#include <random>

#include "support/catch.hpp"

using namespace ripplenotch;
using namespace ripplenotch::literals;
using Catch::Contains;

namespace {

Cascade pair_of_notches(double hz, double q, WidthRule width, double rate = 1000.0) {
    return {design_notch({Hertz(hz), q, infinite_depth_db, width}, Hertz(rate)),
            design_notch({Hertz(2.0 * hz), q, infinite_depth_db, width}, Hertz(rate))};
}

double settle_ms(const Cascade& cascade, double percent) {
    return 1e3 * measure_step(cascade, 1000_Hz, percent).settle.value();
}

/// Settling time in seconds and overshoot in per cent from every sample until the response has surely
/// settled.
std::pair<double, double> whole_run(const Cascade& cascade, double rate, double band_percent) {
    double target = 1.0;
    for (const Biquad& f : cascade) target *= dc_gain(f);
    std::vector<BiquadState> states(cascade.size());
    double last_outside = 0.0, peak = 0.0;
    const std::size_t count = samples_to_settle(cascade, band_percent / 100.0);
    for (std::size_t k = 0; k < count; ++k) {
        double y = 1.0;
        for (std::size_t n = 0; n < cascade.size(); ++n) y = step(cascade[n], states[n], y);
        if (!(std::abs(y - target) <= std::abs(target) * band_percent / 100.0))
            last_outside = static_cast<double>(k + 1);
        peak = std::max(peak, y / target);
    }
    const double overshoot = 100.0 * (peak - 1.0);
    return {last_outside / rate, overshoot > 1e-6 ? overshoot : 0.0};
}

}  // namespace

TEST_CASE("the paper's pair at 25 and 50 Hz settles in 147 ms to 0.5 %, 130 ms to 1 %, 114 ms to 2 %") {
    const Cascade cascade = pair_of_notches(25.0, 0.25, WidthRule::analog);
    CHECK(settle_ms(cascade, 0.5) == Approx(147.0).margin(1.0));
    CHECK(settle_ms(cascade, 1.0) == Approx(130.0).margin(1.0));
    CHECK(settle_ms(cascade, 2.0) == Approx(114.0).margin(1.0));
    CHECK(1e3 * group_delay(cascade, 0_Hz, SampledAt(1000_Hz)).value() == Approx(38.04).margin(0.005));
}

TEST_CASE("the low-pass that the paper calls 13 Hz settles in 408 ms at 13 rad/s and in 65 ms at 13 Hz") {
    CHECK(settle_ms(design_low_pass({Hertz(13.0 / 6.283185307179586), 1}, 1000_Hz), 0.5) ==
          Approx(408.0).margin(1.0));
    CHECK(settle_ms(design_low_pass({13_Hz, 1}, 1000_Hz), 0.5) == Approx(65.0).margin(1.0));
    CHECK(settle_ms(design_low_pass({13_Hz, 2}, 1000_Hz), 0.5) == Approx(86.0).margin(1.0));
    CHECK(settle_ms(design_low_pass({13_Hz, 4}, 1000_Hz), 0.5) == Approx(164.0).margin(1.0));
    CHECK(settle_ms(design_low_pass({13_Hz, 10}, 1000_Hz), 0.5) == Approx(367.0).margin(1.0));
}

TEST_CASE("two notches in series: delay, settling and overshoot of the reference cascades (digital rule)") {
    struct Case {
        double speed, q, delay_ms, settle_2_ms, settle_5_ms, overshoot;
    };
    for (const Case& c : {Case{10, 1, 85.952, 419, 383, 9.12}, Case{30, 0.5, 57.427, 152, 130, 0.0},
                          Case{30, 1, 28.674, 140, 128, 9.10}, Case{30, 2, 14.332, 237, 169, 18.70},
                          Case{30, 5, 5.732, 402, 268, 17.74}, Case{60, 1, 14.377, 70, 64, 9.05}}) {
        INFO(c.speed << " deg/s, Q " << c.q);
        const Cascade cascade = pair_of_notches(100.0 * c.speed / 360.0, c.q, WidthRule::digital);
        CHECK(1e3 * group_delay(cascade, 0_Hz, SampledAt(1000_Hz)).value() ==
              Approx(c.delay_ms).margin(5e-4));
        CHECK(settle_ms(cascade, 2.0) == Approx(c.settle_2_ms).margin(1.0));
        CHECK(settle_ms(cascade, 5.0) == Approx(c.settle_5_ms).margin(1.0));
        CHECK(measure_step(cascade, 1000_Hz, 2.0).overshoot_percent == Approx(c.overshoot).margin(0.006));
    }
}

TEST_CASE("a narrower band never settles earlier, and a measurement ten times as long changes nothing") {
    std::mt19937 engine(4);
    std::uniform_real_distribution<double> where(0.5, 240.0), quality(-1.0, 1.0);
    for (int i = 0; i < 100; ++i) {
        const Cascade cascade =
            pair_of_notches(where(engine), std::pow(10.0, quality(engine)), WidthRule::analog);
        double before = 0.0;
        for (const double percent : {50.0, 5.0, 2.0, 1.0, 0.5, 0.01}) {
            const double now = settle_ms(cascade, percent);
            CHECK(now >= before);
            before = now;
        }
        const std::size_t count = samples_to_settle(cascade, 1e-4);
        std::vector<BiquadState> states(cascade.size());
        std::size_t last_outside = 0;
        for (std::size_t k = 0; k < 10 * count; ++k) {
            double y = 1.0;
            for (std::size_t n = 0; n < cascade.size(); ++n) y = step(cascade[n], states[n], y);
            if (std::abs(y - 1.0) > 1e-4) last_outside = k + 1;
        }
        CHECK(before == Approx(static_cast<double>(last_outside)).margin(1e-9));
    }
}

TEST_CASE("stopping once nothing that is to come can matter gives the very figures of the whole run") {
    std::mt19937 engine(11);
    std::uniform_real_distribution<double> hz(-1.0, 2.6), quality(-1.0, 1.5), percent(-7.0, 1.9);
    for (int i = 0; i < 600; ++i) {
        Cascade cascade;
        const int kind = i % 6;
        const double f = std::pow(10.0, hz(engine)), q = std::pow(10.0, quality(engine));
        if (kind == 0) cascade = pair_of_notches(std::min(f, 240.0), q, WidthRule::analog);
        if (kind == 1) cascade = design_low_pass({Hertz(f), 1 + i % 7}, 1000_Hz);
        if (kind == 2) cascade = {design_notch({Hertz(f), q}, 1000_Hz), design_notch({Hertz(f), q}, 1000_Hz)};
        if (kind == 3)
            cascade = {design_notch({Hertz(f), q, 30.0}, 1000_Hz),
                       design_notch({Hertz(1.0001 * f), q}, 1000_Hz)};
        if (kind == 4) cascade = {Biquad{-0.5, 0.0, 0.0, -0.9, 0.0}, design_notch({Hertz(f), q}, 1000_Hz)};
        if (kind == 5) cascade = {Biquad{1.0, -1.0, 0.0, -0.9, 0.0}};  // no gain at 0 Hz at all
        const double band_percent = std::pow(10.0, percent(engine));
        INFO("kind " << kind << ", " << f << " Hz, Q " << q << ", band " << band_percent << " %");
        const StepFigures figures = measure_step(cascade, 1000_Hz, band_percent);
        const auto [settle, overshoot] = whole_run(cascade, 1000.0, band_percent);
        CHECK(figures.settle.value() == settle);
        CHECK(figures.overshoot_percent == overshoot);
    }
}

TEST_CASE("a filter that does nothing settles at once without overshoot") {
    const StepFigures figures = measure_step(Cascade{Biquad{}}, 1000_Hz, 0.5);
    CHECK(figures.settle.value() == 0.0);
    CHECK(figures.overshoot_percent == 0.0);
}

TEST_CASE("an unstable or endlessly slow filter is refused instead of measured") {
    CHECK_THROWS_WITH(measure_step(Cascade{Biquad{1, 0, 0, -1.2, 0}}, 1000_Hz, 1.0), Contains("unstable"));
    CHECK_THROWS_WITH(measure_step(Cascade{design_notch({1_Hz, 1e9}, 1000_Hz)}, 1000_Hz, 1.0),
                      Contains("too many to measure"));
    CHECK_THROWS_WITH(measure_step(Cascade{Biquad{}}, 1000_Hz, 0.0), Contains("outside 0 to 100"));
    CHECK_THROWS_WITH(measure_step(Cascade{Biquad{}}, 0_Hz, 1.0), Contains("sample rate"));
}
