// SPDX-License-Identifier: MIT
#pragma once
// Internal: the lines of one joint in the order of their dates, as columns.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ripplenotch/fleet/trend.hpp"

namespace ripplenotch {

/// One descriptor in the rows that contain it.
struct Series {
    std::string name;
    std::vector<std::size_t> rows;
    std::vector<double> value;
};

struct Condition {
    std::string name;
    std::vector<double> value;  ///< less its median, a number per row
};

struct JointHistory {
    std::string robot, joint;
    std::vector<const FeatureLine*> lines;
    std::vector<double> day;  ///< since 1970
    std::vector<Condition> conditions;
    std::vector<Series> series;
    std::vector<DescriptorTrend> untold;  ///< descriptors that too few lines contain
    std::vector<std::string> notes;

    [[nodiscard]] double months() const;
};

/// The histories of all joints, by robot and joint. Throws what trend_of() throws for its lines; `notes`
/// receives the notes on the fleet.
[[nodiscard]] std::vector<JointHistory> joint_histories(std::span<const FeatureLine> lines,
                                                        std::vector<std::string>& notes);

// Internal: is there a change in a joint, of any descriptor, anywhere in time? The largest statistic of all
// is compared with its permutation distribution for the residuals of the same joint (Freedman and Lane,
// 1983), so that one p covers all of them.

/// The contribution of one more column.
struct Extra {
    double size = 0.0;   ///< coefficient of the column
    double error = 0.0;  ///< standard error of it
    double t_squared = 0.0;
};

/// Least squares of a series on a few columns, and the reduction of its residual by one more.
class Regression {
  public:
    /// Columns that the ones before them nearly hold are left out. All as long as `value`.
    Regression(std::span<const double> value, const std::vector<std::vector<double>>& columns);

    [[nodiscard]] const std::vector<double>& residual() const { return residual_; }
    [[nodiscard]] double freedom() const;    ///< rows less columns
    [[nodiscard]] double deviation() const;  ///< rms of the residual, by its freedom
    /// Takes the columns out of numbers.
    void project(std::vector<double>& numbers) const;
    /// Empty where less than a twentieth of the column is outside the others.
    [[nodiscard]] std::optional<Extra> extra(std::vector<double> column) const;
    /// Value of the first column, where all others are 0.
    [[nodiscard]] double first_value() const { return first_value_; }

  private:
    std::vector<double> residual_;
    std::vector<std::vector<double>> basis_;
    double first_value_ = 0.0;
};

/// A change that was found: its column, and where it is.
struct FoundChange {
    bool drift = false;
    std::size_t row = 0;  ///< index among the joint's lines: the first after a step
    double p = 1.0, limit = 0.0;
};

/// The column of a change in a row: 0 and 1 of a step, 0 to 1 of a drift.
[[nodiscard]] std::vector<double> change_column(const JointHistory& history, const FoundChange& change,
                                                std::span<const std::size_t> rows);

/// A series, fitted with the conditions and the changes that are known.
[[nodiscard]] Regression regression_of(const JointHistory& history, const Series& series,
                                       std::span<const FoundChange> known);

/// The likeliest change beside those that are known, if its chance is at most `limit`. Rows that remember
/// those before them are permuted in blocks.
[[nodiscard]] std::optional<FoundChange> next_change(const JointHistory& history,
                                                     std::span<const FoundChange> known, double limit,
                                                     std::uint64_t seed);

}  // namespace ripplenotch
