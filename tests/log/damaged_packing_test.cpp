// SPDX-License-Identifier: MIT
// Packed logs that are damaged on the way: what came before, and what is said, do not depend on the pieces in
// which the bytes arrive. Their blocks are stored as they are, so that they can be written by hand, or are
// the few bytes to which programs pack many equal rows.
#include <array>
#include <string>

#include "fuzz/reading.hpp"
#include "log/unpack/unpacked_source.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using Catch::Contains;

namespace {

std::string text_of(int rows) {
    std::string text = "time_s,velocity_deg_s,torque_nm\n";
    for (int k = 0; k < rows; ++k) text += "0." + std::to_string(100 + k) + ",60,1.5\n";
    return text;
}

std::string little_endian(std::size_t number, int bytes) {
    std::string text;
    for (int i = 0; i < bytes; ++i) text += static_cast<char>(number >> (8 * i) & 0xFF);
    return text;
}

// Blocks of equal size, then one of a kind that there is none of.
template <class Block>
std::string stored(const std::string& text, std::size_t blocks, std::string front, const std::string& wrong,
                   const Block& block) {
    const std::size_t size = (text.size() + blocks - 1) / blocks;
    for (std::size_t at = 0; at < text.size(); at += size) front += block(text.substr(at, size));
    return front + wrong + std::string(300, 'x');
}

std::string damaged_zstd(const std::string& text, std::size_t blocks) {
    return stored(text, blocks, {"\x28\xb5\x2f\xfd\0\x50", 6}, {"\x06\0\0", 3},
                  [](const std::string& part) { return little_endian(part.size() << 3U, 3) + part; });
}

// Of another length than its head says: libzstd notices with the last byte.
std::string zstd_of_another_length(const std::string& text) {
    const std::size_t half = text.size() / 2;
    return std::string("\x28\xb5\x2f\xfd\x40\x50", 6) + little_endian(text.size() + 500, 2) +
           little_endian(half << 3U, 3) + text.substr(0, half) +
           little_endian((text.size() - half) << 3U | 1U, 3) + text.substr(half);
}

std::string damaged_lz4(const std::string& text, std::size_t blocks) {
    return stored(text, blocks, {"\x04\x22\x4d\x18\x60\x40\x82", 7}, "\xff\xff\xff\x7f",
                  [](const std::string& part) { return little_endian(part.size() | 0x80000000U, 4) + part; });
}

std::string damaged_gzip(const std::string& text, std::size_t blocks) {
    return stored(text, blocks, {"\x1f\x8b\x08\0\0\0\0\0\0\x03", 10}, "\x06", [](const std::string& part) {
        return '\0' + little_endian(part.size(), 2) + little_endian(~part.size(), 2) + part;
    });
}

std::string bytes_of(std::string_view hex) {
    std::string bytes;
    for (std::size_t i = 0; i + 1 < hex.size(); i += 2)
        bytes += static_cast<char>(std::stoi(std::string(hex.substr(i, 2)), nullptr, 16));
    return bytes;
}

// "velocity_deg_s,torque_nm" and 150 times "60,1.5", packed with a checksum by zstd, lz4 and gzip.
constexpr std::array<std::string_view, 3> packed_rows = {
    "28b52ffd6433033d0100f876656c6f636974795f6465675f732c746f727175655f6e6d0a36302c312e35010047a0bf38014a869a"
    "92",
    "04224d186440a72e000000ff1076656c6f636974795f6465675f732c746f727175655f6e6d0a36302c312e350700ffffffff0050"
    "2c312e350a00000000d76b1463",
    "1f8b08000000000002032b4bcdc94fce2ca98c4f494d8f2fd629c92f2a2c4d8dcfcbe53233d031d4331da546a9516a9442a60040"
    "46b15f33040000"};

}  // namespace

TEST_CASE("a packed log is read alike in pieces of any size, whichever byte of it is wrong", "[log]") {
    for (const std::string_view hex : packed_rows) {
        const std::string good = bytes_of(hex);
        const Packing* const packing = packing_of(good);
        REQUIRE(packing != nullptr);
        if (packing->make == nullptr) continue;
        const ReadOptions options = fuzz::options_of(4);  // a log without time, at 1 kHz
        CHECK(fuzz::reading(good, options, good.size() + 1).back() == '|');
        std::size_t refused = 0;
        for (std::size_t at = 4; at < good.size(); ++at) {
            for (const int wrong : {0x01, 0x10, 0xff}) {
                std::string bytes = good;
                bytes[at] = static_cast<char>(bytes[at] ^ wrong);
                CAPTURE(packing->name, at, wrong);
                const std::string whole = fuzz::reading(bytes, options, bytes.size() + 1);
                refused += whole.back() == '|' ? 0U : 1U;
                for (const std::size_t piece : {1U, 5U, 40U})
                    REQUIRE(fuzz::reading(bytes, options, piece) == whole);
            }
        }
        CHECK(refused > good.size());  // some bytes of a head say nothing of the rows
    }
}

// Of more than 512 bytes, too: those are looked at before the reader reads on, and what is left of their
// block waits within the library while the next one, damaged, comes.
TEST_CASE("where a packed log is damaged is said alike, however its bytes arrive", "[log]") {
    for (const auto& [rows, blocks] : {std::pair{30, 3U}, std::pair{300, 3U}, std::pair{300, 1U}}) {
        const std::string text = text_of(rows), other_length = zstd_of_another_length(text);
        for (const std::string& bytes : {damaged_zstd(text, blocks), other_length, damaged_lz4(text, blocks),
                                         damaged_gzip(text, blocks)}) {
            const Packing* const packing = packing_of(bytes);
            REQUIRE(packing != nullptr);
            if (packing->make == nullptr) continue;
            CAPTURE(rows, blocks, packing->name);
            const std::string whole = fuzz::reading(bytes, {}, bytes.size() + 1);
            CHECK_THAT(whole, Contains("damaged"));
            // How much of a last block of the wrong length comes is up to libzstd.
            if (bytes != other_length)
                CHECK_THAT(whole, Contains("read " + std::to_string(text.size()) + " bytes out of"));
            for (const std::size_t piece : {1U, 2U, 7U, 13U, 100U, 333U})
                CHECK(fuzz::reading(bytes, {}, piece) == whole);
        }
    }
}
