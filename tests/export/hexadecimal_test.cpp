// SPDX-License-Identifier: MIT
// Hexadecimal literals, worked by hand: C99 6.4.4.2 gives the form, IEEE 754 the fields.
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <random>

#include "export/text.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;

TEST_CASE("doubles of every kind are written as worked by hand") {
    CHECK(hexadecimal(0.0) == "0x0p+0");
    CHECK(hexadecimal(-0.0) == "-0x0p+0");
    CHECK(hexadecimal(1.0) == "0x1p+0");
    CHECK(hexadecimal(-2.0) == "-0x1p+1");
    CHECK(hexadecimal(0.5) == "0x1p-1");
    CHECK(hexadecimal(10.0) == "0x1.4p+3");             // 1.25 * 8
    CHECK(hexadecimal(0.1) == "0x1.999999999999ap-4");  // 1.6 / 16, rounded up in the last digit
    CHECK(hexadecimal(1.0 + 0x1p-52) == "0x1.0000000000001p+0");
    CHECK(hexadecimal(std::numeric_limits<double>::max()) == "0x1.fffffffffffffp+1023");
    CHECK(hexadecimal(std::numeric_limits<double>::min()) == "0x1p-1022");
    CHECK(hexadecimal(std::numeric_limits<double>::min() / 2) == "0x0.8p-1022");
    CHECK(hexadecimal(-std::numeric_limits<double>::denorm_min()) == "-0x0.0000000000001p-1022");
}

TEST_CASE("floats are written as worked by hand: each is a normal double") {
    CHECK(hexadecimal_float(0.0) == "0x0p+0f");
    CHECK(hexadecimal_float(-0.0) == "-0x0p+0f");
    CHECK(hexadecimal_float(0.1) == "0x1.99999ap-4f");
    CHECK(hexadecimal_float(std::numeric_limits<float>::max()) == "0x1.fffffep+127f");
    CHECK(hexadecimal_float(std::numeric_limits<float>::min()) == "0x1p-126f");
    CHECK(hexadecimal_float(std::numeric_limits<float>::denorm_min()) == "0x1p-149f");
    CHECK(hexadecimal_float(3e-40) == "0x1.a2238p-132f");  // 214087 = 0x34447 times the smallest
}

TEST_CASE("every finite double reads back from its hexadecimal literal, bit for bit") {
    std::mt19937_64 random(13);
    for (int exponent = 0; exponent < 2047; ++exponent) {
        for (int shift = 0; shift <= 52; shift += 4) {
            const std::uint64_t bits = (random() & 0x8000'0000'0000'0000U) |
                                       (static_cast<std::uint64_t>(exponent) << 52U) |
                                       ((random() >> 12U) >> shift << shift);
            const double value = std::bit_cast<double>(bits);
            const std::string text = hexadecimal(value);
            INFO(text);
            REQUIRE(std::bit_cast<std::uint64_t>(std::strtod(text.c_str(), nullptr)) == bits);
        }
    }
}
