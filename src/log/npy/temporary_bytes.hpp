// SPDX-License-Identifier: MIT
#pragma once
// Internal to the log room: bytes that have to wait until something is known that goes before them.

#include <cstdint>
#include <cstdio>
#include <memory>
#include <string_view>

namespace ripplenotch {

/// A file without a name in the folder for temporary files (TMPDIR). Throws FileError where there is no room.
class TemporaryBytes {
  public:
    TemporaryBytes();
    void put(std::string_view bytes);
    /// All has been put; read() begins at the start.
    void rewind();
    /// Up to `size` bytes; 0 at the end.
    std::size_t read(char* into, std::size_t size);
    /// Exactly `size` bytes that have been put, anywhere; putting goes on behind the last.
    void read_at(std::uint64_t offset, char* into, std::size_t size);

  private:
    struct Close {
        void operator()(std::FILE* file) const { std::fclose(file); }
    };
    std::unique_ptr<std::FILE, Close> file_;
    bool flushed_ = true;
};

}  // namespace ripplenotch
