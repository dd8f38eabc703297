// SPDX-License-Identifier: MIT
#pragma once
// Internal: the record of files read, which sources write and sha256_as_read() asks.

#include <string>
#include <string_view>

#include "core/files/byte_source.hpp"
#include "ripplenotch/core/files.hpp"

namespace ripplenotch {

/// Whether a source of this file hashes its bytes: as wanted, and not where the hash is known. Throws
/// FileError when the file is not what it was when it was first opened.
[[nodiscard]] bool to_be_hashed(const OpenFile& file, std::string_view name);
/// The file was read to its end; or, with an empty hash, is read at places and hashed when somebody asks.
void note_hash(const OpenFile& file, const std::string& sha256);

}  // namespace ripplenotch
