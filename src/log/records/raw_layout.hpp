// SPDX-License-Identifier: MIT
#pragma once
// --layout: what stands in a record of a raw dump, in the words of C and NumPy.

#include <string>
#include <vector>

#include "log/npy/npy_header.hpp"

namespace ripplenotch {

struct RawLayout {
    std::vector<NpyField> fields;
    std::size_t record_size = 0;
    bool named = false;  ///< one field at least says its name
    std::string text;    ///< as it was given
};

/// "f8,f4,f4", "<i2*0.01:torque_nm", ">u4*1e-6:time_s,x4,f8:q". Fields follow each other without room
/// between; x4 is four bytes that are no number. '<' (the default) and '>' hold until the next one. Throws
/// UsageError.
[[nodiscard]] RawLayout parse_raw_layout(const std::string& text);

/// Layouts like this one whose records fit into `bytes` without remainder, the nearest first, two at most:
/// with bytes to be skipped added, or fields left out at the end.
[[nodiscard]] std::vector<std::string> layouts_that_fit(const RawLayout& layout, std::uint64_t bytes);

}  // namespace ripplenotch
