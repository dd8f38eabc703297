// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "model/effects.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/model/fit.hpp"

namespace ripplenotch {
namespace {

constexpr Parameter parameters[] = {
    {.name = "rate_percent",
     .unit = "%",
     .help = "of the samples that are hit",
     .start = 0.1,
     .upper = 100.0},
    {.name = "size_nm",
     .unit = "Nm",
     .help = "of a spike; its sign is chance",
     .start = 5.0,
     .upper = 1e5,
     .linear = true},
    seed_parameter,
};

constexpr LookAlike look_alikes[] = {
    {"noise with heavy tails", "the spikes are no larger than seven times its rms",
     "a rest: spikes stand alone"},
};

void apply(const Situation&, std::span<const double> values, std::span<double> torque_nm) {
    Noise noise(static_cast<std::uint64_t>(values[2]), NoiseChannel::spikes);
    for (std::size_t k = 0; k < torque_nm.size(); ++k) {
        const bool hit = noise.uniform() < 0.01 * values[0], up = noise.uniform() < 0.5;
        if (hit) torque_nm[k] += up ? values[1] : -values[1];
    }
}

// Single samples that stand off their neighbours.
class Outliers {
  public:
    Outliers(const LoggedTorque& log, const FaultRules& rules)
        : log_(log),
          rules_(rules),
          torque_nm_(log.torque_nm),
          least_nm_(std::max(log.noise_nm, rules.spike_steps * log.step_nm)),
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
        return out <= rules_.most_out_together && returns(k);
    }
    [[nodiscard]] double size_nm(std::size_t k) const { return std::abs(off_[k]); }
    [[nodiscard]] bool is_far(std::size_t k) const {
        return size_nm(k) > rules_.far_deviations * threshold(k);
    }

  private:
    [[nodiscard]] double threshold(std::size_t k) const {
        return rules_.spike_deviations * std::max(typical_[k], least_nm_);
    }
    [[nodiscard]] bool stands_out(std::size_t k) const { return size_nm(k) > threshold(k); }

    // After a spike the torque is where it was; after a step it is not. Of two samples to either side one may
    // be a spike itself.
    [[nodiscard]] bool returns(std::size_t k) const {
        const double size = size_nm(k);
        for (const std::size_t before : {k - 1, k - 2}) {
            for (const std::size_t after : {k + 1, k + 2}) {
                if (std::abs(torque_nm_[before] - torque_nm_[after]) < rules_.returns_part * size &&
                    std::abs(torque_nm_[k] - torque_nm_[before]) > rules_.leaves_part * size)
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
    const FaultRules& rules_;
    std::span<const double> torque_nm_;
    double least_nm_;
    std::vector<double> off_, typical_;
};

std::optional<DetectedFault> detect(const LoggedTorque& log, const FaultRules& rules) {
    const Outliers outliers(log, rules);
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
    if (far < rules.fewest_spikes || 2 * far < sizes_nm.size()) return std::nullopt;
    const double per_sample =
        static_cast<double>(sizes_nm.size()) / static_cast<double>(log.torque_nm.size());
    const double size_nm = median_of(sizes_nm);
    fault.values = {100.0 * per_sample, size_nm, seed_parameter.start};
    fault.words =
        fmt::format("{} single samples stand {:.3g} Nm off their neighbours", sizes_nm.size(), size_nm);
    return fault;
}

}  // namespace

const Effect effects::spikes{
    .name = "spikes",
    .summary = "single samples are far off",
    .equation = "logged torque = torque + size_nm or - size_nm, in rate_percent of the samples",
    .symptom = "single samples far outside the noise, at no particular time, speed or position",
    .look_alikes = look_alikes,
    .source = "lost bits and electrical pulses",
    .side = Side::converter,
    .domain = Domain::time,
    .parameters = parameters,
    .chance = true,
    .detect_turn = 1,  // next to held or clipped samples the torque jumps by nature
    .apply = apply,
    .detect = detect,
};

}  // namespace ripplenotch
