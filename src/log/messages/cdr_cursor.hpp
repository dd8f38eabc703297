// SPDX-License-Identifier: MIT
#pragma once
// Where a message in CDR is read: numbers at multiples of their size, texts and lists behind their lengths.

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <string_view>

#include "log/messages/cdr_program.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {

inline constexpr std::size_t cdr_head = 4;  // says the byte order

/// Throws DataError, without a source's name, where the message ends.
class CdrCursor {
  public:
    explicit CdrCursor(std::string_view message) : bytes_(message) {
        if (message.size() < cdr_head)
            raise<DataError>("a message of {} bytes, expected 4 or more", message.size());
        if (message[0] != '\0' || (message[1] != '\0' && message[1] != '\1'))
            raise<DataError>("a message in another encoding of CDR ({:#04x} {:#04x}), expected version 1",
                             static_cast<unsigned char>(message[0]), static_cast<unsigned char>(message[1]));
        swaps_ = (message[1] == '\0') != (std::endian::native == std::endian::big);
        bytes_.remove_prefix(cdr_head);
    }
    // Numbers stand at multiples of their size.
    const char* take(std::size_t size, std::size_t count = 1) {
        const std::size_t at = (at_ + size - 1) & ~(size - 1);
        if (at > bytes_.size() || count > (bytes_.size() - at) / size)
            raise<DataError>("a message that ends after {} bytes, expected {} numbers of {} bytes more",
                             bytes_.size() + cdr_head, count, size);
        at_ = at + count * size;
        return bytes_.data() + at;
    }
    void number(std::size_t size, char* into) {
        const char* const from = take(size);
        if (swaps_)
            std::reverse_copy(from, from + size, into);
        else
            std::memcpy(into, from, size);
    }
    std::uint32_t length() {
        std::uint32_t value = 0;
        number(4, reinterpret_cast<char*>(&value));
        return value;
    }
    // Of things that take a byte or more each.
    std::uint32_t list_length() {
        const std::uint32_t count = length();
        if (count > bytes_.size() - at_)
            raise<DataError>("a list of {} things in the {} bytes that are left of a message, expected fewer",
                             count, bytes_.size() - at_);
        return count;
    }
    std::string_view text() {
        const std::uint32_t size = length();
        std::string_view text(take(1, size), size);
        if (text.ends_with('\0')) text.remove_suffix(1);
        return text;
    }
    std::int64_t stamp() {
        std::int32_t seconds = 0;
        std::uint32_t nanoseconds = 0;
        number(4, reinterpret_cast<char*>(&seconds));
        number(4, reinterpret_cast<char*>(&nanoseconds));
        return std::int64_t{seconds} * 1'000'000'000 + nanoseconds;
    }

  private:
    std::string_view bytes_;
    std::size_t at_ = 0;
    bool swaps_ = false;
};

/// Reads on over what a step says, and checks what it demands.
void pass_cdr(CdrCursor& cursor, const CdrStep& step);
void pass_cdr(CdrCursor& cursor, const std::vector<CdrStep>& steps);

}  // namespace ripplenotch
