// SPDX-License-Identifier: MIT
// Compressed files, found by their first bytes: what comes out, and what is said of damage, is the same from
// a pipe in pieces, into little room, as at once. What the bytes say as a log is for logs_fuzz.cpp.
#include <algorithm>

#include "fuzz/fuzz.hpp"
#include "log/open.hpp"
#include "log/unpack/unpacked_source.hpp"

using namespace ripplenotch;
using namespace ripplenotch::fuzz;

namespace {

// What comes out, as far as it is looked at: few bytes may hold many.
std::string unpacked(std::string_view bytes, std::size_t piece, std::size_t room_size) {
    constexpr std::size_t most = std::size_t{1} << 18;
    std::string out;
    const std::string answer = answer_of([&] {
        auto source = std::make_unique<ByteSource>("log", std::make_shared<const std::string>(bytes), piece);
        std::string first_bytes;
        read_on(*source, first_bytes, first_bytes_size);
        const Packing* const packing = packing_of(first_bytes);
        if (packing == nullptr) return;
        const auto log = unpack(std::move(source), std::move(first_bytes), *packing);
        std::string room(room_size, '\0');
        for (std::size_t got = 1; got > 0 && out.size() < most; out.append(room, 0, got))
            got = log->read(room.data(), std::min(room.size(), most - out.size()));
    });
    return out + "|" + answer;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    Bytes input(data, size);
    const std::size_t room = 16 * (1 + std::size_t{input.choice(256)}), piece = 1 + input.choice(200);
    const std::string at_once = unpacked(input.rest(), size + 1, std::size_t{1} << 16);
    const std::string pieces = unpacked(input.rest(), piece, room);
    if (pieces != at_once) fail("pieces and the whole differ", at_once, pieces);
    return 0;
}
