// SPDX-License-Identifier: MIT
// Numbers printed side by side have the bytes of printf, on every instruction set, whoever their neighbours
// are.
#include "core/text/print_fixed.hpp"

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
#include "support/vectors.hpp"

using namespace ripplenotch;
using namespace ripplenotch::testing;

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

std::string expected(double value, int decimals, char mark) {
    char text[400];
    // printf may write the sign of what is not a number, or not: the way without vectors is the measure.
    char* const end = std::isnan(value) ? put_fixed(text, value, decimals)
                                        : text + std::snprintf(text, sizeof text, "%.*f", decimals, value);
    std::replace(text, end, '.', mark);
    return {text, end};
}

/// Those whose text is another than printf's.
std::size_t misprinted(const std::vector<double>& values, double divisor, int decimals, bool wide,
                       char mark = '.') {
    const Width here(wide);
    FixedTexts texts(mark);
    std::vector<char> text(number_room);
    std::size_t wrong = 0;
    texts.prepare(values, divisor, decimals);
    for (std::size_t i = 0; i < values.size(); ++i) {
        const std::string_view put(text.data(), texts.put(text.data(), i));
        if (put == expected(values[i] / divisor, decimals, mark)) continue;
        UNSCOPED_INFO(put << " for " << values[i] / divisor << " with " << decimals << " decimals");
        ++wrong;
    }
    return wrong;
}

/// `batches` of each number of decimals, of all lengths.
void check_batches(std::uint64_t seed, std::size_t batches, bool wide) {
    for (int decimals = 0; decimals <= 17; ++decimals) {
        HardNumbers numbers(seed + static_cast<std::uint64_t>(decimals), decimals);
        std::size_t wrong = 0;
        for (std::size_t batch = 0; batch < batches; ++batch) {
            std::vector<double> values(batch < 18 ? batch : FixedTexts::most - batch % 4);
            std::generate(values.begin(), values.end(), [&] { return numbers.next(); });
            wrong += misprinted(values, 1.0, decimals, wide);
        }
        CHECK(wrong == 0);
    }
}

}  // namespace

TEST_CASE("numbers printed side by side are printf's, whatever their decimals and however many they are") {
    for (const bool wide : widths()) check_batches(23, 150, wide);
}

// The same for half a minute: ctest leaves it out, `test_core "[.kernels]"` runs it.
TEST_CASE("forty million numbers printed side by side are printf's", "[.kernels]") {
    for (std::uint64_t seed = 1000; seed < 10000; seed += 1000) check_batches(seed, 1000, true);
}

TEST_CASE("ties, signs, zeros and what is no number are printed side by side as printf does") {
    const double infinity = std::numeric_limits<double>::infinity();
    std::vector<double> values = {
        0.0,      -0.0,      0.5,          1.5,     2.5,    -0.5,
        0.125,    0.375,     -1e-9,        -0.4999, 5e-324, -2.2250738585072014e-308,
        infinity, -infinity, std::nan(""), 1e15,    1e16,   1e300};
    for (const double digits : {1e8, 1e14})
        for (const double unit : {1.0, 1e-3, 1e-6, 1e-7, 1e-8, 1e-9, 1e-13})
            for (const double off : {-1.5, -1.0, -0.5, -0.4999, 0.0, 0.4999, 0.5, 1.0})
                values.push_back((digits + off) * unit);
    for (const bool wide : widths())
        for (int decimals = 0; decimals <= 17; ++decimals)
            for (const double divisor : {1.0, 1e-3, -1.0, 0.11298482902761668})
                CHECK(misprinted(values, divisor, decimals, wide, decimals % 2 == 0 ? '.' : ',') == 0);
}
