// SPDX-License-Identifier: MIT
// Logs, text and arrays: read by vectors, by the plain parser, by the careful way and in small pieces, all
// must give the same rows or the same words. A run compares two of them.
#include "core/vectors/lanes.hpp"
#include "fuzz/fuzz.hpp"
#include "fuzz/reading.hpp"
#include "log/text/quick_rows.hpp"

using namespace ripplenotch;
using namespace ripplenotch::fuzz;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    Bytes input(data, size);
    const ReadOptions options = options_of(input.choice(24));
    const std::size_t piece = 1 + input.choice(200);
    const unsigned way = input.choice(3);
    // Blanks behind the last cell belong to the row for the quick ways alone, so that places are compared
    // between vectors and the plain parser only.
    const std::size_t whole = way == 0 ? std::string::npos : size + 1;
    const std::string usual = reading(input.rest(), options, whole);
    if (way == 0) {
        const NarrowVectors plain;
        const std::string other = reading(input.rest(), options, whole);
        if (other != usual) fail("vectors and the plain parser differ", usual, other);
    } else if (way == 1) {
        const CarefulRows careful;
        const std::string other = reading(input.rest(), options, whole);
        if (other != usual) fail("the quick and the careful way differ", usual, other);
    } else {
        const std::string pieces = reading(input.rest(), options, piece);
        if (pieces != usual) fail("pieces and the whole differ", usual, pieces);
    }
    return 0;
}
