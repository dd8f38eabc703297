// SPDX-License-Identifier: MIT
#include "core/functions/many_numbers.hpp"

#include <bit>
#include <cmath>
#include <complex>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

#include "ripplenotch/core/portable_math.hpp"
#include "support/catch.hpp"
#include "support/vectors.hpp"

using namespace ripplenotch;
using namespace ripplenotch::testing;

namespace {
constexpr double radians = std::numbers::pi / 180.0;
}

TEST_CASE("many phasors at once have the bits of each alone") {
    std::mt19937_64 random(13);
    for (const double reach : {1e-9, 3.0, 1e3, 0x1p20, 1e9}) {
        std::uniform_real_distribution<double> anywhere(-reach, reach);
        for (const std::size_t count : {0u, 1u, 5u, 1000u}) {
            std::vector<double> angles(count), cosines(count), sines(count);
            for (double& value : angles) value = anywhere(random);
            for (std::size_t k = 0; k < count / 8; ++k)
                angles[k] = k % 2 == 0 ? -0.0 : 45.0 * radians * static_cast<double>(k);
            for (const bool wide : widths()) {
                const Width here(wide);
                portable::phasors(angles, cosines, sines);
                for (std::size_t k = 0; k < count; ++k) {
                    CAPTURE(angles[k], wide);
                    const std::complex<double> alone = portable::phasor(angles[k]);
                    CHECK(std::bit_cast<std::uint64_t>(cosines[k]) ==
                          std::bit_cast<std::uint64_t>(alone.real()));
                    CHECK(std::bit_cast<std::uint64_t>(sines[k]) ==
                          std::bit_cast<std::uint64_t>(alone.imag()));
                }
            }
        }
    }
}

TEST_CASE("many exponentials, hyperbolic tangents and powers at once have the bits of each alone") {
    std::mt19937_64 random(12);
    const auto same = [](const std::vector<double>& numbers, const std::vector<double>& values, auto one) {
        for (std::size_t k = 0; k < numbers.size(); ++k) {
            CAPTURE(numbers[k]);
            CHECK(std::bit_cast<std::uint64_t>(values[k]) == std::bit_cast<std::uint64_t>(one(numbers[k])));
        }
    };
    for (const double reach : {1e-9, 1.0, 30.0, 699.0, 1e5, 1e300}) {
        std::uniform_real_distribution<double> anywhere(-reach, reach);
        for (const std::size_t count : {0u, 1u, 3u, 4u, 7u, 2000u}) {
            std::vector<double> numbers(count), values(count), sizes(count);
            for (double& value : numbers) value = anywhere(random);
            for (std::size_t k = 0; k < count / 8; ++k)
                numbers[k] = k % 3 == 0 ? -0.0 : 20.0 * static_cast<double>(k % 3);
            for (std::size_t k = 0; k < count; ++k) sizes[k] = std::abs(numbers[k]);
            for (const bool wide : widths()) {
                const Width here(wide);
                portable::exp(numbers, values);
                same(numbers, values, [](double x) { return portable::exp(x); });
                portable::tanh(numbers, values);
                same(numbers, values, [](double x) { return portable::tanh(x); });
                for (const double p : {0.1, 0.5, 0.7, 1.0, 2.0, 3.999, -1.5, 7.3}) {
                    portable::pow(sizes, p, values);
                    same(sizes, values, [p](double x) { return portable::pow(x, p); });
                }
            }
        }
    }
    std::vector<double> special = {std::nan(""), HUGE_VAL, -HUGE_VAL, 10.0, 1e-310, 5e-324, -3.0, 1.0};
    std::vector<double> values(special.size());
    for (const double p : {0.3, 2.0}) {
        portable::pow(special, p, values);
        for (std::size_t k = 0; k < special.size(); ++k) {
            const double alone = portable::pow(special[k], p);
            CHECK(((std::isnan(values[k]) && std::isnan(alone)) || values[k] == alone));
        }
    }
}
