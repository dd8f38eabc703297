// SPDX-License-Identifier: MIT
// Circle functions of many angles, four at a time: the steps of portable_angles.cpp in the same
// order, so the bits are the same.
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>

#include "core/functions/many_numbers.hpp"
#include "core/functions/polynomials.hpp"
#include "core/vectors/lanes.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch::portable {
namespace {

template <class Lanes>
RIPPLENOTCH_INLINED void sum_series(Lanes& sum, const std::array<double, 9>& terms, const Lanes& z) {
    fill(sum, terms[8]);
#pragma GCC unroll 8
    for (std::size_t i = 8; i > 0; --i) sum = sum * z + terms[i - 1];
}

constexpr double round_by_adding = 6755399441055744.0;  // its last bits are those of the integer added

/// Angles whose quarters are below 2^44, which no joint reaches. `quarters_on`: 3 turns a cosine into a sine.
struct Cosines {
    template <class Lanes>
    RIPPLENOTCH_INLINED static void run(const double* angle_deg, std::size_t fours, long long quarters_on,
                                        double* cosine) {
        for (std::size_t k = 0; k < fours * lane_count; k += lane_count) {
            Lanes angle, even, odd;
            BitsOf<Lanes> quadrant;
            load(angle, angle_deg + k);
            const Lanes rounding = angle / 90.0 + round_by_adding;
            const Lanes x = (angle - (rounding - round_by_adding) * 90.0) * (std::numbers::pi / 180.0);
            const Lanes z = x * x;
            sum_series(even, cosine_terms, z);
            sum_series(odd, sine_terms, z);
            odd = x * odd;
            to_bits(quadrant, rounding);
            quadrant += quarters_on;
            choose<Lanes>(odd, -(quadrant & 1), even);
            flip_signs<Lanes>(odd, ((quadrant + 1) & 2) << 62);
            store(cosine + k, odd + 0.0);  // + 0.0: no negative zero
        }
    }
};

/// Angles in radians, below 2^20.
struct Phasors {
    template <class Lanes>
    RIPPLENOTCH_INLINED static void run(const double* angle_rad, std::size_t fours, double* cosine,
                                        double* sine) {
        constexpr double first = 0x1.921fb544p+0, second = 0x1.0b4611a6p-34, third = 0x1.3198a2e037073p-69;
        Lanes zero;
        fill(zero, 0.0);
        for (std::size_t k = 0; k < fours * lane_count; k += lane_count) {
            Lanes angle, even, odd;
            BitsOf<Lanes> quadrant;
            load(angle, angle_rad + k);
            const Lanes rounding = angle * (2.0 / std::numbers::pi) + round_by_adding;
            const Lanes quarters = rounding - round_by_adding;
            const Lanes rough = angle - quarters * first, taken = quarters * second;
            const Lanes fine = rough - taken;
            const Lanes x = fine + (((rough - fine) - taken) - quarters * third);
            const Lanes z = x * x;
            sum_series(even, cosine_terms, z);
            sum_series(odd, sine_terms, z);
            odd = x * odd;
            to_bits(quadrant, rounding);
            const BitsOf<Lanes> swapped = -(quadrant & 1);
            Lanes real = odd, imaginary = even;
            choose<Lanes>(real, swapped, even);
            choose<Lanes>(imaginary, swapped, odd);
            flip_signs<Lanes>(real, ((quadrant + 1) & 2) << 62);
            flip_signs<Lanes>(imaginary, (quadrant & 2) << 62);
            // A sine of 0 has the sign of its angle.
            const BitsOf<Lanes> nothing = angle == zero;
            choose<Lanes>(imaginary, ~nothing, angle);
            store(cosine + k, real);
            store(sine + k, imaginary);
        }
    }
};

void cosines_of(std::span<const double> angle_deg, long long quarters_on, double (*one)(double),
                std::span<double> cosine) {
    const auto all_small = [](std::span<const double> angles) {
        bool small = true;
        for (const double angle : angles) small = small && std::abs(angle) < 0x1p50;
        return small;
    };
    const std::size_t fours = all_small(angle_deg) ? angle_deg.size() / lane_count : 0;
    in_lanes<Cosines>(angle_deg.data(), fours, quarters_on, cosine.data());
    for (std::size_t k = fours * lane_count; k < angle_deg.size(); ++k) cosine[k] = one(angle_deg[k]);
}

}  // namespace

void cos_degrees(std::span<const double> angle_deg, std::span<double> cosine) {
    cosines_of(
        angle_deg, 0, [](double angle) { return cos_degrees(angle); }, cosine);
}

void sin_degrees(std::span<const double> angle_deg, std::span<double> sine) {
    cosines_of(
        angle_deg, 3, [](double angle) { return sin_degrees(angle); }, sine);
}

void phasors(std::span<const double> angle_rad, std::span<double> cosine, std::span<double> sine) {
    bool small = true;
    for (const double angle : angle_rad) small = small && std::abs(angle) < 0x1p20;
    const std::size_t fours = small ? angle_rad.size() / lane_count : 0;
    in_lanes<Phasors>(angle_rad.data(), fours, cosine.data(), sine.data());
    for (std::size_t k = fours * lane_count; k < angle_rad.size(); ++k) {
        const std::complex<double> one = phasor(angle_rad[k]);
        cosine[k] = one.real();
        sine[k] = one.imag();
    }
}

void cos(std::span<const double> angle_rad, std::span<double> cosine) {
    std::array<double, 256> cosines{}, sines{};
    for (std::size_t first = 0; first < angle_rad.size(); first += cosines.size()) {
        const std::size_t count = std::min(cosines.size(), angle_rad.size() - first);
        phasors(angle_rad.subspan(first, count), cosines, sines);
        std::copy_n(cosines.begin(), count, cosine.begin() + static_cast<std::ptrdiff_t>(first));
    }
}

}  // namespace ripplenotch::portable
