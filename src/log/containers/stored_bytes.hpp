// SPDX-License-Identifier: MIT
#pragma once
// The bytes of a container, which is read here and there.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "log/unpack/unpacker.hpp"
#include "ripplenotch/core/files.hpp"

namespace ripplenotch {

class StoredBytes {
  public:
    virtual ~StoredBytes() = default;
    /// 0 where nobody knows before all have been unpacked.
    [[nodiscard]] virtual std::uint64_t size() const = 0;
    /// Throws DataError, beginning with the source's name, where there are not as many.
    virtual void read_at(std::uint64_t offset, char* into, std::size_t size) = 0;
    [[nodiscard]] std::string text_at(std::uint64_t offset, std::size_t size) {
        std::string text(size, '\0');
        read_at(offset, text.data(), size);
        return text;
    }
    /// A name of the open file that holds them, for libraries that open it themselves; empty where it has no
    /// name of its own, by which they might look for it.
    [[nodiscard]] virtual std::string openable() const { return {}; }
    /// When all has been read: throws FileError where somebody wrote to the file meanwhile.
    virtual void require_unchanged() const {}
    /// As messages name it.
    [[nodiscard]] const std::string& name() const { return name_; }

  protected:
    explicit StoredBytes(std::string name) : name_(std::move(name)) {}

  private:
    std::string name_;
};

/// A file is read where it lies; a pipe is kept in a temporary file. `first_bytes` have been read from it.
[[nodiscard]] std::shared_ptr<StoredBytes> store_bytes(std::unique_ptr<ByteSource> source,
                                                       std::string first_bytes);

/// Throws DataError unless the part has this CRC-32. Reads it; says nothing in a build without zlib.
void require_checksum(StoredBytes& bytes, std::uint64_t offset, std::uint64_t size, std::uint32_t checksum);

/// What unpacks from a part of them, unpacked as far as it is asked for, into a temporary file. No more than
/// `most` bytes. With `checksum`, reading the last of `most` throws DataError unless it is theirs (CRC-32).
[[nodiscard]] std::shared_ptr<StoredBytes> unpack_part(std::shared_ptr<StoredBytes> packed,
                                                       std::uint64_t offset, std::uint64_t size, Deflate kind,
                                                       std::uint64_t most,
                                                       std::optional<std::uint32_t> checksum = {});

}  // namespace ripplenotch
