// SPDX-License-Identifier: MIT
#include "core/files/sha256.hpp"

#include <algorithm>
#include <cstdio>
#include <random>
#include <string>

#include "core/process/two_cores.hpp"
#include "ripplenotch/core/error.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;

namespace {

constexpr std::size_t long_file = std::size_t{19} << 20;  // a thread may not fall behind by as much

struct File {
    explicit File(const std::string& bytes) {
        REQUIRE(file != nullptr);
        std::fputs("head", file);
        std::fwrite(bytes.data(), 1, bytes.size(), file);
        std::fflush(file);
    }
    ~File() { std::fclose(file); }
    File(const File&) = delete;
    File& operator=(const File&) = delete;
    [[nodiscard]] int descriptor() const { return ::fileno(file); }

    std::FILE* file = std::tmpfile();
};

std::string some_bytes() {
    std::mt19937 random(1);
    std::string bytes(long_file, '\0');
    std::generate(bytes.begin(), bytes.end(), [&] { return static_cast<char>(random()); });
    return bytes;
}

// In pieces of many sizes.
void give(const std::string& bytes, HashBeside& hash) {
    std::mt19937 random(2);
    for (std::size_t at = 0; at < bytes.size();) {
        const std::size_t size = std::min<std::size_t>(bytes.size() - at, 1 + random() % 700000);
        hash.update({bytes.data() + at, size});
        at += size;
    }
}

}  // namespace

TEST_CASE("the hash is the same beside the reading, in whatever pieces the bytes come") {
    const std::string bytes = some_bytes();
    const File file(bytes);
    Sha256 whole;
    whole.update(bytes);
    const std::string expected = whole.hex();
    HashBeside here, beside(file.descriptor(), 4);
    give(bytes, here);
    give(bytes, beside);
    CHECK(here.hex() == expected);
    CHECK(beside.hex() == expected);
}

TEST_CASE("a reading that is given up leaves no thread behind") {
    const std::string bytes = some_bytes();
    const File file(bytes);
    for (int k = 0; k < 20; ++k) {
        HashBeside hash(file.descriptor(), 4);
        hash.update(bytes);
        hash.update({bytes.data(), std::size_t{1} << 18});
    }
}

TEST_CASE("a file that became shorter than what was read of it has no hash, and nobody waits for it") {
    const std::string bytes = some_bytes();
    const File file(bytes.substr(0, long_file / 4));
    HashBeside hash(file.descriptor(), 4);
    give(bytes, hash);
    if (cores_here() > 1) CHECK_THROWS_AS(hash.hex(), FileError);
}
