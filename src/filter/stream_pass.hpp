// SPDX-License-Identifier: MIT
#pragma once
// Internal to the filter room: blocks of rows, one after another, through the filters of their joints.

#include <span>
#include <string>
#include <vector>

#include "filter/held_rows.hpp"
#include "ripplenotch/filter/engine.hpp"

namespace ripplenotch {

/// The state of one pass over a log.
class StreamPass {
  public:
    /// `moving_deg_s`: by joint; slower counts as standing.
    StreamPass(std::string source, double gap_s, std::span<const JointRun> joints,
               const std::vector<double>& moving_deg_s);

    /// Filters the block's joints into `torque_nm`. Throws DataError when time runs backward.
    void take(const RowBlock& block, std::vector<std::vector<double>>& torque_nm);

    /// By joint, after the last block.
    [[nodiscard]] std::vector<StreamReport> reports();

  private:
    struct Lane {
        JointRun run;
        HeldRows held;
        StreamReport report{};
    };
    /// Rows without a gap between them.
    struct Stretch {
        std::size_t first = 0, count = 0;
        bool begins_run = false;  ///< the filters start anew
    };

    void find_stretches(const RowBlock& block);
    bool step_is_gap(const RowBlock& block, std::size_t k, double step_s);
    void filter_lane(const RowBlock& block, const JointRows& rows, Lane& lane,
                     std::vector<double>& torque_nm) const;
    static void meter_rows(const JointRows& rows, const Stretch& stretch, RippleMeter& meter,
                           const std::vector<double>& torque_nm);
    static void note_motion(const JointRows& rows, Lane& lane, const std::vector<Stretch>& stretches);

    std::string source_;
    double gap_s_;
    std::vector<Lane> lanes_;
    std::vector<Stretch> stretches_;  ///< of the block
    StreamReport clock_;              ///< what all joints have in common
    double run_begin_s_ = 0.0, last_time_s_ = 0.0;
    double duration_s_ = 0.0;  ///< of the runs that are over
};

}  // namespace ripplenotch
