// SPDX-License-Identifier: MIT
// Logs, text and arrays: read by vectors, by the plain parser, by the careful way and in small pieces, all
// must give the same rows or the same words.
#include "core/vectors/dispatch.hpp"
#include "fuzz/fuzz.hpp"
#include "fuzz/reading.hpp"
#include "log/text/quick_rows.hpp"

using namespace ripplenotch;
using namespace ripplenotch::fuzz;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    Bytes input(data, size);
    const ReadOptions options = options_of(input.choice(24));
    const std::size_t piece = 1 + input.choice(200);
    constexpr std::size_t whole = std::string::npos;
    const std::string usual = reading(input.rest(), options, whole);
    {
        const NarrowVectors plain;
        const std::string other = reading(input.rest(), options, whole);
        if (other != usual) fail("vectors and the plain parser differ", usual, other);
    }
    // Blanks behind the last cell belong to the row for the quick ways alone, so that places are not
    // compared.
    const std::string at_once = reading(input.rest(), options, size + 1);
    {
        const CarefulRows careful;
        const std::string other = reading(input.rest(), options, size + 1);
        if (other != at_once) fail("the quick and the careful way differ", at_once, other);
    }
    const std::string pieces = reading(input.rest(), options, piece);
    if (pieces != at_once) fail("pieces and the whole differ", at_once, pieces);
    return 0;
}
