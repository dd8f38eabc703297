// SPDX-License-Identifier: MIT
// Specifications, and text as people see it.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <complex>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "core/functions/many_numbers.hpp"
#include "core/text/number.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/core/quantity.hpp"
#include "ripplenotch/core/spec.hpp"
#include "ripplenotch/core/visible_text.hpp"
#include "support/catch.hpp"
#include "support/vectors.hpp"

using namespace ripplenotch;
using namespace ripplenotch::testing;
using Catch::Contains;

namespace {
const std::array keys = {
    Key{.name = "cutoff",
        .dimension = Dimension::frequency,
        .required = true,
        .above = 0.0,
        .help = "where it is -3 dB"},
    Key{.name = "order", .default_text = "1", .above = 0.0, .at_most = 20.0, .whole = true},
    Key{.name = "dwell", .dimension = Dimension::time, .at_least = 0.0},
    Key{.name = "counts", .kind = KeyKind::list, .at_least = 1.0, .whole = true},
    Key{.name = "centers", .kind = KeyKind::list, .dimension = Dimension::frequency, .above = 0.0},
    Key{.name = "mode", .default_text = "keep", .choices = "keep reset"},
};
Settings settings(std::string_view text) { return Settings("method lowpass", parse_spec(text), keys); }
}  // namespace

TEST_CASE("a specification gives typed values, lists and defaults") {
    const Settings s = settings("lowpass,cutoff=2kHz,centers=25Hz:50Hz:0.1kHz");
    CHECK(s.number("cutoff") == 2000.0);
    CHECK(s.number("order") == 1.0);
    CHECK(s.list("centers") == std::vector<double>{25.0, 50.0, 100.0});
    CHECK(s.text("mode") == "keep");
    CHECK(s.has("order"));
    CHECK_FALSE(settings("lowpass,cutoff=1").has("centers"));
}

TEST_CASE("what was typed can be typed again") {
    CHECK(parse_spec("lowpass,cutoff=13rad/s,order=1").text() == "lowpass,cutoff=13rad/s,order=1");
}

TEST_CASE("a wrong specification names the piece and the remedy") {
    CHECK_THROWS_WITH(settings("lowpass,cutof=3"), Contains("cutof") && Contains("did you mean cutoff?"));
    CHECK_THROWS_WITH(settings("lowpass"), Contains("needs cutoff") && Contains("-3 dB"));
    CHECK_THROWS_WITH(settings("lowpass,cutoff=0"), Contains("not above 0 Hz"));
    CHECK_THROWS_WITH(settings("lowpass,cutoff=1,order=21"), Contains("limit of 20"));
    CHECK_THROWS_WITH(settings("lowpass,cutoff=1,mode=drop"), Contains("'drop'") && Contains("keep, reset"));
    CHECK_THROWS_WITH(parse_spec("lowpass,cutoff"), Contains("'cutoff' is not KEY=VALUE"));
    CHECK_THROWS_WITH(parse_spec("lowpass,a=1,a=2"), Contains("a is given twice"));
    CHECK_THROWS_WITH(parse_spec("cutoff=3"), Contains("starts with 'cutoff=3'"));
    CHECK_THROWS_AS(parse_spec(""), UsageError);
}

TEST_CASE("a bound may belong to the range, and numbers may have to be whole") {
    CHECK(settings("lowpass,cutoff=1,dwell=0").number("dwell") == 0.0);
    CHECK(settings("lowpass,cutoff=1,counts=1:3").list("counts") == std::vector<double>{1.0, 3.0});
    CHECK_THROWS_WITH(settings("lowpass,cutoff=1,dwell=-1ms"), Contains("dwell: -1ms is below 0 s"));
    CHECK_THROWS_WITH(settings("lowpass,cutoff=1,counts=3:0"), Contains("counts: 0 is below 1"));
    CHECK_THROWS_WITH(settings("lowpass,cutoff=1,order=1.5"), Contains("order: 1.5 is not a whole number"));
    CHECK_THROWS_WITH(settings("lowpass,cutoff=1,counts=1:2.5"), Contains("2.5 is not a whole number"));
}

TEST_CASE("the nearest name is offered only when it is near") {
    const std::vector<std::string> known = {"filter", "identify", "info"};
    CHECK(nearest_name("filtre", known) == "filter");
    CHECK(nearest_name("identfy", known) == "identify");
    CHECK_FALSE(nearest_name("zzz", known).has_value());
}

TEST_CASE("a comma inside brackets separates nothing", "[core]") {
    const Spec spec = parse_spec("tau_rigid[:,1],scale=1,name=log.tau(:,3)");
    CHECK(spec.name == "tau_rigid[:,1]");
    CHECK(spec.values ==
          std::vector<std::pair<std::string, std::string>>{{"scale", "1"}, {"name", "log.tau(:,3)"}});
}

TEST_CASE("text that only shows stays as it is, in any script") {
    for (const std::string text : {"torque Nm", "<script>alert(1)</script>", "Drehmoment größer",
                                   "関節トルク", "a_b^c{d}@e%f", "\"quoted\" 'twice' `id`", "🦾"})
        CHECK(visible_text(text) == text);
}

TEST_CASE("what would act is written out") {
    CHECK(visible_text("a\nb\tc\rd") == "a\\nb\\tc\\rd");
    CHECK(visible_text("\x1b[2J\x07") == "\\x1b[2J\\x07");
    CHECK(visible_text(std::string("a\0b", 3)) == "a\\x00b");
    CHECK(visible_text("\xc2\x9b") == "\\u009b");                    // a control sequence in one character
    CHECK(visible_text("\xe2\x80\xaegpj.exe") == "\\u202egpj.exe");  // turns the direction of writing
    CHECK(visible_text("\xef\xbb\xbfx") == "\\ufeffx");
}

TEST_CASE("bytes that are not UTF-8 are written out one by one") {
    CHECK(visible_text("\xff\xfe") == "\\xff\\xfe");
    CHECK(visible_text("gr\xfc\xdf") == "gr\\xfc\\xdf");
    CHECK(visible_text("\xc0\xaf") == "\\xc0\\xaf");           // a slash in two bytes
    CHECK(visible_text("\xed\xa0\x80") == "\\xed\\xa0\\x80");  // half of a pair
    CHECK(visible_text("\xe2\x82") == "\\xe2\\x82");           // cut short
    CHECK(visible_text("\xf4\x90\x80\x80") == "\\xf4\\x90\\x80\\x80");
}

TEST_CASE("lengths count characters, not bytes") {
    CHECK(text_width("größe") == 5);
    CHECK(cut_to("größe", 5) == "größe");
    CHECK(cut_to("größer", 5) == "größ…");
}

TEST_CASE("lines are broken at blanks, and within a word only when it is too long") {
    CHECK(wrapped("one two three", 8) == std::vector<std::string>{"one two", "three"});
    CHECK(wrapped("eleventwelve x", 6) == std::vector<std::string>{"eleven", "twelve", "x"});
    CHECK(wrapped("", 6) == std::vector<std::string>{""});
    CHECK(wrapped("ääääää", 3) == std::vector<std::string>{"äää", "äää"});
}

TEST_CASE("JSON keeps its value and loses what acts") {
    CHECK(visible_json("{\n  \"a\": \"größer 🦾\"\n}\n") == "{\n  \"a\": \"größer 🦾\"\n}\n");
    CHECK(visible_json("[\"\x7f\xc2\x9b\xe2\x80\xae\xef\xbb\xbf\"]") == "[\"\\u007f\\u009b\\u202e\\ufeff\"]");
    CHECK(visible_json("[\"\xf0\x9f\xbf\xbf\"]") == "[\"\\ud83f\\udfff\"]");  // no character, beyond 16 bits
}

// Numbers as text: read, written, counted in words, with units.

TEST_CASE("shortest text reads back as the same double, bit for bit") {
    std::mt19937_64 engine(7);
    for (int i = 0; i < 200000; ++i) {
        const auto value = std::bit_cast<double>(engine());
        if (!std::isfinite(value)) continue;
        std::string out;
        append_shortest(out, value);
        REQUIRE(out == shortest(value));
        REQUIRE(std::bit_cast<std::uint64_t>(parse_number(out).value()) ==
                std::bit_cast<std::uint64_t>(value));
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

// The shortest text of usual numbers is that of the formatting library, byte for byte.

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

// Numbers with fixed decimals have the bytes of printf.

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
    std::size_t wrong = 0;
    for (const double value : values) {
        std::string put;
        append_fixed(put, value, decimals);
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

namespace {
constexpr double radians = std::numbers::pi / 180.0;
}

TEST_CASE("many phasors at once have the bits of each alone") {
    std::mt19937_64 random(13);
    for (const double reach : {1e-9, 3.0, 1e3, 0x1p20, 1e9}) {
        std::uniform_real_distribution<double> anywhere(-reach, reach);
        for (const std::size_t count : {0u, 1u, 5u, 1000u}) {
            std::vector<double> angles(count), cosines(count), sines(count);
            for (double& value : angles) value = anywhere(random);
            for (std::size_t k = 0; k < count / 8; ++k)
                angles[k] = k % 2 == 0 ? -0.0 : 45.0 * radians * static_cast<double>(k);
            for (const bool wide : widths()) {
                const Width here(wide);
                portable::phasors(angles, cosines, sines);
                for (std::size_t k = 0; k < count; ++k) {
                    CAPTURE(angles[k], wide);
                    const std::complex<double> alone = portable::phasor(angles[k]);
                    CHECK(std::bit_cast<std::uint64_t>(cosines[k]) ==
                          std::bit_cast<std::uint64_t>(alone.real()));
                    CHECK(std::bit_cast<std::uint64_t>(sines[k]) ==
                          std::bit_cast<std::uint64_t>(alone.imag()));
                }
            }
        }
    }
}

TEST_CASE(
    "many exponentials, logarithms, hyperbolic tangents and powers at once have the bits of each alone") {
    std::mt19937_64 random(12);
    const auto same = [](const std::vector<double>& numbers, const std::vector<double>& values, auto one) {
        for (std::size_t k = 0; k < numbers.size(); ++k) {
            CAPTURE(numbers[k]);
            CHECK(std::bit_cast<std::uint64_t>(values[k]) == std::bit_cast<std::uint64_t>(one(numbers[k])));
        }
    };
    for (const double reach : {1e-9, 1.0, 30.0, 699.0, 1e5, 1e300}) {
        std::uniform_real_distribution<double> anywhere(-reach, reach);
        for (const std::size_t count : {0u, 1u, 3u, 4u, 7u, 2000u}) {
            std::vector<double> numbers(count), values(count), sizes(count);
            for (double& value : numbers) value = anywhere(random);
            for (std::size_t k = 0; k < count / 8; ++k)
                numbers[k] = k % 3 == 0 ? -0.0 : 20.0 * static_cast<double>(k % 3);
            for (std::size_t k = 0; k < count; ++k) sizes[k] = std::abs(numbers[k]);
            for (const bool wide : widths()) {
                const Width here(wide);
                portable::exp(numbers, values);
                same(numbers, values, [](double x) { return portable::exp(x); });
                portable::log(sizes, values);
                same(sizes, values, [](double x) { return portable::log(x); });
                portable::tanh(numbers, values);
                same(numbers, values, [](double x) { return portable::tanh(x); });
                for (const double p : {0.1, 0.5, 0.7, 1.0, 2.0, 3.999, -1.5, 7.3}) {
                    portable::pow(sizes, p, values);
                    same(sizes, values, [p](double x) { return portable::pow(x, p); });
                }
            }
        }
    }
    std::vector<double> special = {std::nan(""), HUGE_VAL, -HUGE_VAL, 10.0, 1e-310, 5e-324, -3.0, 1.0};
    std::vector<double> values(special.size());
    for (const double p : {0.3, 2.0}) {
        portable::pow(special, p, values);
        for (std::size_t k = 0; k < special.size(); ++k) {
            const double alone = portable::pow(special[k], p);
            CHECK(((std::isnan(values[k]) && std::isnan(alone)) || values[k] == alone));
        }
    }
}

TEST_CASE("a percentage has two digits and is never an exponent or a negative nought") {
    CHECK(percent_text(99.96) == "100");
    CHECK(percent_text(100.0) == "100");
    CHECK(percent_text(1234.5) == "1234");
    CHECK(percent_text(9.97) == "10");
    CHECK(percent_text(9.94) == "9.9");
    CHECK(percent_text(0.163) == "0.16");
    CHECK(percent_text(0.00046) == "0.00046");
    CHECK(percent_text(-1e-9) == "0");
    CHECK(percent_text(-0.0) == "0");
}

TEST_CASE("one is told in the singular, none and many in the plural") {
    CHECK(how_many(1, "gap") == "1 gap");
    CHECK(how_many(0, "gap") == "0 gaps");
    CHECK(how_many(12, "gap") == "12 gaps");
    CHECK(how_many(1, "change of filter", "changes of filter") == "1 change of filter");
    CHECK(how_many(2, "change of filter", "changes of filter") == "2 changes of filter");
}

TEST_CASE("quantities carry their unit to the base unit") {
    CHECK(parse_quantity("1kHz", Dimension::frequency, "f") == 1000.0);
    CHECK(parse_quantity("13rad/s", Dimension::frequency, "f") ==
          Approx(13.0 / (2.0 * std::numbers::pi)).epsilon(1e-15));
    CHECK(parse_quantity("90deg/s", Dimension::speed, "v") == 90.0);
    CHECK(parse_quantity("0.5236 rad/s", Dimension::speed, "v") ==
          Approx(0.5236 * 57.29577951308232).epsilon(1e-15));
    CHECK(parse_quantity("5rpm", Dimension::speed, "v") == 30.0);
    CHECK(parse_quantity("200ms", Dimension::time, "t") == Approx(0.2).epsilon(1e-15));
    CHECK(parse_quantity("-1.5e3mNm", Dimension::torque, "t") == Approx(-1.5).epsilon(1e-15));
    CHECK(parse_quantity("7", Dimension::torque, "t") == 7.0);
    CHECK(parse_quantity("1234567.891Hz", Dimension::frequency, "f") == 1234567.891);
}

TEST_CASE("milli and mega differ, because units keep their case") {
    CHECK(unit_factor(Dimension::frequency, "mHz") == 1e-3);
    CHECK(unit_factor(Dimension::frequency, "MHz") == 1e6);
    CHECK_FALSE(unit_factor(Dimension::frequency, "hz").has_value());
}

TEST_CASE("a header's rad_s is rad/s, and a torque is no speed") {
    CHECK(unit_factor(Dimension::speed, "rad_s") == unit_factor(Dimension::speed, "rad/s"));
    CHECK_FALSE(unit_factor(Dimension::speed, "Nm").has_value());
}

TEST_CASE("a refused quantity says what was read and what is understood") {
    CHECK(parse_quantity("1e27kNm", Dimension::torque, "--noise") == 1e30);
    for (const char* beyond : {"1e308kNm", "1.1e30", "-1e34mNm", "1e308"}) {
        CHECK_THROWS_WITH(parse_quantity(beyond, Dimension::torque, "--noise"),
                          Contains("--noise: '") && Contains("write a number from -1e+30 to 1e+30"));
    }
    CHECK_THROWS_WITH(parse_quantity("5V", Dimension::frequency, "--cutoff"),
                      Contains("--cutoff") && Contains("'5V'") && Contains("'V'") && Contains("rad/s"));
    CHECK_THROWS_WITH(parse_quantity("fast", Dimension::speed, "--speed"),
                      Contains("'fast'") && Contains("deg/s"));
    for (const char* bad : {"", "nan", "inf", "nanHz", "Hz", "1e", "1.2.3Hz"}) {
        INFO(bad);
        CHECK_THROWS_AS(parse_quantity(bad, Dimension::frequency, "f"), UsageError);
    }
}

TEST_CASE("every unit of every dimension is accepted by its own parser") {
    for (const auto dimension :
         {Dimension::time, Dimension::frequency, Dimension::angle, Dimension::speed, Dimension::torque,
          Dimension::torque_rate, Dimension::inertia, Dimension::decibel}) {
        CHECK_FALSE(base_unit(dimension).empty());
        CHECK(unit_factor(dimension, base_unit(dimension)) == 1.0);
        for (const auto name : unit_names(dimension)) {
            // The ticks of TwinCAT's clock, "100ns", are a unit of columns; after a number they need a blank.
            const std::string blank = name.front() >= '0' && name.front() <= '9' ? " " : "";
            CHECK(parse_quantity("2" + blank + std::string(name), dimension, "x") ==
                  2.0 * unit_factor(dimension, name).value());
        }
    }
}

TEST_CASE("ripple frequency is n Kg |v| / 360") {
    // 100 motor turns an output turn, 60 deg/s is a sixth of a turn a second: 100 / 6 Hz, twice that for
    // order 2.
    CHECK(ripple_frequency(Order(1), GearRatio(100), DegPerSec(60)).value() ==
          Approx(100.0 / 6.0).epsilon(1e-15));
    CHECK(ripple_frequency(Order(2), GearRatio(100), DegPerSec(-60)).value() ==
          Approx(200.0 / 6.0).epsilon(1e-15));
}
