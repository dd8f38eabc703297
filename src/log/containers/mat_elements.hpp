// SPDX-License-Identifier: MIT
#pragma once
// The data elements of a MAT file of version 5, 6 or 7 (MathWorks, "MAT-File Format"): which arrays of
// numbers are in it and where their bytes are.

#include <memory>
#include <string>
#include <vector>

#include "log/containers/stored_array.hpp"

namespace ripplenotch {

/// What was found.
struct MatContents {
    std::vector<StoredArray>
        arrays;  ///< of numbers, by paths as MATLAB writes them: "log.q_dot", "runs(2).tau"
    std::vector<ContentEntry> others;  ///< what is no log: "a function handle", "complex"
};

/// Of a whole file. Reads the heads of its elements only. Throws DataError, beginning with the file's name,
/// where it is damaged or nested deeper than 16.
[[nodiscard]] MatContents find_mat_arrays(const std::shared_ptr<StoredBytes>& file);

}  // namespace ripplenotch
