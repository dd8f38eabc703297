// SPDX-License-Identifier: MIT
#pragma once
// A compressed file as the bytes inside it, in bounded memory.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "ripplenotch/core/files.hpp"

namespace ripplenotch {

// Compressed bytes, unpacked a piece at a time: what the kinds of compressed files have in common.

/// Unpacks one stream of bytes; streams that follow each other are one, as their own programs have it.
class Unpacker {
  public:
    Unpacker() = default;
    virtual ~Unpacker() = default;
    Unpacker(const Unpacker&) = delete;
    Unpacker& operator=(const Unpacker&) = delete;
    struct Step {
        std::size_t taken = 0;  ///< of the packed bytes
        std::size_t given = 0;  ///< put into the room
        std::string damage;     ///< why nothing more comes, without a source's name; what was given counts
    };
    /// Takes from `packed`, gives into `into`. Neither for want of bytes. What is given before the damage of
    /// damaged bytes, or of bytes that ask for more than 128 MiB to be unpacked, does not depend on the
    /// pieces in which they come.
    virtual Step step(std::string_view packed, std::span<char> into) = 0;
    /// Whether what was taken so far is whole.
    [[nodiscard]] virtual bool complete() const = 0;
};

/// How containers wrap the deflate method: as zlib does (RFC 1950), or not at all (RFC 1951).
enum class Deflate { wrapped, bare };

/// Throws UsageError, beginning with `source`, where this build lacks zlib.
[[nodiscard]] std::unique_ptr<Unpacker> make_inflater(Deflate kind, const std::string& source);

/// CRC-32 as gzip and many others have it; none where this build lacks zlib.
[[nodiscard]] std::optional<std::uint32_t> crc32_of(std::string_view bytes, std::uint32_t before = 0);

/// One kind of compressed file.
struct Packing {
    std::string_view name;     ///< "gzip"
    std::string_view magic;    ///< the first bytes of such a file
    std::string_view program;  ///< that unpacks it to a pipe: "zcat"
    std::string_view lacks;    ///< the library that this build lacks; empty where it has it
    std::unique_ptr<Unpacker> (*make)() = nullptr;  ///< null where it lacks it
};

namespace packings {
extern const Packing gzip, zstd, lz4;
}

/// All kinds.
[[nodiscard]] std::span<const Packing* const> all_packings();

/// The kind that begins with these bytes; null where it is none.
[[nodiscard]] const Packing* packing_of(std::string_view first_bytes);

/// What `packed` holds behind its `first_bytes`, which have been read from it already, under its name. A file
/// is unpacked by a thread of its own, ahead of who reads; a pipe in read() itself, since waiting for it must
/// not hold up the end. read() throws DataError where the bytes are damaged, cut off, or unpack to more than
/// any log does.
[[nodiscard]] std::unique_ptr<ByteSource> unpack(std::unique_ptr<ByteSource> packed, std::string first_bytes,
                                                 const Packing& packing);

}  // namespace ripplenotch
