// SPDX-License-Identifier: MIT
#pragma once
// Every way in which a joint's velocity and position could be written, and how much speaks against each.

#include <exception>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "log/columns/infer_motion.hpp"
#include "ripplenotch/log/format.hpp"

namespace ripplenotch {

// Velocity for logs that hold none: the slope of the position, or one that is stated.

/// A reader whose rows are those of another one, changed.
class ChangedRows : public LogReader {
  public:
    explicit ChangedRows(std::unique_ptr<LogReader> reader) : reader_(std::move(reader)) {}
    [[nodiscard]] const Layout& layout() const override { return reader_->layout(); }
    [[nodiscard]] std::string_view head() const override { return reader_->head(); }
    [[nodiscard]] const LogReader& base() const override { return reader_->base(); }

  protected:
    std::unique_ptr<LogReader> reader_;
};

/// Passes on the rows of another reader, with the slope of the position as the velocity of joints that have
/// none: central differences from row to row, one-sided at both ends of the log. A step of more than half a
/// turn is taken as a wrap.
class DerivedVelocity : public ChangedRows {
  public:
    explicit DerivedVelocity(std::unique_ptr<LogReader> reader);

    bool next(RowBlock& block) override;

  private:
    struct Point {
        double time_s = 0.0, position_deg = 0.0;
    };
    void look_ahead();
    void derive(RowBlock& block, std::size_t joint);

    std::vector<std::size_t> joints_;           ///< without a velocity of their own
    std::vector<double> turns_deg_;             ///< of them: where the position would wrap
    std::vector<std::optional<Point>> before_;  ///< of them: the last row of the block before
    RowBlock ahead_;                            ///< the block after the one that is passed on
    bool begun_ = false, more_ = false;
    std::exception_ptr failure_;  ///< of the block ahead; for when its turn comes
};

/// Passes on the rows of another reader, with the shifts of its columns added.
class ShiftedColumns : public ChangedRows {
  public:
    using ChangedRows::ChangedRows;

    bool next(RowBlock& block) override;
};

/// Passes on the rows of another reader, with one velocity for all joints.
class ConstantVelocity : public ChangedRows {
  public:
    ConstantVelocity(std::unique_ptr<LogReader> reader, DegPerSec speed)
        : ChangedRows(std::move(reader)), speed_(speed) {}

    bool next(RowBlock& block) override;

  private:
    DegPerSec speed_;
};

/// One column's unit and side under a reading.
struct ReadColumn {
    std::string_view unit;
    double unit_factor = 1.0;  ///< to deg/s or deg
    Shaft side = Shaft::joint;
    double factor = 1.0;  ///< to the joint's deg/s or deg: by unit and ratio
};

struct MotionReading {
    ReadColumn velocity, position;
    std::optional<double> ratio;  ///< between the motor and the joint, where a side is the motor's
    bool against_header = false;  ///< a unit that the log states is wrong
    double cost = 0.0;            ///< the likeliest has the least
};

/// A reading is as possible as the likeliest when it costs less than this much more.
inline constexpr double open_margin = 1.0;

/// The columns that a motion has, with the factors of stated units in `layout`.
struct MotionQuestion {
    const MotionColumns& columns;
    const MotionEvidence& evidence;
    const Layout& layout;
    std::optional<double> gear_ratio;
};

/// Whether the column's name says that it is measured before the gear.
[[nodiscard]] bool names_motor(const MotionColumn& column);

/// All readings that fit the evidence, the likeliest first. `with_scale` false: position and velocity need
/// not belong together. Those against the header come last.
[[nodiscard]] std::vector<MotionReading> motion_readings(const MotionQuestion& question, bool with_scale);

}  // namespace ripplenotch
