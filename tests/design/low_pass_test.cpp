// SPDX-License-Identifier: MIT
#include "ripplenotch/design/notch.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include "support/catch.hpp"

using namespace ripplenotch;
using namespace ripplenotch::literals;
using Catch::Contains;

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
