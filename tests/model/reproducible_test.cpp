// SPDX-License-Identifier: MIT
#include "model/reproducible.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <random>

using namespace ripplenotch;

namespace {
constexpr double radians = std::numbers::pi / 180.0;
}

TEST_CASE("cosine and sine in degrees are exact at multiples of 90 degrees") {
    for (int turn = -1000; turn <= 1000; ++turn) {
        const double base = 360.0 * turn;
        CHECK(cos_degrees(base) == 1.0);
        CHECK(cos_degrees(base + 90.0) == 0.0);
        CHECK(cos_degrees(base + 180.0) == -1.0);
        CHECK(cos_degrees(base + 270.0) == 0.0);
        CHECK(sin_degrees(base) == 0.0);
        CHECK(sin_degrees(base + 90.0) == 1.0);
        CHECK(sin_degrees(base + 270.0) == -1.0);
    }
}

TEST_CASE("cosine and sine in degrees agree with the C library within 3e-16 of full scale") {
    std::mt19937_64 engine(1);
    std::uniform_real_distribution<double> angle(-360.0, 360.0);
    for (int i = 0; i < 20000; ++i) {
        const double a = angle(engine);
        // The argument in radians is rounded: its own half unit in the last place is part of the tolerance.
        const double slack = 3e-16 + 0.5e-15 * std::abs(a * radians);
        CHECK(std::abs(cos_degrees(a) - std::cos(a * radians)) < slack);
        CHECK(std::abs(sin_degrees(a) - std::sin(a * radians)) < slack);
    }
}

TEST_CASE("cosine and sine have period 360 to the last bit and their symmetries, however large the angle") {
    std::mt19937_64 engine(2);
    std::uniform_int_distribution<int> eighth(-2880, 2880);
    for (int i = 0; i < 5000; ++i) {
        const double a = eighth(engine) / 8.0;
        for (const double turns : {1.0, -7.0, 1e6, 1e9})
            CHECK(cos_degrees(a + 360.0 * turns) == cos_degrees(a));
        CHECK(cos_degrees(-a) == cos_degrees(a));
        CHECK(sin_degrees(-a) == -sin_degrees(a));
        CHECK(std::abs(cos_degrees(a) * cos_degrees(a) + sin_degrees(a) * sin_degrees(a) - 1.0) < 4e-16);
    }
    CHECK(cos_degrees(0x1p60 * 360.0) == 1.0);
}

TEST_CASE("the natural logarithm agrees with the C library within 4e-16, relative or absolute") {
    CHECK(natural_log(1.0) == 0.0);
    std::mt19937_64 engine(3);
    std::uniform_real_distribution<double> exponent(-300.0, 300.0);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    for (int i = 0; i < 20000; ++i) {
        const double wide = std::pow(10.0, exponent(engine));
        CHECK(std::abs(natural_log(wide) / std::log(wide) - 1.0) < 4e-16);
        const double near = 1.0 - unit(engine) * 0.5;
        CHECK(std::abs(natural_log(near) - std::log(near)) < 4e-16);
    }
}

TEST_CASE("the exponential and the smooth sign agree with the C library") {
    std::mt19937_64 engine(4);
    std::uniform_real_distribution<double> wide(-700.0, 700.0), narrow(-25.0, 25.0);
    for (int i = 0; i < 20000; ++i) {
        const double x = wide(engine);
        CHECK(std::abs(exponential(x) / std::exp(x) - 1.0) < 1e-15);
        const double y = narrow(engine);
        CHECK(std::abs(smooth_sign(y) - std::tanh(y)) < 1e-15);
        CHECK(smooth_sign(-y) == -smooth_sign(y));
    }
    CHECK(exponential(0.0) == 1.0);
    CHECK(smooth_sign(0.0) == 0.0);
    CHECK_FALSE(std::signbit(smooth_sign(-0.0)));
    CHECK(smooth_sign(1e300) == 1.0);
}

// What a seed means rests on these bits. Reference in the comments: 40-digit arithmetic (Python 3.11, module
// decimal).
TEST_CASE("elementary functions keep their bits") {
    CHECK(cos_degrees(1.0) == 0x1.ffec097f5af8ap-1);   // 0.99984769515639123915701155881...
    CHECK(sin_degrees(1.0) == 0x1.1df0b2b89dd1ep-6);   // 0.01745240643728351281941897851...
    CHECK(cos_degrees(60.0) == 0x1.fffffffffffffp-2);  // 0.5, one unit in the last place below
    CHECK(natural_log(2.0) == 0x1.62e42fefa39efp-1);   // 0.69314718055994530941723212145...
    CHECK(natural_log(10.0) == 0x1.26bb1bbb55515p+1);  // 2.30258509299404568401799145468..., one unit below
    CHECK(exponential(1.0) == 0x1.5bf0a8b14576ap+1);   // 2.71828182845904523536028747135..., one unit above
    CHECK(smooth_sign(1.0) == Approx(0.76159415595576488812).epsilon(4e-16));
}
