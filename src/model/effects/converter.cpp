// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "model/effects.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/model/effect.hpp"
#include "ripplenotch/model/noise.hpp"

namespace ripplenotch {
namespace {

// What tells a fault of the converter from a torque that looks like it.
// A noisy torque comes to its extreme once or twice; a clipped one stays there.
constexpr std::size_t fewest_clipped = 8;
// Times: on whole steps the extreme is held by chance too, but less often than the level below it.
constexpr double clipped_of_next = 2.0;
// Levels so near to the extreme are compared with it.
constexpr double next_level_steps = 1.5;
// Chance: how likely a run of equal values in the whole log may be by chance and still be told as held.
constexpr double chance_run = 1e-4;
// Times the slowest speed: only faster samples say how often neighbours are equal by nature: at rest a
// noiseless torque stays.
constexpr double moving_speeds = 2.0;
// No shorter run is told as held, however unlikely.
constexpr std::size_t fewest_held = 4;
// The same where the log holds whole steps, on which a slow torque stays by nature.
constexpr std::size_t fewest_held_of_steps = 30;
// Times the usual turn: on whole steps a held stretch goes through several times the angle of the longest
// natural ones.
constexpr double held_turns = 4.0;
// %: share of the runs that are natural, among which the longest is looked for.
constexpr std::size_t usual_turns_percent = 98;
// With fewer runs nothing is known of what is usual, and none is told as held.
constexpr std::size_t fewest_turns = 10;
// Of the held stretches: that have to end in a jump of more than a step: from a step on which it stays by
// itself the torque goes to the next one.
constexpr double jumping_part = 0.1;
// Deviations: smaller ones are the tail of the noise.
constexpr double spike_deviations = 9.0;
// So many have to be far out: one or two are chance, a touch, or the end of a heavy tail.
constexpr std::size_t fewest_spikes = 3;
// Times the limit: far out; half of the spikes have to be: spikes stand apart from the noise, heavy tails go
// on from it.
constexpr double far_deviations = 2.0;
// More samples that stand out about one are a burst or a ringing.
constexpr std::size_t max_out_together = 4;
// Of its size: after a spike the torque is where it was, within this; after a step it is not.
constexpr double returns_part = 0.4;
// Of its size: a spike is farther than this from both sides; a slope is near to one of them.
constexpr double leaves_part = 0.7;
// The typical deviation counts as no less: a torque that rests on one step has none.
constexpr double spike_steps = 0.3;

// The most samples in a row of one value that is no end of the range.
std::size_t longest_hold(std::span<const double> torque_nm, double low_nm, double high_nm) {
    std::size_t longest = 1, here = 1;
    for (std::size_t k = 1; k < torque_nm.size(); ++k) {
        const bool held = torque_nm[k] == torque_nm[k - 1] && torque_nm[k] > low_nm && torque_nm[k] < high_nm;
        here = held ? here + 1 : 1;
        longest = std::max(longest, here);
    }
    return longest;
}

// Number of samples at an end of the range, without those that the recorder only repeats (it holds up to
// `longest` samples elsewhere). Where it holds by chance, each further sample is less likely by the same
// factor: none is held twice as long as all others.
std::size_t counted_once(std::span<const std::size_t> at, std::size_t longest) {
    const std::size_t held = longest > 1 ? 2 * longest : 1;
    std::size_t counted = 0;
    for (std::size_t first = 0, end = 0; first < at.size(); first = end) {
        end = first + 1;
        while (end < at.size() && at[end] == at[end - 1] + 1) ++end;
        counted += end - first > held ? end - first : 1;
    }
    return counted;
}

// Samples at an end of the log's range; none where the torque only came to its extreme.
std::vector<std::size_t> clipped_at(const LoggedTorque& log, double rail_nm, std::size_t longest) {
    std::vector<std::size_t> at;
    std::size_t next = 0;  // samples on the level before the last
    for (std::size_t k = 0; k < log.torque_nm.size(); ++k) {
        const double off = std::abs(log.torque_nm[k] - rail_nm);
        if (off <= 1e-9 * std::abs(rail_nm))
            at.push_back(k);
        else if (log.step_nm > 0.0 && off < next_level_steps * log.step_nm)
            ++next;
    }
    // On whole steps the extreme is held by chance, but by fewer samples than the level below it.
    const bool by_chance =
        log.step_nm > 0.0 && static_cast<double>(at.size()) < clipped_of_next * static_cast<double>(next);
    if (counted_once(at, longest) < fewest_clipped || by_chance) at.clear();
    return at;
}

// Single samples that stand off their neighbours.
class Outliers {
  public:
    Outliers(const LoggedTorque& log)
        : log_(log),
          torque_nm_(log.torque_nm),
          min_nm_(std::max(log.noise_nm, spike_steps * log.step_nm)),
          off_(from_neighbours()),
          typical_(typical_about(off_)) {}

    [[nodiscard]] bool is_spike(std::size_t k) const {
        // Next to held or clipped samples the torque jumps by nature.
        const auto spoiled = [&](std::size_t i) { return log_.use[i] == 0; };
        if (spoiled(k - 2) || spoiled(k - 1) || spoiled(k) || spoiled(k + 1) || spoiled(k + 2)) return false;
        if (!stands_out(k)) return false;
        // Up to two together; a burst or a ringing has its neighbours out as well.
        std::size_t out = 0;
        for (std::size_t i = k >= 8 ? k - 8 : 0; i < std::min(k + 9, off_.size()); ++i)
            out += stands_out(i) ? 1U : 0U;
        return out <= max_out_together && returns(k);
    }
    [[nodiscard]] double size_nm(std::size_t k) const { return std::abs(off_[k]); }
    [[nodiscard]] bool is_far(std::size_t k) const { return size_nm(k) > far_deviations * threshold(k); }

  private:
    [[nodiscard]] double threshold(std::size_t k) const {
        return spike_deviations * std::max(typical_[k], min_nm_);
    }
    [[nodiscard]] bool stands_out(std::size_t k) const { return size_nm(k) > threshold(k); }

    // After a spike the torque is where it was; after a step it is not. Of two samples to either side one may
    // be a spike itself.
    [[nodiscard]] bool returns(std::size_t k) const {
        const double size = size_nm(k);
        for (const std::size_t before : {k - 1, k - 2}) {
            for (const std::size_t after : {k + 1, k + 2}) {
                if (std::abs(torque_nm_[before] - torque_nm_[after]) < returns_part * size &&
                    std::abs(torque_nm_[k] - torque_nm_[before]) > leaves_part * size)
                    return true;
            }
        }
        return false;
    }

    // Each sample less what its two neighbours to either side let expect: their median, or the cubic through
    // them, whichever it is nearer to. A step is near the one, a fast swing near the other.
    [[nodiscard]] std::vector<double> from_neighbours() const {
        std::vector<double> off(torque_nm_.size(), 0.0);
        for (std::size_t k = 2; k + 2 < torque_nm_.size(); ++k) {
            double four[] = {torque_nm_[k - 2], torque_nm_[k - 1], torque_nm_[k + 1], torque_nm_[k + 2]};
            const double cubic = torque_nm_[k] - (4.0 * (four[1] + four[2]) - four[0] - four[3]) / 6.0;
            std::sort(std::begin(four), std::end(four));
            const double median_off = torque_nm_[k] - 0.5 * (four[1] + four[2]);
            off[k] = std::abs(cubic) < std::abs(median_off) ? cubic : median_off;
        }
        return off;
    }

    // Typical size over a fifth of a second about each sample.
    [[nodiscard]] std::vector<double> typical_about(const std::vector<double>& off) const {
        const auto block =
            std::max<std::size_t>(20, static_cast<std::size_t>(0.1 * log_.motion.sample_rate.value()));
        std::vector<double> blocks;
        for (std::size_t first = 0; first < off.size(); first += block) {
            std::vector<double> part;
            for (std::size_t k = first; k < std::min(first + block, off.size()); ++k)
                if (log_.use[k] != 0) part.push_back(std::abs(off[k]));
            blocks.push_back(deviations_of_median * median_of(part));
        }
        std::vector<double> typical(off.size());
        for (std::size_t k = 0; k < off.size(); ++k) {
            const std::size_t b = k / block;
            typical[k] =
                std::max({blocks[b], blocks[b > 0 ? b - 1 : 0], blocks[std::min(b + 1, blocks.size() - 1)]});
        }
        return typical;
    }

    const LoggedTorque& log_;
    std::span<const double> torque_nm_;
    double min_nm_;
    std::vector<double> off_, typical_;
};

// Runs of equal values, and which of them are no chance.
class Runs {
  public:
    Runs(const LoggedTorque& log) : log_(log) {}

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
            if (std::abs(log_.motion.velocity_deg_s[k]) < moving_speeds * log_.moving_deg_s ||
                log_.use[k] == 0)
                continue;
            ++moving;
            if (log_.torque_nm[k] == log_.torque_nm[k - 1]) ++equal;
        }
        // Neither never nor always, so that the logarithm is one.
        const double often = std::clamp(
            static_cast<double>(equal) / static_cast<double>(std::max<std::size_t>(moving, 1)), 1e-3, 0.95);
        const auto run = static_cast<std::size_t>(
            std::ceil(portable::log(chance_run / static_cast<double>(n)) / portable::log(often)));
        // With whole steps a slow torque stays on one: a held value must be long against that.
        return std::max(run, log_.step_nm > 0.0 ? fewest_held_of_steps : fewest_held);
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
        if (turns.size() < fewest_turns) return 1e300;
        const std::size_t place = std::min(turns.size() * usual_turns_percent / 100, turns.size() - 1);
        const auto high = turns.begin() + static_cast<std::ptrdiff_t>(place);
        std::nth_element(turns.begin(), high, turns.end());
        return held_turns * *high;
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
};

}  // namespace

const Effect effects::saturation{
    .name = "saturation",
    .summary = "the sensor or its converter clips",
    .equation = "logged torque = torque, or -limit_nm or limit_nm where it is beyond",
    .symptom = "runs of samples at exactly the largest value of the log",
    .look_alikes = {{"rest on a coarse quantization", "the torque rests at its extreme",
                     "a finer log; clipped samples lie at both ends of the range"}},
    .source = "the range of an amplifier",
    .side = Side::converter,
    .domain = Domain::time,
    .parameters = {plain("limit_nm", "Nm",
                         "largest torque that is logged; at the upper bound there is no limit",
                         {2.0, 0.0, 1e6, 1e6})},
    .linear_in_torque = false,
    .apply =
        [](const Situation&, Values values, Torques torque_nm) {
            for (std::size_t k = 0; k < torque_nm.size(); ++k)
                torque_nm[k] = std::clamp(torque_nm[k], -values[0], values[0]);
        },
    .detect = [](const LoggedTorque& log) -> std::optional<DetectedFault> {
        const auto [low, high] = std::minmax_element(log.torque_nm.begin(), log.torque_nm.end());
        // Whole steps hold a torque as well.
        const std::size_t longest = log.step_nm > 0.0 ? 1 : longest_hold(log.torque_nm, *low, *high);
        DetectedFault fault;
        double limit_nm = 0.0;
        for (const double rail_nm : {*low, *high}) {
            const std::vector<std::size_t> at = clipped_at(log, rail_nm, longest);
            if (at.empty()) continue;
            limit_nm = std::max(limit_nm, std::abs(rail_nm));
            fault.spoiled.insert(fault.spoiled.end(), at.begin(), at.end());
        }
        if (fault.spoiled.empty()) return std::nullopt;
        std::sort(fault.spoiled.begin(), fault.spoiled.end());
        fault.values = {limit_nm};
        fault.words = fmt::format("{} samples stand at exactly {:.3g} Nm, the end of the log's range",
                                  fault.spoiled.size(), limit_nm);
        return fault;
    }};

const Effect effects::quantization{
    .name = "quantization",
    .summary = "the converter logs whole steps",
    .equation = "logged torque = step_nm * round(torque / step_nm)",
    .symptom = "few distinct values in the log, at equal distances",
    .look_alikes = {{"dropout", "the torque hardly changes, so that neighbouring samples are equal by nature",
                     "counting the distinct values of the log"},
                    {"ripple", "the steps are coarser than the noise, which makes harmonics",
                     "a log with more noise or a finer converter"}},
    .source = "Widrow, 1956",
    .side = Side::converter,
    .domain = Domain::time,
    .parameters = {plain("step_nm", "Nm",
                         "difference of neighbouring values that can be logged; 0 is continuous",
                         {0.1, 0.0, 1e5})},
    .linear_in_torque = false,
    .apply =
        [](const Situation&, Values values, Torques torque_nm) {
            if (values[0] == 0.0) return;
            for (std::size_t k = 0; k < torque_nm.size(); ++k)
                torque_nm[k] = std::round(torque_nm[k] / values[0]) * values[0] + 0.0;
        },
    .detect = [](const LoggedTorque& log) -> std::optional<DetectedFault> {
        if (log.step_nm == 0.0 || log.step_nm < step_of_noise * log.noise_nm) return std::nullopt;
        const std::set<double> levels(log.torque_nm.begin(), log.torque_nm.end());
        return DetectedFault{.values = {log.step_nm},
                             .spoiled = {},
                             .words = fmt::format("the log holds {} distinct values, {:.3g} Nm apart",
                                                  levels.size(), log.step_nm)};
    }};

const Effect effects::spikes{
    .name = "spikes",
    .summary = "single samples are far off",
    .equation = "logged torque = torque + size_nm or - size_nm, in rate_percent of the samples",
    .symptom = "single samples far outside the noise, at no particular time, speed or position",
    .look_alikes = {{"noise with heavy tails", "the spikes are no larger than seven times its rms",
                     "a rest: spikes stand alone"}},
    .source = "lost bits and electrical pulses",
    .side = Side::converter,
    .domain = Domain::time,
    .parameters = {plain("rate_percent", "%", "of the samples that are hit", {0.1, 0.0, 100.0}),
                   linear("size_nm", "Nm", "of a spike; its sign is chance", {5.0, 0.0, 1e5}),
                   seed_parameter()},
    .chance = true,
    .detect_turn = 1,
    .apply =
        [](const Situation&, Values values, Torques torque_nm) {
            Noise noise(static_cast<std::uint64_t>(values[2]), NoiseChannel::spikes);
            for (std::size_t k = 0; k < torque_nm.size(); ++k) {
                const bool hit = noise.uniform() < 0.01 * values[0], up = noise.uniform() < 0.5;
                if (hit) torque_nm[k] += up ? values[1] : -values[1];
            }
        },
    .detect = [](const LoggedTorque& log) -> std::optional<DetectedFault> {
        const Outliers outliers(log);
        DetectedFault fault;
        std::vector<double> sizes_nm;
        std::size_t far = 0;
        for (std::size_t k = 2; k + 2 < log.torque_nm.size(); ++k) {
            if (!outliers.is_spike(k)) continue;
            fault.spoiled.push_back(k);
            sizes_nm.push_back(outliers.size_nm(k));
            far += outliers.is_far(k) ? 1U : 0U;
        }
        // Spikes stand apart from the noise; heavy tails go on from it.
        if (far < fewest_spikes || 2 * far < sizes_nm.size()) return std::nullopt;
        const double per_sample =
            static_cast<double>(sizes_nm.size()) / static_cast<double>(log.torque_nm.size());
        const double size_nm = median_of(sizes_nm);
        fault.values = {100.0 * per_sample, size_nm, first_seed};
        fault.words =
            fmt::format("{} single samples stand {:.3g} Nm off their neighbours", sizes_nm.size(), size_nm);
        return fault;
    }};

const Effect effects::dropout{
    .name = "dropout",
    .summary = "the log repeats old values where new ones were lost",
    .equation =
        "logged torque = last value before the stretch, in stretches of duration_s that begin rate_hz times "
        "a second",
    .symptom = "runs of equal values while the joint moves",
    .look_alikes = {{"quantization",
                     "the torque hardly changes, so that neighbouring samples are equal by nature",
                     "counting the distinct values of the log"},
                    {"saturation", "every held stretch lies at the extreme of the log", "a smaller torque"}},
    .source = "lost messages; found in public robot logs, where up to 37 % of the samples are held",
    .side = Side::converter,
    .domain = Domain::time,
    .parameters = {plain("rate_hz", "Hz", "held stretches a second, on average", {2.0, 0.0, 1e4}),
                   plain("duration_s", "s",
                         "mean length; lengths are even between half and one and a half of it",
                         {0.1, 0.0, 1000.0, 0.1}),
                   seed_parameter()},
    .chance = true,
    .apply =
        [](const Situation& situation, Values values, Torques torque_nm) {
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
        },
    .detect = [](const LoggedTorque& log) -> std::optional<DetectedFault> {
        const Runs runs(log);
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
            static_cast<double>(jumps) < jumping_part * static_cast<double>(lengths.size()))
            return std::nullopt;
        const double rate = log.motion.sample_rate.value();
        double mean = 0.0;
        for (const double length : lengths) mean += length / static_cast<double>(lengths.size());
        const double duration_s = static_cast<double>(n) / rate;
        fault.values = {static_cast<double>(lengths.size()) / duration_s, mean / rate, first_seed};
        fault.words = lengths.size() == 1
                          ? fmt::format("1 stretch of {:.3g} ms repeats one value", 1e3 * mean / rate)
                          : fmt::format("{} stretches of {:.3g} ms on average repeat one value",
                                        lengths.size(), 1e3 * mean / rate);
        return fault;
    }};

}  // namespace ripplenotch
