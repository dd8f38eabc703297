// SPDX-License-Identifier: MIT
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "ripplenotch/log/format.hpp"

namespace ripplenotch {

/// Counts rows that repeat the row before because nothing new had been measured. A channel tells when it
/// changes in most rows of a moving joint, which is known only at the end: a coarse torque repeats by itself,
/// and so does the velocity of a steady motion. So repetitions are counted for every set of telling channels,
/// and one count is chosen then.
class HeldRows {
  public:
    explicit HeldRows(double moving_deg_s) : moving_deg_s_(moving_deg_s) {}

    void add(const JointRows& rows, std::size_t k, bool continues) {
        const double velocity = rows.velocity_deg_s[k], torque = rows.torque_nm[k];
        const double position = rows.position_deg.empty() ? 0.0 : rows.position_deg[k];
        has_position_ = !rows.position_deg.empty();
        if (continues && std::min(std::abs(velocity), std::abs(velocity_)) > moving_deg_s_) {
            const bool same_velocity = velocity == velocity_, same_position = position == position_;
            ++moving_;
            velocity_repeats_ += same_velocity;
            position_repeats_ += same_position;
            if (torque == torque_) {
                by_velocity_ += same_velocity;
                by_position_ += same_position;
                by_both_ += same_velocity && same_position;
            }
        }
        velocity_ = velocity;
        torque_ = torque;
        position_ = position;
    }

    [[nodiscard]] std::size_t count() const {
        const bool velocity_tells = 2 * velocity_repeats_ < moving_;
        const bool position_tells = has_position_ && 2 * position_repeats_ < moving_;
        if (velocity_tells) return position_tells ? by_both_ : by_velocity_;
        return position_tells ? by_position_ : 0;
    }

  private:
    double moving_deg_s_, velocity_ = 0.0, torque_ = 0.0, position_ = 0.0;
    bool has_position_ = false;
    std::size_t moving_ = 0, velocity_repeats_ = 0, position_repeats_ = 0;
    std::size_t by_velocity_ = 0, by_position_ = 0, by_both_ = 0;
};

}  // namespace ripplenotch
