// SPDX-License-Identifier: MIT
#pragma once
// Columns of arrays side by side: what they are called, and their numbers as records.

#include <memory>
#include <string>
#include <vector>

#include "log/containers/array_clocks.hpp"
#include "log/containers/stored_array.hpp"

namespace ripplenotch {

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

/// The numbers of columns of one length as records, row by row.
[[nodiscard]] std::unique_ptr<RecordSource> array_records(std::shared_ptr<StoredBytes> file,
                                                          const std::vector<ArrayColumn>& columns);

}  // namespace ripplenotch
