// SPDX-License-Identifier: MIT
// One reader of containers, named by FUZZ_FORMAT when this is compiled: from a pipe in pieces it must give
// the same rows, or the same words, as at once.
#include "fuzz/fuzz.hpp"
#include "fuzz/reading.hpp"

using namespace ripplenotch;
using namespace ripplenotch::fuzz;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    Bytes input(data, size);
    ReadOptions options = options_of(input.choice(6));
    const std::size_t piece = 1 + input.choice(200);
    options.format = FUZZ_FORMAT;
    options.records = "f8:time_s,<i2*0.01:velocity_deg_s,x2,>f4:torque_nm";
    const std::string at_once = reading(input.rest(), options, size + 1);
    const std::string pieces = reading(input.rest(), options, piece);
    if (pieces != at_once) fail("pieces and the whole differ", at_once, pieces);
    return 0;
}
