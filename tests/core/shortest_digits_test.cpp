// SPDX-License-Identifier: MIT
// The shortest text of usual numbers is that of the formatting library, byte for byte.
#include "core/text/number.hpp"

#include <bit>
#include <cmath>
#include <cstdint>
#include <random>
#include <string_view>
#include <vector>

#include "ripplenotch/core/number.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;

namespace {

/// Doubles from 2^-14 to 2^27, of both signs: any bits; few bits, whose scaled halves are ties; bits near a
/// power of two; short decimals and their neighbours.
class UsualNumbers {
  public:
    explicit UsualNumbers(std::uint64_t seed) : engine_(seed) {}

    double next() {
        const std::uint64_t all = (std::uint64_t{1} << 52) - 1, mantissa = engine_() & all;
        switch (kind_++ % 8) {
            case 0:
                return with(mantissa & ~std::uint64_t{0} << engine_() % 53);
            case 1:
                return with(engine_() % 8);
            case 2:
                return with(all - engine_() % 8);
            case 3:
                return short_decimal(mantissa);
            case 4:
                return std::nextafter(short_decimal(mantissa), 1e9);
            case 5:
                return std::nextafter(short_decimal(mantissa), -1e9);
            default:
                return with(mantissa);
        }
    }

  private:
    double with(std::uint64_t mantissa) {
        const std::uint64_t exponent = 1023 - 14 + engine_() % 42, sign = engine_() << 63;
        return std::bit_cast<double>(sign | exponent << 52 | mantissa);
    }
    double short_decimal(std::uint64_t mantissa) {
        const double scale = std::pow(10.0, static_cast<double>(engine_() % 10));
        return std::round(with(mantissa) * scale) / scale;
    }

    std::mt19937_64 engine_;
    std::uint64_t kind_ = 0;
};

std::string_view usual(std::vector<char>& room, double value) {
    char* const end = put_usual_shortest(room.data(), value);
    return end == nullptr ? std::string_view() : std::string_view(room.data(), end);
}

struct Count {
    std::size_t taken = 0, wrong = 0;
};

Count compare(std::uint64_t seed, std::size_t count) {
    UsualNumbers numbers(seed);
    std::vector<char> room(32);
    Count counted;
    for (std::size_t i = 0; i < count; ++i) {
        const double value = numbers.next();
        const std::string_view text = usual(room, value);
        if (text.empty()) continue;
        ++counted.taken;
        if (text == shortest(value)) continue;
        ++counted.wrong;
        UNSCOPED_INFO(text << " for " << shortest(value));
    }
    return counted;
}

}  // namespace

TEST_CASE("the shortest text of usual numbers is the formatting library's") {
    const Count counted = compare(3, 1500000);
    CHECK(counted.wrong == 0);
    CHECK(counted.taken > 1200000);
}

// The same for half a minute: ctest leaves it out, `test_core "[.kernels]"` runs it.
TEST_CASE("the shortest text of forty million usual numbers is the formatting library's", "[.kernels]") {
    for (std::uint64_t seed = 10; seed < 50; ++seed) CHECK(compare(seed, 1000000).wrong == 0);
}

TEST_CASE(
    "a tie of two shortest texts goes to the even digit, signs and whole numbers are as they are written") {
    std::vector<char> room(32);
    CHECK(usual(room, 3.0 + std::pow(2.0, -17)) == "3.0000076293945312");
    CHECK(usual(room, 3.0 + 3.0 * std::pow(2.0, -17)) == "3.0000228881835938");
    CHECK(usual(room, -3.0) == "-3");
    CHECK(usual(room, 30.0) == "30");
    CHECK(usual(room, 67108863.5) == "67108863.5");
    CHECK(usual(room, 0.1) == "0.1");
    CHECK(usual(room, -0.30000000000000004) == "-0.30000000000000004");
    CHECK(usual(room, 0.00012207031250000003) == "0.00012207031250000003");
}

TEST_CASE("numbers out of the usual range, powers of two and what is no number are left to the library") {
    std::vector<char> room(32);
    for (const double value :
         {0.0, -0.0, 1.0, -0.25, 1e-4, 67108864.5, 1e300, 5e-324, HUGE_VAL, std::nan("")})
        CHECK(put_usual_shortest(room.data(), value) == nullptr);
}
