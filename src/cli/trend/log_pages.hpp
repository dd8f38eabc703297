// SPDX-License-Identifier: MIT
#pragma once
// Where the reports of single logs are, so that a trend can lead to them.

#include <optional>
#include <string>

#include "ripplenotch/fleet/trend.hpp"

namespace ripplenotch {

/// Throws UsageError for a pattern of pages that names no log: {log}, {stem} (without its ending), {name}
/// (without folders and ending), {robot}, {joint}, {date}.
void check_page_pattern(const std::optional<std::string>& pattern);

/// The address of each log's report that an alert or a course names: by the pattern, else STEM.html or
/// LOG.html beside the log, where there is one.
void add_log_pages(Trend& trend, const std::optional<std::string>& pattern);

}  // namespace ripplenotch
