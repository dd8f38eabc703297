// SPDX-License-Identifier: MIT
#pragma once
// Numbers of an HDF5 dataset, a column at a time.

#include <memory>
#include <optional>

#include "log/containers/hdf5_handles.hpp"
#include "log/containers/stored_array.hpp"

namespace ripplenotch {

/// The file that datasets are read from.
struct Hdf5File {
    std::shared_ptr<StoredBytes> bytes;
    Hdf5Handle file;
};

/// Numbers in memory, and how they are asked for.
struct Hdf5Memory {
    NpyField field;
    std::shared_ptr<Hdf5Handle> type;  ///< one number, an array of them, or a record of one member
    std::size_t count = 1;             ///< numbers that come for each row
};

[[nodiscard]] hid_t hdf5_native(const NpyField& field);
/// A number of the file as the processor has it; none for text, references, and what is wider than 8 bytes.
[[nodiscard]] std::optional<NpyField> hdf5_number(hid_t type);

/// A column of a dataset of one dimension or two, or one number of an array in every row.
[[nodiscard]] std::unique_ptr<ColumnCursor> hdf5_column(std::shared_ptr<Hdf5File> file,
                                                        std::shared_ptr<Hdf5Handle> dataset,
                                                        Hdf5Memory memory, std::size_t dimensions,
                                                        std::size_t time_dimension, std::size_t column);

}  // namespace ripplenotch
