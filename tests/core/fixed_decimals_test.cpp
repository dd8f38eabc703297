// SPDX-License-Identifier: MIT
// Numbers with fixed decimals have the bytes of printf.
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "ripplenotch/core/number.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;

namespace {

/// Numbers of all sizes that `decimals` digits make hard to print: random ones, short ones, ties, powers of
/// ten of the last digit give or take a half, whole multiples of 1e8 of it, any bits at all.
class HardNumbers {
  public:
    HardNumbers(std::uint64_t seed, int decimals) : engine_(seed), unit_(std::pow(10.0, -decimals)) {}

    double next() {
        const double random = mantissa_(engine_) * std::pow(10.0, std::floor(exponent_(engine_)));
        switch (kind_++ % 8) {
            case 0:
                return std::round(random * 1000.0) / 1000.0;
            case 1:
                return (std::round(random) + 0.5) / std::pow(2.0, digits_(engine_));
            case 2:
                return near((power_of_ten() + digits_(engine_) - 3.0) * unit_);
            case 3:
                return near((power_of_ten() - 0.5) * unit_);
            case 4:
                return near((std::round(random) * 1e8 + digits_(engine_) / 2.0) * unit_);
            case 5:
                return any_bits();
            default:
                return random;
        }
    }

  private:
    double power_of_ten() { return std::pow(10.0, 2 * digits_(engine_)); }
    double any_bits() { return digits_(engine_) == 0 ? std::bit_cast<double>(engine_()) : small_(engine_); }
    /// The number, one of its neighbours, or one of these with the other sign.
    double near(double value) {
        const std::uint64_t way = engine_() % 6;
        if (way % 3 == 1) value = std::nextafter(value, 1e300);
        if (way % 3 == 2) value = std::nextafter(value, -1e300);
        return way < 3 ? value : -value;
    }

    std::mt19937_64 engine_;
    double unit_;
    std::uint64_t kind_ = 0;
    std::uniform_real_distribution<double> exponent_{-9.0, 18.0}, mantissa_{-10.0, 10.0}, small_{-3.0, 3.0};
    std::uniform_int_distribution<int> digits_{0, 8};
};

/// printf may write the sign of what is not a number, or not: there it is the formatting library's.
std::string expected(double value, int decimals) {
    if (std::isnan(value)) return fmt::format("{:.{}f}", value, decimals);
    char text[400];
    return {text, text + std::snprintf(text, sizeof text, "%.*f", decimals, value)};
}

/// Those whose text is another than printf's.
std::size_t misprinted(const std::vector<double>& values, int decimals) {
    std::vector<char> text(number_room);
    std::size_t wrong = 0;
    for (const double value : values) {
        const std::string_view put(text.data(), put_fixed(text.data(), value, decimals));
        if (put == expected(value, decimals)) continue;
        UNSCOPED_INFO(put << " for " << value << " with " << decimals << " decimals");
        ++wrong;
    }
    return wrong;
}

/// `count` numbers of each number of decimals.
void check_numbers(std::uint64_t seed, std::size_t count) {
    for (int decimals = 0; decimals <= 17; ++decimals) {
        HardNumbers numbers(seed + static_cast<std::uint64_t>(decimals), decimals);
        std::vector<double> values(count);
        std::generate(values.begin(), values.end(), [&] { return numbers.next(); });
        CHECK(misprinted(values, decimals) == 0);
    }
}

}  // namespace

TEST_CASE("numbers with fixed decimals are printf's, whatever their size and their decimals") {
    check_numbers(23, 35000);
}

// The same for half a minute: ctest leaves it out, `test_core "[.kernels]"` runs it.
TEST_CASE("forty million numbers with fixed decimals are printf's", "[.kernels]") {
    for (std::uint64_t seed = 1000; seed < 10000; seed += 1000) check_numbers(seed, 250000);
}

TEST_CASE("ties, signs, zeros and what is no number are printed as printf does") {
    const double infinity = std::numeric_limits<double>::infinity();
    std::vector<double> values = {
        0.0,      -0.0,      0.5,          1.5,     2.5,    -0.5,
        0.125,    0.375,     -1e-9,        -0.4999, 5e-324, -2.2250738585072014e-308,
        infinity, -infinity, std::nan(""), 1e15,    1e16,   1e300};
    for (const double digits : {1e8, 1e14})
        for (const double unit : {1.0, 1e-3, 1e-6, 1e-7, 1e-8, 1e-9, 1e-13})
            for (const double off : {-1.5, -1.0, -0.5, -0.4999, 0.0, 0.4999, 0.5, 1.0})
                values.push_back((digits + off) * unit);
    for (const double divisor : {1.0, 1e-3, -1.0, 0.11298482902761668}) {
        std::vector<double> quotients;
        for (const double value : values) quotients.push_back(value / divisor);
        for (int decimals = 0; decimals <= 17; ++decimals) CHECK(misprinted(quotients, decimals) == 0);
    }
}
