#include "ripplenotch/core/biquad.hpp"

#include <cmath>
#include <numbers>
#include <random>

#include "support/catch.hpp"

using namespace ripplenotch;
using namespace ripplenotch::literals;

namespace {
// A stable section with poles at radius r and angle theta, zeros on the circle at phi, unity gain at DC.
Biquad section(double r, double theta, double phi) {
    Biquad f{1.0, -2.0 * std::cos(phi), 1.0, -2.0 * r * std::cos(theta), r * r};
    const double gain = dc_gain(f);
    return {f.b0 / gain, f.b1 / gain, f.b2 / gain, f.a1, f.a2};
}
}  // namespace

TEST_CASE("the response of a section is what a sine measures on it") {
    const Biquad f = section(0.9, 0.3, 0.5);
    const double hz = 37.0, rate = 1000.0;
    BiquadState s;
    std::complex<double> in = 0.0, out = 0.0;
    for (int k = 0; k < 3000; ++k) {
        const double phase = 2.0 * std::numbers::pi * hz * k / rate;
        const double y = step(f, s, std::cos(phase));
        if (k >= 2000) {  // 37 whole periods, long after the transient (0.9^2000)
            in += std::cos(phase) * std::polar(1.0, -phase);
            out += y * std::polar(1.0, -phase);
        }
    }
    CHECK(std::abs(out / in - response(f, Hertz(hz), SampledAt(Hertz(rate)))) < 1e-9);
}

TEST_CASE("group delay is the negative slope of the phase") {
    const Cascade cascade = {section(0.9, 0.3, 0.5), section(0.7, 0.9, 1.2)};
    for (double hz = 1.0; hz < 450.0; hz += 7.3) {
        const double h = 1e-4;
        const auto ratio = response(cascade, Hertz(hz + h), SampledAt(1000_Hz)) /
                           response(cascade, Hertz(hz - h), SampledAt(1000_Hz));
        const double slope = -std::arg(ratio) / (2.0 * std::numbers::pi * 2.0 * h);
        CHECK(group_delay(cascade, Hertz(hz), SampledAt(1000_Hz)).value() == Approx(slope).margin(1e-8));
    }
}

TEST_CASE("a ramp lags by the group delay at zero frequency") {
    const Cascade cascade = {section(0.95, 0.2, 0.3)};
    BiquadState s;
    double y = 0.0;
    for (int k = 0; k <= 4000; ++k) y = step(cascade[0], s, 0.01 * k);
    CHECK((0.01 * 4000 - y) / 0.01 / 1000.0 ==
          Approx(group_delay(cascade, 0_Hz, SampledAt(1000_Hz)).value()).epsilon(1e-9));
}

TEST_CASE("pole radius is right for complex and for real poles") {
    CHECK(pole_radius(section(0.93, 1.0, 0.5)) == Approx(0.93).epsilon(1e-12));
    CHECK(pole_radius(Biquad{1, 0, 0, -(0.9 + 0.5), 0.9 * 0.5}) == Approx(0.9).epsilon(1e-12));
    CHECK(pole_radius(Biquad{1, 0, 0, 0.9 + 0.5, 0.9 * 0.5}) == Approx(0.9).epsilon(1e-12));
}
