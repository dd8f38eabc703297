// SPDX-License-Identifier: MIT
#pragma once
// diagnose of a table of constant speeds and friction torques.

#include <optional>
#include <string>

#include "cli/command.hpp"
#include "cli/diagnose/joint_diagnosis.hpp"

namespace ripplenotch {

/// The rows of the request's log where it is a table and no log: --friction-table says so, or it has speed
/// and torque, no time, no position and no stated rate, and fewer rows than a log must have. Empty for a log.
/// Throws DataError where such a file has as many rows as a log, and nothing says which of both it is; for a
/// table what the readers throw, and UsageError for options that a table has no use for.
[[nodiscard]] std::optional<Log> friction_table_of(const DiagnoseRequest& request);

/// Fits it and tells; -o takes the model.
ExitCode run_friction_table(const DiagnoseRequest& request, const Log& table,
                            const std::string& command_line);

}  // namespace ripplenotch
