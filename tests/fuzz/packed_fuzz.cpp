// SPDX-License-Identifier: MIT
// Compressed files, found by their first bytes: what comes out, and what is said of damage, is the same from
// a pipe in pieces as at once. One in eight is read as a log; what the bytes of the others say is
// logs_fuzz.cpp's.
#include <algorithm>
#include <array>

#include "fuzz/fuzz.hpp"
#include "fuzz/reading.hpp"
#include "log/detect_format.hpp"
#include "log/read_on.hpp"
#include "log/unpack/unpacked_source.hpp"

using namespace ripplenotch;
using namespace ripplenotch::fuzz;

namespace {

// What comes out, as far as it is looked at: few bytes may hold many.
std::string unpacked(std::string_view bytes, std::size_t piece) {
    constexpr std::size_t most = std::size_t{1} << 18;
    std::string out;
    const std::string answer = answer_of([&] {
        auto source = std::make_unique<ByteSource>("log", std::make_shared<const std::string>(bytes), piece);
        std::string first_bytes;
        first_bytes.resize(read_on(*source, first_bytes, 0, first_bytes_size));
        const Packing* const packing = packing_of(first_bytes);
        if (packing == nullptr) return;
        const auto log = unpack(std::move(source), std::move(first_bytes), *packing);
        std::array<char, 4096> room;
        for (std::size_t got = 1; got > 0 && out.size() < most; out.append(room.data(), got))
            got = log->read(room.data(), std::min(room.size(), most - out.size()));
    });
    return out + "|" + answer;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    Bytes input(data, size);
    const bool as_log = input.choice(8) == 0;
    const std::size_t piece = 1 + input.choice(200);
    const auto taken = [&](std::size_t most) {
        return as_log ? reading(input.rest(), {}, most) : unpacked(input.rest(), most);
    };
    const std::string at_once = taken(size + 1), pieces = taken(piece);
    if (pieces != at_once) fail("pieces and the whole differ", at_once, pieces);
    return 0;
}
