// SPDX-License-Identifier: MIT
#pragma once
// Internal: the SHA-256 of what is read, on another core than the one that reads.

#include <condition_variable>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>

#include "ripplenotch/core/files.hpp"

namespace ripplenotch {

/// The hash of bytes that come in order. Of a long file a thread of its own hashes one piece while the next
/// is read; a short file, a process of one core and a system without a thread to spare do without.
class HashBeside {
  public:
    /// `beside`: whether a thread may be begun.
    explicit HashBeside(bool beside) : beside_(beside) {}
    void update(std::string_view bytes);
    /// Of all bytes so far; the last call.
    [[nodiscard]] std::string hex();

  private:
    void begin_thread();
    void hand_over();
    void hash_pieces(const std::stop_token& ended);

    Sha256 hash_;
    bool beside_;
    std::size_t hashed_here_ = 0;
    std::string filling_, handed_over_;  ///< the thread reads handed_over_ while it is busy
    std::mutex mutex_;
    std::condition_variable_any changed_;
    bool busy_ = false;
    std::jthread thread_;  ///< last: it ends before what it uses
};

}  // namespace ripplenotch
