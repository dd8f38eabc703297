// SPDX-License-Identifier: MIT
#include "core/hash_beside.hpp"

#include <algorithm>
#include <random>
#include <string>

#include "support/catch.hpp"

using namespace ripplenotch;

namespace {

constexpr std::size_t long_file = std::size_t{9} << 20;  // beyond what is hashed without a thread

std::string some_bytes() {
    std::mt19937 random(1);
    std::string bytes(long_file, '\0');
    std::generate(bytes.begin(), bytes.end(), [&] { return static_cast<char>(random()); });
    return bytes;
}

}  // namespace

TEST_CASE("the hash is the same beside the reading, in whatever pieces the bytes come") {
    const std::string bytes = some_bytes();
    Sha256 whole;
    whole.update(bytes);
    const std::string expected = whole.hex();
    for (const bool beside : {false, true}) {
        std::mt19937 random(2);
        HashBeside hash(beside);
        for (std::size_t at = 0; at < bytes.size();) {
            const std::size_t size = std::min<std::size_t>(bytes.size() - at, 1 + random() % 700000);
            hash.update({bytes.data() + at, size});
            at += size;
        }
        CHECK(hash.hex() == expected);
    }
}

TEST_CASE("a reading that is given up leaves no thread behind") {
    const std::string bytes = some_bytes();
    for (int k = 0; k < 20; ++k) {
        HashBeside hash(true);
        hash.update(bytes);
        hash.update({bytes.data(), std::size_t{1} << 18});
    }
}
