// SPDX-License-Identifier: MIT
#pragma once
// Verdicts under everything that a log may mean: one that another reading of the log would change is none.

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "ripplenotch/analysis/identification.hpp"
#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/core/quantity.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"
#include "ripplenotch/filter/map_fit.hpp"
#include "ripplenotch/log/log.hpp"
#include "ripplenotch/verdict/other_motors.hpp"

namespace ripplenotch {

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

/// Why the lines of logs speak against a gear ratio that is stated, a sentence for a warning; empty where
/// they do not. `found`: identified with that ratio, or without any.
[[nodiscard]] std::string against_ratio(const Identification& found, GearRatio stated);
/// The same of logs of one joint that are about to be filtered by this gear.
[[nodiscard]] std::string against_gear(std::span<const Log> logs, const GearAccount& gear);

/// The same where the motors of other joints may be in the torque. What is found of them (fit_joint_map) is
/// subtracted before the lines are searched again; `alone` is what identify_readings() gave.
[[nodiscard]] Identification identify_among(std::span<const Log> logs, Identification alone,
                                            const OtherMotors& others, const IdentifyOptions& options);

/// Adds the amplitudes by speed and direction at the ripple orders that were found; without a ratio in the
/// lines, with the one stated, at those that gears have. Nothing where the lines are doubted.
void add_amplitudes(Identification& found, std::span<const Log> logs, std::optional<GearRatio> stated);

/// diagnose(); `undecided`, with nothing named and the model as given, where another reading of the log that
/// is as possible would name something else.
[[nodiscard]] Diagnosis diagnose_readings(const Model& model, const Log& log, const Log* validation,
                                          const DiagnosisOptions& options);

/// fit_ripple_map() of the logs of one joint, with the angle of the joint at which the map begins. `doubt`
/// says so where two readings of the logs are as possible and both show a map, or none of several does; then
/// it is not conclusive. Where the reading is settled the motors of other joints are looked for, too
/// (fit_joint_map). Throws what fit_ripple_map throws.
[[nodiscard]] MapFit map_readings(std::span<const Log> logs, const GearAccount& gear, Degrees zero,
                                  const OtherMotors& others = {});

/// Throws DataError, naming what settles it, where the log may mean several motions: its units are open, or
/// it was measured before the gear and its ratio is not stated.
void refuse_open_readings(const Log& log);

}  // namespace ripplenotch
