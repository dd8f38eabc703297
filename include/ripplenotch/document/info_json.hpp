// SPDX-License-Identifier: MIT
#pragma once
// What info says about a log, as JSON.

#include <span>
#include <string>

#include "ripplenotch/document/provenance.hpp"
#include "ripplenotch/survey/survey.hpp"

namespace ripplenotch {

/// The object of info --json, whose fields docs/commands/info.md names: of one log at the top, of several in
/// {"logs": [...]}, each with the same fields. Of several joints, `held_samples` is the largest,
/// `clock_factor` that of the joint that moves most, `speed_deg_s` spans all; each joint's own figures are in
/// `joints`.
[[nodiscard]] std::string info_to_json(std::span<const LogInfo> logs, const Provenance& provenance);

}  // namespace ripplenotch
