// SPDX-License-Identifier: MIT
#pragma once
// Verdicts under everything that a log may mean: one that another reading of the log would change is none.

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "ripplenotch/analysis/identification.hpp"
#include "ripplenotch/arm/arm_fit.hpp"
#include "ripplenotch/arm/joint_matching.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"
#include "ripplenotch/log/log.hpp"

namespace ripplenotch {

// All joints of an arm from one log, in the order of its chain.

struct ArmReading {
    std::vector<Log> logs;  ///< a joint of the chain each
    JointMatch match;
    std::vector<std::string> names;  ///< of the joints in the log, in the order of the chain

    [[nodiscard]] ArmLog view() const;
    /// The place in the chain of a joint by its name in the log or in the chain, whatever its case. Throws
    /// UsageError with the nearest name.
    [[nodiscard]] std::size_t find(const Chain& chain, const std::string& joint) const;
};

/// Of a log with more than `most_rows` the pieces of read_log_in_part. Throws what
/// read_joints_at_once_in_part and match_joints throw, and UsageError where a joint of the chain has no
/// position.
[[nodiscard]] ArmReading read_arm(const std::string& path, const ReadOptions& options, std::size_t most_rows,
                                  const Chain& chain, const StatedJoints& stated);

/// Readings as possible as the one taken, of all the logs, each once.
[[nodiscard]] std::vector<OtherReading> open_readings(std::span<const Log> logs);

/// What the one that was taken is called: "in rad/s and rad, as assumed".
[[nodiscard]] std::string assumed_reading(std::span<const Log> logs);

/// Options that settle them, those for what was assumed first.
[[nodiscard]] std::string settling_options(std::span<const Log> logs);

/// Why nothing is known of orders, in half a sentence: the readings that may hold as well as the one taken,
/// and what settles it. Empty where none of them may.
[[nodiscard]] std::string reading_doubt(std::span<const Log> logs,
                                        const std::function<bool(const OtherReading&)>& may_hold);

/// The trace as it would be under another reading.
[[nodiscard]] Trace read_otherwise(const Trace& trace, const OtherReading& reading);

/// What the logs of one joint show; where another reading that is as possible shows something else, an
/// inconclusive identification without a ratio whose verdict begins with "Cannot tell". Motion measured
/// before a gear of unknown ratio gives orders of the motor and no ratio.
[[nodiscard]] Identification identify_readings(std::span<const Log> logs, const IdentifyOptions& options);

/// diagnose(); `undecided`, with nothing named and the model as given, where another reading of the log that
/// is as possible would name something else.
[[nodiscard]] Diagnosis diagnose_readings(const Model& model, const Log& log, const Log* validation,
                                          const DiagnosisOptions& options);

}  // namespace ripplenotch
