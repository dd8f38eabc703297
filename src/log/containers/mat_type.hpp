// SPDX-License-Identifier: MIT
#pragma once
// Numbers of data types in MAT files of level 5.

#include <cstdint>

namespace ripplenotch::mat_type {

enum : std::uint32_t {
    int8 = 1,
    uint16 = 4,
    int32 = 5,
    uint32 = 6,
    float64 = 9,
    matrix = 14,
    compressed = 15,
    utf16 = 17
};

}  // namespace ripplenotch::mat_type
