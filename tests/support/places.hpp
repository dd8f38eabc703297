// SPDX-License-Identifier: MIT
#pragma once
#include <string>

namespace ripplenotch {

/// Folder of this project, without a slash at its end.
[[nodiscard]] std::string source_folder();
/// Folder of logs of real robots, which need not be there.
[[nodiscard]] std::string logs_folder();

}  // namespace ripplenotch
