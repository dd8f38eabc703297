// SPDX-License-Identifier: MIT
#pragma once
// Internal: the largest statistic of one series over all places of a step, and of a drift, for its residuals
// in any order.

#include <optional>
#include <string>
#include <vector>

#include "fleet/trend/joint_history.hpp"
#include "fleet/trend/regression.hpp"

namespace ripplenotch {

/// What is known of a series' scatter beside its own lines, and how many lines that is worth.
struct Scatter {
    double freedom = 0.0;
    double variance = 0.0;  ///< of lines, in squares of Scan::unit()
};

/// The usual error of a line as the lines state it, else the size of the series: what scatters of joints are
/// compared in. 0: there is none.
[[nodiscard]] double unit_of(const Series& series, const Regression& regression);

class Scan {
  public:
    Scan(const JointHistory& history, const Series& series, const Regression& regression);
    /// All torques together, each by its relative residual: what a sensor of another gain moves at once, each
    /// of them by too little. Empty where fewer than three torques are told by every line.
    [[nodiscard]] static std::optional<Scan> of_sensor_gain(const JointHistory& history,
                                                            const std::vector<Regression>& known);

    [[nodiscard]] const std::string& name() const { return name_; }
    [[nodiscard]] double unit() const { return unit_; }  ///< unit_of(), 1 of all torques together
    [[nodiscard]] const Scatter& scatter() const { return scatter_; }  ///< of its own lines
    /// From here on a statistic is held against its own scatter and this one together.
    void lean_on(const Scatter& known);

    [[nodiscard]] double largest() const { return largest_; }  ///< t squared, in the order of time
    [[nodiscard]] bool is_drift() const { return drift_; }
    [[nodiscard]] std::size_t row() const { return row_; }   ///< of the joint's lines: first after the step
    [[nodiscard]] double memory() const { return memory_; }  ///< from row to row, beside the best change
    /// The same of what chance makes of the series, in another order of the joint's rows.
    [[nodiscard]] double largest_of(const std::vector<std::size_t>& order, std::vector<double>& room) const;

  private:
    struct Found {
        double t_squared = 0.0;
        bool drift = false;
        std::size_t place = 0;
    };
    Scan(const JointHistory& history, std::string name, std::vector<std::size_t> rows, double unit,
         Regression regression);
    [[nodiscard]] Found look(const std::vector<double>& residual) const;
    void leave_chance(const Found& found);

    std::string name_;
    double unit_ = 0.0;
    Scatter scatter_;
    Scatter known_;  ///< of others, in the series' unit
    std::vector<std::size_t> rows_;
    std::vector<std::size_t> place_of_row_;  ///< in rows_; rows that do not tell the series have rows_.size()
    Regression regression_;
    std::vector<double> norm_;  ///< squares that are left of a step before each place; 0: it is not looked at
    std::vector<double> chance_;  ///< residual beside the best change, if it is one, weighed
    std::vector<double> slope_;
    double slope_norm_ = 0.0, largest_ = 0.0, memory_ = 0.0;
    bool drift_ = false;
    std::size_t row_ = 0;
};

}  // namespace ripplenotch
