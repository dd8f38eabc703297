// SPDX-License-Identifier: MIT
#include "log/read_on.hpp"

#include <algorithm>

namespace ripplenotch {

std::size_t read_on(ByteSource& source, std::string& bytes, std::size_t have, std::size_t size) {
    constexpr std::size_t first_room = std::size_t{1} << 12;
    for (std::size_t got = 1; have < size && got > 0; have += got) {
        if (bytes.size() == have) bytes.resize(std::min(size, std::max(2 * have, first_room)));
        got = source.read(bytes.data() + have, std::min(size, bytes.size()) - have);
    }
    return have;
}

}  // namespace ripplenotch
