// SPDX-License-Identifier: MIT
#pragma once
// --drive: the torque of a log by the control law of its drive, from a command and the position that followed
// it.

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "ripplenotch/diagnose/diagnosis.hpp"
#include "ripplenotch/log/log.hpp"

namespace ripplenotch {

/// torque = kp (command(t - delay) - position) + kd (velocity_command(t - delay) - velocity), within +-limit.
struct DriveLaw {
    double kp_nm_per_rad = 0.0, kd_nm_per_rad_s = 0.0;
    std::string command;                          ///< column of a position
    std::optional<std::string> velocity_command;  ///< column of a velocity; left out: 0
    std::optional<double> delay_s = 0.0;          ///< empty: it is fitted
    std::optional<double> limit_nm;
};

/// Reads "pd,kp=60,kd=2,command=target_rad[,velocity-command=COLUMN][,delay=4ms|fit][,limit=90Nm]". Throws
/// UsageError.
[[nodiscard]] DriveLaw read_drive(std::string_view words);

/// How a log is read whose torque is made: it needs none of its own.
[[nodiscard]] ReadOptions without_torque(ReadOptions reading);

/// Replaces the torque of a log, which was read at `path` by without_torque(reading). A fitted delay is that
/// of lag_by_law. Throws UsageError for a column that is missing, DataError for a log without position, or
/// one that no delay fits. `most_rows`: of which the log was held whole, as read_log_in_part.
DrivenTorque apply_drive(const DriveLaw& law, const ReadOptions& reading, const std::string& path, Log& log,
                         std::size_t most_rows = all_rows);

/// What the residuals of a diagnosis are as positions: a torque e that a model lacks moves its joint by x, of
/// (kd + viscous friction) x' + kp x = e; below the frequency of the loop, where inertia does not count.
/// `motion`: that of the log, as the model takes it.
[[nodiscard]] DriveAnswer drive_answer(const DriveLaw& law, const DrivenTorque& torque,
                                       const Diagnosis& diagnosis, const Motion& motion,
                                       const TraceView& log);

/// "drive: 3.2 Nm rms by its law; delay of the command 4.1 ms [4.0, 4.2]; 12 rows at the limit".
[[nodiscard]] std::string drive_words(const DrivenTorque& torque);
/// "position: the model's answer to the command is 0.82 deg rms off the log, 0.07 with what is missing; of it
/// coulomb-friction 0.61, viscous-friction 0.3".
[[nodiscard]] std::string position_words(const DriveAnswer& answer);

}  // namespace ripplenotch
