// SPDX-License-Identifier: MIT
#pragma once
// Internal to the log room: text put together piece by piece in a string that is used again and again.

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <string>
#include <string_view>

#include "ripplenotch/core/number.hpp"

namespace ripplenotch {

/// Behind what is there, there is always room for a number and a little more.
class TextRoom {
  public:
    /// Keeps what `room` holds of size: making a string longer fills it, which takes as long as the text.
    TextRoom(std::string& room, std::size_t expected) : room_(room) {
        if (room_.size() < expected + slack) room_.resize(expected + slack);
    }

    /// text[from, to)
    void copy(std::string_view text, std::size_t from, std::size_t to) {
        const std::size_t size = to - from;
        make_room(size);
        // Most pieces are short, and copying a fixed number of bytes is one instruction or two.
        if (size <= piece && from + piece <= text.size())
            std::memcpy(end(), text.data() + from, piece);
        else
            std::memcpy(end(), text.data() + from, size);
        used_ += size;
    }
    void put(char one) {
        make_room(1);
        *end() = one;
        ++used_;
    }
    /// `write` takes where to write to, which has room for number_room bytes, and returns its end.
    template <typename Write>
    void number(const Write& write) {
        make_room(0);
        used_ += static_cast<std::size_t>(write(end()) - end());
    }
    [[nodiscard]] std::string_view text() const { return {room_.data(), used_}; }

  private:
    static constexpr std::size_t piece = 32, slack = number_room + 2 * piece;
    [[nodiscard]] char* end() { return room_.data() + used_; }
    void make_room(std::size_t size) {
        if (used_ + size + slack > room_.size()) room_.resize(2 * (used_ + size + slack));
    }

    std::string& room_;
    std::size_t used_ = 0;
};

}  // namespace ripplenotch
