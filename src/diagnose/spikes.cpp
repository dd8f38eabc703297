// SPDX-License-Identifier: MIT
#include "diagnose/spikes.hpp"

#include <algorithm>
#include <cmath>

#include "ripplenotch/core/median.hpp"

namespace ripplenotch {
namespace {

// A spike stands this many times the typical deviation about it from its neighbours, and alone.
constexpr double spike_deviations = 9.0;
constexpr std::size_t fewest_spikes = 3;

class Outliers {
  public:
    Outliers(const Case& looked_at, double least_nm)
        : case_(looked_at),
          torque_nm_(looked_at.torque_nm),
          least_nm_(least_nm),
          off_(from_neighbours()),
          typical_(typical_about(off_)) {}

    [[nodiscard]] bool is_spike(std::size_t k) const {
        // Beside what is held or clipped the torque jumps by nature.
        const auto spoiled = [&](std::size_t i) { return case_.use[i] == 0; };
        if (spoiled(k - 2) || spoiled(k - 1) || spoiled(k) || spoiled(k + 1) || spoiled(k + 2)) return false;
        if (!stands_out(k)) return false;
        // Up to two together; a burst or a ringing has its neighbours out as well.
        std::size_t out = 0;
        for (std::size_t i = k >= 8 ? k - 8 : 0; i < std::min(k + 9, off_.size()); ++i)
            out += stands_out(i) ? 1U : 0U;
        return out <= 4 && returns(k);
    }
    [[nodiscard]] double size_nm(std::size_t k) const { return std::abs(off_[k]); }
    [[nodiscard]] bool is_far(std::size_t k) const { return size_nm(k) > 2.0 * threshold(k); }

  private:
    [[nodiscard]] double threshold(std::size_t k) const {
        return spike_deviations * std::max(typical_[k], least_nm_);
    }
    [[nodiscard]] bool stands_out(std::size_t k) const { return size_nm(k) > threshold(k); }

    // After a spike the torque is where it was; after a step it is not. Of two samples to either side one may
    // be a spike itself.
    [[nodiscard]] bool returns(std::size_t k) const {
        const double size = size_nm(k);
        for (const std::size_t before : {k - 1, k - 2}) {
            for (const std::size_t after : {k + 1, k + 2}) {
                if (std::abs(torque_nm_[before] - torque_nm_[after]) < 0.4 * size &&
                    std::abs(torque_nm_[k] - torque_nm_[before]) > 0.7 * size)
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
            std::max<std::size_t>(20, static_cast<std::size_t>(0.1 * case_.motion.sample_rate.value()));
        std::vector<double> blocks;
        for (std::size_t first = 0; first < off.size(); first += block) {
            std::vector<double> part;
            for (std::size_t k = first; k < std::min(first + block, off.size()); ++k)
                if (case_.use[k] != 0) part.push_back(std::abs(off[k]));
            blocks.push_back(1.4826 * median_of(part));
        }
        std::vector<double> typical(off.size());
        for (std::size_t k = 0; k < off.size(); ++k) {
            const std::size_t b = k / block;
            typical[k] =
                std::max({blocks[b], blocks[b > 0 ? b - 1 : 0], blocks[std::min(b + 1, blocks.size() - 1)]});
        }
        return typical;
    }

    const Case& case_;
    const std::vector<double>& torque_nm_;
    double least_nm_;
    std::vector<double> off_, typical_;
};

}  // namespace

std::vector<Spike> find_spikes(const Case& looked_at, double least_nm) {
    const Outliers outliers(looked_at, least_nm);
    std::vector<Spike> spikes;
    std::size_t far = 0;
    for (std::size_t k = 2; k + 2 < looked_at.size(); ++k) {
        if (!outliers.is_spike(k)) continue;
        spikes.push_back({k, outliers.size_nm(k)});
        far += outliers.is_far(k) ? 1U : 0U;
    }
    // Spikes stand apart from the noise; heavy tails go on from it.
    if (spikes.size() < fewest_spikes || 2 * far < spikes.size()) return {};
    return spikes;
}

}  // namespace ripplenotch
