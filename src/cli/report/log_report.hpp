// SPDX-License-Identifier: MIT
#pragma once
// The results of a log for a page: what info, identify, recommend, compare, filter and spectrum say of it.

#include <string>
#include <vector>

#include "ripplenotch/page/page.hpp"

namespace ripplenotch {

struct LogReport {
    std::string log;
    std::vector<std::string> reading, gear, ratio;  ///< options of the log, of its gear, and its ratio alone
    bool quiet = false;
};

/// False where the file is named or begins as JSON, and for standard input.
[[nodiscard]] bool is_log(const std::string& path);

/// Runs the commands one after the other. What one of them refuses is a section with its message; without a
/// log that can be read, or a torque in it, Error is thrown.
[[nodiscard]] std::vector<PageSection> sections_of_log(const LogReport& report);

}  // namespace ripplenotch
