// SPDX-License-Identifier: MIT
#include "diagnose/answer/answer.hpp"

#include <algorithm>
#include <cmath>

#include "core/rows/row_facts.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/model/effect.hpp"

namespace ripplenotch {
namespace {

// A hundredth of the fastest speed of a slow joint is motion; of a fast one the limit stays, however fast.
constexpr double moving_share = 0.01, moving_most_deg_s = 1.0;

double slowest_moving(const Motion& motion) {
    double fastest = 0.0;
    for (const double speed : motion.velocity_deg_s) fastest = std::max(fastest, std::abs(speed));
    return fastest > 0.0 ? std::min(moving_most_deg_s, moving_share * fastest) : moving_most_deg_s;
}

// Step of a quantized log that was rounded once more, from the distances of neighbouring values: these differ
// from multiples of it by no more than the second rounding step. 0 when not so.
double rounded_step(const std::vector<double>& distances, double usual) {
    double shortest = usual, longest = usual, range = 0.0, steps = 0.0;
    for (const double distance : distances) {
        if (distance < 1.5 * usual) {  // one step, not two
            shortest = std::min(shortest, distance);
            longest = std::max(longest, distance);
        }
        range += distance;
        steps += std::round(distance / usual);
    }
    const double rounded_to = longest - shortest, step = range / steps;
    double value = 0.0, place = 0.0;
    // Coarser, it would leave no steps to be seen; chosen, not derived.
    bool in_place = rounded_to < 0.5 * usual;
    for (const double distance : distances) {
        value += distance;
        place += std::round(distance / step) * step;
        in_place = in_place && std::abs(value - place) <= rounded_to + 1e-9 * range;
    }
    return in_place ? step : 0.0;
}

// of the samples: a log with more distinct values than that is as good as continuous.
constexpr double most_distinct_part = 0.25;
// of the distance: rounding in a file leaves crumbs: distances this near to whole steps are whole steps.
constexpr double off_step_part = 0.02;
// %: so many distances have to be whole steps: rare levels leave multiples, other causes leave any distance.
constexpr std::size_t fitting_percent = 90;
// Step of a log that holds few distinct values at equal distances; 0 when it is as good as continuous.
double step_of(std::span<const double> torque_nm, double noise_nm) {
    std::vector<double> values(torque_nm.begin(), torque_nm.end());
    std::sort(values.begin(), values.end());
    std::vector<double> distances;
    const double range = values.back() - values.front();
    for (std::size_t k = 1; k < values.size(); ++k) {
        const double distance = values[k] - values[k - 1];
        if (distance > 1e-9 * range) distances.push_back(distance);
    }
    if (distances.empty() ||
        static_cast<double>(distances.size()) > most_distinct_part * static_cast<double>(values.size()))
        return 0.0;
    // The smallest that is common: rarer levels cause multiples of it, rounding causes tiny differences.
    const double step = median_of(distances);
    std::size_t fitting = 0;
    for (const double distance : distances) {
        const double steps = distance / step;
        if (std::abs(steps - std::round(steps)) < off_step_part * std::max(steps, 1.0) && steps > 0.5)
            ++fitting;
    }
    if (fitting >= distances.size() * fitting_percent / 100) return step;
    // Finer than the noise, such steps cannot be distinguished from values that happen to lie so.
    const double rounded = rounded_step(distances, step);
    return rounded >= step_of_noise * noise_nm ? rounded : 0.0;
}

// Effects that can be detected in a log, in the order of their detectors.
std::vector<const Effect*> detectable() {
    std::vector<const Effect*> effects;
    for (const Effect* effect : catalogue()) {
        if (effect->detect != nullptr) effects.push_back(effect);
    }
    std::stable_sort(effects.begin(), effects.end(),
                     [](const Effect* a, const Effect* b) { return a->detect_turn < b->detect_turn; });
    return effects;
}

Fault fault_of(const Effect& effect, const DetectedFault& found, const Motion& motion) {
    Fault fault{{&effect, {}}, found.spoiled.size(), {}, found.words};
    for (std::size_t p = 0; p < effect.parameters.size(); ++p) {
        const Parameter& parameter = effect.parameters[p];
        fault.term.values.emplace_back(std::clamp(found.values.at(p), parameter.lower, parameter.upper));
    }
    // Samples next to each other are one stretch, however their times are rounded.
    const double gap_s = 1.5 / motion.sample_rate.value();
    for (const std::size_t k : found.spoiled) {
        if (!fault.time_s.empty() && motion.time_s[k] - fault.time_s.back().to <= gap_s) {
            fault.time_s.back().to = motion.time_s[k];
        } else {
            fault.time_s.push_back({motion.time_s[k], motion.time_s[k]});
        }
    }
    return fault;
}

}  // namespace

std::vector<Fault> find_faults(const Motion& motion, std::span<const double> torque_nm,
                               std::vector<unsigned char>& use) {
    const double noise_nm = noise_from_differences(torque_nm, 2);
    const LoggedTorque log{motion,  torque_nm, use, slowest_moving(motion), step_of(torque_nm, noise_nm),
                           noise_nm};
    std::vector<Fault> faults;
    for (const Effect* effect : detectable()) {
        const auto found = effect->detect(log);
        if (!found) continue;
        faults.push_back(fault_of(*effect, *found, motion));
        for (const std::size_t k : found->spoiled) use[k] = 0;
    }
    return faults;
}

}  // namespace ripplenotch
