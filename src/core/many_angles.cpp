// SPDX-License-Identifier: MIT
// cos_degrees and sin_degrees of many angles, four at a time: the steps of portable_angles.cpp in the same
// order, so the bits are the same.
#include <cmath>
#include <numbers>

#include "core/circle_terms.hpp"
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

/// Angles whose quarters are below 2^44, which no joint reaches. `quarters_on`: 3 turns a cosine into a sine.
struct Cosines {
    template <class Lanes>
    RIPPLENOTCH_INLINED static void run(const double* angle_deg, std::size_t fours, long long quarters_on,
                                        double* cosine) {
        constexpr double round_by_adding =
            6755399441055744.0;  // its last bits are those of the integer added
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

}  // namespace ripplenotch::portable
