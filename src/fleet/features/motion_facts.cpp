// SPDX-License-Identifier: MIT
#include "fleet/features/motion_facts.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ripplenotch {
namespace {

constexpr double moving_most_deg_s = 0.5, moving_part = 0.01;  // as a diagnosis counts
constexpr std::size_t fewest_moving = 100;                     // by hand
constexpr double least_share = 0.05;                           // of a direction, so that its friction is seen
constexpr double least_speeds = 1.5;  // between slow and fast, so that viscous friction is seen

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

double rms_beside_mean(std::span<const double> values) {
    double mean = 0.0, squares = 0.0;
    for (const double value : values) mean += value / static_cast<double>(values.size());
    for (const double value : values) squares += (value - mean) * (value - mean);
    return values.empty() ? 0.0 : std::sqrt(squares / static_cast<double>(values.size()));
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

bool MotionFacts::both_directions() const {
    return mix.moving_share > least_share && mix.forward_share > least_share &&
           mix.forward_share < 1.0 - least_share;
}

bool MotionFacts::several_speeds() const {
    return mix.speed_p90_deg_s >= least_speeds * std::max(mix.speed_p10_deg_s, moving_deg_s);
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
    double fastest = 0.0, speed_squares = 0.0, squares = 0.0;
    for (std::size_t k = 0; k < motion.size(); ++k) {
        const double speed = motion.velocity_deg_s[k];
        const double rad_s2 = motion.acceleration_deg_s2[k] * std::numbers::pi / 180.0;
        fastest = std::max(fastest, std::abs(speed));
        speed_squares += speed * speed;
        squares += rad_s2 * rad_s2;
    }
    const auto samples = static_cast<double>(std::max<std::size_t>(motion.size(), 1));
    facts.speed_rms_deg_s = std::sqrt(speed_squares / samples);
    facts.acceleration_rms_rad_s2 = std::sqrt(squares / samples);
    facts.moving_deg_s = std::min(moving_most_deg_s, moving_part * fastest);
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
    mix.torque_rms_nm = rms_beside_mean(torque_nm);
    return facts;
}

std::size_t samples_after_reversals(const Motion& motion, std::span<const unsigned char> use,
                                    double most_deg) {
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
        if (reversed && use[k] != 0 && way_deg < most_deg) ++seen;
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
