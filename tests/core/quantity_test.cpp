#include "ripplenotch/core/quantity.hpp"

#include <numbers>

#include "ripplenotch/core/error.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using Catch::Contains;

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
