// SPDX-License-Identifier: MIT
// Functions of numbers that are the same on every machine.
#include <algorithm>
#include <bit>
#include <cmath>
#include <complex>
#include <cstdint>
#include <cstring>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "core/matrices/least_squares.hpp"
#include "core/rows/row_facts.hpp"
#include "core/vectors/dot.hpp"
#include "core/vectors/lanes.hpp"
#include "ripplenotch/core/biquad.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "support/catch.hpp"
#include "support/vectors.hpp"

using namespace ripplenotch;
using namespace ripplenotch::testing;
using namespace ripplenotch::literals;

namespace {
constexpr double degree_rad = std::numbers::pi / 180.0;
}

TEST_CASE("cosine and sine in degrees are exact at multiples of 90 degrees") {
    for (int turn = -1000; turn <= 1000; ++turn) {
        const double base = 360.0 * turn;
        CHECK(portable::cos_degrees(base) == 1.0);
        CHECK(portable::cos_degrees(base + 90.0) == 0.0);
        CHECK(portable::cos_degrees(base + 180.0) == -1.0);
        CHECK(portable::cos_degrees(base + 270.0) == 0.0);
        CHECK(portable::sin_degrees(base) == 0.0);
        CHECK(portable::sin_degrees(base + 90.0) == 1.0);
        CHECK(portable::sin_degrees(base + 270.0) == -1.0);
    }
}

TEST_CASE("cosine and sine in degrees agree with the C library within 3e-16 of full scale") {
    std::mt19937_64 engine(1);
    std::uniform_real_distribution<double> angle(-360.0, 360.0);
    for (int i = 0; i < 20000; ++i) {
        const double a = angle(engine);
        // The argument in radians is rounded: its own half unit in the last place is part of the
        // tolerance.
        const double slack = 3e-16 + 0.5e-15 * std::abs(a * degree_rad);
        CHECK(std::abs(portable::cos_degrees(a) - std::cos(a * degree_rad)) < slack);
        CHECK(std::abs(portable::sin_degrees(a) - std::sin(a * degree_rad)) < slack);
    }
}

TEST_CASE("cosine and sine have period 360 to the last bit and their symmetries, however large the angle") {
    std::mt19937_64 engine(2);
    std::uniform_int_distribution<int> eighth(-2880, 2880);
    for (int i = 0; i < 5000; ++i) {
        const double a = eighth(engine) / 8.0;
        for (const double turns : {1.0, -7.0, 1e6, 1e9})
            CHECK(portable::cos_degrees(a + 360.0 * turns) == portable::cos_degrees(a));
        CHECK(portable::cos_degrees(-a) == portable::cos_degrees(a));
        CHECK(portable::sin_degrees(-a) == -portable::sin_degrees(a));
        CHECK(std::abs(portable::cos_degrees(a) * portable::cos_degrees(a) +
                       portable::sin_degrees(a) * portable::sin_degrees(a) - 1.0) < 4e-16);
    }
    CHECK(portable::cos_degrees(0x1p60 * 360.0) == 1.0);
}

TEST_CASE("many angles at once have the bits of each angle alone") {
    std::mt19937_64 random(11);
    for (const double reach : {1.0, 400.0, 1e6, 1e12, 0x1p50, 1e300}) {
        std::uniform_real_distribution<double> angle(-reach, reach);
        for (const std::size_t count : {0u, 1u, 3u, 4u, 7u, 2000u}) {
            std::vector<double> angles(count), cosines(count), sines(count);
            for (double& value : angles) value = angle(random);
            for (std::size_t k = 0; k < count / 4; ++k) angles[k] = 45.0 * std::round(angles[k] / 45.0);
            for (const bool wide : widths()) {
                const Width here(wide);
                portable::cos_degrees(angles, cosines);
                portable::sin_degrees(angles, sines);
                for (std::size_t k = 0; k < count; ++k) {
                    CAPTURE(angles[k], wide);
                    CHECK(std::bit_cast<std::uint64_t>(cosines[k]) ==
                          std::bit_cast<std::uint64_t>(portable::cos_degrees(angles[k])));
                    CHECK(std::bit_cast<std::uint64_t>(sines[k]) ==
                          std::bit_cast<std::uint64_t>(portable::sin_degrees(angles[k])));
                }
            }
        }
    }
}

TEST_CASE("the natural logarithm agrees with the C library within 4e-16, relative or absolute") {
    CHECK(portable::log(1.0) == 0.0);
    std::mt19937_64 engine(3);
    std::uniform_real_distribution<double> exponent(-300.0, 300.0);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    for (int i = 0; i < 20000; ++i) {
        const double wide = std::pow(10.0, exponent(engine));
        CHECK(std::abs(portable::log(wide) / std::log(wide) - 1.0) < 4e-16);
        const double near = 1.0 - unit(engine) * 0.5;
        CHECK(std::abs(portable::log(near) - std::log(near)) < 4e-16);
    }
}

TEST_CASE("the exponential and the hyperbolic tangent agree with the C library") {
    std::mt19937_64 engine(4);
    std::uniform_real_distribution<double> wide(-700.0, 700.0), narrow(-25.0, 25.0);
    for (int i = 0; i < 20000; ++i) {
        const double x = wide(engine);
        CHECK(std::abs(portable::exp(x) / std::exp(x) - 1.0) < 1e-15);
        const double y = narrow(engine);
        CHECK(std::abs(portable::tanh(y) - std::tanh(y)) < 1e-15);
        CHECK(portable::tanh(-y) == -portable::tanh(y));
    }
    CHECK(portable::exp(0.0) == 1.0);
    CHECK(portable::tanh(0.0) == 0.0);
    CHECK_FALSE(std::signbit(portable::tanh(-0.0)));
    CHECK(portable::tanh(1e300) == 1.0);
}

namespace {

/// The largest |found - expected| over `count` random places in a range, in units of max(|expected|, floor).
template <class Found, class Expected>
double worst_error(double from, double to, double floor, Found found, Expected expected) {
    std::mt19937_64 engine(5);
    std::uniform_real_distribution<double> place(from, to);
    double worst = 0.0;
    for (int i = 0; i < 20000; ++i) {
        const double x = place(engine), reference = expected(x);
        worst = std::max(worst, std::abs(found(x) - reference) / std::max(std::abs(reference), floor));
    }
    return worst;
}

}  // namespace

// The C library's own functions are within one unit in the last place, 1.1e-16 to 2.2e-16 of the value.
TEST_CASE("circle functions of radians agree with the C library within 3e-16 of full scale") {
    for (const double reach : {1e-3, 1.0, 10.0, 1e3, 1e6}) {
        CAPTURE(reach);
        CHECK(worst_error(
                  -reach, reach, 1.0, [](double x) { return portable::cos(x); },
                  [](double x) { return std::cos(x); }) < 3e-16);
        CHECK(worst_error(
                  -reach, reach, 1.0, [](double x) { return portable::sin(x); },
                  [](double x) { return std::sin(x); }) < 3e-16);
        CHECK(worst_error(
                  -reach, reach, 1.0, [](double x) { return portable::tan(x); },
                  [](double x) { return std::tan(x); }) < 7e-16);
    }
    // Next to a multiple of pi the sine is what reduction leaves: its relative error tells how exact that is.
    for (const int halves : {1, 2, 3, 1000, 99999}) {
        const double at = halves * std::numbers::pi;
        CHECK(portable::sin(at) == Approx(std::sin(at)).epsilon(1e-12));
    }
    // From 2^20 on the multiple of 2 pi is rounded: half a unit in the last place of the angle.
    for (const double reach : {1e7, 1e9}) {
        CHECK(worst_error(
                  -reach, reach, 1.0, [](double x) { return portable::cos(x); },
                  [](double x) { return std::cos(x); }) < 3e-16 * reach);
    }
    CHECK(std::signbit(portable::sin(-0.0)));
    for (double angle = -1e4; angle < 1e4; angle += 1.37) {
        CHECK(portable::phasor(angle) == std::complex<double>(portable::cos(angle), portable::sin(angle)));
    }
}

TEST_CASE("inverse circle functions agree with the C library within 5e-16 and keep its quadrants") {
    for (const double reach : {1e-3, 1.0, 8.0, 1e4}) {
        CHECK(worst_error(
                  -reach, reach, 0.0, [](double x) { return portable::atan(x); },
                  [](double x) { return std::atan(x); }) < 5e-16);
    }
    CHECK(worst_error(
              -1.0, 1.0, 0.0, [](double x) { return portable::asin(x); },
              [](double x) { return std::asin(x); }) < 6e-16);
    CHECK(worst_error(
              -1.0, 1.0, 0.5, [](double x) { return portable::acos(x); },
              [](double x) { return std::acos(x); }) < 6e-16);
    const double infinity = std::numeric_limits<double>::infinity();
    for (const double y : {-infinity, -2.0, -0.0, 0.0, 1e-300, 3.0, infinity}) {
        for (const double x : {-infinity, -1e300, -1.0, -0.0, 0.0, 5.0, infinity}) {
            CAPTURE(y, x);
            CHECK(portable::atan2(y, x) == Approx(std::atan2(y, x)).epsilon(5e-16).margin(0.0));
            CHECK(std::signbit(portable::atan2(y, x)) == std::signbit(std::atan2(y, x)));
        }
    }
    CHECK(std::isnan(portable::atan2(std::nan(""), 1.0)));
    CHECK(std::isnan(portable::asin(1.5)));
}

TEST_CASE("logarithms, powers and roots agree with the C library") {
    const auto wide = [](auto function) {
        return [function](double x) { return function(std::pow(10.0, x)); };
    };
    CHECK(worst_error(-300.0, 300.0, 1.0, wide([](double x) { return portable::log10(x); }),
                      wide([](double x) { return std::log10(x); })) < 5e-16);
    CHECK(worst_error(-300.0, 300.0, 1.0, wide([](double x) { return portable::log2(x); }),
                      wide([](double x) { return std::log2(x); })) < 5e-16);
    CHECK(worst_error(
              -0.9, 3.0, 0.0, [](double x) { return portable::log1p(x); },
              [](double x) { return std::log1p(x); }) < 5e-16);
    CHECK(worst_error(
              -1000.0, 1000.0, 0.0, [](double x) { return portable::exp2(x); },
              [](double x) { return std::exp2(x); }) < 1e-15);
    CHECK(worst_error(
              -300.0, 300.0, 0.0, [](double x) { return portable::pow(10.0, x); },
              [](double x) { return std::pow(10.0, x); }) < 1e-15);
    CHECK(worst_error(
              0.01, 5.0, 0.0, [](double x) { return portable::pow(x, 2.7); },
              [](double x) { return std::pow(x, 2.7); }) < 1e-14);
    CHECK(worst_error(
              -1e4, 1e4, 0.0, [](double x) { return portable::cbrt(x); },
              [](double x) { return std::cbrt(x); }) < 5e-16);
    CHECK(worst_error(
              0.1, 200.0, 1.0, [](double x) { return portable::lgamma(x); },
              [](double x) { return std::lgamma(x); }) < 1e-13);
    CHECK(worst_error(
              -5.0, 5.0, 0.0, [](double x) { return portable::hypot(x, 3.0 * x - 1.0); },
              [](double x) { return std::hypot(x, 3.0 * x - 1.0); }) < 5e-16);
}

TEST_CASE("what has an exact answer gets it") {
    for (int n = -22; n <= 22; ++n) {
        CAPTURE(n);
        const double power = portable::pow(10.0, n);
        CHECK(power == (n < 0 ? 1.0 / std::pow(10.0, -n) : std::pow(10.0, n)));
        CHECK(portable::log10(power) == n);
    }
    for (int n = -1000; n <= 1000; n += 7) CHECK(portable::log2(std::ldexp(1.0, n)) == n);
    CHECK(portable::pow(3.0, 4.0) == 81.0);
    CHECK(portable::pow(-2.0, 3.0) == -8.0);
    CHECK(portable::pow(2.0, -2.0) == 0.25);
    CHECK(portable::pow(2.25, 0.5) == 1.5);
    CHECK(portable::pow(0.0, 1.5) == 0.0);
    CHECK(portable::exp(0.0) == 1.0);
    CHECK(portable::hypot(3.0, 4.0) == 5.0);
    CHECK(portable::hypot(3e200, 4e200) == Approx(5e200).epsilon(3e-16));
    CHECK(portable::hypot(3e-200, 4e-200) == Approx(5e-200).epsilon(3e-16));
}

TEST_CASE("outside of their domains the functions answer as those of the C library") {
    const double infinity = std::numeric_limits<double>::infinity();
    CHECK(portable::log(0.0) == -infinity);
    CHECK(portable::log10(infinity) == infinity);
    CHECK(std::isnan(portable::log2(-1.0)));
    CHECK(std::isnan(portable::pow(-2.0, 0.3)));
    CHECK(portable::exp(-800.0) == 0.0);
    CHECK(portable::exp(800.0) == infinity);
    CHECK(std::isnan(portable::exp(std::nan(""))));
    CHECK(portable::pow(10.0, 400.0) == infinity);
    CHECK(portable::log1p(-1.0) == -infinity);
}

// What a seed means rests on these bits. Reference in the comments: 40-digit arithmetic (Python 3.11, module
// decimal).
TEST_CASE("an angle without end has no cosine, alone or among many") {
    for (const double angle :
         {std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(),
          std::numeric_limits<double>::quiet_NaN()}) {
        CHECK(std::isnan(portable::cos(angle)));
        CHECK(std::isnan(portable::sin(angle)));
        CHECK(std::isnan(portable::cos_degrees(angle)));
        CHECK(std::isnan(portable::sin_degrees(angle)));
        const std::vector<double> many{1.0, angle, 2.0, 3.0, angle};
        std::vector<double> cosine(many.size());
        portable::cos_degrees(many, cosine);
        CHECK(std::isnan(cosine[1]));
        CHECK(cosine[3] == portable::cos_degrees(3.0));
        CHECK(std::isnan(cosine[4]));
    }
}

TEST_CASE("elementary functions keep their bits") {
    CHECK(portable::cos_degrees(1.0) == 0x1.ffec097f5af8ap-1);   // 0.99984769515639123915701155881...
    CHECK(portable::sin_degrees(1.0) == 0x1.1df0b2b89dd1ep-6);   // 0.01745240643728351281941897851...
    CHECK(portable::cos_degrees(60.0) == 0x1.fffffffffffffp-2);  // 0.5, one unit in the last place below
    CHECK(portable::log(2.0) == 0x1.62e42fefa39efp-1);           // 0.69314718055994530941723212145...
    CHECK(portable::log(10.0) == 0x1.26bb1bbb55515p+1);  // 2.30258509299404568401799145468..., one unit below
    CHECK(portable::exp(1.0) == 0x1.5bf0a8b14576ap+1);   // 2.71828182845904523536028747135..., one unit above
    CHECK(portable::tanh(1.0) == Approx(0.76159415595576488812).epsilon(4e-16));
}

// Sums over columns are what their plain loops are, and the same bits on every width of vectors.

namespace {

using Numbers = std::vector<double>;

Numbers noise(std::size_t count, std::mt19937_64& random) {
    std::uniform_real_distribution<double> between(-3.0, 3.0);
    Numbers values(count);
    for (double& value : values) value = between(random);
    return values;
}

bool same_bits(const Numbers& a, const Numbers& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

// Everything that these functions make of the same columns.
Numbers made_of(const Numbers& a, const Numbers& b, const Numbers& c, const Numbers& d) {
    const std::size_t n = a.size();
    Numbers made{dot(a.data(), b.data(), n)};
    double sums[4] = {1.0, 2.0, 3.0, 4.0};
    add_dots({a.data(), b.data()}, {c.data(), d.data()}, n, sums);
    made.insert(made.end(), std::begin(sums), std::end(sums));
    Numbers scaled = c;
    add_scaled(0.37, a.data(), scaled.data(), n);
    made.insert(made.end(), scaled.begin(), scaled.end());
    return made;
}

}  // namespace

TEST_CASE("sums of products give the same bits on every width of vectors, and what a plain loop gives") {
    std::mt19937_64 random(41);
    for (const std::size_t n : {1U, 2U, 3U, 4U, 5U, 7U, 8U, 9U, 15U, 16U, 17U, 31U, 64U, 1001U}) {
        const Numbers a = noise(n, random), b = noise(n, random), c = noise(n, random), d = noise(n, random);
        std::vector<Numbers> made;
        for (const bool wide : widths()) {
            const Width here(wide);
            made.push_back(made_of(a, b, c, d));
        }
        INFO(n << " numbers");
        CHECK(same_bits(made.front(), made.back()));
        Numbers plain{0.0, 1.0, 2.0, 3.0, 4.0};
        for (std::size_t k = 0; k < n; ++k) {
            plain[0] += a[k] * b[k];
            plain[1] += a[k] * c[k];
            plain[2] += a[k] * d[k];
            plain[3] += b[k] * c[k];
            plain[4] += b[k] * d[k];
            plain.push_back(c[k] + 0.37 * a[k]);
        }
        REQUIRE(made.front().size() == plain.size());
        // Products of up to 9, summed in another order.
        for (std::size_t i = 0; i < plain.size(); ++i)
            CHECK(made.front()[i] == Approx(plain[i]).margin(1e-11));
    }
}

TEST_CASE("errors of a prediction are those of a plain loop to the last bit, on every width of vectors") {
    std::mt19937_64 random(42);
    for (const std::size_t memory : {0U, 1U, 3U, 50U}) {
        const Numbers weights = noise(memory, random);
        for (const std::size_t n : {1U, 4U, 15U, 16U, 17U, 40U, 333U}) {
            const Numbers signal = noise(memory + n, random);
            Numbers plain;
            for (std::size_t k = memory; k < signal.size(); ++k) {
                double sum = 0.0;
                for (std::size_t i = 0; i < memory; ++i) sum += weights[i] * signal[k - 1 - i];
                plain.push_back(signal[k] - sum);
            }
            for (const bool wide : widths()) {
                const Width here(wide);
                Numbers errors(n);
                prediction_errors(signal.data() + memory, n, weights.data(), memory, errors.data());
                INFO(n << " numbers, memory of " << memory << ", " << (wide ? "wide" : "narrow"));
                CHECK(same_bits(errors, plain));
            }
        }
    }
}

namespace {
// A stable section with poles at radius r and angle theta, zeros on the circle at phi, unity gain at DC.
Biquad section(double r, double theta, double phi) {
    Biquad f{1.0, -2.0 * std::cos(phi), 1.0, -2.0 * r * std::cos(theta), r * r};
    const double gain = dc_gain(f);
    return {f.b0 / gain, f.b1 / gain, f.b2 / gain, f.a1, f.a2};
}
}  // namespace

TEST_CASE("the response of a section is what a sine measures on it") {
    const Biquad f = section(0.9, 0.3, 0.5);
    const double hz = 37.0, rate = 1000.0;
    BiquadState s;
    std::complex<double> in = 0.0, out = 0.0;
    for (int k = 0; k < 3000; ++k) {
        const double phase = 2.0 * std::numbers::pi * hz * k / rate;
        const double y = step(f, s, std::cos(phase));
        if (k >= 2000) {  // 37 whole periods, long after the transient (0.9^2000)
            in += std::cos(phase) * std::polar(1.0, -phase);
            out += y * std::polar(1.0, -phase);
        }
    }
    CHECK(std::abs(out / in - response(f, Hertz(hz), SampledAt(Hertz(rate)))) < 1e-9);
}

TEST_CASE("group delay is the negative slope of the phase") {
    const Cascade cascade = {section(0.9, 0.3, 0.5), section(0.7, 0.9, 1.2)};
    for (double hz = 1.0; hz < 450.0; hz += 7.3) {
        const double h = 1e-4;
        const auto ratio = response(cascade, Hertz(hz + h), SampledAt(1000_Hz)) /
                           response(cascade, Hertz(hz - h), SampledAt(1000_Hz));
        const double slope = -std::arg(ratio) / (2.0 * std::numbers::pi * 2.0 * h);
        CHECK(group_delay(cascade, Hertz(hz), SampledAt(1000_Hz)).value() == Approx(slope).margin(1e-8));
    }
}

TEST_CASE("a ramp lags by the group delay at zero frequency") {
    const Cascade cascade = {section(0.95, 0.2, 0.3)};
    BiquadState s;
    double y = 0.0;
    for (int k = 0; k <= 4000; ++k) y = step(cascade[0], s, 0.01 * k);
    CHECK((0.01 * 4000 - y) / 0.01 / 1000.0 ==
          Approx(group_delay(cascade, 0_Hz, SampledAt(1000_Hz)).value()).epsilon(1e-9));
}

TEST_CASE("pole radius is right for complex and for real poles") {
    CHECK(pole_radius(section(0.93, 1.0, 0.5)) == Approx(0.93).epsilon(1e-12));
    CHECK(pole_radius(Biquad{1, 0, 0, -(0.9 + 0.5), 0.9 * 0.5}) == Approx(0.9).epsilon(1e-12));
    CHECK(pole_radius(Biquad{1, 0, 0, 0.9 + 0.5, 0.9 * 0.5}) == Approx(0.9).epsilon(1e-12));
}

// Least squares and factorisations.

TEST_CASE("least squares: worked arithmetic, and what is left stands upright on every column") {
    const std::vector<std::vector<double>> columns = {{1, 1, 1, 1}, {0, 1, 2, 3}};
    const std::vector<double> target = {1, 3, 2, 6};
    const auto values = least_squares(columns, target);  // slope 7/5, at 0: 3 - 7/5 * 3/2
    REQUIRE(values.size() == 2);
    CHECK(values[0] == Approx(0.9));
    CHECK(values[1] == Approx(1.4));
    for (const auto& column : columns) {
        double along = 0.0;
        for (std::size_t k = 0; k < target.size(); ++k)
            along += column[k] * (target[k] - values[0] - values[1] * columns[1][k]);
        CHECK(std::abs(along) < 1e-12);
    }
}

TEST_CASE("least squares of columns that cannot be told apart shares between them, and nothing gets 0") {
    const std::vector<double> column = {1, 2, 3}, nothing = {0, 0, 0};
    const auto values = least_squares({column, column, nothing}, column);
    CHECK(values[0] == Approx(0.5));
    CHECK(values[1] == Approx(0.5));
    CHECK(std::abs(values[2]) < 1e-12);
}

TEST_CASE("the root mean square of nothing is 0") {
    CHECK(rms(std::vector<double>{3, 4, 0, 0}) == Approx(2.5));
    CHECK(rms(std::vector<double>{}) == 0.0);
}

namespace {

using Column = std::vector<double>;

std::vector<Column> drawn(std::size_t rows, std::size_t count, unsigned seed) {
    std::mt19937 draw(seed);
    std::vector<Column> columns(count, Column(rows));
    for (Column& column : columns) {
        for (double& value : column) value = static_cast<double>(draw()) / 4294967296.0 - 0.3;
    }
    return columns;
}

TallTriangle of(const std::vector<Column>& columns, const Column& right) {
    Column all;
    for (const Column& column : columns) all.insert(all.end(), column.begin(), column.end());
    return tall_triangle(all, right);
}

double product(const double* a, const double* b, std::size_t count) {
    double sum = 0.0;
    for (std::size_t k = 0; k < count; ++k) sum += a[k] * b[k];
    return sum;
}

// By which the columns are nearest to the right side.
Column solved(const TallTriangle& found) {
    const std::size_t count = found.reached.size();
    Column values = found.reached;
    for (std::size_t i = count; i-- > 0;) {
        for (std::size_t c = i + 1; c < count; ++c) values[i] -= found.triangle[c * count + i] * values[c];
        values[i] /= found.triangle[i * count + i];
    }
    return values;
}

}  // namespace

// Rows about one block, several, and no whole number of them.
TEST_CASE("a tall triangle has the products of its columns with each other and with the right side") {
    constexpr std::size_t count = 4;
    for (const std::size_t rows : std::initializer_list<std::size_t>{4, 5, 255, 256, 257, 1000}) {
        const auto columns = drawn(rows, count, static_cast<unsigned>(rows));
        const Column right = drawn(rows, 1, 7)[0];
        const TallTriangle found = of(columns, right);
        REQUIRE(found.triangle.size() == count * count);
        REQUIRE(found.reached.size() == count);
        const double close = 1e-13 * static_cast<double>(rows);
        for (std::size_t a = 0; a < count; ++a) {
            const double* const in_triangle = &found.triangle[a * count];
            for (std::size_t below = a + 1; below < count; ++below) CHECK(in_triangle[below] == 0.0);
            for (std::size_t b = 0; b < count; ++b) {
                CHECK(product(in_triangle, &found.triangle[b * count], count) ==
                      Approx(product(columns[a].data(), columns[b].data(), rows)).margin(close));
            }
            CHECK(product(in_triangle, found.reached.data(), count) ==
                  Approx(product(columns[a].data(), right.data(), rows)).margin(close));
        }
    }
}

// The products of such columns are singular in double precision: 1 + 1e-18 is 1.
TEST_CASE("a tall triangle tells columns apart that differ by a part in a thousand million") {
    auto columns = drawn(900, 2, 3);
    Column right(900);
    for (std::size_t k = 0; k < right.size(); ++k) {
        columns[1][k] = columns[0][k] + 1e-9 * columns[1][k];
        right[k] = 3.0 * columns[0][k] - 2.0 * columns[1][k];
    }
    const Column values = solved(of(columns, right));
    CHECK(values[0] == Approx(3.0).epsilon(1e-5));
    CHECK(values[1] == Approx(-2.0).epsilon(1e-5));
}

TEST_CASE("a column of zeros has a row of zeros, and the others are as without it") {
    auto columns = drawn(600, 3, 5);
    columns[1].assign(600, 0.0);
    const Column right = drawn(600, 1, 6)[0];
    const TallTriangle found = of(columns, right), without = of({columns[0], columns[2]}, right);
    for (std::size_t c = 0; c < 3; ++c) CHECK(found.triangle[c * 3 + 1] == 0.0);
    CHECK(found.triangle[6] == without.triangle[2]);
    CHECK(found.triangle[8] == without.triangle[3]);
    CHECK(found.reached[2] == without.reached[1]);
}

TEST_CASE("a tall triangle has the same bits with and without wide vectors") {
    const auto columns = drawn(1000, 5, 11);
    const Column right = drawn(1000, 1, 12)[0];
    const TallTriangle wide = of(columns, right);
    const NarrowVectors narrow;
    const TallTriangle plain = of(columns, right);
    CHECK(wide.triangle == plain.triangle);
    CHECK(wide.reached == plain.reached);
}
