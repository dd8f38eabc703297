// SPDX-License-Identifier: MIT
#pragma once
// Rows that repeat the row before because nothing new had been measured: the one count of them.

#include <array>
#include <vector>

#include "core/rows/row_facts.hpp"
#include "ripplenotch/core/trace.hpp"
#include "ripplenotch/log/recording.hpp"

namespace ripplenotch {

/// Counts rows whose torque and every other telling channel equal the row before, while the joint moves by
/// more than 0.2 deg/s. A channel is evidence when it changes in most moving rows, or when the torque changes
/// only together with it, which is known at the end only: a coarsely quantised torque repeats by itself, and
/// so does the velocity of a perfectly steady motion. So repetitions are counted for every set of telling
/// channels, and one count is chosen then. Where no channel tells, the torque alone does, unless it is
/// coarse: its usual change is only a few of its smallest.
class HeldCounter {
  public:
    /// `by_position`: the velocity is the slope of the position from row to row, which is 0 within a hold;
    /// the joint moves where the position does, from one of its changes to the next.
    explicit HeldCounter(bool by_position = false) : by_position_(by_position) {}
    /// Consecutive rows; `begins_run`: the row before is no past of theirs.
    void count(const TraceView& rows, bool begins_run);
    [[nodiscard]] HeldSamples held() const;

  private:
    struct Row {
        double velocity = 0.0, torque = 0.0, position = 0.0, time_s = 0.0;
    };
    enum Way { torque_alone, with_velocity, with_position, with_both };

    /// Rows since the last change of the position, of which the next change says whether the joint moves.
    struct Stretch {
        std::size_t pairs = 0, torque = 0, longest = 0;
        double since_s = 0.0;
    };
    void count_by_position(const Row& before, const Row& now);
    static Row row_of(const TraceView& rows, std::size_t k);
    void count_pairs(const RowChannels& rows, std::size_t pairs);
    void measure_runs(const RowChannels& rows, std::size_t pairs);
    void note_changes(const RowChannels& rows, std::size_t pairs);
    [[nodiscard]] bool is_evidence(std::size_t repeats, std::size_t with_torque) const;
    [[nodiscard]] Way way() const;
    [[nodiscard]] bool torque_is_coarse() const;

    bool by_position_, any_ = false, has_position_ = false;
    Stretch stretch_;
    Row last_;
    RepeatCounts counts_;
    std::array<std::size_t, 4> run_ = {}, longest_ = {};  ///< by way
    std::vector<double> changes_;                         ///< of the torque, the first ones
};

}  // namespace ripplenotch
