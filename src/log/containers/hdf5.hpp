// SPDX-License-Identifier: MIT
#pragma once
// The arrays of numbers in an HDF5 file, of MATLAB's version 7.3 too, by libhdf5.

#include <memory>
#include <vector>

#include "core/files/byte_sink.hpp"
#include "log/containers/stored_array.hpp"
#include "log/table_writer.hpp"

namespace ripplenotch {

// New HDF5 files: a dataset of float64 for each column.

/// The library goes back and forth in what it writes, so that the file waits under no name until it is whole.
/// Throws UsageError where this build lacks libhdf5.
[[nodiscard]] std::unique_ptr<TableWriter> make_hdf5_table(ByteSink& sink, const WriteOptions& options);

struct Hdf5Contents {
    std::vector<StoredArray> arrays;  ///< datasets of one dimension or two, members of compound types
    std::vector<ContentEntry>
        others;  ///< "outside of the file, not followed", "packed by a filter that is not here"
};

/// Links and numbers that lie in other files are never followed, and no filter is loaded. With `matlab`,
/// paths are as MATLAB writes them ("log.q_dot") and text, cells and objects are left out. Throws DataError,
/// beginning with the file's name, where the library cannot read it.
[[nodiscard]] Hdf5Contents find_hdf5_arrays(const std::shared_ptr<StoredBytes>& file, bool matlab);

}  // namespace ripplenotch
