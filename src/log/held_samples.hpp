// SPDX-License-Identifier: MIT
#pragma once
// Rows that repeat the row before because nothing new had been measured.

#include <array>
#include <cstddef>
#include <limits>

#include "ripplenotch/core/trace.hpp"

namespace ripplenotch {

struct HeldSamples {
    std::size_t count = 0;
    std::size_t longest = 0;  ///< rows in the longest unbroken repetition
};

/// Counts rows whose torque and every other telling channel equal the row before, while the joint moves. A
/// channel tells when it changes in most moving rows: a coarsely quantised torque repeats by itself, and so
/// does the velocity of a perfectly steady motion. Nothing is counted where no channel tells and the torque
/// is coarse. Rows go by once, and a second time where the torque has to be judged.
class HeldCounter {
  public:
    /// The fastest row of the log.
    explicit HeldCounter(double fastest_deg_s) : moving_deg_s_(0.02 * fastest_deg_s) {}

    void take(const TraceView& rows);
    /// Whether it matters how coarse the torque is.
    [[nodiscard]] bool needs_grain() const;
    void take_grain(const TraceView& rows);

    [[nodiscard]] HeldSamples held() const;

  private:
    struct Row {
        double velocity = std::numeric_limits<double>::quiet_NaN(), torque = velocity, position = velocity;
    };
    struct Way {
        HeldSamples held;
        std::size_t run = 0;
        void add(bool same);
    };
    [[nodiscard]] bool moves(const Row& row, const Row& before) const;
    void take(const Row& row);
    [[nodiscard]] bool velocity_tells() const { return 2 * velocity_repeats_ < moving_rows_; }
    [[nodiscard]] bool position_tells() const {
        return has_position_ && 2 * position_repeats_ < moving_rows_;
    }
    [[nodiscard]] const Way& way() const;

    double moving_deg_s_;
    bool usable_ = true, has_position_ = false;
    Row before_, grain_before_;
    std::size_t rows_ = 0, grain_rows_ = 0;
    std::size_t moving_rows_ = 0, velocity_repeats_ = 0, position_repeats_ = 0;
    std::array<Way, 4> ways_;                     ///< 1: the velocity must repeat too, 2: the position
    std::size_t changes_ = 0, fine_changes_ = 0;  ///< of the torque: all, and those below ten of the smallest
    double smallest_change_ = std::numeric_limits<double>::infinity();
};

[[nodiscard]] HeldSamples count_held(const TraceView& trace);

}  // namespace ripplenotch
