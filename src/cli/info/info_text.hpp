// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "ripplenotch/survey/survey.hpp"

namespace ripplenotch {

/// One screen about a log, a sentence first. Wide files list only the columns that mean something.
[[nodiscard]] std::string info_to_text(const LogInfo& log);

}  // namespace ripplenotch
