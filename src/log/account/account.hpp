// SPDX-License-Identifier: MIT
#pragma once
// The one account of a log while it goes by: how its rows belong together, which samples are held, and where
// each joint's angle comes from. Whole logs and streams are read through this.

#include <span>
#include <vector>

#include "log/account/held_samples.hpp"
#include "log/opening.hpp"
#include "ripplenotch/log/clock.hpp"
#include "ripplenotch/log/joint_angle.hpp"
#include "ripplenotch/log/recording.hpp"

namespace ripplenotch {

/// The rows [first, first + count) of one joint of a block, as a view that starts no run.
[[nodiscard]] TraceView view_of(const RowBlock& block, std::size_t joint, std::size_t first,
                                std::size_t count);

class Account {
  public:
    /// Judges the opening.
    Account(const Layout& layout, const Opening& opening, double gap_steps = default_gap_steps);

    /// The next rows, from the first of the log on, as the clock parts them; valid until the next call.
    /// Throws DataError when time runs backward.
    std::span<const RunPart> add(const RowBlock& block);

    [[nodiscard]] const Clock& clock() const { return clock_; }
    /// Of the rows so far; by joint, as Layout::all_chosen().
    [[nodiscard]] const AngleFacts& angle(std::size_t joint) const { return joints_[joint].angle.facts(); }
    /// `layout` as it stands now.
    [[nodiscard]] Recording recording(const Layout& layout, std::size_t joint) const;

  private:
    struct Joint {
        HeldCounter held;
        JointAngle angle;
    };
    Clock clock_;
    std::vector<Joint> joints_;
    bool judged_ = false;  ///< the clock tells how far a velocity goes
};

/// A logged position as the joint's, row after row: nothing where the angle is taken from the velocity, the
/// sign turned where it is reversed, carried on by the velocity from where the two part.
class JointsPosition {
  public:
    /// The next rows that are used; `angle` as it is known after them. Valid until the next call.
    [[nodiscard]] std::span<const double> of(const AngleFacts& angle, const TraceView& rows);

  private:
    std::size_t rows_ = 0;
    double last_s_ = 0.0, last_deg_s_ = 0.0, last_deg_ = 0.0;
    std::vector<double> room_;
};

}  // namespace ripplenotch
