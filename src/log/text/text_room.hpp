// SPDX-License-Identifier: MIT
#pragma once
// Internal to the log room: text put together piece by piece in a string that is used again and again.

#include <cstddef>
#include <cstring>
#include <string>
#include <string_view>

namespace ripplenotch {

/// Text is written at end(), where ensure() has seen to it that there is room.
class TextRoom {
  public:
    /// Keeps what `room` holds of size: making a string longer fills it, which takes as long as the text.
    TextRoom(std::string& room, std::size_t expected) : room_(room) {
        if (room_.size() < expected) room_.resize(expected);
    }

    /// Room for so many bytes at what it returns, the end of what has been written.
    [[nodiscard]] char* ensure(std::size_t size) {
        if (used_ + size > room_.size()) room_.resize(2 * (used_ + size));
        return room_.data() + used_;
    }
    /// What has been written ends here.
    void written_until(const char* end) { used_ = static_cast<std::size_t>(end - room_.data()); }
    [[nodiscard]] std::string_view text() const { return {room_.data(), used_}; }

  private:
    std::string& room_;
    std::size_t used_ = 0;
};

/// Copies of pieces of one text, one behind the other. Most pieces are short, and copying a fixed number of
/// bytes is one instruction or two, so where it can it copies more than a piece: there must be room for
/// `over` bytes behind it.
class PieceCopier {
  public:
    static constexpr std::size_t over = 32;

    explicit PieceCopier(std::string_view text)
        : text_(text.data()), short_until_(text.size() < over ? 0 : text.size() - over + 1) {}
    /// The bytes from where it is, until `to`; returns the end of the copy.
    char* copy_until(std::size_t to, char* into) {
        const std::size_t size = to - done_;
        const char* const from = text_ + done_;
        if (size <= over && done_ < short_until_) [[likely]]
            std::memcpy(into, from, over);
        else
            std::memcpy(into, from, size);
        done_ = to;
        return into + size;
    }
    /// Goes on behind what stands before `to`.
    void skip_until(std::size_t to) { done_ = to; }
    [[nodiscard]] std::size_t done() const { return done_; }

  private:
    const char* text_;
    std::size_t short_until_;  ///< from there on a short piece would reach behind the text
    std::size_t done_ = 0;
};

}  // namespace ripplenotch
