// SPDX-License-Identifier: MIT
#include "core/rows/first_outside.hpp"

#include <cmath>

#include "core/vectors/lanes.hpp"

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

/// Where the sixteen begin among which the first outside is, or those that are left.
struct SkipInside {
    template <class Lanes, class What>
    RIPPLENOTCH_INLINED static std::size_t run(const What& what, std::size_t count, double low, double high) {
        Lanes lows, highs, values;
        fill(lows, low);
        fill(highs, high);
        std::size_t k = 0;
        for (; k + at_once <= count; k += at_once) {
            what.load_at(values, k);
            BitsOf<Lanes> all = (values > lows) & (values <= highs);
            for (std::size_t i = lane_count; i < at_once; i += lane_count) {
                what.load_at(values, k + i);
                all &= (values > lows) & (values <= highs);
            }
            if (!all_set(all)) break;
        }
        return k;
    }
};

template <class What>
std::size_t first(const What& what, std::size_t count, double low, double high) {
    std::size_t k = in_lanes<SkipInside>(what, count, low, high);
    while (k < count && what.at(k) > low && what.at(k) <= high) ++k;
    return k;
}

}  // namespace

std::size_t first_outside(std::span<const double> values, double low, double high) noexcept {
    return first(Magnitudes{values.data()}, values.size(), low, high);
}

std::size_t first_step_outside(std::span<const double> values, double low, double high) noexcept {
    return values.empty() ? 0 : 1 + first(Steps{values.data()}, values.size() - 1, low, high);
}

}  // namespace ripplenotch
