// SPDX-License-Identifier: MIT
#pragma once
// Files for libhdf5, which opens by name only.

#include <memory>

#include "core/files/temporary_file.hpp"
#include "log/containers/hdf5_handles.hpp"
#include "log/containers/stored_bytes.hpp"

namespace ripplenotch {

/// Reads them where they lie; what came through a pipe has a name for the moment of opening. Not good() where
/// the library cannot open it. Throws FileError.
[[nodiscard]] Hdf5Handle open_hdf5(StoredBytes& bytes);

/// A new file that nobody sees, for the library to write and us to read.
struct Hdf5Scratch {
    Hdf5Handle file;
    std::unique_ptr<TemporaryFile> bytes;
};
/// Throws FileError.
[[nodiscard]] Hdf5Scratch create_hdf5();

}  // namespace ripplenotch
