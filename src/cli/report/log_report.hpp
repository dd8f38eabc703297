// SPDX-License-Identifier: MIT
#pragma once
// The results of a log for a page: what info, identify, recommend, compare, filter and spectrum say of it.

#include <string>
#include <string_view>
#include <vector>

#include "ripplenotch/page/page.hpp"

namespace ripplenotch {

struct LogReport {
    std::string log;                                ///< its path
    std::string piped;                              ///< the log itself, where it came through standard input
    std::vector<std::string> reading, gear, ratio;  ///< options of the log, of its gear, and its ratio alone
    bool quiet = false;
};

/// False for what commands wrote: a JSON object whose first lines name its schema.
[[nodiscard]] bool is_log(std::string_view text);

/// The name of a log on a page: without folders.
[[nodiscard]] std::string shown_name(const std::string& path);

/// Runs the commands on each log, and on each joint of it, one after the other: the answer with its picture
/// first, then a section for each question; before all that a table where there are several joints. What one
/// of the commands refuses is a section with its message; without a log that can be read, or a torque in it,
/// Error is thrown.
[[nodiscard]] std::vector<PageSection> sections_of_logs(const std::vector<LogReport>& reports);

}  // namespace ripplenotch
