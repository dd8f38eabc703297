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

    /// Rows [first, end) of a block. `continues`: the first of them comes right after the last of the call
    /// before.
    void add(const JointRows& rows, std::size_t first, std::size_t end, bool continues) {
        if (first == end) return;
        has_position_ = !rows.position_deg.empty();
        const Row begin = row_of(rows, first);
        if (continues) count_pair(last_, begin);
        if (has_position_)
            count_pairs<true>(rows, first, end);
        else
            count_pairs<false>(rows, first, end);
        last_ = row_of(rows, end - 1);
    }

    [[nodiscard]] std::size_t count() const {
        const bool velocity_tells = 2 * velocity_repeats_ < moving_;
        const bool position_tells = has_position_ && 2 * position_repeats_ < moving_;
        if (velocity_tells) return position_tells ? by_both_ : by_velocity_;
        return position_tells ? by_position_ : 0;
    }

  private:
    struct Row {
        double velocity = 0.0, torque = 0.0, position = 0.0;
    };
    static Row row_of(const JointRows& rows, std::size_t k) {
        return {rows.velocity_deg_s[k], rows.torque_nm[k],
                rows.position_deg.empty() ? 0.0 : rows.position_deg[k]};
    }
    // No branches: what repeats in a noisy log is as good as a coin's toss.
    void count_pair(const Row& before, const Row& now) {
        const unsigned moving =
            std::min(std::abs(before.velocity), std::abs(now.velocity)) > moving_deg_s_ ? 1 : 0;
        const unsigned velocity = before.velocity == now.velocity ? moving : 0;
        const unsigned position = before.position == now.position ? moving : 0;
        const unsigned torque = before.torque == now.torque ? 1 : 0;
        moving_ += moving;
        velocity_repeats_ += velocity;
        position_repeats_ += position;
        by_velocity_ += velocity & torque;
        by_position_ += position & torque;
        by_both_ += velocity & position & torque;
    }
    template <bool with_position>
    void count_pairs(const JointRows& rows, std::size_t first, std::size_t end) {
        const double* const velocity = rows.velocity_deg_s.data();
        const double* const torque = rows.torque_nm.data();
        const double* const position = rows.position_deg.data();
        const auto row = [&](std::size_t k) {
            return Row{velocity[k], torque[k], with_position ? position[k] : 0.0};
        };
        HeldRows counted(moving_deg_s_);
        for (std::size_t k = first + 1; k < end; ++k) counted.count_pair(row(k - 1), row(k));
        moving_ += counted.moving_;
        velocity_repeats_ += counted.velocity_repeats_;
        position_repeats_ += counted.position_repeats_;
        by_velocity_ += counted.by_velocity_;
        by_position_ += counted.by_position_;
        by_both_ += counted.by_both_;
    }

    double moving_deg_s_;
    Row last_;
    bool has_position_ = false;
    std::size_t moving_ = 0, velocity_repeats_ = 0, position_repeats_ = 0;
    std::size_t by_velocity_ = 0, by_position_ = 0, by_both_ = 0;
};

}  // namespace ripplenotch
