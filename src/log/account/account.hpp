// SPDX-License-Identifier: MIT
#pragma once
// The one account of a log while it goes by: how its rows belong together, which samples are held, and where
// each joint's angle comes from. Whole logs and streams are read through this.

#include <array>
#include <cstddef>
#include <limits>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/rows/row_facts.hpp"
#include "log/open.hpp"
#include "ripplenotch/core/quantity.hpp"
#include "ripplenotch/core/trace.hpp"
#include "ripplenotch/log/clock.hpp"
#include "ripplenotch/log/recording.hpp"

namespace ripplenotch {

// Rows that repeat the row before because nothing new had been measured: the one count of them.

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

// Angles that start again at a full turn.

/// Removes jumps of whole periods in place, from one angle to the next.
class Unwrapper {
  public:
    explicit Unwrapper(double period) : period_(period) {}
    /// Goes on behind `before_deg`, an angle that was continuous so far.
    Unwrapper(double period, double before_deg) : period_(period), before_(before_deg) {}

    [[nodiscard]] double next(double position_deg);
    void apply(std::span<double> position_deg) {
        for (double& angle : position_deg) angle = next(angle);
    }

  private:
    double period_, turns_ = 0.0;
    std::optional<double> before_;
};

/// Finds out, from angles that go by, whether they start again at a full turn: 360 deg, or what that becomes
/// when the unit is mistaken (2 pi, 360 * 180 / pi). Says also what they are once made continuous.
class WrapWatch {
  public:
    void follow(std::span<const double> position_deg);

    /// Empty when nothing jumps, or when jumps are no full turn.
    [[nodiscard]] std::optional<double> period() const;
    /// The sum of the angles made continuous.
    [[nodiscard]] double sum() const { return found() != nullptr ? found()->sum : sum_; }

  private:
    struct Turn {
        double period;
        bool ruled_out = false;
        std::optional<Unwrapper> unwrapper = std::nullopt;  ///< from the first jump on
        double sum = 0.0;                                   ///< of the angles made continuous
    };
    void look_at(double step, Turn& turn) const;
    [[nodiscard]] const Turn* found() const;

    std::array<Turn, 3> turns_ = {{{360.0}, {2.0 * std::numbers::pi}, {360.0 * degrees_per_radian}}};
    std::size_t count_ = 0;
    double low_ = std::numeric_limits<double>::infinity(), high_ = -low_, before_ = 0.0;
    bool jumped_ = false;  ///< some turn has an unwrapper
    double sum_ = 0.0;
};

/// A sentence for the warnings of a log.
[[nodiscard]] std::string wrap_in_words(double period_deg);

[[nodiscard]] std::optional<double> wrap_period(std::span<const double> position_deg);

/// The rows [first, first + count) of one joint of a block, as a view that starts no run.
[[nodiscard]] TraceView view_of(const RowBlock& block, std::size_t joint, std::size_t first,
                                std::size_t count);

class Account {
  public:
    /// Judges the opening.
    Account(const Layout& layout, const Opening& opening);
    ~Account();
    Account(Account&&) noexcept;

    /// The next rows, from the first of the log on, as the clock parts them; valid until the next call.
    /// Throws DataError when time runs backward.
    std::span<const RunPart> add(const RowBlock& block);

    [[nodiscard]] const Clock& clock() const { return clock_; }
    /// What the rows so far say of the angle; by joint, as Layout::all_chosen().
    [[nodiscard]] const AngleFacts& angle(std::size_t joint) const;
    /// `layout` as it stands now, in which the joint stands at `place`.
    [[nodiscard]] Recording recording(const Layout& layout, std::size_t place, std::size_t joint) const;
    [[nodiscard]] Recording recording(const Layout& layout, std::size_t joint) const {
        return recording(layout, joint, joint);
    }

  private:
    struct Joint;
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
