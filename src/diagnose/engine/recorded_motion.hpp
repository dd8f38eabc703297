// SPDX-License-Identifier: MIT
#pragma once
// A log on a regular clock: the torque as recorded, the motion from its positions, and which samples count.

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ripplenotch/core/trace.hpp"
#include "ripplenotch/model/effect.hpp"

namespace ripplenotch::engine {

/// Torque of the user's own simulation, along its own motion. Spans have an entry per row of the log;
/// `velocity_deg_s` and `position_deg` may be empty: without both, the torque is taken as one along the
/// measured motion.
struct Simulation {
    std::span<const double> torque_nm, velocity_deg_s, position_deg;
    bool is_scale_known = false;  ///< its size is that of the log, within the error of a torque constant
};

/// A regular clock for stamps that jitter and rows that are missing.
struct Clock {
    double step_s = 0.0;
    double start_s = 0.0;              ///< time of slot 0, as the log counts
    std::vector<std::size_t> slot_of;  ///< of each row, not decreasing
    std::size_t slots = 0;
};
/// The rate is a round number of hertz where that fits the stamps as well as the mean rate.
[[nodiscard]] Clock regular_clock(std::span<const double> time_s);

/// Value and first two derivatives of a signal by the cubic that fits best within a window of an odd number
/// of samples, by least squares (Savitzky and Golay, 1964); at the ends that of the first or last window.
struct SmoothedSignal {
    std::vector<double> value, slope_per_s, curvature_per_s2;
};
[[nodiscard]] SmoothedSignal smooth_signal(std::span<const double> values, std::size_t window, double step_s);

/// Root mean square over the rows that count; 0 of none.
[[nodiscard]] double rms_where(std::span<const double> values, std::span<const unsigned char> use);

/// All vectors have an entry per slot of the clock.
class RecordedMotion {
  public:
    /// Throws DataError for fewer than 200 slots, and smooth() for a joint that does not move. `simulation`
    /// is copied.
    RecordedMotion(const TraceView& log, const std::optional<Simulation>& simulation);

    /// Derives motion, moved simulation and usable samples with a smoothing window of this length.
    void smooth(double window_s);
    /// Velocities of the arm's joints, an entry per row of the log, for motion().
    void set_others(std::span<const std::vector<double>> per_row_deg_s);
    /// Takes an error of the velocity out of the positions that are its integral; with the next smooth().
    void remove_velocity_bias(double bias_deg_s);
    [[nodiscard]] double removed_bias_deg_s() const { return removed_bias_deg_s_; }
    /// Excludes samples from now on, for instance spikes; takes effect with the next smooth().
    void exclude(std::size_t first, std::size_t count);

    [[nodiscard]] std::size_t size() const { return torque_nm_.size(); }
    [[nodiscard]] double step_s() const { return clock_.step_s; }
    [[nodiscard]] double window_s() const { return window_s_; }
    /// Times from 0; known_nm is the simulation along the measured motion, empty without one.
    [[nodiscard]] const Motion& motion() const { return motion_; }
    [[nodiscard]] const std::vector<double>& torque_nm() const { return torque_nm_; }
    [[nodiscard]] const std::vector<unsigned char>& usable() const { return usable_; }
    /// Usable samples and those at standstill.
    [[nodiscard]] const std::vector<unsigned char>& recorded() const { return recorded_; }
    [[nodiscard]] std::size_t usable_count() const;
    [[nodiscard]] double travel_deg() const;
    [[nodiscard]] double fastest_deg_s() const;
    /// By which widths of a friction over speed and angle are wider than those of a robot's joint: powers of
    /// four, 1 for every joint of a robot. A screw's nut travels tens of turns.
    [[nodiscard]] double speed_scale() const;
    [[nodiscard]] double angle_scale() const;
    /// The log's row nearest to a slot.
    [[nodiscard]] std::size_t row_of(std::size_t slot) const { return row_of_[slot]; }
    [[nodiscard]] const Clock& clock() const { return clock_; }
    /// The log has no position: it is the integral of its velocity.
    [[nodiscard]] bool is_position_integrated() const { return is_position_integrated_; }

    /// A column of one entry per row of the log, on the clock.
    [[nodiscard]] std::vector<double> on_clock(std::span<const double> per_row) const;
    /// Marks rows of the log that do not hold the joint's torque, before the first smooth().
    void mark_spoiled_rows(std::span<const unsigned char> is_good_row);

  private:
    void refuse_standstill() const;
    void move_simulation();
    void mark_usable(std::size_t window);

    TraceView log_;
    std::vector<double> row_s_;      ///< time of each row, long gaps shortened
    std::vector<double> removed_s_;  ///< from long gaps before each row
    Clock clock_;
    bool counts_rows_ = false;  ///< rows are regular and their stamps jitter
    bool is_position_integrated_ = false;
    std::vector<double> torque_nm_, raw_position_deg_, simulated_nm_, simulated_velocity_deg_s_,
        simulated_position_deg_;
    std::vector<unsigned char> recorded_, usable_;
    std::vector<std::size_t> row_of_;
    double window_s_ = 0.0, removed_bias_deg_s_ = 0.0;
    Motion motion_;
};

/// Friction that builds up over an angle after a reversal (Dahl, 1968), between -1 and 1, exact for each
/// step.
[[nodiscard]] std::vector<double> friction_loop(std::span<const double> position_deg, double width_deg);

/// The slope between neighbours, central within and one-sided at the ends, per step of the clock.
[[nodiscard]] std::vector<double> gradient(std::span<const double> values, double step_s);

}  // namespace ripplenotch::engine
