// SPDX-License-Identifier: MIT
#include "filter/kernels/first_outside.hpp"

#include <cmath>

#include "core/lanes.hpp"

namespace ripplenotch {
namespace {

constexpr std::size_t at_once = 16;
constexpr long long all_but_sign = 0x7FFF'FFFF'FFFF'FFFF;

using TwoBits = long long __attribute__((vector_size(16)));
using FourBits = long long __attribute__((vector_size(32)));

/// All bits of a lane stay where its value is inside, and become 0 where it is not.
RIPPLENOTCH_INLINED void keep_inside(FourBits& all, const double* values, const Four& low, const Four& high) {
    Four value;
    load(value, values);
    const Four magnitude = reinterpret_cast<Four>(reinterpret_cast<FourBits>(value) & all_but_sign);
    all &= (magnitude > low) & (magnitude <= high);
}
RIPPLENOTCH_INLINED void keep_inside(TwoBits& all, const double* values, const TwoAndTwo& low,
                                     const TwoAndTwo& high) {
    TwoAndTwo value;
    load(value, values);
    const Two a = reinterpret_cast<Two>(reinterpret_cast<TwoBits>(value.low) & all_but_sign);
    const Two b = reinterpret_cast<Two>(reinterpret_cast<TwoBits>(value.high) & all_but_sign);
    all &= ((a > low.low) & (a <= high.low)) & ((b > low.high) & (b <= high.high));
}

RIPPLENOTCH_INLINED bool any_lost(const FourBits& all) { return (all[0] & all[1] & all[2] & all[3]) == 0; }
RIPPLENOTCH_INLINED bool any_lost(const TwoBits& all) { return (all[0] & all[1]) == 0; }

/// Where the sixteen begin among which the first outside is, or those that are left.
template <class Lanes, class LaneBits>
RIPPLENOTCH_INLINED std::size_t skip_inside(std::span<const double> values, double low, double high) {
    Lanes lows, highs;
    fill(lows, low);
    fill(highs, high);
    std::size_t k = 0;
    for (; k + at_once <= values.size(); k += at_once) {
        LaneBits all = ~LaneBits{};
        for (std::size_t i = 0; i < at_once; i += 4) keep_inside(all, values.data() + k + i, lows, highs);
        if (any_lost(all)) break;
    }
    return k;
}

RIPPLENOTCH_TARGET_AVX2 std::size_t skip_inside_avx2(std::span<const double> values, double low,
                                                     double high) {
    return skip_inside<Four, FourBits>(values, low, high);
}

}  // namespace

std::size_t first_outside(std::span<const double> values, double low, double high, bool avx2) noexcept {
    std::size_t k =
        avx2 ? skip_inside_avx2(values, low, high) : skip_inside<TwoAndTwo, TwoBits>(values, low, high);
    for (; k < values.size(); ++k) {
        const double magnitude = std::abs(values[k]);
        if (!(magnitude > low && magnitude <= high)) break;
    }
    return k;
}

}  // namespace ripplenotch
