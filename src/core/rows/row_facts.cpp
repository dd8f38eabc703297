// SPDX-License-Identifier: MIT
#include "core/rows/row_facts.hpp"

#include <algorithm>
#include <cmath>

#include "core/vectors/dot.hpp"
#include "core/vectors/lanes.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {

namespace {

constexpr std::size_t at_once = 16;

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

std::size_t first_step_outside(std::span<const double> values, double low, double high) noexcept {
    return values.empty() ? 0 : 1 + first(Steps{values.data()}, values.size() - 1, low, high);
}

double rms(std::span<const double> values) {
    const double sum = dot(values.data(), values.data(), values.size());
    return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(values.size(), 1)));
}

double noise_from_differences(std::span<const double> values, std::size_t order, std::size_t apart,
                              const std::function<bool(std::size_t)>& counts) {
    std::vector<double> factors{1.0}, sizes;
    double squares = 1.0;  // sum of those of the factors
    for (std::size_t i = 1; i <= order; ++i) {
        const auto left = static_cast<double>(order + 1 - i), n = static_cast<double>(i);
        factors.push_back(-factors.back() * left / n);
        squares += factors.back() * factors.back();
    }
    for (std::size_t k = order * apart; k < values.size(); ++k) {
        if (counts && !counts(k)) continue;
        double difference = 0.0;
        for (std::size_t i = 0; i <= order; ++i) difference += factors[i] * values[k - i * apart];
        sizes.push_back(std::abs(difference));
    }
    return deviations_of_median * median_in(sizes) / std::sqrt(squares);
}

namespace {

/// Lanes that count down by the bits of comparisons.
template <class Lanes>
struct RepeatLanes {
    BitsOf<Lanes> moving{}, velocity{}, position{}, torque{};
    BitsOf<Lanes> velocity_and_torque{}, position_and_torque{}, all{};

    [[nodiscard]] RIPPLENOTCH_INLINED RepeatCounts counts() const {
        return {number(moving),
                number(velocity),
                number(position),
                number(torque),
                number(velocity_and_torque),
                number(position_and_torque),
                number(all)};
    }

  private:
    RIPPLENOTCH_INLINED static std::size_t number(const BitsOf<Lanes>& count) {
        return static_cast<std::size_t>(-sum(count));
    }
};

template <bool WithPosition, class Lanes>
RIPPLENOTCH_INLINED void count_four(RepeatLanes<Lanes>& lanes, const RowChannels& rows, std::size_t k,
                                    const Lanes& threshold) {
    using Bits = BitsOf<Lanes>;
    Lanes before, now;
    load(before, rows.torque_nm + k);
    load(now, rows.torque_nm + k + 1);
    const Bits torque = before == now;
    load(before, rows.velocity_deg_s + k);
    load(now, rows.velocity_deg_s + k + 1);
    Bits velocity = before == now;
    drop_signs(before);
    drop_signs(now);
    lower(before, now);
    const Bits moving = before > threshold;
    velocity &= moving;
    lanes.moving += moving;
    lanes.torque += torque & moving;
    lanes.velocity += velocity;
    lanes.velocity_and_torque += velocity & torque;
    if constexpr (WithPosition) {
        load(before, rows.position_deg + k);
        load(now, rows.position_deg + k + 1);
        const Bits position = (before == now) & moving;
        lanes.position += position;
        lanes.position_and_torque += position & torque;
        lanes.all += position & velocity & torque;
    }
}

template <bool WithPosition>
struct CountFours {
    template <class Lanes>
    RIPPLENOTCH_INLINED static RepeatCounts run(const RowChannels& rows, std::size_t pairs,
                                                double moving_deg_s) {
        Lanes threshold;
        fill(threshold, moving_deg_s);
        RepeatLanes<Lanes> lanes;
        for (std::size_t k = 0; k < pairs; k += lane_count)
            count_four<WithPosition>(lanes, rows, k, threshold);
        return lanes.counts();
    }
};

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

struct Widen {
    template <class Lanes>
    RIPPLENOTCH_INLINED static SpeedExtent run(SpeedExtent range, std::span<const double> velocity_deg_s) {
        constexpr std::size_t groups = 2, step = groups * lane_count;
        const std::size_t n = velocity_deg_s.size(), even = n - n % step;
        Lanes slowest[groups], fastest[groups], speed;
        for (std::size_t g = 0; g < groups; ++g) {
            fill(slowest[g], range.slowest_deg_s);
            fill(fastest[g], range.fastest_deg_s);
        }
        for (std::size_t k = 0; k < even; k += step) {
            for (std::size_t g = 0; g < groups; ++g) {
                load(speed, velocity_deg_s.data() + k + g * lane_count);
                drop_signs(speed);
                lower(slowest[g], speed);
                raise(fastest[g], speed);
            }
        }
        double least[step], most[step];
        for (std::size_t g = 0; g < groups; ++g) {
            store(least + g * lane_count, slowest[g]);
            store(most + g * lane_count, fastest[g]);
        }
        range.slowest_deg_s = std::min(range.slowest_deg_s, *std::min_element(least, least + step));
        range.fastest_deg_s = std::max(range.fastest_deg_s, *std::max_element(most, most + step));
        for (std::size_t k = even; k < n; ++k) {
            range.slowest_deg_s = std::min(range.slowest_deg_s, std::abs(velocity_deg_s[k]));
            range.fastest_deg_s = std::max(range.fastest_deg_s, std::abs(velocity_deg_s[k]));
        }
        return range;
    }
};

}  // namespace

void widen(SpeedExtent& range, std::span<const double> velocity_deg_s) noexcept {
    range = in_lanes<Widen>(range, velocity_deg_s);
}

double fastest_of(std::span<const double> velocity_deg_s) noexcept {
    SpeedExtent range{};
    widen(range, velocity_deg_s);
    return range.fastest_deg_s;
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
    RepeatCounts counts = rows.position_deg != nullptr
                              ? in_lanes<CountFours<true>>(rows, even, moving_deg_s)
                              : in_lanes<CountFours<false>>(rows, even, moving_deg_s);
    for (std::size_t k = even; k < pairs; ++k) counts += count_pair(rows, k, moving_deg_s);
    return counts;
}

double usual_step_s(std::span<const double> time_s) {
    std::vector<double> steps;
    for (std::size_t k = 1; k < time_s.size(); ++k) steps.push_back(time_s[k] - time_s[k - 1]);
    return median_in(steps);
}

std::vector<double> interpolate(std::span<const double> known, std::span<const double> values,
                                std::span<const double> places) {
    std::vector<double> found(places.size());
    std::size_t next = 0;
    for (std::size_t k = 0; k < places.size(); ++k) {
        while (next < known.size() && known[next] <= places[k]) ++next;
        if (next == 0) {
            found[k] = values.front();
        } else if (next == known.size()) {
            found[k] = values.back();
        } else {
            const double share = (places[k] - known[next - 1]) / (known[next] - known[next - 1]);
            found[k] = values[next - 1] + share * (values[next] - values[next - 1]);
        }
    }
    return found;
}

}  // namespace ripplenotch
