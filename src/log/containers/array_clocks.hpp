// SPDX-License-Identifier: MIT
#pragma once
// Which arrays of a container were recorded at the same moments. Simulink's structs have a time beside each
// signal (tau.Time, tau.Data), HDF5 files a group for each device, dSPACE an axis for all.

#include <string>
#include <vector>

#include "log/containers/stored_array.hpp"

namespace ripplenotch {

/// Arrays of one clock, or of one length where nothing says whose clock they have.
struct ArrayGroup {
    std::size_t rows = 0;
    std::vector<const StoredArray*> arrays;  ///< in the order of the file; of equal clocks only the first
    const StoredArray* clock = nullptr;      ///< one of them
};

/// In order of their rows. The clock of an array is the vector named as a time in its own folder or in the
/// nearest one around it, if it has as many rows; clocks that hold the same numbers are one. Reads clocks
/// where several have the same length.
[[nodiscard]] std::vector<ArrayGroup> groups_by_clock(const std::vector<StoredArray>& arrays);

/// The last part of a path: "Data" of "log.tau.Data".
[[nodiscard]] std::string last_word(const std::string& path);
/// What is in front of it: "log.tau".
[[nodiscard]] std::string path_around(const std::string& path);
/// Without last parts that say nothing: "/tau/value" is "/tau", "tau.signals.values" is "tau".
[[nodiscard]] std::string without_empty_words(const std::string& path);

}  // namespace ripplenotch
