// SPDX-License-Identifier: MIT
#pragma once
// Tables of results that people read across: columns chosen and named, four digits.

#include <optional>

#include "document/json/json.hpp"
#include "ripplenotch/figure/figure.hpp"
#include "ripplenotch/page/page.hpp"

namespace ripplenotch {

// Tables of a trend that lead to the reports of the logs.

/// An alert a row: joint, cause, since when, surest sign, and the logs before and after it with links to
/// their reports.
[[nodiscard]] PageTable alert_table(const Json& alerts);

/// A log a row, of the joints whose course is shown, each with a link to its report.
[[nodiscard]] PageTable course_table(const Json& courses);

/// The methods of a comparison under the labels A, B, C in the order given (a control keeps its name), with
/// what each label stands for below, and why it does not fit where that was asked; columns that no method
/// fills are left out.
[[nodiscard]] PageTable comparison_table(const Json& methods);

/// The design itself: one row a band, with centre frequency and Q of the notch for each order.
[[nodiscard]] PageTable notch_table(const Json& bands);

/// How many switches have a jump of which size; none for fewer than 20, which a table tells better.
[[nodiscard]] std::optional<Figure> switch_figure(const Json& switches);

/// The ten switches with the largest jumps; all of them where there are no more.
[[nodiscard]] PageTable largest_switches(const Json& switches);

}  // namespace ripplenotch
