// SPDX-License-Identifier: MIT
#pragma once
// Tables of a trend that lead to the reports of the logs.

#include "document/json/json.hpp"
#include "ripplenotch/page/page.hpp"

namespace ripplenotch {

/// An alert a row: joint, cause, since when, surest sign, and the logs before and after it with links to
/// their reports.
[[nodiscard]] PageTable alert_table(const Json& alerts);

/// A log a row, of the joints whose course is shown, each with a link to its report.
[[nodiscard]] PageTable course_table(const Json& courses);

}  // namespace ripplenotch
