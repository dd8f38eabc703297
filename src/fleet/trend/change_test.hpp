// SPDX-License-Identifier: MIT
#pragma once
// Internal: is there a change in a joint, of any descriptor, anywhere in time? The largest statistic of all
// is compared with its permutation distribution for the residuals of the same joint (Freedman and Lane,
// 1983), so that one p covers all of them.

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "fleet/trend/joint_history.hpp"

namespace ripplenotch {

// Internal: weighted least squares of a series on a few columns, and the reduction of their residual by one
// more column.

/// The contribution of one more column.
struct Extra {
    double size = 0.0;   ///< coefficient of the column
    double error = 0.0;  ///< standard error of it
    double t_squared = 0.0;
};

class Regression {
  public:
    /// `weights` multiply rows: 1 over a standard deviation, or in proportion to it. Columns that the ones
    /// before them nearly hold are left out. All as long as `value`.
    Regression(std::span<const double> value, std::span<const double> weights,
               const std::vector<std::vector<double>>& columns);

    [[nodiscard]] const std::vector<double>& residual() const { return residual_; }  ///< weighed
    [[nodiscard]] const std::vector<double>& weights() const { return weights_; }
    [[nodiscard]] double freedom() const;    ///< rows less columns
    [[nodiscard]] double deviation() const;  ///< rms of the weighed residual, by its freedom
    /// The residual of a column after projection on the others, weighted.
    [[nodiscard]] std::vector<double> beside(std::span<const double> column) const;
    /// Takes the columns out of weighed numbers.
    void project(std::vector<double>& weighed) const;
    /// Empty where less than a twentieth of the column is outside the others.
    [[nodiscard]] std::optional<Extra> extra(std::span<const double> column) const;
    /// Value of the first column, where all others are 0.
    [[nodiscard]] double first_value() const { return first_value_; }

  private:
    std::vector<double> weights_, residual_;
    std::vector<std::vector<double>> basis_;
    double first_value_ = 0.0;
};

// Internal: how much the lines of a series scatter, estimated from the other joints of the kind. Thirty lines
// alone determine their scatter to an eighth, and four changed lines have to exceed it.

/// Prior of a series' scatter in addition to its own lines, and its weight as a number of lines.
struct Scatter {
    double freedom = 0.0;
    double variance = 0.0;  ///< variance of lines, in squares of Scan::unit()
};

/// By the names of scans; without those that no other joint has.
using ScatterOfSeries = std::map<std::string, Scatter>;

/// The scatter for each history, from the joints of its name on other robots, never from its own lines; with
/// the greater weight the more similar those joints are (G. K. Smyth, Linear models and empirical Bayes
/// methods for assessing differential expression in microarray experiments, 2004).
[[nodiscard]] std::vector<ScatterOfSeries> scatter_of_kin(std::span<const JointHistory> histories);

/// A change that was found: its column, and where it is.
struct FoundChange {
    bool drift = false;
    std::size_t row = 0;                   ///< index among the joint's lines: the first after a step
    std::size_t earliest = 0, latest = 0;  ///< rows that are hardly worse
    double p = 1.0, limit = 0.0;
};

/// The column of a change in a row: 0 and 1 of a step, 0 to 1 of a drift.
[[nodiscard]] std::vector<double> change_column(const JointHistory& history, const FoundChange& change,
                                                std::span<const std::size_t> rows);

/// Each series, fitted with the conditions and the changes that are known.
[[nodiscard]] std::vector<Regression> regressions(const JointHistory& history,
                                                  std::span<const FoundChange> known);

/// The likeliest change, if its chance is at most `limit`; and the autocorrelation is kept by blocks.
/// `scatter`: prior on each series in addition to its lines.
[[nodiscard]] std::optional<FoundChange> next_change(const JointHistory& history,
                                                     const std::vector<Regression>& known,
                                                     const ScatterOfSeries& scatter, double limit,
                                                     std::uint64_t seed);

// Internal: the largest statistic of one series over all places of a step, and of a drift, for its residuals
// in any order.

/// The usual error of a line as the lines state it, else the size of the series: what scatters of joints are
/// compared in. 0: there is none.
[[nodiscard]] double unit_of(const Series& series, const Regression& regression);

}  // namespace ripplenotch
