// SPDX-License-Identifier: MIT
#include "diagnose/setup/smoothed_series.hpp"

#include <algorithm>
#include <numeric>

#include "ripplenotch/core/median.hpp"

namespace ripplenotch {

double usual_step_s(std::span<const double> time_s) {
    std::vector<double> steps;
    for (std::size_t k = 1; k < time_s.size(); ++k) steps.push_back(time_s[k] - time_s[k - 1]);
    return median_in(steps);
}

SmoothedSeries::SmoothedSeries(std::span<const double> time_s, std::span<const double> value,
                               double half_width_s)
    : time_s_(time_s), value_(value.begin(), value.end()), width_s_(half_width_s) {
    // About its mean: the second integral grows with the square of time.
    mean_ = std::accumulate(value_.begin(), value_.end(), 0.0) / static_cast<double>(value_.size());
    for (double& each : value_) each -= mean_;
    once_.assign(value_.size(), 0.0);
    twice_.assign(value_.size(), 0.0);
    const double longest_s = std::max(width_s_, 3.0 * usual_step_s(time_s_));
    for (std::size_t k = 1; k < value_.size(); ++k) {
        const double step_s = time_s_[k] - time_s_[k - 1];
        if (step_s > longest_s) gaps_s_.emplace_back(time_s_[k - 1], time_s_[k]);
        once_[k] = once_[k - 1] + 0.5 * step_s * (value_[k - 1] + value_[k]);
        twice_[k] =
            twice_[k - 1] + step_s * (once_[k - 1] + step_s * (value_[k - 1] / 3.0 + value_[k] / 6.0));
    }
}

bool SmoothedSeries::covers(double at_s) const {
    if (at_s - width_s_ < time_s_.front() || at_s + width_s_ > time_s_.back()) return false;
    const auto next = std::upper_bound(gaps_s_.begin(), gaps_s_.end(), at_s - width_s_,
                                       [](double t, const auto& gap) { return t < gap.second; });
    return next == gaps_s_.end() || next->first >= at_s + width_s_;
}

double SmoothedSeries::integral(Integral kind, double at_s) const {
    const auto next = std::upper_bound(time_s_.begin(), time_s_.end(), at_s) - time_s_.begin();
    const auto k =
        std::min(static_cast<std::size_t>(std::max<std::ptrdiff_t>(next - 1, 0)), value_.size() - 2);
    const double t = at_s - time_s_[k];
    const double slope = (value_[k + 1] - value_[k]) / (time_s_[k + 1] - time_s_[k]);
    switch (kind) {
        case Integral::none:
            return value_[k] + t * slope;
        case Integral::once:
            return once_[k] + t * (value_[k] + 0.5 * t * slope);
        default:
            return twice_[k] + t * (once_[k] + t * (0.5 * value_[k] + t * slope / 6.0));
    }
}

double SmoothedSeries::second_difference(Integral kind, double at_s) const {
    return (integral(kind, at_s + width_s_) - 2.0 * integral(kind, at_s) + integral(kind, at_s - width_s_)) /
           (width_s_ * width_s_);
}

double SmoothedSeries::mean(double at_s) const { return mean_ + second_difference(Integral::twice, at_s); }
double SmoothedSeries::slope(double at_s) const { return second_difference(Integral::once, at_s); }
double SmoothedSeries::curvature(double at_s) const { return second_difference(Integral::none, at_s); }

}  // namespace ripplenotch
