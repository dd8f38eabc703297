// SPDX-License-Identifier: MIT
#include "analysis/motion/velocity_noise.hpp"

#include <cmath>
#include <vector>

#include "ripplenotch/core/median.hpp"

namespace ripplenotch {

double velocity_noise(const TraceView& log) {
    // By hand: long enough to hold the noise that a filter lets pass, short enough for motion of some hertz.
    constexpr double mean_over_s = 0.025;
    constexpr std::size_t fewest_means = 100;  // by hand: their median is within a tenth
    constexpr double normal_median = 0.6745;   // of the magnitude of a normal variable, in deviations
    const auto samples =
        static_cast<std::size_t>(std::max(1.0, std::round(mean_over_s * log.sample_rate.value())));
    std::vector<double> means;
    for (std::size_t first = 0; first + samples <= log.size(); first += samples) {
        double sum = 0.0;
        for (std::size_t k = first; k < first + samples; ++k) sum += log.velocity_deg_s[k];
        means.push_back(sum / static_cast<double>(samples));
    }
    if (means.size() < fewest_means) return 0.0;
    std::vector<double> bends;
    for (std::size_t i = 3; i < means.size(); ++i)
        bends.push_back(std::abs(means[i] - 3.0 * means[i - 1] + 3.0 * means[i - 2] - means[i - 3]));
    const double deviation = median_in(bends) / normal_median / std::sqrt(20.0);
    return deviation * deviation * static_cast<double>(samples) / log.sample_rate.value();
}

}  // namespace ripplenotch
