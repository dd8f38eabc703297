// SPDX-License-Identifier: MIT
#pragma once
// New HDF5 files: a dataset of float64 for each column.

#include <memory>

#include "log/table_writer.hpp"

namespace ripplenotch {

/// The library goes back and forth in what it writes, so that the file waits under no name until it is whole.
/// Throws UsageError where this build lacks libhdf5.
[[nodiscard]] std::unique_ptr<TableWriter> make_hdf5_table(ByteSink& sink, const WriteOptions& options);

}  // namespace ripplenotch
