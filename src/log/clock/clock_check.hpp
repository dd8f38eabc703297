// SPDX-License-Identifier: MIT
#pragma once
// Does the clock agree with the motion? Change of position against integrated velocity, by robust regression.

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ripplenotch/core/trace.hpp"

namespace ripplenotch {

/// Neither is more than `factor` times the other.
[[nodiscard]] inline bool within_factor(double a, double b, double factor) {
    return a <= factor * b && b <= factor * a;
}

/// The steps from time to time that advance.
[[nodiscard]] std::vector<double> advancing_steps(std::span<const double> time_s);

struct StepSums {
    double shortest_s, longest_s;
    double squares;  ///< of the steps about the usual one
};

/// Sums up the steps between two times or more.
[[nodiscard]] StepSums sum_up_steps(std::span<const double> time_s, double usual_s) noexcept;

struct ClockCheck {
    std::optional<double>
        factor;  ///< change of position / integrated velocity; empty when there is too little motion
    std::string
        warning;  ///< one sentence when the factor is not 1, or position and velocity do not belong together
};

/// The motion of a log in pieces that are long enough to average noise, and many enough for a median.
class MotionPieces {
  public:
    /// `rows` of the whole log.
    explicit MotionPieces(std::size_t rows);

    /// Rows with a continuous position, one after another; where a run starts, a piece ends.
    void add(const TraceView& rows);
    [[nodiscard]] ClockCheck check(Hertz sample_rate);

    // The change of velocity is there because a filtered velocity lags: position = integrated velocity + lag
    // * velocity, which looks like a factor while the joint speeds up.
    struct Piece {
        double position_change = 0.0, integrated_velocity = 0.0, velocity_change = 0.0;
    };

    /// Those that are complete.
    [[nodiscard]] const std::vector<Piece>& pieces() const { return pieces_; }

  private:
    struct Row {
        double time_s, velocity_deg_s, position_deg;
    };
    void end_piece();

    std::size_t rows_, rows_in_piece_;
    std::optional<Row> before_;
    std::size_t in_piece_ = 0;
    Piece piece_;
    std::vector<Piece> pieces_;
};

/// "position changes 57.3 times as much as velocity and time say; ..." and what that factor may come from.
[[nodiscard]] std::string factor_in_words(double factor);

}  // namespace ripplenotch
