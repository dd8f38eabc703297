// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>

#include "filter/kernels/row_facts.hpp"
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
        if (continues) count_across(rows, first);
        counts_ += count_repeats({rows.velocity_deg_s.data() + first, rows.torque_nm.data() + first,
                                  has_position_ ? rows.position_deg.data() + first : nullptr},
                                 end - first - 1, moving_deg_s_);
        last_ = row_of(rows, end - 1);
    }

    [[nodiscard]] std::size_t count() const {
        const bool velocity_tells = 2 * counts_.velocity < counts_.moving;
        const bool position_tells = has_position_ && 2 * counts_.position < counts_.moving;
        if (velocity_tells) return position_tells ? counts_.all : counts_.velocity_and_torque;
        return position_tells ? counts_.position_and_torque : 0;
    }

  private:
    struct Row {
        double velocity = 0.0, torque = 0.0, position = 0.0;
    };
    static Row row_of(const JointRows& rows, std::size_t k) {
        return {rows.velocity_deg_s[k], rows.torque_nm[k],
                rows.position_deg.empty() ? 0.0 : rows.position_deg[k]};
    }
    void count_across(const JointRows& rows, std::size_t first) {
        const Row now = row_of(rows, first);
        const std::array velocity = {last_.velocity, now.velocity}, torque = {last_.torque, now.torque},
                         position = {last_.position, now.position};
        counts_ += count_repeats({velocity.data(), torque.data(), position.data()}, 1, moving_deg_s_);
    }

    double moving_deg_s_;
    Row last_;
    bool has_position_ = false;
    RepeatCounts counts_;
};

}  // namespace ripplenotch
