// SPDX-License-Identifier: MIT
#pragma once
// Internal to the filter room: blocks of rows, one after another, through the filters of their joints.

#include <span>
#include <vector>

#include "log/account/account.hpp"
#include "ripplenotch/filter/engine.hpp"

namespace ripplenotch {

/// The state of one pass over a log.
class StreamPass {
  public:
    StreamPass(Account& account, std::span<const JointRun> joints);

    /// Filters the block's joints into `torque_nm`. Throws DataError when time runs backward.
    void filter(const RowBlock& block, std::vector<std::vector<double>>& torque_nm);

    /// By joint, after the last block; `layout` as it stands then.
    [[nodiscard]] std::vector<StreamReport> reports(const Layout& layout) const;

  private:
    struct Lane {
        JointRun run;
        StreamReport report{};
        std::size_t rows = 0, rows_left_out = 0;
        JointsPosition position{};
    };

    /// `temperature_degc`: of the block's rows, or empty.
    void filter_part(const RowBlock& block, std::size_t joint, const RunPart& part,
                     std::span<const double> temperature_degc, std::vector<double>& torque_nm);
    static void meter_rows(const TraceView& rows, bool begins_run, std::span<const double> torque_nm,
                           Lane& lane);
    static void note_switches(const RowBlock& block, Lane& lane);
    static void note_motion(const JointRows& rows, Lane& lane);

    Account& account_;
    std::vector<Lane> lanes_;
};

}  // namespace ripplenotch
