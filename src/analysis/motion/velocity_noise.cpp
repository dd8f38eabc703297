// SPDX-License-Identifier: MIT
#include "analysis/motion/velocity_noise.hpp"

#include <cmath>
#include <span>
#include <vector>

#include "ripplenotch/core/median.hpp"

namespace ripplenotch {
namespace {

/// Where a velocity in coarse steps turns, it stays at one value while the joint is up to a step beside it: a
/// parabola that reaches a share h of the step, anything from 0 to 1, is off by 2 h / 3 - 1 / 2 in the mean.
constexpr double square_off = 1.0 / 27.0 + 1.0 / 36.0;
constexpr std::size_t fewest_alike = 3;  // by hand: noise alone makes two alike now and then
constexpr double same_step = 1e-3;       // by hand: of a step; values have been rounded in other units

/// Variance that turning points of a velocity in steps add to its sum in each second, in deg^2/s. Between
/// them the steps average out.
double of_steps(std::span<const double> velocity_deg_s, Hertz rate) {
    double sum = 0.0;
    std::size_t begin = 0;
    for (std::size_t k = 1; k < velocity_deg_s.size(); ++k) {
        if (velocity_deg_s[k] == velocity_deg_s[begin]) continue;
        if (begin > 0 && k - begin >= fewest_alike) {
            const double before = velocity_deg_s[begin - 1] - velocity_deg_s[begin],
                         after = velocity_deg_s[k] - velocity_deg_s[begin];
            const double seconds = static_cast<double>(k - begin) / rate.value();
            if (std::abs(before - after) <= same_step * std::abs(after))
                sum += square_off * after * after * seconds * seconds;
        }
        begin = k;
    }
    return sum / (static_cast<double>(velocity_deg_s.size()) / rate.value());
}

}  // namespace

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
    return deviation * deviation * static_cast<double>(samples) / log.sample_rate.value() +
           of_steps(log.velocity_deg_s, log.sample_rate);
}

}  // namespace ripplenotch
