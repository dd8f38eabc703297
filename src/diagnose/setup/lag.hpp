// SPDX-License-Identifier: MIT
#pragma once
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "ripplenotch/diagnose/setup.hpp"

namespace ripplenotch {

// A series over a triangular window, at any time.

/// The series is linear between its samples; what follows is exact for that, whatever the rate.
class SmoothedSeries {
  public:
    /// `half_width_s` of the window. No window reaches across a gap of more than that and three usual steps.
    SmoothedSeries(std::span<const double> time_s, std::span<const double> value, double half_width_s);

    /// Whether the window about this time lies within the series and no gap.
    [[nodiscard]] bool covers(double at_s) const;
    /// Mean of the series, of its slope and of its curvature in the window; covers(at_s).
    [[nodiscard]] double mean(double at_s) const;
    [[nodiscard]] double slope(double at_s) const;
    [[nodiscard]] double curvature(double at_s) const;
    [[nodiscard]] double first_s() const { return time_s_.front(); }
    [[nodiscard]] double last_s() const { return time_s_.back(); }

  private:
    enum class Integral { none, once, twice };
    [[nodiscard]] double integral(Integral kind, double at_s) const;
    [[nodiscard]] double second_difference(Integral kind, double at_s) const;

    std::span<const double> time_s_;
    std::vector<double> value_, once_, twice_;
    std::vector<std::pair<double, double>> gaps_s_;
    double width_s_, mean_ = 0.0;
};

// Least squares of a series by another one that is shifted in time, with nuisance columns.

/// Largest lag of a search along these times of a log.
[[nodiscard]] double search_range_s(std::span<const double> time_s, const AlignmentOptions& options);

/// Times half a window apart at which all these series are covered.
[[nodiscard]] std::vector<double> window_times(const std::vector<const SmoothedSeries*>& series,
                                               double smoothing_s);

}  // namespace ripplenotch
