// SPDX-License-Identifier: MIT
#pragma once
// The descriptors of a joint from one log: lines and ratio are those of an identification, all else is one
// fit of the model, without the terms that are not identifiable from the motion.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ripplenotch/analysis/identification.hpp"
#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/core/trace.hpp"
#include "ripplenotch/model/fit.hpp"

namespace ripplenotch {

/// A figure that a joint keeps from log to log unless something happens to it.
struct Descriptor {
    std::string stem;             ///< "coulomb_friction", "ripple_2_amplitude"
    std::string unit;             ///< as it ends the name: "nm", "deg"; empty for a plain number
    std::optional<double> value;  ///< empty: not identifiable from the log
    std::optional<Interval> ci95;
    std::string reason;  ///< reason for an empty value, one clause

    /// "coulomb_friction_nm"
    [[nodiscard]] std::string name() const { return unit.empty() ? stem : stem + "_" + unit; }
    /// "coulomb_friction_ci95_nm"
    [[nodiscard]] std::string interval_name() const {
        return stem + "_ci95" + (unit.empty() ? "" : "_" + unit);
    }
};

/// The motion and the load while the descriptors were measured.
struct MotionMix {
    double moving_share = 0.0, forward_share = 0.0;  ///< shares of the samples; of the moving ones
    /// Percentiles of |v| while moving.
    double speed_p10_deg_s = 0.0, speed_p50_deg_s = 0.0, speed_p90_deg_s = 0.0;
    double travel_deg = 0.0;  ///< from end to end
    std::size_t reversals = 0;
    double torque_rms_nm = 0.0;              ///< less its mean
    std::optional<double> load_rms_nm = {};  ///< rms torque of inertia and gravity, as fitted
    bool operator==(const MotionMix&) const = default;
};

/// One log and one joint of it; or a log that could not be read, with its error and nothing else.
struct FeatureLine {
    std::string log, sha256;          ///< as named; of its bytes, empty where it could not be opened
    std::string robot, joint;         ///< empty when unknown
    std::string version;              ///< version of the tool
    std::optional<std::string> date;  ///< "2026-01-05T12:30:00Z"
    std::string date_source;          ///< "log", "name"; or why there is none
    std::optional<double> temperature_degc;
    std::string temperature_source;  ///< "column motor_temp", "--temperature"; or why there is none
    std::size_t rows = 0;
    double duration_s = 0.0;
    MotionMix mix;
    std::vector<Descriptor> descriptors;
    std::string error;   ///< the message; empty for a log that was read
    int error_code = 0;  ///< the exit code that it would have been

    [[nodiscard]] bool failed() const { return !error.empty(); }
};

/// A descriptor without a value, by its name in a line, split into stem and unit. Throws DataError where no
/// descriptor has this name, and gives the right name where only the unit is another.
[[nodiscard]] Descriptor descriptor_named(const std::string& name);

/// "2026-01-05T12:30:00Z" of seconds since 1970 in universal time.
[[nodiscard]] std::string date_text(double seconds);
/// Seconds since 1970 of "2026-01-05", "2026-01-05T12:30", "2026-01-05T12:30:00Z", with a blank for the T as
/// well. Empty for anything else, and for days that no month has.
[[nodiscard]] std::optional<double> date_seconds(std::string_view text);

/// A pattern of names: %Y %m %d %H %M %S are digits of the date, {robot} is any text without a slash, * any
/// text, ? any character; everything else stands for itself. The whole name has to fit, or its end after a
/// slash.
class NamePattern {
  public:
    /// Throws UsageError: no %Y, %m and %d in it, one of them twice, another letter behind %.
    explicit NamePattern(std::string pattern);

    struct Found {
        std::string date;   ///< as date_text() gives it
        std::string robot;  ///< empty where the pattern has none
    };
    /// Empty where the name does not fit, or gives a day that no month has.
    [[nodiscard]] std::optional<Found> match(const std::string& name) const;
    [[nodiscard]] const std::string& text() const { return pattern_; }

  private:
    std::string pattern_;
};

struct Features {
    MotionMix mix;
    std::vector<Descriptor> descriptors;  ///< always the same ones, but for those of the orders of ripple
};

/// `found`: the result of identify for the log. `stated`: the gear that the user states, whose ratio and
/// orders are those of the ripple then, and else those that were found. Samples beyond 2^14 are thinned out
/// evenly. Throws DataError: fewer samples than values to be fitted, or times that do not increase.
[[nodiscard]] Features features_of(const TraceView& log, const Identification& found,
                                   const std::optional<GearAccount>& stated);

}  // namespace ripplenotch
