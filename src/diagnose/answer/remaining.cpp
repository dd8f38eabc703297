// SPDX-License-Identifier: MIT
#include "diagnose/answer/answer.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "ripplenotch/analysis/fourier.hpp"

namespace ripplenotch {
namespace {

// A residual of less is the noise: the regression that measures it has some eighty numbers of its own, and
// logs with nothing hidden come to 1.00 to 1.08.
constexpr double least_left = 1.15;
constexpr std::size_t bins = 40;
// A stretch that holds this share of what is left is where it is, if it is less than half as much of the log.
constexpr double most_of_it = 0.6, small_share = 0.5;
constexpr double tone_share = 0.3;     // of the residual's squares, in one line
constexpr double least_tone_hz = 2.0;  // slower is the motion

struct Stretch {
    Span range;
    double part = 0.0;       // of the excess
    double log_share = 1.0;  // of the samples
};

// The shortest stretch of a quantity that holds most of the excess over the noise.
std::optional<Stretch> shortest_stretch(std::span<const double> quantity, std::span<const double> residual_nm,
                                        std::span<const unsigned char> use, double noise_nm) {
    double low = 0.0, high = 0.0;
    bool is_first = true;
    for (std::size_t k = 0; k < quantity.size(); ++k) {
        if (use[k] == 0) continue;
        low = is_first ? quantity[k] : std::min(low, quantity[k]);
        high = is_first ? quantity[k] : std::max(high, quantity[k]);
        is_first = false;
    }
    if (!(high > low)) return std::nullopt;
    const double width = (high - low) / static_cast<double>(bins);
    std::vector<double> excess(bins, 0.0), count(bins, 0.0);
    for (std::size_t k = 0; k < quantity.size(); ++k) {
        if (use[k] == 0) continue;
        const auto bin = std::min(static_cast<std::size_t>((quantity[k] - low) / width), bins - 1);
        excess[bin] += residual_nm[k] * residual_nm[k] - noise_nm * noise_nm;
        count[bin] += 1.0;
    }
    for (double& each : excess) each = std::max(each, 0.0);
    const double all = std::accumulate(excess.begin(), excess.end(), 0.0);
    const double samples = std::accumulate(count.begin(), count.end(), 0.0);
    if (all <= 0.0) return std::nullopt;
    std::optional<Stretch> best;
    for (std::size_t first = 0; first < bins; ++first) {
        double part = 0.0, share = 0.0;
        for (std::size_t last = first; last < bins; ++last) {
            part += excess[last] / all;
            share += count[last] / samples;
            if (part < most_of_it) continue;
            if (!best || share < best->log_share)
                best = Stretch{
                    {low + width * static_cast<double>(first), low + width * static_cast<double>(last + 1)},
                    part,
                    share};
            break;
        }
    }
    return best;
}

// Frequency and share of the squares of the strongest line.
std::pair<double, double> strongest_line(std::span<const double> residual_nm,
                                         std::span<const unsigned char> use, double sample_rate_hz) {
    std::vector<double> counted(residual_nm.begin(), residual_nm.end());
    double squares = 0.0;
    for (std::size_t k = 0; k < counted.size(); ++k) {
        counted[k] *= use[k];
        squares += counted[k] * counted[k];
    }
    const auto sums = real_fourier(counted);
    const auto samples = static_cast<double>(counted.size());
    std::pair<double, double> best{0.0, 0.0};
    for (std::size_t cell = 2; cell + 2 < sums.size(); ++cell) {
        double power = 0.0;  // a line lies between cells
        for (std::size_t near = cell - 1; near <= cell + 1; ++near) power += 2.0 * std::norm(sums[near]);
        const double share = power / (samples * std::max(squares, 1e-300));
        if (share > best.second) best = {sample_rate_hz / samples * static_cast<double>(cell), share};
    }
    return best;
}

}  // namespace

std::optional<RemainingResidual> remaining_residual(const Motion& motion, std::span<const double> residual_nm,
                                                    std::span<const unsigned char> use, double noise_nm) {
    RemainingResidual left;
    left.rms_nm = rms_where(residual_nm, use);
    if (left.rms_nm <= least_left * noise_nm) return std::nullopt;
    const auto [hz, share] = strongest_line(residual_nm, use, motion.sample_rate.value());
    if (share > tone_share && hz > least_tone_hz) {
        left.kind = RegionKind::tone;
        left.where = {hz, hz};
        left.part = share;
        return left;
    }
    double least_share = small_share;
    const auto offer = [&](RegionKind kind, std::span<const double> quantity) {
        const auto found = shortest_stretch(quantity, residual_nm, use, noise_nm);
        if (!found || found->log_share >= least_share) return;
        least_share = found->log_share;
        left.kind = kind;
        left.where = found->range;
        left.part = found->part;
    };
    offer(RegionKind::time, motion.time_s);
    offer(RegionKind::speed, motion.velocity_deg_s);
    offer(RegionKind::position, motion.position_deg);
    return left;
}

}  // namespace ripplenotch
