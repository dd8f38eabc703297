// SPDX-License-Identifier: MIT
// Logs of every dialect with a few bytes changed: vectors, the plain parser, the careful way and small pieces
// give the same rows or the same words. The fuzz targets do the same for hours.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "core/vectors/dispatch.hpp"
#include "fuzz/reading.hpp"
#include "log/text/quick_rows.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;

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
