// SPDX-License-Identifier: MIT
#pragma once
// What a reader decided about a log: which column is what, in which unit, and how the file is written.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "ripplenotch/core/quantity.hpp"

namespace ripplenotch {

// Which rows of a log are read, by their time (--from, --to), and what became of the others.

/// A time as it was typed. What hours and minutes count from depends on how the log writes its times.
struct TimePoint {
    enum class Form {
        seconds,     ///< on the log's own time axis
        two_fields,  ///< 12:30
        hours,       ///< 1:02:30.5
        date,        ///< 2024-05-01T12:30:00
    };
    std::string text;
    Form form = Form::seconds;
    double seconds = 0.0;      ///< of Form::seconds
    std::int64_t whole_s = 0;  ///< of the others: 12:30 as minutes; since 1970 of a date, less its zone
    double fraction_s = 0.0;   ///< 0 to 1, to be added
    bool zoned = false;        ///< a date that says its zone
};

/// "2", "500ms", "1.5min", "12:30", "1:02:30.5", "2024-05-01T12:30:00Z". Throws UsageError, which begins with
/// `label`, for other texts.
[[nodiscard]] TimePoint parse_time_point(std::string_view text, std::string_view label);

/// Both ends belong to the range; one that is left out is the log's own.
struct TimeRange {
    std::optional<TimePoint> from, to;
    [[nodiscard]] bool given() const { return from || to; }
};

/// Rows that a range left out. The counts are complete when the log has been read to its end.
struct RowsOutside {
    std::optional<double> from_s, to_s;  ///< the range, on the time axis of the whole log
    /// The time of the first row that was kept, on that axis, where the times that are told count from it;
    /// else 0.
    double zero_s = 0.0;
    std::size_t before = 0, after = 0;  ///< a row without a time is counted with the row before it
    [[nodiscard]] std::size_t count() const { return before + after; }
};
/// "only rows from 1 s to 2.5 s"; with what times count from, where that is not the log's own zero.
[[nodiscard]] std::string range_in_words(const RowsOutside& outside);

// What a person should know about a log before believing it.

struct LogWarning {
    std::string_view about;     ///< what it is about, alike for all joints that are warned of the same
    std::string text;           ///< one sentence
    bool of_one_joint = false;  ///< it holds a column or a figure of the joint that was read
    bool operator==(const LogWarning&) const = default;
};

enum class Role { time, velocity, torque, position, other };
[[nodiscard]] std::string_view role_name(Role role);

/// Where a motion is measured: behind the gear, or on the motor's shaft before it.
enum class Shaft { joint, motor };

/// What one unit of a column's numbers is (--scale): "360deg/524288", "0.04Nm", "2Nm+10Nm".
struct ColumnScale {
    std::string text;     ///< as typed
    double factor = 1.0;  ///< divided by the divisor, if there is one
    std::string unit;
    double offset = 0.0;  ///< in `unit`, added after
};
/// Throws UsageError, which begins with `label`, for other texts. Whether the unit fits the column, the log
/// says.
[[nodiscard]] ColumnScale parse_scale(std::string_view text, std::string_view label);

/// One column of the file, in file order.
struct Column {
    std::string name;  ///< as in the header, without quotes; "column 3" when there is no header
    Role role = Role::other;
    std::string unit;     ///< as understood ("rad/s"); empty for role other
    double factor = 1.0;  ///< file value * factor + shift = value in the tool's unit, of the joint
    double shift = 0.0;
    std::string scale;          ///< as --scale states it; else empty
    bool unit_assumed = false;  ///< nothing settled the unit: it is in Layout::assumptions
    std::string joint;          ///< "" when the file holds one unnamed joint
    std::string unused = {};    ///< of role other: why it was taken for nothing
    bool current = false;       ///< of a torque: a motor current, of which 1 A is taken as 1 Nm
    Shaft side = Shaft::joint;  ///< of a velocity or position, as measured; the factor divides by the ratio
    std::optional<double> motor_ratio;  ///< of a motion measured before the gear: what the factor divides by
};

/// What the numbers would be had a log been written otherwise than assumed: factors on the values as read.
struct OtherReading {
    std::string words;   ///< "the speed is in rad/s"
    std::string option;  ///< that makes it so: "--unit velocity=rad/s"
    double time_factor = 1.0, velocity_factor = 1.0, position_factor = 1.0;
    bool changes_side = false;  ///< from before the gear to behind it, or back, by no known ratio
};

/// What a log does not say about itself, and how it was read all the same.
struct Assumption {
    std::string about;                 ///< "unit of 'dq' (column 2)"
    std::string assumed;               ///< "deg/s"
    std::string reason;                ///< one clause
    std::string settle_with;           ///< the option that says it: "--unit velocity=deg/s"
    std::vector<OtherReading> others;  ///< readings as possible as the one assumed, that change the motion
};

/// What the caller asks of a reader; everything left out is found out from the file.
struct ReadOptions {
    std::optional<std::string> format;  ///< name in the format registry: "csv", "npy"
    std::optional<std::string> joint;   ///< "j1", "j1,j3-j5", "all" (--joint); all when left out
    bool every_joint = false;           ///< read all of them that have a velocity and a torque, at once
    bool torque_of_each = true;         ///< with every_joint: false reads joints without a torque, too
    /// Read all that are asked for at once, where there are several, and say of each what reading it alone
    /// would (Layout::each).
    bool each_joint = false;
    std::vector<std::string> columns;          ///< "time,velocity,torque" by place, or "torque=tau_J" by name
    std::map<std::string, std::string> units;  ///< role or column name -> unit
    std::map<std::string, ColumnScale> scales;  ///< role or column name -> what its numbers are in a unit
    std::optional<Hertz> sample_rate;           ///< for logs without time; overrides the log's own time
    std::optional<DegPerSec> constant_speed;    ///< of a log that holds no motion (--constant-speed)
    std::vector<DegPerSec> constant_speeds;     ///< of several such logs, in their order; else empty
    std::optional<char> delimiter;
    std::optional<char> decimal_mark;
    std::optional<bool> header;
    std::optional<double> nm_per_ampere;  ///< torque constant for current columns (--kt)
    std::optional<double> lead_m;         ///< travel of a linear axis in one turn of its screw (--lead)
    bool hold_bad_values = false;         ///< replace nan and empty cells by the sample before, and count
    std::size_t skip_lines = 0;           ///< at the top of a text log, passed on and not read
    std::optional<std::string> records;   ///< fields of a raw dump: "f8,f4,f4" (--layout)
    std::optional<std::string> clock;     ///< of messages: "log" when they were recorded, "header" their own
    std::optional<std::string> join;   ///< of signals with clocks of their own: "nearest", "hold", "linear"
    std::map<Role, Shaft> sides;       ///< of velocity and position (--side)
    std::optional<double> gear_ratio;  ///< for what is measured before the gear
    /// Where the joints' gears differ: of a joint by its name. Asked for the joints that are read only.
    std::function<std::optional<double>(const std::string& joint)> gear_ratio_of;
    /// With every_joint: throws Error where the caller has no use for a joint, which is left out then.
    std::function<void(const std::string& joint)> check_joint;
    bool takes_motor_units = false;  ///< motion before a gear of unknown ratio is not refused
    bool needs_torque = true;        ///< false for info
    bool needs_velocity = true;      ///< false: a log without motion has a velocity of nan
    TimeRange range;                 ///< rows outside are ignored
};

/// One numeric thing in a container, as `info` lists it.
struct ContentEntry {
    std::string path;   ///< as --columns takes it
    std::string shape;  ///< "4000", "4000 x 7", "4000 messages"
    std::string type;   ///< "float64", "sensor_msgs/msg/JointState"
    std::string unit;   ///< as the file states it
    std::optional<double> rate_hz;
    bool read = false;  ///< it is among the columns
};

/// The columns of the joint chosen, by index into Layout::columns.
struct JointColumns {
    std::string joint;
    std::optional<std::size_t> time, velocity, torque, position;
    /// Of a role but Role::other.
    [[nodiscard]] std::optional<std::size_t>& of(Role role) {
        return role == Role::time       ? time
               : role == Role::velocity ? velocity
               : role == Role::torque   ? torque
                                        : position;
    }
    [[nodiscard]] std::optional<std::size_t> of(Role role) const { return JointColumns(*this).of(role); }
};

/// A joint that was asked for and is not read.
struct LeftOutJoint {
    std::string joint, why;  ///< "it has no torque"
};

/// How dates and times are written where their fields alone do not say it.
struct StampForm {
    bool day_first = true;      ///< 3/4/2025 is in April
    bool either_order = false;  ///< no field of the opening says which: the next day is the nearer one
    std::int64_t other_s = 0;   ///< how much later the other order has the first date
    bool milliseconds = false;  ///< digits behind the seconds count them, without zeros in front: .5 is 5 ms
    bool operator==(const StampForm&) const = default;
};

struct Layout {
    std::string source;  ///< for messages: path or "standard input"
    std::string format;  ///< "csv", "npy"
    std::vector<Column> columns;
    std::vector<ContentEntry> contents;        ///< of a container: all numeric things in it
    std::vector<std::string> joints;           ///< all joints in the file, in file order
    std::vector<std::string> asked;            ///< those of them that options ask for
    std::vector<LeftOutJoint> left_out;        ///< asked for, but without what is needed
    JointColumns chosen;                       ///< the joint that is read; the first of them
    std::vector<JointColumns> others;          ///< that are read with it, when every joint is
    std::optional<std::size_t> time_fraction;  ///< beside chosen.time: nanoseconds to be added to its seconds
    std::int64_t time_origin = 0;  ///< in the column's own unit: taken off stamps that count from long ago
    bool time_as_text = false;     ///< stamps like 12:30:00.5 or 2024-05-01T12:30:00.5Z
    StampForm stamp_form;          ///< of these
    bool time_is_steps = false;    ///< the time column holds steps from row to row, which are summed
    bool velocity_from_position = false;      ///< no velocity is logged: it is the slope of the position
    std::optional<DegPerSec> constant_speed;  ///< no motion is logged: it was stated (--constant-speed)
    bool motor_units = false;             ///< motion is the motor's, and no ratio was known to divide it by
    std::optional<Hertz> stated_rate;     ///< from --sample-rate, or from the head of a file without a clock
    std::string options;                  ///< the option line that would force this reading
    std::vector<LogWarning> warnings;     ///< about columns, units and the time
    std::vector<Assumption> assumptions;  ///< what no rule decided
    std::vector<Assumption> inferences;   ///< what the log does not say and a rule decided, with its reason
    std::shared_ptr<const RowsOutside>
        outside;               ///< where a range was asked for; counted while the log is read
    std::vector<Layout> each;  ///< with ReadOptions::each_joint: of each joint alone, as all_chosen()

    /// The columns of the time and of all joints that are read.
    [[nodiscard]] std::vector<std::size_t> columns_read() const {
        std::vector<std::size_t> found;
        for (const JointColumns& joint : all_chosen())
            for (const Role role : {Role::time, Role::velocity, Role::torque, Role::position})
                if (const auto c = joint.of(role); c && (role != Role::time || found.empty()))
                    found.push_back(*c);
        return found;
    }

    void warn(std::string_view about, std::string text, bool of_one_joint = false) {
        warnings.push_back({about, std::move(text), of_one_joint});
    }
    void infer(std::string about, std::string assumed, std::string reason, std::string settle_with) {
        inferences.push_back(
            {std::move(about), std::move(assumed), std::move(reason), std::move(settle_with), {}});
    }

    /// Does so with this one and with those of each joint.
    template <class Change>
    void change_all(const Change& change) {
        change(*this);
        for (Layout& one : each) change(one);
    }

    /// All joints that are read.
    [[nodiscard]] std::vector<JointColumns> all_chosen() const {
        std::vector<JointColumns> all = {chosen};
        all.insert(all.end(), others.begin(), others.end());
        return all;
    }
};

}  // namespace ripplenotch
