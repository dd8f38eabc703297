// SPDX-License-Identifier: MIT
#include "support/places.hpp"

namespace ripplenotch {

std::string source_folder() { return RIPPLENOTCH_SOURCE_DIR; }
std::string logs_folder() { return RIPPLENOTCH_LOGS_DIR; }

}  // namespace ripplenotch
