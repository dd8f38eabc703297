// SPDX-License-Identifier: MIT
#include "core/first_outside.hpp"

#include <cmath>

#include "core/lanes.hpp"

namespace ripplenotch {
namespace {

constexpr std::size_t at_once = 16;

struct Magnitudes {
    const double* values;

    [[nodiscard]] double at(std::size_t k) const { return std::abs(values[k]); }
    template <class Lanes>
    RIPPLENOTCH_INLINED void load_at(Lanes& lanes, std::size_t k) const {
        load(lanes, values + k);
        drop_signs(lanes);
    }
};

/// From each value to the next.
struct Steps {
    const double* values;

    [[nodiscard]] double at(std::size_t k) const { return values[k + 1] - values[k]; }
    template <class Lanes>
    RIPPLENOTCH_INLINED void load_at(Lanes& lanes, std::size_t k) const {
        Lanes before;
        load(lanes, values + k + 1);
        load(before, values + k);
        lanes = lanes - before;
    }
};

/// All bits of a lane stay where its value is inside, and become 0 where it is not.
RIPPLENOTCH_INLINED void keep_inside(FourBits& all, const Four& values, const Four& low, const Four& high) {
    all &= (values > low) & (values <= high);
}
RIPPLENOTCH_INLINED void keep_inside(TwoBits& all, const TwoAndTwo& values, const TwoAndTwo& low,
                                     const TwoAndTwo& high) {
    all &= ((values.low > low.low) & (values.low <= high.low)) &
           ((values.high > low.high) & (values.high <= high.high));
}

RIPPLENOTCH_INLINED bool any_lost(const FourBits& all) { return (all[0] & all[1] & all[2] & all[3]) == 0; }
RIPPLENOTCH_INLINED bool any_lost(const TwoBits& all) { return (all[0] & all[1]) == 0; }

/// Where the sixteen begin among which the first outside is, or those that are left.
template <class Lanes, class LaneBits, class What>
RIPPLENOTCH_INLINED std::size_t skip_inside(const What& what, std::size_t count, double low, double high) {
    Lanes lows, highs, values;
    fill(lows, low);
    fill(highs, high);
    std::size_t k = 0;
    for (; k + at_once <= count; k += at_once) {
        LaneBits all = ~LaneBits{};
        for (std::size_t i = 0; i < at_once; i += lane_count) {
            what.load_at(values, k + i);
            keep_inside(all, values, lows, highs);
        }
        if (any_lost(all)) break;
    }
    return k;
}

RIPPLENOTCH_TARGET_AVX2 std::size_t skip_inside_avx2(const Magnitudes& what, std::size_t count, double low,
                                                     double high) {
    return skip_inside<Four, FourBits>(what, count, low, high);
}
RIPPLENOTCH_TARGET_AVX2 std::size_t skip_inside_avx2(const Steps& what, std::size_t count, double low,
                                                     double high) {
    return skip_inside<Four, FourBits>(what, count, low, high);
}

template <class What>
std::size_t first(const What& what, std::size_t count, double low, double high, bool avx2) {
    std::size_t k = avx2 ? skip_inside_avx2(what, count, low, high)
                         : skip_inside<TwoAndTwo, TwoBits>(what, count, low, high);
    while (k < count && what.at(k) > low && what.at(k) <= high) ++k;
    return k;
}

}  // namespace

std::size_t first_outside(std::span<const double> values, double low, double high, bool avx2) noexcept {
    return first(Magnitudes{values.data()}, values.size(), low, high, avx2);
}

std::size_t first_step_outside(std::span<const double> values, double low, double high, bool avx2) noexcept {
    return values.empty() ? 0 : 1 + first(Steps{values.data()}, values.size() - 1, low, high, avx2);
}

}  // namespace ripplenotch
