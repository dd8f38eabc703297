// SPDX-License-Identifier: MIT
#pragma once
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "log/containers/stored_array.hpp"

namespace ripplenotch {

// Which arrays of a container were recorded at the same moments. Simulink's structs have a time beside each
// signal (tau.Time, tau.Data), HDF5 files a group for each device, dSPACE an axis for all.

/// Arrays of one clock, or of one length where nothing says whose clock they have.
struct ArrayGroup {
    std::size_t rows = 0;
    std::vector<const StoredArray*> arrays;  ///< in the order of the file; of equal clocks only the first
    const StoredArray* clock = nullptr;      ///< one of them
};

// Columns of arrays side by side: what they are called, and their numbers as records.

/// One column of an array under its own path.
struct ArrayColumn {
    std::string path;     ///< "log.q_dot(:,3)"
    std::string read_as;  ///< what it means beside the others: "q_dot[3]"
    const StoredArray* array;
    std::size_t number;
};

/// Of all arrays of a group. What their names have in front in common is left out.
[[nodiscard]] std::vector<ArrayColumn> columns_of(const ArrayGroup& group, PathStyle style);

/// Adds the columns as fields of records.
void add_fields(const std::vector<ArrayColumn>& columns, RecordTable& table);

// Arrays that have clocks of their own, joined by time.

/// The rows of `base` with its clock in nanoseconds, and behind them what `asked` takes of the columns of
/// `others`, by `how` ("linear"). All groups have a clock. Fills the fields of the table.
[[nodiscard]] std::unique_ptr<RecordSource> joined_arrays(
    const std::shared_ptr<StoredBytes>& file, const ArrayGroup& base,
    const std::vector<const ArrayGroup*>& others, PathStyle style,
    const std::function<bool(const std::string& path)>& asked, const std::string& how, RecordTable& table);

}  // namespace ripplenotch
