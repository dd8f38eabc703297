// SPDX-License-Identifier: MIT
#include "filter/kernels/first_outside.hpp"

#include <cmath>

#include "filter/kernels/lanes.hpp"

namespace ripplenotch {
namespace {

using Bits = long long __attribute__((vector_size(16)));
constexpr long long all_but_sign = 0x7FFF'FFFF'FFFF'FFFF;

RIPPLENOTCH_INLINED Bits inside(const double* values, double low, double high) {
    const Bits bits = reinterpret_cast<Bits>(*reinterpret_cast<const TwoInMemory*>(values));
    const Two magnitude = reinterpret_cast<Two>(bits & Bits{all_but_sign, all_but_sign});
    return (magnitude > Two{low, low}) & (magnitude <= Two{high, high});
}

}  // namespace

std::size_t first_outside(std::span<const double> values, double low, double high) noexcept {
    std::size_t k = 0;
    for (; k + 8 <= values.size(); k += 8) {
        const double* const at = values.data() + k;
        const Bits all = (inside(at, low, high) & inside(at + 2, low, high)) &
                         (inside(at + 4, low, high) & inside(at + 6, low, high));
        if ((all[0] & all[1]) == 0) break;
    }
    for (; k < values.size(); ++k) {
        const double magnitude = std::abs(values[k]);
        if (!(magnitude > low && magnitude <= high)) break;
    }
    return k;
}

}  // namespace ripplenotch
