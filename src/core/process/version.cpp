// SPDX-License-Identifier: MIT
#include "ripplenotch/core/progress.hpp"

namespace ripplenotch {

std::string_view version() { return RIPPLENOTCH_VERSION; }

}  // namespace ripplenotch
