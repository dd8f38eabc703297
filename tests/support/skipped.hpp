// SPDX-License-Identifier: MIT
#pragma once

#include <string>

namespace ripplenotch::test {

/// Says that a part of the test in hand cannot run here, and why. Where nothing failed, the program then ends
/// with exit code 4, which ctest shows as skipped.
void skipped(const std::string& reason);

}  // namespace ripplenotch::test
