// SPDX-License-Identifier: MIT
#include "fleet/features/motion_facts.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/matrices/least_squares.hpp"
#include "core/rows/row_facts.hpp"
#include "core/vectors/dot.hpp"
#include "model/motion/local_motion.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/model/motion.hpp"

namespace ripplenotch {
namespace {

constexpr double jump_deviations = 8.0, jump_part = 0.02;  // chosen, not derived
constexpr double least_over_noise = 5.0;                   // ratio to the noise of accelerations, rms
constexpr double min_change = 1e-3;  // share of the speed within a window, or it is rounding

double mean_square(const std::vector<double>& values) {
    const double size = rms(values);
    return size * size;
}

// sample_noise() with a median in the place of the rms, which jumps do not change.
double usual_noise(std::span<const double> values) {
    const double usual = noise_from_differences(values, 4);
    return usual > 0.0 ? usual : sample_noise(values);
}

// Share of the squares of `values` that no sum of the columns makes.
double share_beside(std::vector<double> values, const std::vector<std::vector<double>>& columns) {
    const double whole = mean_square(values);
    const std::vector<double> factors = least_squares(columns, values);
    for (std::size_t c = 0; c < columns.size(); ++c)
        add_scaled(-factors[c], columns[c].data(), values.data(), values.size());
    return whole > 0.0 ? mean_square(values) / whole : 0.0;
}

constexpr double moving_most_deg_s = 0.5, moving_part = 0.01;  // as a diagnosis counts
constexpr std::size_t fewest_moving = 100;                     // chosen, not derived
constexpr double least_share = 0.05;  // share of a direction, so that its friction is seen
constexpr double min_speeds = 1.5;    // between slow and fast, so that viscous friction is seen

double at_share(const std::vector<double>& sorted, double share) {
    if (sorted.empty()) return 0.0;
    return sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
}

template <class Value>
std::vector<Value> every_nth(std::span<const Value> values, std::size_t step) {
    std::vector<Value> some;
    for (std::size_t k = 0; k < values.size(); k += step) some.push_back(values[k]);
    return some;
}

std::size_t reversals_of(const Motion& motion, double moving_deg_s) {
    std::size_t reversals = 0;
    int before = 0;
    for (const double speed : motion.velocity_deg_s) {
        const int way = speed > moving_deg_s ? 1 : speed < -moving_deg_s ? -1 : 0;
        if (way == 0) continue;
        if (before != 0 && way != before) ++reversals;
        before = way;
    }
    return reversals;
}

}  // namespace

std::vector<unsigned char> rows_of_known_motion(const TraceView& log, const Motion& motion) {
    std::vector<double> speeds;
    for (const double speed : motion.velocity_deg_s) speeds.push_back(std::abs(speed));
    const double max_deg_s =
        std::max(jump_deviations * usual_noise(log.velocity_deg_s), jump_part * median_in(speeds));
    std::vector<unsigned char> known(log.size(), 1);
    const double window_s = default_smoothing.value();
    std::size_t from = 0, until = 0;  // `until`: rows before it are settled
    for (std::size_t k = 0; k < log.size(); ++k) {
        if (!(std::abs(log.velocity_deg_s[k] - motion.velocity_deg_s[k]) > max_deg_s)) continue;
        while (log.time_s[k] - log.time_s[from] > window_s) ++from;
        until = std::max(until, from);
        while (until < log.size() && log.time_s[until] - log.time_s[k] <= window_s) known[until++] = 0;
    }
    return known;
}

Accelerations accelerations_of(const TraceView& log, const Motion& motion,
                               const std::vector<unsigned char>& rows) {
    std::vector<double> acceleration, ones, direction, speed;
    for (std::size_t k = 0; k < rows.size(); ++k) {
        if (rows[k] == 0) continue;
        acceleration.push_back(motion.acceleration_deg_s2[k]);
        ones.push_back(1.0);
        speed.push_back(motion.velocity_deg_s[k]);
        direction.push_back(speed.back() > 0.0 ? 1.0 : speed.back() < 0.0 ? -1.0 : 0.0);
    }
    const double samples = std::max(1.0, default_smoothing.value() * log.sample_rate.value());
    // Noise of the slope of a cubic in the middle of so many samples.
    const double noise = usual_noise(log.velocity_deg_s) * log.sample_rate.value() *
                         std::sqrt(75.0 / (samples * samples * samples));
    const auto count = static_cast<double>(std::max<std::size_t>(acceleration.size(), 1));
    const double whole = mean_square(acceleration);
    const double beside = share_beside(acceleration, {ones, direction, speed});
    const double alone = std::sqrt(whole * beside), along = std::sqrt(whole * std::max(0.0, 1.0 - beside));
    const double rounding = min_change * rms(speed) / default_smoothing.value();
    // The projection of noise on three columns, for accelerations that are correlated over a window.
    const double noise_along = noise * std::sqrt(3.0 * samples / count);
    Accelerations found;
    found.known = alone > std::max(least_over_noise * noise, rounding);
    found.like_friction = !found.known && along > std::max(least_over_noise * noise_along, rounding);
    return found;
}

bool MotionFacts::both_directions() const {
    return mix.moving_share > least_share && mix.forward_share > least_share &&
           mix.forward_share < 1.0 - least_share;
}

bool MotionFacts::several_speeds() const {
    return mix.speed_p90_deg_s >= min_speeds * std::max(mix.speed_p10_deg_s, moving_deg_s);
}

FittedSamples thinned(const Motion& motion, std::span<const double> torque_nm,
                      std::span<const unsigned char> use, std::size_t most) {
    const std::size_t step = std::max<std::size_t>((motion.size() + most - 1) / most, 1);
    return {
        {Hertz(motion.sample_rate.value() / static_cast<double>(step)),
         every_nth<double>(motion.time_s, step), every_nth<double>(motion.position_deg, step),
         every_nth<double>(motion.velocity_deg_s, step), every_nth<double>(motion.acceleration_deg_s2, step)},
        every_nth(torque_nm, step),
        every_nth(use, step)};
}

MotionFacts motion_facts(const Motion& motion, std::span<const double> torque_nm, bool has_position) {
    MotionFacts facts;
    facts.has_position = has_position;
    const auto samples = static_cast<double>(std::max<std::size_t>(motion.size(), 1));
    facts.speed_rms_deg_s = rms(motion.velocity_deg_s);
    facts.acceleration_rms_rad_s2 = rms(motion.acceleration_deg_s2) * std::numbers::pi / 180.0;
    facts.moving_deg_s = std::min(moving_most_deg_s, moving_part * fastest_of(motion.velocity_deg_s));
    std::vector<double> speeds;
    std::size_t forward = 0;
    for (const double speed : motion.velocity_deg_s) {
        if (!(std::abs(speed) > facts.moving_deg_s)) continue;
        speeds.push_back(std::abs(speed));
        if (speed > 0.0) ++forward;
    }
    std::sort(speeds.begin(), speeds.end());
    MotionMix& mix = facts.mix;
    mix.moving_share = static_cast<double>(speeds.size()) / samples;
    if (!speeds.empty())
        mix.forward_share = static_cast<double>(forward) / static_cast<double>(speeds.size());
    mix.speed_p10_deg_s = at_share(speeds, 0.1);
    mix.speed_p50_deg_s = at_share(speeds, 0.5);
    mix.speed_p90_deg_s = at_share(speeds, 0.9);
    const auto ends = std::minmax_element(motion.position_deg.begin(), motion.position_deg.end());
    if (ends.first != motion.position_deg.end()) mix.travel_deg = *ends.second - *ends.first;
    mix.reversals = reversals_of(motion, facts.moving_deg_s);
    std::vector<double> swing(torque_nm.begin(), torque_nm.end());
    const double mean = std::accumulate(swing.begin(), swing.end(), 0.0) / samples;
    for (double& torque : swing) torque -= mean;
    mix.torque_rms_nm = rms(swing);
    return facts;
}

std::size_t samples_after_reversals(const Motion& motion, std::span<const unsigned char> use,
                                    double max_deg) {
    std::size_t seen = 0;
    double way_deg = 0.0;
    int before = 0;
    bool reversed = false;
    for (std::size_t k = 1; k < motion.size(); ++k) {
        const double speed = motion.velocity_deg_s[k];
        const int direction = speed > 0.0 ? 1 : speed < 0.0 ? -1 : before;
        way_deg += std::abs(motion.position_deg[k] - motion.position_deg[k - 1]);
        if (direction != before) {
            reversed = before != 0;
            way_deg = 0.0;
        }
        before = direction;
        if (reversed && use[k] != 0 && way_deg < max_deg) ++seen;
    }
    return seen;
}

std::vector<unsigned char> moving_samples(const Motion& motion, std::vector<unsigned char> use,
                                          double moving_deg_s) {
    std::vector<unsigned char> moving = use;
    for (std::size_t k = 0; k < moving.size(); ++k)
        if (!(std::abs(motion.velocity_deg_s[k]) > moving_deg_s)) moving[k] = 0;
    const auto left = static_cast<std::size_t>(std::count(moving.begin(), moving.end(), 1));
    return left < fewest_moving ? use : moving;
}

void leave_out_start(const Motion& motion, double way_deg, std::vector<unsigned char>& use) {
    double gone_deg = 0.0;
    for (std::size_t k = 1; k < use.size() && gone_deg < way_deg; ++k) {
        gone_deg += std::abs(motion.position_deg[k] - motion.position_deg[k - 1]);
        use[k - 1] = 0;
    }
}

}  // namespace ripplenotch
