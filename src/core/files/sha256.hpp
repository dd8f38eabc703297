// SPDX-License-Identifier: MIT
#pragma once
#include <atomic>
#include <cstdint>
#include <string>
#include <string_view>
#include <thread>

#include "ripplenotch/core/files.hpp"

namespace ripplenotch {

// Internal: the SHA-256 of what is read, on another core than the one that reads.

/// The hash of bytes that come in order. Of a long file a thread of its own reads them once more, which costs
/// less than to hand them from core to core; a short file, a process of one core and a system without a
/// thread to spare do without. Whoever reads has to see that nobody writes to the file meanwhile.
class HashBeside {
  public:
    /// No thread will do.
    HashBeside() = default;
    /// The bytes are those of a file, from this place on. The descriptor must outlive it.
    HashBeside(int descriptor, std::uint64_t begin) : descriptor_(descriptor), at_(begin) {}
    ~HashBeside();
    HashBeside(const HashBeside&) = delete;
    HashBeside& operator=(const HashBeside&) = delete;

    void update(std::string_view bytes);
    /// The digest of all bytes so far; the last call. Throws FileError where they cannot be read once more.
    [[nodiscard]] std::string hex();

  private:
    void begin_thread();
    void hash_file();

    Sha256 hash_;
    int descriptor_ = -1;
    std::uint64_t at_ = 0;  ///< place in the file up to which bytes came
    std::uint64_t hashed_here_ = 0, told_to_ = 0;
    /// Twice the place up to which the thread may read, and 1 where that is the end.
    std::atomic<std::uint64_t> told_ = 0;
    std::atomic<std::uint64_t> hashed_to_ = 0;  ///< by the thread
    std::atomic<bool> failed_ = false;
    std::thread thread_;
};

}  // namespace ripplenotch
