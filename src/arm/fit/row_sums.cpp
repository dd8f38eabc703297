// SPDX-License-Identifier: MIT
#include "arm/fit/row_sums.hpp"

#include <algorithm>

namespace ripplenotch {
namespace {

using Eigen::Index;

// Rows as logged only judge a window; more of them would not judge it better.
constexpr std::size_t most_judging_rows = 6000;
constexpr double rows_a_window = 4.0;
// A short log has more rows a window, so that each fifth has some.
constexpr std::size_t fewest_fit_rows = 100;

struct Window {
    std::size_t first = 0, end = 0;
};

std::vector<Window> windows_about(const std::vector<std::size_t>& centers, std::span<const double> time_s,
                                  double half_s) {
    std::vector<Window> windows;
    Window window;
    for (const std::size_t center : centers) {
        while (time_s[center] - time_s[window.first] > half_s) ++window.first;
        window.end = std::max(window.end, center + 1);
        while (window.end < time_s.size() && time_s[window.end] - time_s[center] <= half_s) ++window.end;
        windows.push_back(window);
    }
    return windows;
}

// The rows of a window that goes forward, each computed once.
class RecentRows {
  public:
    RecentRows(ArmRows& rows, std::size_t most) : rows_(rows), room_(most), values_(most * rows.values()) {}

    std::span<const double> at(std::size_t k) const {
        return std::span(values_).subspan((k % room_) * rows_.values(), rows_.values());
    }
    void reach(Window window) {
        next_ = std::max(next_, window.first);
        for (; next_ < window.end; ++next_)
            rows_.at(next_, std::span(values_).subspan((next_ % room_) * rows_.values(), rows_.values()));
    }

  private:
    ArmRows& rows_;
    std::size_t room_, next_ = 0;
    std::vector<double> values_;
};

std::vector<FoldSums> empty_folds(std::size_t values) { return std::vector(arm_folds, FoldSums(values)); }

std::vector<FoldSums> smoothed_sums(ArmRows& rows, const TraceView& log, double half_s,
                                    const std::vector<std::size_t>& centers, const std::vector<bool>& use) {
    std::vector<FoldSums> folds = empty_folds(rows.values());
    const auto windows = windows_about(centers, log.time_s, half_s);
    std::size_t most = 1;
    for (const Window& window : windows) most = std::max(most, window.end - window.first);
    RecentRows recent(rows, most);
    std::vector<double> mean(rows.values());
    for (std::size_t c = 0; c < centers.size(); ++c) {
        recent.reach(windows[c]);
        std::fill(mean.begin(), mean.end(), 0.0);
        double torque_nm = 0.0, sum = 0.0;
        for (std::size_t k = windows[c].first; k < windows[c].end; ++k) {
            if (!use[k]) continue;
            const double u = half_s > 0.0 ? (log.time_s[k] - log.time_s[centers[c]]) / half_s : 0.0;
            const double weight = k == centers[c] ? 1.0 : (1.0 - u * u) * (1.0 - u * u);
            const auto row = recent.at(k);
            for (std::size_t v = 0; v < row.size(); ++v) mean[v] += weight * row[v];
            torque_nm += weight * log.torque_nm[k];
            sum += weight;
        }
        for (double& value : mean) value /= sum;
        folds[c * arm_folds / centers.size()].add(mean, torque_nm / sum);
    }
    return folds;
}

std::vector<FoldSums> logged_sums(ArmRows& rows, const TraceView& log,
                                  const std::vector<std::size_t>& centers) {
    std::vector<FoldSums> folds = empty_folds(rows.values());
    std::vector<double> row(rows.values());
    const std::size_t step = centers.size() / most_judging_rows + 1;
    for (std::size_t c = 0; c < centers.size(); c += step) {
        rows.at(centers[c], row);
        folds[c * arm_folds / centers.size()].add(row, log.torque_nm[centers[c]]);
    }
    return folds;
}

}  // namespace

FoldSums::FoldSums(std::size_t values)
    : rows_by_rows(Eigen::MatrixXd::Zero(static_cast<Index>(values), static_cast<Index>(values))),
      rows_by_torque(Eigen::VectorXd::Zero(static_cast<Index>(values))) {}

void FoldSums::add(std::span<const double> row, double torque_nm) {
    for (std::size_t b = 0; b < row.size(); ++b) {
        if (row[b] == 0.0) continue;  // links before the joint
        double* const column = rows_by_rows.data() + b * row.size();
        for (std::size_t a = 0; a <= b; ++a) column[a] += row[a] * row[b];
        rows_by_torque[static_cast<Index>(b)] += row[b] * torque_nm;
    }
    torque_by_torque += torque_nm * torque_nm;
    count += 1.0;
}

void FoldSums::add(const FoldSums& other) {
    rows_by_rows += other.rows_by_rows;
    rows_by_torque += other.rows_by_torque;
    torque_by_torque += other.torque_by_torque;
    count += other.count;
}

void FoldSums::complete() {
    rows_by_rows.triangularView<Eigen::StrictlyLower>() = rows_by_rows.transpose().eval();
}

double FoldSums::left(const Eigen::VectorXd& values) const {
    const double sum =
        torque_by_torque - 2.0 * values.dot(rows_by_torque) + values.dot(rows_by_rows * values);
    return std::max(0.0, sum);
}

FitRows fit_rows(const TraceView& log, Seconds window, const std::vector<bool>& use) {
    const double step = window.value() * log.sample_rate.value() / rows_a_window;
    const auto there = static_cast<std::size_t>(std::count(use.begin(), use.end(), true));
    const std::size_t every = std::clamp<std::size_t>(static_cast<std::size_t>(step), 1,
                                                      std::max<std::size_t>(1, there / fewest_fit_rows));
    FitRows rows{{}, static_cast<double>(every)};
    for (std::size_t k = every / 2; k < log.size(); k += every)
        if (use[k]) rows.centers.push_back(k);
    return rows;
}

JointSums sums_of(ArmRows& rows, const TraceView& log, std::size_t joint, Seconds window,
                  const FitRows& chosen, const std::vector<bool>& use) {
    // A millionth of a sample wider, so that rounding of the times does not decide which rows are in.
    const double half_s = 0.5 * window.value() + 1e-6 / log.sample_rate.value();
    std::vector<std::size_t> logged;
    for (std::size_t k = 0; k < log.size(); ++k)
        if (use[k]) logged.push_back(k);
    JointSums sums{joint, smoothed_sums(rows, log, half_s, chosen.centers, use),
                   logged_sums(rows, log, logged)};
    for (auto* folds : {&sums.smoothed, &sums.logged})
        for (FoldSums& fold : *folds) fold.complete();
    return sums;
}

}  // namespace ripplenotch
