// SPDX-License-Identifier: MIT
#pragma once
// What was read back, for people.

#include <string>

#include "ripplenotch/document/export_json.hpp"

namespace ripplenotch {

[[nodiscard]] std::string export_report_to_text(const ExportReport& report);

}  // namespace ripplenotch
