// SPDX-License-Identifier: MIT
#include "ripplenotch/design/notch.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "ripplenotch/core/error.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using namespace ripplenotch::literals;
using Catch::Contains;

namespace {

double gain(const Biquad& f, double hz, double rate) {
    return std::abs(response(f, Hertz(hz), SampledAt(Hertz(rate))));
}
double gain_db(const Biquad& f, double hz, double rate) { return 20.0 * std::log10(gain(f, hz, rate)); }

Biquad digital(double hz, double q, double rate) {
    return design_notch({Hertz(hz), q, infinite_depth_db, WidthRule::digital}, Hertz(rate));
}

// Where the gain crosses 1/sqrt(2) between two frequencies that bracket one crossing.
double edge_hz(const Biquad& f, double low, double high, double rate) {
    const bool falls = gain(f, low, rate) > std::numbers::sqrt2 / 2.0;
    for (int i = 0; i < 100; ++i) {
        const double middle = 0.5 * (low + high);
        ((gain(f, middle, rate) > std::numbers::sqrt2 / 2.0) == falls ? low : high) = middle;
    }
    return low;
}

}  // namespace

TEST_CASE("A1: the digital rule gives SciPy's iirnotch(0.06, 30)") {
    const Biquad f = digital(0.03, 30.0, 1.0);
    CHECK(f.b0 == Approx(0.996868235770807).epsilon(1e-13));
    CHECK(f.b1 == Approx(-1.958421917308129).epsilon(1e-13));
    CHECK(f.b2 == Approx(0.996868235770807).epsilon(1e-13));
    CHECK(f.a1 == Approx(-1.958421917308129).epsilon(1e-13));
    CHECK(f.a2 == Approx(0.993736471541615).epsilon(1e-13));
}

TEST_CASE("A2: iirnotch(0.3, 30) is 3 dB down at 0.295 and 0.305, open at 0.2 and 0.4, shut at 0.3") {
    const Biquad f = digital(1500.0, 30.0, 10000.0);
    CHECK(gain(f, 1475.0, 10000.0) == Approx(0.70914).margin(5e-6));
    CHECK(gain(f, 1525.0, 10000.0) == Approx(0.70510).margin(5e-6));
    CHECK(gain(f, 1000.0, 10000.0) == Approx(0.99913).margin(5e-6));
    CHECK(gain(f, 2000.0, 10000.0) == Approx(0.99857).margin(5e-6));
    CHECK(gain(f, 1500.0, 10000.0) < 1e-10);
}

TEST_CASE("A3: 60 Hz, Q 30 at 200 Hz has SciPy's coefficients, edges and gains") {
    const Biquad f = digital(60.0, 30.0, 200.0);
    CHECK(f.b0 == Approx(0.969531252908746).epsilon(1e-13));
    CHECK(f.b2 == f.b0);
    CHECK(f.b1 == Approx(0.599203267452875).epsilon(1e-13));
    CHECK(f.a1 == f.b1);
    CHECK(f.a2 == Approx(0.939062505817492).epsilon(1e-13));
    const double low = edge_hz(f, 50.0, 60.0, 200.0), high = edge_hz(f, 60.0, 70.0, 200.0);
    CHECK(low == Approx(58.994897).margin(1e-6));
    CHECK(high == Approx(60.994897).margin(1e-6));
    CHECK(high - low == Approx(2.0).margin(1e-9));
    CHECK(gain_db(f, 50.0, 200.0) == Approx(-0.0447).margin(5e-5));
    CHECK(gain_db(f, 55.0, 200.0) == Approx(-0.1761).margin(5e-5));
    CHECK(gain_db(f, 59.5, 200.0) == Approx(-7.009).margin(5e-4));
    CHECK(gain_db(f, 65.0, 200.0) == Approx(-0.1591).margin(5e-5));
    CHECK(gain_db(f, 70.0, 200.0) == Approx(-0.0360).margin(5e-5));
}

TEST_CASE("A4: 60 Hz, Q 35 at 300 Hz has MATLAB's coefficients and width") {
    const Biquad f = digital(60.0, 35.0, 300.0);
    CHECK(f.b0 == Approx(0.982362770083370).epsilon(1e-13));
    CHECK(f.b1 == Approx(-0.607133581194021).epsilon(1e-13));
    CHECK(f.a2 == Approx(0.964725540166739).epsilon(1e-13));
    const double low = edge_hz(f, 50.0, 60.0, 300.0), high = edge_hz(f, 60.0, 70.0, 300.0);
    CHECK(low == Approx(59.145357).margin(1e-6));
    CHECK(high == Approx(60.859643).margin(1e-6));
    CHECK(high - low == Approx(60.0 / 35.0).margin(1e-9));
}

TEST_CASE("A5: a notch of finite depth has its depth at the centre and delays by 2 zeta (1 - gmin) / omega") {
    for (const auto width : {WidthRule::analog, WidthRule::digital}) {
        for (const double depth : {3.0, 20.0, 40.0, 80.0}) {
            // Sampled so fast that the continuous formula holds to a few parts in a million.
            const double rate = 1e4, hz = 10.0, q = 0.7;
            const Biquad f = design_notch({Hertz(hz), q, depth, width}, Hertz(rate));
            CHECK(gain_db(f, hz, rate) == Approx(-depth).margin(1e-6));
            const double zeta = 1.0 / (2.0 * q), least = std::pow(10.0, -depth / 20.0);
            const double continuous = 2.0 * zeta * (1.0 - least) / (2.0 * std::numbers::pi * hz);
            CHECK(group_delay(Cascade{f}, 0_Hz, SampledAt(Hertz(rate))).value() ==
                  Approx(continuous).epsilon(2e-5));
        }
    }
}

TEST_CASE("the analog rule is the bilinear image of the paper's twin-T, exact at every frequency") {
    const double rate = 1000.0, hz = 25.0;
    const Biquad f = design_notch({Hertz(hz)}, Hertz(rate));
    const double warped_center = std::tan(std::numbers::pi * hz / rate);
    for (double at = 0.5; at < 499.0; at += 0.5) {
        // H(j u) of eq. 2 with w0 = 1, at the frequency that the bilinear transform puts there.
        const std::complex<double> s(0.0, std::tan(std::numbers::pi * at / rate) / warped_center);
        const auto prototype = (s * s + 1.0) / (s * s + 4.0 * s + 1.0);
        REQUIRE(std::abs(response(f, Hertz(at), SampledAt(Hertz(rate))) - prototype) < 1e-11);
    }
    // The paper's 25 Hz notch at Q 1/4 is 3 dB down from about 5.9 to 102 Hz.
    CHECK(edge_hz(f, 1.0, 25.0, rate) == Approx(5.9).margin(0.05));
    CHECK(edge_hz(f, 25.0, 300.0, rate) == Approx(102.0).margin(0.5));
}

TEST_CASE("the digital rule has a -3 dB width of exactly centre over Q, whatever the sample rate") {
    std::mt19937 engine(1);
    std::uniform_real_distribution<double> where(0.02, 0.4), quality(0.0, 2.0);
    for (int i = 0; i < 300; ++i) {
        const double rate = 1000.0, hz = rate * where(engine), q = std::pow(10.0, quality(engine));
        if (hz / q > 0.4 * rate) continue;
        const Biquad f = digital(hz, q, rate);
        const double width = edge_hz(f, hz, 499.9999, rate) - edge_hz(f, 1e-6, hz, rate);
        CHECK(width == Approx(hz / q).epsilon(1e-9));
    }
}

TEST_CASE("a random notch stays inside its mask: 1 at both ends, never above 1, monotone to its null") {
    std::mt19937 engine(2);
    std::uniform_real_distribution<double> where(0.001, 0.499), quality(-1.0, 2.5), depth(1.0, 100.0),
        coin(0.0, 1.0);
    for (int i = 0; i < 500; ++i) {
        const double rate = 1000.0;
        const NotchSpec spec{Hertz(rate * where(engine)), std::pow(10.0, quality(engine)),
                             coin(engine) < 0.5 ? infinite_depth_db : depth(engine), WidthRule::analog};
        INFO("centre " << spec.center.value() << " Hz, Q " << spec.q << ", depth " << spec.depth_db << " dB");
        const Biquad f = design_notch(spec, Hertz(rate));
        CHECK(pole_radius(f) < 1.0);
        CHECK(std::abs(response(f, 0_Hz, SampledAt(Hertz(rate)))) == Approx(1.0).epsilon(1e-9));
        CHECK(std::abs(response(f, 500_Hz, SampledAt(Hertz(rate)))) == Approx(1.0).epsilon(1e-9));
        const double floor_gain =
            spec.depth_db >= infinite_depth_db ? 0.0 : std::pow(10.0, -spec.depth_db / 20.0);
        CHECK(gain(f, spec.center.value(), rate) == Approx(floor_gain).margin(1e-9));
        double before = 1.0;
        for (int k = 1; k <= 200; ++k) {
            const double now = gain(f, spec.center.value() * k / 200.0, rate);
            REQUIRE(now <= before + 1e-9);
            before = now;
        }
        for (int k = 1; k <= 200; ++k) {
            const double now = gain(f, spec.center.value() + (500.0 - spec.center.value()) * k / 200.0, rate);
            REQUIRE(now >= before - 1e-9);
            before = now;
        }
    }
}

TEST_CASE("a line that misses the centre is attenuated as the detuning law says") {
    const auto detuned_db = [](double q, double off) {
        // So far below half the sample rate that the sampled filter is the continuous one.
        const Biquad f = design_notch({1_Hz, q}, 100000_Hz);
        return gain_db(f, 1.0 + off, 100000.0);
    };
    for (const double q : {1.0, 5.0, 30.0}) {
        for (const double off : {0.01, 0.02, 0.05, 0.10}) {
            const double r = 1.0 + off, null = std::abs(1.0 - r * r);
            const double law = 20.0 * std::log10(null / std::hypot(1.0 - r * r, r / q));
            CHECK(detuned_db(q, off) == Approx(law).margin(1e-4));
        }
    }
    CHECK(detuned_db(1.0, 0.01) == Approx(-34.02).margin(0.005));
    CHECK(detuned_db(1.0, 0.02) == Approx(-28.05).margin(0.005));
    CHECK(detuned_db(1.0, 0.05) == Approx(-20.25).margin(0.005));
    CHECK(detuned_db(1.0, 0.10) == Approx(-14.54).margin(0.005));
    CHECK(detuned_db(5.0, 0.01) == Approx(-20.09).margin(0.005));
    CHECK(detuned_db(5.0, 0.02) == Approx(-14.23).margin(0.005));
    CHECK(detuned_db(5.0, 0.05) == Approx(-7.16).margin(0.005));
    CHECK(detuned_db(5.0, 0.10) == Approx(-3.22).margin(0.005));
    CHECK(detuned_db(30.0, 0.01) == Approx(-5.80).margin(0.005));
}

TEST_CASE("a notch that cannot exist is refused with its value and the limit") {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    CHECK_THROWS_WITH(design_notch({500_Hz}, 1000_Hz),
                      Contains("500 Hz") && Contains("half the sample rate, 500 Hz"));
    CHECK_THROWS_WITH(design_notch({600_Hz}, 1000_Hz),
                      Contains("600 Hz") && Contains("half the sample rate"));
    CHECK_THROWS_WITH(design_notch({0_Hz}, 1000_Hz), Contains("not above 0 Hz"));
    CHECK_THROWS_WITH(design_notch({Hertz(-5.0)}, 1000_Hz), Contains("-5 Hz is not above 0 Hz"));
    CHECK_THROWS_WITH(design_notch({Hertz(nan)}, 1000_Hz), Contains("nan"));
    CHECK_THROWS_WITH(design_notch({50_Hz, 0.0}, 1000_Hz), Contains("Q 0 is not above 0"));
    CHECK_THROWS_WITH(design_notch({50_Hz, -2.0}, 1000_Hz), Contains("Q -2 is not above 0"));
    CHECK_THROWS_WITH(design_notch({50_Hz, nan}, 1000_Hz), Contains("Q nan"));
    CHECK_THROWS_WITH(design_notch({50_Hz, 1.0, 0.0}, 1000_Hz), Contains("depth 0 dB"));
    CHECK_THROWS_WITH(design_notch({50_Hz, 1.0, nan}, 1000_Hz), Contains("depth nan dB"));
    CHECK_THROWS_WITH(design_notch({50_Hz}, 0_Hz), Contains("sample rate is 0 Hz"));
    CHECK_THROWS_WITH(design_notch({50_Hz}, Hertz(nan)), Contains("sample rate is nan Hz"));
    CHECK_THROWS_WITH(digital(150.0, 0.25, 1000.0), Contains("600 Hz wide") && Contains("analog"));
    CHECK_THROWS_WITH(design_notch({1_Hz, 1e16}, 1000_Hz), Contains("too narrow"));
    CHECK_THROWS_AS(design_notch({500_Hz}, 1000_Hz), UsageError);
}

TEST_CASE("a low-pass of any order is the Butterworth magnitude, prewarped at its cut-off") {
    for (int order = 1; order <= 20; ++order) {
        for (const double cutoff : {0.5, 13.0, 120.0, 450.0}) {
            const Cascade f = design_low_pass({Hertz(cutoff), order}, 1000_Hz);
            CHECK(f.size() == static_cast<std::size_t>((order + 1) / 2));
            CHECK(pole_radius(f) < 1.0);
            for (double hz = 0.25; hz < 500.0; hz *= 1.3) {
                const double ratio =
                    std::tan(std::numbers::pi * hz / 1000.0) / std::tan(std::numbers::pi * cutoff / 1000.0);
                const double expected = 1.0 / std::sqrt(1.0 + std::pow(ratio, 2.0 * order));
                REQUIRE(std::abs(response(f, Hertz(hz), SampledAt(1000_Hz))) ==
                        Approx(expected).epsilon(1e-7).margin(1e-12));
            }
            CHECK(std::abs(response(f, Hertz(cutoff), SampledAt(1000_Hz))) ==
                  Approx(std::numbers::sqrt2 / 2.0).epsilon(1e-9));
        }
    }
}

TEST_CASE("the gain of a low-pass at 0 Hz is 1 to the last digits, however low its cut-off") {
    for (const double cutoff : {1e-3, 0.1, 2.0, 200.0}) {
        for (int order = 1; order <= 8; ++order) {
            for (const Biquad& f : design_low_pass({Hertz(cutoff), order}, 1000_Hz)) {
                CHECK(dc_gain(f) == Approx(1.0).epsilon(1e-14));
            }
        }
    }
}

TEST_CASE("second-order Butterworth baselines: delay and attenuation at 8.33 Hz") {
    struct Case {
        double cutoff, delay_ms, gain_db, settle_ms;
    };
    for (const Case& c : {Case{2.0, 112.5, -24.8, 474.0}, Case{3.0, 75.0, -17.8, 316.0},
                          Case{5.0, 45.0, -9.4, 190.0}, Case{25.0 / 3.0, 27.0, -3.0, 114.0}}) {
        const Cascade f = design_low_pass({Hertz(c.cutoff), 2}, 1000_Hz);
        CHECK(1e3 * group_delay(f, 0_Hz, SampledAt(1000_Hz)).value() == Approx(c.delay_ms).margin(0.05));
        CHECK(20.0 * std::log10(std::abs(response(f, Hertz(25.0 / 3.0), SampledAt(1000_Hz)))) ==
              Approx(c.gain_db).margin(0.06));
        CHECK(1e3 * measure_step(f, 1000_Hz, 2.0).settle.value() == Approx(c.settle_ms).margin(1.0));
    }
}

TEST_CASE("a low-pass that cannot exist is refused with its value and the limit") {
    CHECK_THROWS_WITH(design_low_pass({500_Hz, 1}, 1000_Hz), Contains("half the sample rate, 500 Hz"));
    CHECK_THROWS_WITH(design_low_pass({0_Hz, 1}, 1000_Hz), Contains("not above 0 Hz"));
    CHECK_THROWS_WITH(design_low_pass({Hertz(std::numeric_limits<double>::quiet_NaN()), 1}, 1000_Hz),
                      Contains("nan"));
    CHECK_THROWS_WITH(design_low_pass({10_Hz, 0}, 1000_Hz), Contains("order 0"));
    CHECK_THROWS_WITH(design_low_pass({10_Hz, 21}, 1000_Hz), Contains("order 21"));
    CHECK_THROWS_WITH(design_low_pass({10_Hz, 1}, 0_Hz), Contains("sample rate is 0 Hz"));
    CHECK_THROWS_WITH(design_low_pass({Hertz(1e-9), 4}, 1000_Hz), Contains("too low"));
}

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
