// SPDX-License-Identifier: MIT
// Logs of strangers: broken, cut off, damaged on the way.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <string>

#include "core/vectors/lanes.hpp"
#include "fuzz/reading.hpp"
#include "log/text/quick_rows.hpp"
#include "log/unpack/unpacked_source.hpp"
#include "log_support.hpp"
#include "ripplenotch/core/error.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using namespace ripplenotch::test;
using Catch::Contains;

// Ways to break a text log: each gives one message with file, line, column, what was read, expected, and to
// be done.

namespace {

const std::string head = "time_s,velocity_deg_s,torque_nm\n";

}  // namespace

TEST_CASE("a counter that begins anew is told as such, with what the log says and what to do") {
    const std::string tail = ",10,2.5\n";
    const auto after = [&](const std::string& unit, const std::string& before, const std::string& time) {
        return complaint("time_" + unit + ",velocity_deg_s,torque_nm\n" + before + tail + time + tail);
    };
    CHECK_THAT(after("ms", "65535", "0"), Contains("read the time 0 after 65535") &&
                                              Contains("a counter of 16 bits") && Contains("--to") &&
                                              Contains("--sample-rate"));
    CHECK_THAT(after("us", "4294967000", "704"),
               Contains("a counter of 32 bits") && Contains("after 4294967000"));
    CHECK_THAT(after("us", "2147483000", "-2147483296"), Contains("a counter of 32 bits"));
    CHECK_THAT(after("ms", "86399999", "0"), Contains("a time of day"));
    CHECK_THAT(after("ms", "65535", "30000"), !Contains("counter") && Contains("sort or split"));
    CHECK_THAT(after("ms", "65000", "64000"), !Contains("counter"));
    CHECK_THAT(after("ns", "1700000000000001000", "1700000000000000000"),
               Contains("read the time 1700000000000000000 after 1700000000000001000"));
}

TEST_CASE("a broken row is named by line and column with the remedy", "[log]") {
    CHECK_THAT(
        complaint(head + "0,10,2.5\n0.01,abc,3\n0.02,12,4\n"),
        Contains("log.csv:3:6: read 'abc' in 'velocity_deg_s' (column 2), expected a number; correct or "
                 "remove the line"));
    CHECK_THAT(complaint(head + "0,10,2.5\n0.01,11,nan\n0.02,12,4\n"),
               Contains("log.csv:3:9: read 'nan' in 'torque_nm' (column 3), expected a finite number"));
    CHECK_THAT(complaint(head + "0,10,2.5\n0.01,11,-inf\n0.02,12,4\n"), Contains("log.csv:3:9: read '-inf'"));
    CHECK_THAT(complaint(head + "0,10,2.5\n0.01,11,1e999\n0.02,12,4\n"),
               Contains("log.csv:3:9: read '1e999'"));
    CHECK_THAT(complaint(head + "0,10,2.5\n0.01,11\n0.02,12,4\n"),
               Contains("log.csv:3:8: read 2 cells, expected 3; correct"));
    CHECK_THAT(complaint(head + "0,10,2.5\n0.01,11,1,2\n0.02,12,4\n"),
               Contains("log.csv:3:12: read 4 cells, expected 3"));
    CHECK_THAT(complaint(head + "0,10,2.5\n0.01,11,1\n0.0"),
               Contains("log.csv:4:4: read 1 cells, expected 3; the last line is cut off"));
    CHECK_THAT(complaint(head + "0,10,2.5\n0.02,11,1\n0.01,12,4\n"),
               Contains("log.csv:4:1: read the time 0.01 after 0.02, expected time to run forward"));
    CHECK_THAT(complaint(head + "0,10,2.5\n0.01,11,\"1\n0.02,12,4\n"),
               Contains("log.csv:3:9") && Contains("quote"));
    CHECK_THAT(complaint(head + "0,10,2.5\n0.01,11,1 2\n0.02,12,4\n"), Contains("read '1 2'"));
    CHECK_THAT(complaint(head + "0,10,2.5\n0.01,11,0x1F\n0.02,12,4\n"), Contains("read '0x1F'"));
}

TEST_CASE("a broken file is refused with one sentence", "[log]") {
    CHECK_THAT(complaint(""), Contains("log.csv: read an empty file, expected rows of numbers"));
    CHECK_THAT(complaint(head), Contains("log.csv:1: read only a header"));
    CHECK_THAT(complaint("time,velocity,torque\ns,deg/s,Nm\n"), Contains("only a header"));
    CHECK_THAT(complaint("\n\n# nothing\n"), Contains("without a row of numbers"));
    CHECK_THAT(complaint(std::string("\x7f"
                                     "ELF\x02\x01\x01\x00\x00\x00",
                                     10)),
               Contains("read the byte 0x02, expected text"));
    CHECK_THAT(complaint(std::string("time_s,velocity_deg_s,torque_nm\n0,10,\0\n", 39)),
               Contains("log.csv:2:6: read the byte 0x00"));
    CHECK_THAT(complaint("\xff\xfet\0i\0m\0e\0"), Contains("UTF-16") && Contains("iconv"));
    CHECK_THAT(complaint("time_s,velocity_deg_s,torque_nm\r0,1,2\r1,1,2\r"),
               Contains("CR alone") && Contains("tr '"));
    CHECK_THAT(complaint("PK\x03\x04"), Contains("ZIP"));
    CHECK_THAT(complaint("time_s,velocity_deg_s,torque_nm\n0,1,2\n1,2\n"), Contains("cells, expected"));
    CHECK_THAT(complaint("a sentence, that is no log\nand another one here\nand one more\n"),
               Contains("expected numbers"));
    CHECK_THAT(complaint("time_s,velocity_deg_s\n0,1\n1,2\n"),
               Contains("expected a torque column") && Contains("--columns torque=NAME"));
    CHECK_THAT(complaint("time_s,velocity_deg_s,torque_nm\n5,1,2\n5,1,2\n"),
               Contains("time does not advance"));
    CHECK_THAT(complaint("time_s,0.5,torque_nm\n0,10,2.5\n0.01,11,-0.25\n"),
               Contains("half names and half numbers"));
}

TEST_CASE("a unit that does not measure what the column is refused", "[log]") {
    CHECK_THAT(complaint("time_s,velocity [kg],torque_nm\n0,1,2\n1,2,3\n"),
               Contains("'velocity [kg]' (column 2) in 'kg'") && Contains("deg/s") &&
                   Contains("--unit velocity=deg/s"));
    CHECK_THAT(complaint("time_s,velocity [m/s],torque_nm\n0,1,2\n1,2,3\n"),
               Contains("'velocity [m/s]' (column 2) in m/s") && Contains("--lead 5mm"));
    CHECK_THAT(complaint("time_s,velocity_deg_s,torque [V]\n0,1,2\n1,2,3\n"), Contains("in V"));
    ReadOptions options;
    options.units["velocity"] = "furlong";
    CHECK_THROWS_AS(read_text(head + "0,1,2\n1,2,3\n", options), UsageError);
    ReadOptions unknown;
    unknown.units["sped"] = "deg/s";
    CHECK_THROWS_WITH(read_text(head + "0,1,2\n1,2,3\n", unknown), Contains("'sped'"));
}

TEST_CASE("damage after the part that was looked at first is found as well", "[log]") {
    std::string rows = head;
    for (int row = 0; rows.size() < 200000; ++row) rows += std::to_string(row / 1000.0) + ",10,2.5\n";
    CHECK_THAT(complaint(rows + "1000,10,\x01\n1000,10,1\n"), Contains("byte 0x01"));
    CHECK_THAT(complaint(rows + std::string(3 << 20, '7') + "\n"), Contains("more than 1 MiB"));
    CHECK_THAT(complaint(rows + "EOF\n1000,10,1\n"), Contains("EOF"));
    CHECK_THAT(complaint(rows + "1000,10"), Contains("cut off"));
    CHECK_THAT(complaint(head + std::string(20 << 20, '7')), Contains("log.csv:2"));
}

// Packed logs that are damaged on the way: what came before, and what is said, do not depend on the pieces in
// which the bytes arrive. Their blocks are stored as they are, so that they can be written by hand, or are
// the few bytes to which programs pack many equal rows.

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

// Logs of every dialect with a few bytes changed: vectors, the plain parser, the careful way and small pieces
// give the same rows or the same words. The fuzz targets do the same for hours.

namespace {

std::string log_of(std::mt19937& random) {
    const auto below = [&](std::size_t most) { return random() % most; };
    const char delimiter = std::array{',', ';', '\t', ' '}[below(4)];
    const char mark = delimiter == ';' && below(2) == 0 ? ',' : '.';
    const std::string end = std::array{"\n", "\r\n"}[below(2)];
    std::string text = below(5) == 0 ? "" : "time_s,velocity_deg_s,torque_nm,note" + end;
    const std::size_t rows = 20 + below(150);
    for (std::size_t k = 0; k < rows; ++k) {
        text += fmt::format("0.{:03d},{}.5,{}{}.25,n{}{}", k, below(100), below(2) == 0 ? "-" : "", below(10),
                            k, end);
    }
    for (char& c : text)
        if (c == ',') c = delimiter;
    for (std::size_t i = 1; i + 1 < text.size(); ++i)
        if (text[i] == '.') text[i] = mark;
    return text;
}

void mutate(std::string& text, std::mt19937& random) {
    constexpr std::string_view pieces[] = {
        "\"",   "#", "\n", "\r\n",  ",",         ";",    "\t", " ",  "\x1b", std::string_view("\0", 1), "nan",
        "1e31", "-", "1e", "EOF\n", "# 1,2,3\n", "\n\n", "%",  "//", "\xff", "12345678901234567890",    "é"};
    for (std::size_t changes = 1 + random() % 3; changes > 0; --changes) {
        const std::size_t at = random() % text.size();
        const std::string_view piece = pieces[random() % std::size(pieces)];
        switch (random() % 3) {
            case 0:
                text.replace(at, std::min(piece.size(), text.size() - at), piece);
                break;
            case 1:
                text.insert(at, piece);
                break;
            default:
                text.erase(at, 1 + random() % 12);
        }
    }
}

/// The same rows, or the same words, by vectors, plainly, carefully and in pieces.
void check_every_way(const std::string& text, const ReadOptions& options) {
    INFO(text);
    const std::string usual = fuzz::reading(text, options, text.size() + 1);
    {
        const NarrowVectors narrow;
        CHECK(fuzz::reading(text, options, text.size() + 1) == usual);
    }
    {
        const CarefulRows careful;
        CHECK(fuzz::reading(text, options, text.size() + 1) == usual);
    }
    for (const std::size_t piece : {1U, 7U, 100U}) CHECK(fuzz::reading(text, options, piece) == usual);
}

}  // namespace

TEST_CASE("a time of -0 is one however it is read", "[log]") {
    const std::string head = "time_s,velocity_deg_s,torque_nm,note\n";
    const std::string rest = "0.001,60,1,x\n0.002,60,2,x\n0.003,60,3,x\n";
    for (const std::string first : {"-0.000,60,0,x\n", "\"-0.000\",60,0,x\n", "-0e5,60,0,\"x\"\n"}) {
        check_every_way(head + first + rest, {});
        const auto reader = open_log(
            std::make_unique<ByteSource>("log", std::make_shared<const std::string>(head + first + rest)),
            {});
        RowBlock block;
        REQUIRE(reader->next(block));
        CHECK(std::signbit(block.time_s.front()));
    }
}

// Found by the fuzz target of logs: a time of -0 in a row, and bytes in the last that are no text.
TEST_CASE("a log that the careful and the quick way once took differently", "[log]") {
    check_every_way(
        "time_s\tvelocity_deg_s\ttorque_nm\tnote\r-.000\t60.5\t-0.25\tx\r0.001\t60.05\t-0.25\tx\r"
        "0.022\t60.5\t-\xff\xff"
        "0.2\xff\xff\xff\xff\xff"
        "5\r",
        fuzz::options_of(1));
}

// Found by the same target: "sep=" and a carriage return stated the line's own end as the separator.
TEST_CASE("a line's end is no separator", "[log]") {
    check_every_way("SEP=\r\r\n0\r\r\n0.0EP\"0\r\r\n0.0EP=\r\r\n0\r\r\n" + std::string(25, '\xff') +
                        "0.1c=\r\r\n0\r\n\r0.1cur\r0",
                    fuzz::options_of(13));
    CHECK(fuzz::reading("sep=\r\r\ntime_s\rvelocity_deg_s\n0\r60\n0.001\r60\n", fuzz::options_of(1), 1000)
              .back() != '|');
}

TEST_CASE("mutated logs read the same way by vectors, plainly, carefully and in pieces", "[log]") {
    constexpr std::size_t whole = std::string::npos;
    std::mt19937 random(11);
    std::size_t read = 0;
    const std::size_t rounds = 1500;
    for (std::size_t i = 0; i < rounds; ++i) {
        std::string text = log_of(random);
        mutate(text, random);
        const ReadOptions options = fuzz::options_of(static_cast<unsigned>(random() % 24));
        const std::string usual = fuzz::reading(text, options, whole);
        read += usual.back() == '|' ? 1U : 0U;
        INFO(text);
        {
            const NarrowVectors narrow;
            REQUIRE(fuzz::reading(text, options, whole) == usual);
        }
        const std::string rows = fuzz::reading(text, options, text.size() + 1);
        {
            const CarefulRows careful;
            REQUIRE(fuzz::reading(text, options, text.size() + 1) == rows);
        }
        REQUIRE(fuzz::reading(text, options, 1 + random() % 100) == rows);
    }
    CHECK(read > rounds / 10);  // the others are refused
}
