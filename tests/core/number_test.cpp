#include "ripplenotch/core/number.hpp"

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <random>
#include <vector>

#include "support/catch.hpp"

using namespace ripplenotch;

TEST_CASE("shortest text reads back as the same double, bit for bit") {
    std::mt19937_64 engine(7);
    for (int i = 0; i < 200000; ++i) {
        const std::uint64_t bits = engine();
        double value = 0.0;
        std::memcpy(&value, &bits, sizeof value);
        if (!std::isfinite(value)) continue;
        const auto back = parse_number(shortest(value));
        REQUIRE(back.has_value());
        std::uint64_t back_bits = 0;
        std::memcpy(&back_bits, &*back, sizeof back_bits);
        REQUIRE(back_bits == bits);
    }
}

TEST_CASE("a number fills its text or is refused") {
    CHECK(parse_number("1.5") == 1.5);
    CHECK(parse_number("+1.5") == 1.5);
    CHECK(parse_number("-.5e1") == -5.0);
    CHECK(parse_number("1,5", ',') == 1.5);
    CHECK(std::isnan(parse_number("nan").value()));
    CHECK(std::isinf(parse_number("-inf").value()));
    for (const char* junk :
         {"", "+", "-", "1.5 ", " 1.5", "1.5x", "1,5", "0x10", "+-1", "--1", "1e999", "e5", "."}) {
        INFO(junk);
        CHECK_FALSE(parse_number(junk).has_value());
    }
    CHECK_FALSE(parse_number("1.5", ',').has_value());
}

TEST_CASE("fixed decimals round as printf does") {
    std::string out;
    append_fixed(out, -0.0005, 3);
    out += ' ';
    append_fixed(out, 2.5, 0);
    out += ' ';
    append_fixed(out, 1e15 + 0.3, 1);
    char expected[80];
    std::snprintf(expected, sizeof expected, "%.3f %.0f %.1f", -0.0005, 2.5, 1e15 + 0.3);
    CHECK(out == expected);
}

/// Numbers, of `count`, whose fixed decimals are not those of printf or whose shortest text reads back as
/// another.
std::size_t misprinted(std::uint64_t seed, std::size_t count) {
    std::mt19937_64 engine(seed);
    std::uniform_real_distribution<double> exponent(-9.0, 18.0), mantissa(-10.0, 10.0);
    std::uniform_int_distribution<int> digits(0, 10);
    std::vector<char> text(number_room);
    char expected[400];
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < count; ++i) {
        double value = mantissa(engine) * std::pow(10.0, std::floor(exponent(engine)));
        const int decimals = digits(engine);
        if (i % 4 == 1) value = std::round(value * 1000.0) / 1000.0;
        if (i % 4 == 2) value = (std::round(value) + 0.5) / std::pow(2.0, digits(engine));
        if (i % 16 == 3) value = std::bit_cast<double>(engine());  // any exponent, subnormal, infinite, none
        const int size = std::snprintf(expected, sizeof expected, "%.*f", decimals, value);
        const char* const end = put_fixed(text.data(), value, decimals);
        const bool same =
            std::string_view(text.data(), end) == std::string_view(expected, static_cast<std::size_t>(size));
        const auto again = parse_number({text.data(), put_shortest(text.data(), value)});
        const bool back =
            again && std::bit_cast<std::uint64_t>(*again) == std::bit_cast<std::uint64_t>(value);
        // printf writes the sign of a nan, the formatting library does too; which nan is of no interest.
        wrong += (same && back) || std::isnan(value) ? 0 : 1;
    }
    return wrong;
}

TEST_CASE("numbers in all decimals are printf's, and shortest ones read back", "[core]") {
    CHECK(misprinted(5, 200000) == 0);
}

// The same for half a minute: ctest leaves it out, `test_core "[.kernels]"` runs it.
TEST_CASE("thirty million numbers in all decimals are printf's", "[.kernels]") {
    for (std::uint64_t seed = 100; seed < 130; ++seed) CHECK(misprinted(seed, 1000000) == 0);
}

TEST_CASE("appended numbers are those of the formatting library and of printf, digit for digit") {
    std::mt19937_64 engine(19);
    std::uniform_real_distribution<double> exponent(-9.0, 18.0), mantissa(-10.0, 10.0);
    std::uniform_int_distribution<int> digits(0, 10);
    char expected[80];
    for (int i = 0; i < 300000; ++i) {
        double value = mantissa(engine) * std::pow(10.0, std::floor(exponent(engine)));
        const int decimals = digits(engine);
        // Also numbers with few digits, and halves of the last digit, which are ties for printf.
        if (i % 3 == 1) value = std::round(value * 1000.0) / 1000.0;
        if (i % 3 == 2) value = (std::round(value) + 0.5) / std::pow(2.0, digits(engine));
        std::string out;
        append_shortest(out, value);
        REQUIRE(out == shortest(value));
        out.clear();
        append_fixed(out, value, decimals);
        std::snprintf(expected, sizeof expected, "%.*f", decimals, value);
        REQUIRE(out == expected);
    }
    for (const double special :
         {0.0, -0.0, 1e-4, 1e-5, 9999999999999998.0, 1e16, -1.0, 5e-324, 1.7976931348623157e308}) {
        std::string out;
        append_shortest(out, special);
        CHECK(out == shortest(special));
    }
    std::string out;
    append_fixed(out, -0.0, 2);
    append_fixed(out, -1e-9, 3);
    CHECK(out == "-0.00-0.000");
}

TEST_CASE("a figure for people that rounds to zero has no sign") {
    CHECK(rounded(-0.04, 1) == "0.0");
    CHECK(rounded(-0.06, 1) == "-0.1");
    CHECK(rounded(-0.0, 0) == "0");
    CHECK(rounded(127.27, 1) == "127.3");
}

TEST_CASE("a value has as many decimals as its error has two digits") {
    CHECK(with_error(0.59983, 0.00241) == "0.5998 +/- 0.0024");
    CHECK(with_error(0.7993, 0.002) == "0.7993 +/- 0.0020");
    CHECK(with_error(0.43214, 0.21) == "0.43 +/- 0.21");
    CHECK(with_error(-12.3456, 3.7) == "-12.3 +/- 3.7");
    CHECK(with_error(1234.5, 35.0) == "1234 +/- 35");
    CHECK(with_error(-0.001, 0.2) == "0.00 +/- 0.20");
    CHECK(with_error(1.23456e-9, 2.1e-11) == "1.235e-09 +/- 2.1e-11");
    CHECK(with_error(1.23456e6, 3.5e4) == "1.235e+06 +/- 3.5e+04");
    CHECK(with_error(2.0, 0.0) == "2 +/- 0");
    CHECK(decimals_of(0.003, 1) == 3);
    CHECK(decimals_of(30.0, 1) == 0);
}
