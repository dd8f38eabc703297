// SPDX-License-Identifier: MIT
#include "core/row_facts.hpp"

#include <algorithm>
#include <cmath>

#include "core/lanes.hpp"

namespace ripplenotch {
namespace {

/// Lanes that count down by the bits of comparisons.
struct RepeatLanes {
    FourBits moving{}, velocity{}, position{}, torque{};
    FourBits velocity_and_torque{}, position_and_torque{}, all{};

    [[nodiscard]] RIPPLENOTCH_INLINED RepeatCounts counts() const {
        RepeatCounts sums;
        for (std::size_t i = 0; i < lane_count; ++i)
            sums += {number(moving[i]),
                     number(velocity[i]),
                     number(position[i]),
                     number(torque[i]),
                     number(velocity_and_torque[i]),
                     number(position_and_torque[i]),
                     number(all[i])};
        return sums;
    }

  private:
    static std::size_t number(long long lane) { return static_cast<std::size_t>(-lane); }
};

template <bool WithPosition>
RIPPLENOTCH_INLINED void count_four(RepeatLanes& lanes, const RowChannels& rows, std::size_t k,
                                    const Four& threshold) {
    Four before, now;
    load(before, rows.torque_nm + k);
    load(now, rows.torque_nm + k + 1);
    const FourBits torque = before == now;
    load(before, rows.velocity_deg_s + k);
    load(now, rows.velocity_deg_s + k + 1);
    FourBits velocity = before == now;
    drop_signs(before);
    drop_signs(now);
    const FourBits moving = (now < before ? now : before) > threshold;
    velocity &= moving;
    lanes.moving += moving;
    lanes.torque += torque & moving;
    lanes.velocity += velocity;
    lanes.velocity_and_torque += velocity & torque;
    if constexpr (WithPosition) {
        load(before, rows.position_deg + k);
        load(now, rows.position_deg + k + 1);
        const FourBits position = (before == now) & moving;
        lanes.position += position;
        lanes.position_and_torque += position & torque;
        lanes.all += position & velocity & torque;
    }
}

template <bool WithPosition>
RIPPLENOTCH_INLINED RepeatCounts count_fours(const RowChannels& rows, std::size_t pairs,
                                             double moving_deg_s) {
    Four threshold;
    fill(threshold, moving_deg_s);
    RepeatLanes lanes;
    for (std::size_t k = 0; k < pairs; k += lane_count) count_four<WithPosition>(lanes, rows, k, threshold);
    return lanes.counts();
}

RIPPLENOTCH_FOR_AVX2_TOO
RepeatCounts count_with_position(const RowChannels& rows, std::size_t pairs, double moving_deg_s) {
    return count_fours<true>(rows, pairs, moving_deg_s);
}
RIPPLENOTCH_FOR_AVX2_TOO
RepeatCounts count_without_position(const RowChannels& rows, std::size_t pairs, double moving_deg_s) {
    return count_fours<false>(rows, pairs, moving_deg_s);
}

/// A pair of rows, the first at `k`.
RepeatCounts count_pair(const RowChannels& rows, std::size_t k, double moving_deg_s) {
    const auto same = [k](const double* values) { return values[k] == values[k + 1]; };
    const double* const speed = rows.velocity_deg_s + k;
    const bool moving = std::min(std::abs(speed[0]), std::abs(speed[1])) > moving_deg_s;
    const bool velocity = moving && same(rows.velocity_deg_s), torque = moving && same(rows.torque_nm);
    const bool position = moving && rows.position_deg != nullptr && same(rows.position_deg);
    return {moving,
            velocity,
            position,
            torque,
            velocity && torque,
            position && torque,
            velocity && position && torque};
}

}  // namespace

RIPPLENOTCH_FOR_AVX2_TOO
void widen(SpeedExtent& range, std::span<const double> velocity_deg_s) noexcept {
    constexpr std::size_t groups = 2, step = groups * lane_count;
    const std::size_t n = velocity_deg_s.size(), even = n - n % step;
    Four slowest[groups], fastest[groups], speed;
    for (std::size_t g = 0; g < groups; ++g) {
        fill(slowest[g], range.slowest_deg_s);
        fill(fastest[g], range.fastest_deg_s);
    }
    for (std::size_t k = 0; k < even; k += step) {
        for (std::size_t g = 0; g < groups; ++g) {
            load(speed, velocity_deg_s.data() + k + g * lane_count);
            drop_signs(speed);
            slowest[g] = speed < slowest[g] ? speed : slowest[g];
            fastest[g] = fastest[g] < speed ? speed : fastest[g];
        }
    }
    for (std::size_t i = 0; i < step; ++i) {
        range.slowest_deg_s = std::min(range.slowest_deg_s, slowest[i / lane_count][i % lane_count]);
        range.fastest_deg_s = std::max(range.fastest_deg_s, fastest[i / lane_count][i % lane_count]);
    }
    for (std::size_t k = even; k < n; ++k) {
        range.slowest_deg_s = std::min(range.slowest_deg_s, std::abs(velocity_deg_s[k]));
        range.fastest_deg_s = std::max(range.fastest_deg_s, std::abs(velocity_deg_s[k]));
    }
}

RepeatCounts& RepeatCounts::operator+=(const RepeatCounts& more) noexcept {
    moving += more.moving;
    velocity += more.velocity;
    position += more.position;
    torque += more.torque;
    velocity_and_torque += more.velocity_and_torque;
    position_and_torque += more.position_and_torque;
    all += more.all;
    return *this;
}

RepeatCounts count_repeats(const RowChannels& rows, std::size_t pairs, double moving_deg_s) noexcept {
    const std::size_t even = pairs - pairs % lane_count;
    RepeatCounts counts = rows.position_deg != nullptr ? count_with_position(rows, even, moving_deg_s)
                                                       : count_without_position(rows, even, moving_deg_s);
    for (std::size_t k = even; k < pairs; ++k) counts += count_pair(rows, k, moving_deg_s);
    return counts;
}

}  // namespace ripplenotch
