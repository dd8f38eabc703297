// SPDX-License-Identifier: MIT
#include "arm/fit/smooth_along.hpp"

#include <algorithm>

namespace ripplenotch {
namespace {

// What each value of a window counts for the parabola's middle: the same for every column.
class Kernels {
  public:
    Kernels(std::span<const double> time_s, Seconds window)
        : time_s_(time_s), half_s_(0.5 * window.value()) {}

    [[nodiscard]] std::size_t first() const { return first_; }
    /// Of the values from first() on; empty where the value stays as it is.
    std::span<const double> about(std::size_t k) {
        while (time_s_[k] - time_s_[first_] > half_s_) ++first_;
        while (end_ < time_s_.size() && time_s_[end_] - time_s_[k] <= half_s_) ++end_;
        kernel_.clear();
        if (end_ - first_ <= 3) return kernel_;
        double moments[5] = {};
        for (std::size_t i = first_; i < end_; ++i) {
            const double u = (time_s_[i] - time_s_[k]) / half_s_, square = u * u;
            const double weight = (1.0 - square) * (1.0 - square);
            moments[0] += weight;
            moments[1] += weight * u;
            moments[2] += weight * square;
            moments[3] += weight * square * u;
            moments[4] += weight * square * square;
        }
        // Cramer's rule.
        const double a = moments[2] * moments[4] - moments[3] * moments[3],
                     b = moments[2] * moments[3] - moments[1] * moments[4],
                     c = moments[1] * moments[3] - moments[2] * moments[2];
        const double size = moments[0] * a + moments[1] * b + moments[2] * c;
        if (!(size > 1e-9 * moments[0] * moments[0] * moments[0])) return kernel_;
        for (std::size_t i = first_; i < end_; ++i) {
            const double u = (time_s_[i] - time_s_[k]) / half_s_, square = u * u;
            kernel_.push_back((1.0 - square) * (1.0 - square) * (a + b * u + c * square) / size);
        }
        return kernel_;
    }

  private:
    std::span<const double> time_s_;
    double half_s_;
    std::size_t first_ = 0, end_ = 0;
    std::vector<double> kernel_;
};

// Four sums side by side: one would wait for itself.
double weighed(std::span<const double> kernel, const double* values) {
    double sums[4] = {};
    std::size_t i = 0;
    for (; i + 4 <= kernel.size(); i += 4) {
        for (std::size_t lane = 0; lane < 4; ++lane) sums[lane] += kernel[i + lane] * values[i + lane];
    }
    for (; i < kernel.size(); ++i) sums[0] += kernel[i] * values[i];
    return (sums[0] + sums[1]) + (sums[2] + sums[3]);
}

}  // namespace

std::vector<std::vector<double>> smooth_along(std::span<const double> time_s,
                                              std::span<const std::vector<double>> columns, Seconds window) {
    std::vector<std::vector<double>> smooth(columns.begin(), columns.end());
    Kernels kernels(time_s, window);
    for (std::size_t k = 0; k < time_s.size(); ++k) {
        const auto kernel = kernels.about(k);
        if (kernel.empty()) continue;
        for (std::size_t c = 0; c < columns.size(); ++c)
            smooth[c][k] = weighed(kernel, columns[c].data() + kernels.first());
    }
    return smooth;
}

std::vector<double> smooth_along(std::span<const double> time_s, std::span<const double> values,
                                 Seconds window) {
    const std::vector<std::vector<double>> one = {{values.begin(), values.end()}};
    return smooth_along(time_s, one, window).front();
}

}  // namespace ripplenotch
