// SPDX-License-Identifier: MIT
// Packed logs that are damaged on the way: what came before, and what is said, do not depend on the pieces in
// which the bytes arrive. Their blocks are stored as they are, so that they can be written by hand.
#include <string>

#include "fuzz/reading.hpp"
#include "log/unpack/unpacker.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using Catch::Contains;

namespace {

std::string text_of_rows() {
    std::string text = "time_s,velocity_deg_s,torque_nm\n";
    for (int k = 0; k < 30; ++k) text += "0." + std::to_string(100 + k) + ",60,1.5\n";
    return text;
}

std::string little_endian(std::size_t number, int bytes) {
    std::string text;
    for (int i = 0; i < bytes; ++i) text += static_cast<char>(number >> (8 * i) & 0xFF);
    return text;
}

// Three blocks, then one of a kind that there is none of.
template <class Block>
std::string stored(const std::string& front, const std::string& wrong, const Block& block) {
    const std::string text = text_of_rows();
    const std::size_t part = text.size() / 3;
    return front + block(text.substr(0, part)) + block(text.substr(part, part)) +
           block(text.substr(2 * part)) + wrong + std::string(300, 'x');
}

std::string damaged_zstd() {
    return stored({"\x28\xb5\x2f\xfd\0\x50", 6}, {"\x06\0\0", 3},
                  [](const std::string& part) { return little_endian(part.size() << 3U, 3) + part; });
}

// Of another length than its head says: libzstd notices with the last byte.
std::string zstd_of_another_length() {
    const std::string text = text_of_rows();
    const std::size_t half = text.size() / 2;
    return std::string("\x28\xb5\x2f\xfd\x40\x50", 6) + little_endian(1000, 2) +
           little_endian(half << 3U, 3) + text.substr(0, half) +
           little_endian((text.size() - half) << 3U | 1U, 3) + text.substr(half);
}

std::string damaged_lz4() {
    return stored({"\x04\x22\x4d\x18\x60\x40\x82", 7}, "\xff\xff\xff\x7f",
                  [](const std::string& part) { return little_endian(part.size() | 0x80000000U, 4) + part; });
}

std::string damaged_gzip() {
    return stored({"\x1f\x8b\x08\0\0\0\0\0\0\x03", 10}, "\x06", [](const std::string& part) {
        return '\0' + little_endian(part.size(), 2) + little_endian(~part.size(), 2) + part;
    });
}

}  // namespace

TEST_CASE("where a packed log is damaged is said alike, however its bytes arrive", "[log]") {
    for (const std::string& bytes :
         {damaged_zstd(), zstd_of_another_length(), damaged_lz4(), damaged_gzip()}) {
        const Packing* const packing = packing_of(bytes);
        REQUIRE(packing != nullptr);
        if (packing->make == nullptr) continue;
        const std::string whole = fuzz::reading(bytes, {}, bytes.size() + 1);
        CHECK_THAT(whole, Contains("damaged"));
        // How much of a last block of the wrong length comes is up to libzstd.
        if (bytes != zstd_of_another_length())
            CHECK_THAT(whole, Contains("read " + std::to_string(text_of_rows().size()) + " bytes out of"));
        for (const std::size_t piece : {1U, 2U, 7U, 13U, 100U, 333U})
            CHECK(fuzz::reading(bytes, {}, piece) == whole);
    }
}
