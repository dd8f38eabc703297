// SPDX-License-Identifier: MIT
#pragma once
// What a run read: the SHA-256 of a file is that of the bytes that were read, whatever has become of the
// file.

#include <string>

namespace ripplenotch {

/// From now on every ByteSource of a file, in this process, hashes what it reads (about a second for a
/// gigabyte), or none does any longer. Off at the start.
void hash_inputs(bool wanted);

/// Of the bytes of `path` as they were first read to their end. Where nobody has read it, it is read now.
/// Throws FileError.
[[nodiscard]] std::string sha256_as_read(const std::string& path);

}  // namespace ripplenotch
