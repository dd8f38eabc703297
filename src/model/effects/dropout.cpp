// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "model/effects.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/model/fit.hpp"

namespace ripplenotch {
namespace {

constexpr Parameter parameters[] = {
    {.name = "rate_hz",
     .unit = "Hz",
     .help = "held stretches a second, on average",
     .start = 2.0,
     .upper = 1e4},
    {.name = "duration_s",
     .unit = "s",
     .help = "mean length; lengths are even between half and one and a half of it",
     .neutral = 0.1,
     .start = 0.1,
     .lower = 0.0,
     .upper = 1000.0},
    seed_parameter,
};

constexpr LookAlike look_alikes[] = {
    {"quantization", "the torque hardly changes, so that neighbouring samples are equal by nature",
     "counting the distinct values of the log"},
    {"saturation", "every held stretch lies at the extreme of the log", "a smaller torque"},
};

void apply(const Situation& situation, std::span<const double> values, std::span<double> torque_nm) {
    const double rate_hz = situation.motion.sample_rate.value();
    const double chance = values[0] / rate_hz;
    Noise noise(static_cast<std::uint64_t>(values[2]), NoiseChannel::dropout);
    double left = 0.0;
    for (std::size_t k = 1; k < torque_nm.size(); ++k) {
        const bool begins = noise.uniform() < chance;
        const double samples = (0.5 + noise.uniform()) * values[1] * rate_hz;
        if (left < 0.5 && begins) left = samples;
        if (left < 0.5) continue;
        torque_nm[k] = torque_nm[k - 1];
        left -= 1.0;
    }
}

// Runs of equal values, and which of them are no chance.
class Runs {
  public:
    Runs(const LoggedTorque& log, const FaultRules& rules) : log_(log), rules_(rules) {}

    // First sample from k on that differs from the one before it.
    [[nodiscard]] std::size_t end_of_run(std::size_t k) const {
        while (k < log_.torque_nm.size() && log_.torque_nm[k] == log_.torque_nm[k - 1] && log_.use[k] != 0)
            ++k;
        return k;
    }

    // Repeats in a row that chance hardly makes while the joint moves.
    [[nodiscard]] std::size_t unlikely() const {
        const std::size_t n = log_.torque_nm.size();
        std::size_t equal = 0, moving = 0;
        for (std::size_t k = 1; k < n; ++k) {
            if (std::abs(log_.motion.velocity_deg_s[k]) < rules_.moving_speeds * log_.moving_deg_s ||
                log_.use[k] == 0)
                continue;
            ++moving;
            if (log_.torque_nm[k] == log_.torque_nm[k - 1]) ++equal;
        }
        // Neither never nor always, so that the logarithm is one.
        const double often = std::clamp(
            static_cast<double>(equal) / static_cast<double>(std::max<std::size_t>(moving, 1)), 1e-3, 0.95);
        const auto run = static_cast<std::size_t>(
            std::ceil(portable::log(rules_.chance_run / static_cast<double>(n)) / portable::log(often)));
        // With whole steps a slow torque stays on one: a held value must be long against that.
        return std::max(run, log_.step_nm > 0.0 ? rules_.fewest_held_of_steps : rules_.fewest_held);
    }

    [[nodiscard]] double turn_deg(std::size_t first, std::size_t end) const {
        return std::abs(log_.motion.position_deg[end - 1] - log_.motion.position_deg[first]);
    }

    // On whole steps the torque stays on one until the joint has turned far enough: a held stretch goes
    // through several times the angle of the longest that come by nature.
    [[nodiscard]] double least_turn_deg() const {
        if (log_.step_nm == 0.0) return 0.0;
        std::vector<double> turns;
        for (std::size_t k = 1; k < log_.torque_nm.size();) {
            const std::size_t end = end_of_run(k);
            if (end > k) turns.push_back(turn_deg(k - 1, end));
            k = std::max(end, k + 1);
        }
        if (turns.size() < rules_.fewest_turns) return 1e300;
        const std::size_t place = std::min(turns.size() * rules_.usual_turns_percent / 100, turns.size() - 1);
        const auto high = turns.begin() + static_cast<std::ptrdiff_t>(place);
        std::nth_element(turns.begin(), high, turns.end());
        return rules_.held_turns * *high;
    }

    // A torque that stays on a quantization step by itself moves to the next one; a held sample catches up at
    // once.
    [[nodiscard]] bool jumps_at(std::size_t end) const {
        if (log_.step_nm == 0.0) return true;
        return end < log_.torque_nm.size() &&
               std::abs(log_.torque_nm[end] - log_.torque_nm[end - 1]) > 1.5 * log_.step_nm;
    }

  private:
    const LoggedTorque& log_;
    const FaultRules& rules_;
};

std::optional<DetectedFault> detect(const LoggedTorque& log, const FaultRules& rules) {
    const Runs runs(log, rules);
    const std::size_t n = log.torque_nm.size(), unlikely = runs.unlikely();
    const double least_turn_deg = runs.least_turn_deg();
    DetectedFault fault;
    std::vector<double> lengths;
    std::size_t jumps = 0;
    for (std::size_t k = 1; k < n;) {
        const std::size_t end = runs.end_of_run(k);
        if (end - k >= unlikely && runs.turn_deg(k - 1, end) >= least_turn_deg) {
            lengths.push_back(static_cast<double>(end - k));
            if (runs.jumps_at(end)) ++jumps;
            for (std::size_t i = k; i < end; ++i) fault.spoiled.push_back(i);
        }
        k = std::max(end, k + 1);
    }
    if (lengths.empty() ||
        static_cast<double>(jumps) < rules.jumping_part * static_cast<double>(lengths.size()))
        return std::nullopt;
    const double rate = log.motion.sample_rate.value();
    double mean = 0.0;
    for (const double length : lengths) mean += length / static_cast<double>(lengths.size());
    const double duration_s = static_cast<double>(n) / rate;
    fault.values = {static_cast<double>(lengths.size()) / duration_s, mean / rate, seed_parameter.start};
    fault.words = lengths.size() == 1
                      ? fmt::format("1 stretch of {:.3g} ms repeats one value", 1e3 * mean / rate)
                      : fmt::format("{} stretches of {:.3g} ms on average repeat one value", lengths.size(),
                                    1e3 * mean / rate);
    return fault;
}

}  // namespace

const Effect effects::dropout{
    .name = "dropout",
    .summary = "the log repeats old values where new ones were lost",
    .equation =
        "logged torque = last value before the stretch, in stretches of duration_s that begin rate_hz times "
        "a second",
    .symptom = "runs of equal values while the joint moves",
    .look_alikes = look_alikes,
    .source = "lost messages; found in public robot logs, where up to 37 % of the samples are held",
    .side = Side::converter,
    .domain = Domain::time,
    .parameters = parameters,
    .chance = true,
    .apply = apply,
    .detect = detect,
};

}  // namespace ripplenotch
