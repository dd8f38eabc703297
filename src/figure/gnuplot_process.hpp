// SPDX-License-Identifier: MIT
#pragma once
#include <optional>
#include <string>

namespace ripplenotch {

/// Runs gnuplot without anybody's settings on this script and gives what it printed; empty when there is no
/// gnuplot. Throws FileError when it ends with another exit code than 0.
[[nodiscard]] std::optional<std::string> run_gnuplot(const std::string& script);

}  // namespace ripplenotch
