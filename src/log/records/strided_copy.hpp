// SPDX-License-Identifier: MIT
#pragma once
// Numbers from equal distances to equal distances: how columns become records, and records columns.

#include <cstddef>
#include <cstring>

namespace ripplenotch {

/// Where numbers lie: the first, and how many bytes further each next one.
template <class Byte>
struct Stride {
    Byte* first;
    std::size_t bytes;
};

namespace strided {

/// With a size that the compiler knows, a copy is one load and one store.
template <std::size_t Size>
void copy_numbers(Stride<const char> from, Stride<char> into, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i)
        std::memcpy(into.first + i * into.bytes, from.first + i * from.bytes, Size);
}

}  // namespace strided

/// `count` numbers of `size` bytes each; the two places do not overlap.
inline void copy_numbers(Stride<const char> from, Stride<char> into, std::size_t size, std::size_t count) {
    switch (size) {
        case 8:
            return strided::copy_numbers<8>(from, into, count);
        case 4:
            return strided::copy_numbers<4>(from, into, count);
        case 2:
            return strided::copy_numbers<2>(from, into, count);
        default:
            for (std::size_t i = 0; i < count; ++i)
                std::memcpy(into.first + i * into.bytes, from.first + i * from.bytes, size);
    }
}

}  // namespace ripplenotch
