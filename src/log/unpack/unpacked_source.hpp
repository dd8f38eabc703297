// SPDX-License-Identifier: MIT
#pragma once
// A compressed file as the bytes inside it, in bounded memory.

#include <memory>
#include <string>

#include "log/unpack/unpacker.hpp"
#include "ripplenotch/core/files.hpp"

namespace ripplenotch {

/// Bytes that give more than this many times what they take are no log but a trap; asked only once so much
/// has come out.
inline constexpr std::uint64_t most_unpacked_for_one = 500, unpacked_unasked = std::uint64_t{64} << 20;

/// What `packed` holds behind its `first_bytes`, which have been read from it already, under its name. A file
/// is unpacked by a thread of its own, ahead of who reads; a pipe in read() itself, since waiting for it must
/// not hold up the end. read() throws DataError where the bytes are damaged, cut off, or unpack to more than
/// any log does.
[[nodiscard]] std::unique_ptr<ByteSource> unpack(std::unique_ptr<ByteSource> packed, std::string first_bytes,
                                                 const Packing& packing);

}  // namespace ripplenotch
