// SPDX-License-Identifier: MIT
#pragma once
// The entries of the format registry, declared from its one list.

#include "ripplenotch/log/format.hpp"

namespace ripplenotch::formats {

#define FORMAT(name) extern const LogFormat name;
#include "log/formats/formats.def"
#undef FORMAT

}  // namespace ripplenotch::formats
