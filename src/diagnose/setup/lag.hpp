// SPDX-License-Identifier: MIT
#pragma once
// Series of a log and of a simulation over one window, and least squares between them at any delay.

#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/matrices/linear_algebra.hpp"
#include "ripplenotch/core/trace.hpp"
#include "ripplenotch/diagnose/setup.hpp"

namespace ripplenotch {

/// A series over a triangular window, at any time: exact for values that are joined by lines.
class SmoothedSeries {
  public:
    /// `half_width_s` of the window. No window reaches across a gap of more than that and three usual steps.
    SmoothedSeries(std::span<const double> time_s, std::span<const double> value, double half_width_s);

    /// Whether the window about this time lies within the series and no gap.
    [[nodiscard]] bool covers(double at_s) const;
    /// Mean of the series, or of its first or second derivative, in the window; covers(at_s).
    [[nodiscard]] double mean(double at_s, int derivative = 0) const;
    /// Times half a window apart that it covers.
    [[nodiscard]] std::vector<double> times_s() const;

  private:
    [[nodiscard]] double integral(int times, double at_s) const;

    std::span<const double> time_s_;
    std::vector<double> value_, once_, twice_;
    std::vector<std::pair<double, double>> gaps_s_;
    double width_s_, mean_ = 0.0;
};

using Columns = std::vector<std::vector<double>>;
using Places = std::vector<Eigen::Index>;
[[nodiscard]] inline Places operator+(Places left, const Places& right) {
    left.insert(left.end(), right.begin(), right.end());
    return left;
}

/// Products of columns by block of rows: what is left of any combination of them with others of them.
class BlockProducts {
  public:
    /// Ten blocks leave nine degrees of freedom: intervals are 15 % wider than with a known variance, and
    /// each block still is longer than what correlates residuals.
    static constexpr std::size_t blocks = 10;
    /// The rows of a block have the same sum of weights as those of another.
    BlockProducts(const Columns& columns, std::span<const double> weight);

    /// A combination that is one column.
    [[nodiscard]] Eigen::VectorXd column(Eigen::Index place) const;
    /// Factors of the columns `by` that leave least of a combination, without one block if that is stated.
    [[nodiscard]] Eigen::VectorXd values(const Eigen::VectorXd& of, const Places& by,
                                         std::optional<std::size_t> without = {}) const;
    /// Squares that are left of each block, by factors found with or without that block, and their sum.
    [[nodiscard]] std::vector<double> left(const Eigen::VectorXd& of, const Places& by, bool held_out) const;
    [[nodiscard]] double squares(const Eigen::VectorXd& of, const Places& by, bool held_out = true) const;
    [[nodiscard]] double product(const Eigen::VectorXd& a, const Eigen::VectorXd& b) const;

  private:
    std::vector<Eigen::MatrixXd> products_;
    Eigen::MatrixXd all_;
};

/// A measured and a simulated series, and columns of what the measured one may have with it.
class Alignment {
  public:
    /// Columns of products(): both series, the derivatives of the simulated one by its delay, then others.
    enum : Eigen::Index { measured, simulated, slope, drift, bend, third, constant };

    /// Of positions the slopes are compared, where that is wanted. `log`: whose motion makes the columns
    /// with an offset; null: there are none.
    Alignment(std::span<const double> log_s, std::span<const double> left, bool is_slope_of_left,
              const SimulatedMotion& simulation, std::span<const double> right, bool is_slope_of_right,
              const TraceView* log = nullptr, std::optional<GearRatio> gear_ratio = {});

    /// At a delay that the search reaches.
    [[nodiscard]] BlockProducts products(double delay_s, double clock_error = 0.0,
                                         std::size_t stride = 1) const;

    /// Which series the other one and these columns are to explain: the measured one; or the simulated one by
    /// the columns alone.
    struct Question {
        Places nuisance;
        bool is_simulated = false;
        [[nodiscard]] Eigen::Index target() const { return is_simulated ? simulated : measured; }
        [[nodiscard]] Places at_a_delay() const {
            return is_simulated ? nuisance : Places{simulated} + nuisance;
        }
        [[nodiscard]] Places alone() const { return is_simulated ? Places{constant} : nuisance; }
        /// By which the delay is longer, from the first factors.
        [[nodiscard]] double delay_of(const Eigen::VectorXd& factors) const {
            return is_simulated ? factors[0] : -factors[1] / factors[0];
        }
    };
    /// The delay that leaves least.
    [[nodiscard]] SimulationLag lag(const Question& of) const;

    /// Places of columns: an offset, Coulomb friction of two widths and viscous friction; inertia; cosine and
    /// sine of the position; ripple; friction that grows with the torque; hysteresis. Empty where the log has
    /// not what they need.
    Places friction{constant}, inertia, gravity, ripple, load, loop;
    /// Further columns, of friction that turns over faster than a sensor's delay lets it: of the log.
    [[nodiscard]] Places add_sharp_friction(const TraceView& log);

  private:
    struct Candidate;
    [[nodiscard]] Places fitted(const BlockProducts& products, const Question& of, bool with_clock) const;
    [[nodiscard]] Candidate refined(double delay_s, bool with_clock, const Question& of) const;
    void measure(Candidate& found, bool with_clock, const Question& of) const;
    [[nodiscard]] std::vector<double> minima_s(const Question& of) const;
    void add(Places& group, std::span<const double> time_s, std::span<const double> values,
             int derivative = 0);
    void add_motion(const TraceView& log, std::optional<GearRatio> gear_ratio);

    double smoothing_s_, range_s_, middle_s_ = 0.0;
    SmoothedSeries right_;
    int derivative_;
    std::vector<double> at_s_;
    Columns rows_;  ///< measured, then with
};

}  // namespace ripplenotch
