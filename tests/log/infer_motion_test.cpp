// SPDX-License-Identifier: MIT
// The law of units that nobody states: what is read is the truth, or the truth is among the readings listed.

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "log/columns/column_name.hpp"
#include "log_support.hpp"
#include "ripplenotch/core/quantity.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using test::read_text;

namespace {

constexpr double pi = std::numbers::pi;

struct Written {
    std::string velocity_name, position_name;
    double velocity = 1.0, position = 1.0;  ///< file value of 1 deg/s, 1 deg
    double wrap_deg = 0.0;                  ///< 0: it does not
    bool has_position = true;
};

/// 40 deg/s forth and 70 deg/s back, at 500 Hz.
double speed_at(int k) { return k < 100 ? 0.0 : k < 700 ? 40.0 : k < 1300 ? -70.0 : 25.0; }

std::string text_of(const Written& written) {
    std::string text = "time_s,torque_nm," + written.velocity_name +
                       (written.has_position ? "," + written.position_name : "") + "\n";
    double angle = 30.0;
    for (int k = 0; k < 1500; ++k) {
        angle += speed_at(k) / 500.0;
        const double shown = written.wrap_deg > 0.0 ? std::fmod(angle + 720.0, written.wrap_deg) : angle;
        text += std::to_string(k / 500.0) + "," + std::to_string(k % 11) + "," +
                std::to_string(speed_at(k) * written.velocity);
        if (written.has_position) text += "," + std::to_string(shown * written.position);
        text += "\n";
    }
    return text;
}

/// Of what is read to the truth, by the fastest stretch.
double error_factor(const Log& log) { return log.trace.velocity_deg_s[1000] / -70.0; }

bool lists(const Log& log, double factor) {
    for (const Assumption& one : log.layout.assumptions) {
        for (const OtherReading& other : one.others) {
            if (other.changes_side || std::abs(other.velocity_factor / factor - 1.0) < 0.03) return true;
        }
    }
    return false;
}

const Assumption* with_others(const Log& log) {
    for (const Assumption& one : log.layout.assumptions) {
        if (!one.others.empty()) return &one;
    }
    return nullptr;
}

}  // namespace

TEST_CASE("no speed is read wrong for sure, whatever its unit, beside whatever position", "[log]") {
    const double rad = pi / 180.0;
    std::size_t settled = 0, open = 0;
    for (const auto& [speed, unit] : {std::pair{"velocity", 1.0},
                                      {"velocity", rad},
                                      {"speed", 1.0 / 6.0},
                                      {"velocity", 1.0 / 360.0},
                                      {"velocity", 100.0}}) {
        for (const double position : {1.0, rad, 1.0 / 360.0, 100.0}) {
            for (const double wrap : {0.0, 360.0}) {
                for (const bool has_position : {true, false}) {
                    const Written written{speed, "position", unit, position, wrap, has_position};
                    if (position == 100.0 && wrap > 0.0) continue;
                    INFO(speed << " " << unit << ", position " << has_position << " " << position << " wraps "
                               << wrap);
                    ReadOptions options;
                    options.takes_motor_units = true;
                    const Log log = read_text(text_of(written), options);
                    // Turns a second without anything that says so are beyond what can be told.
                    if (unit == 1.0 / 360.0 && (!has_position || position == 1.0 / 360.0)) continue;
                    // A hundredfold of both is a motor, and 100 deg/s is no less likely than 100 times 1.
                    if (unit == 100.0 && (!has_position || position == 100.0)) {
                        CHECK((log.layout.motor_units || with_others(log) != nullptr));
                        continue;
                    }
                    const bool right = std::abs(error_factor(log) - 1.0) < 0.03;
                    CHECK((right || lists(log, 1.0 / error_factor(log))));
                    (with_others(log) == nullptr ? settled : open) += 1;
                }
            }
        }
    }
    CHECK(settled > 20);
    CHECK(open > 3);
}

TEST_CASE("names of known writers settle the unit, and the reason names the source", "[log]") {
    const double rad = pi / 180.0;
    const Log log = read_text(text_of({"dq", "q", rad, rad}));
    CHECK(error_factor(log) == Approx(1.0).epsilon(1e-4));
    CHECK(with_others(log) == nullptr);
    REQUIRE(log.layout.inferences.size() == 1);
    CHECK_THAT(log.layout.inferences[0].reason, Catch::Contains("rad"));
}

TEST_CASE("a stated unit is believed, and a contradiction keeps a verdict back", "[log]") {
    const double rad = pi / 180.0;
    const Log log = read_text(text_of({"velocity_deg_s", "position_deg", rad, 1.0}));
    CHECK(error_factor(log) == Approx(rad).epsilon(1e-3));
    REQUIRE(with_others(log) != nullptr);
    CHECK(lists(log, 1.0 / rad));
}

TEST_CASE("a position that turns a hundred times more, or less, is the other side of a gear", "[log]") {
    const Log position = read_text(text_of({"velocity_deg_s", "position_deg", 1.0, 100.0}));
    CHECK(error_factor(position) == Approx(1.0));
    CHECK(position.layout.columns[*position.layout.chosen.position].motor_ratio.value() ==
          Approx(100.0).epsilon(0.002));
    const Log velocity = read_text(text_of({"velocity_rpm", "position_deg", 100.0 / 6.0, 1.0}));
    CHECK(error_factor(velocity) == Approx(1.0).epsilon(0.002));
    // The position of another joint is no gear.
    const Log other = read_text(text_of({"velocity_deg_s", "position_deg", 1.0, 0.3}));
    CHECK(error_factor(other) == 1.0);
    CHECK_FALSE(other.layout.columns[*other.layout.chosen.position].motor_ratio.has_value());
}

TEST_CASE("motion of the motor is divided by the ratio that is known, and only by that", "[log]") {
    const Written written{"motor_velocity_rpm", "", 100.0 / 6.0, 1.0, 0.0, false};
    CHECK_THAT(test::complaint(text_of(written)),
               Catch::Contains("--gear-ratio") && Catch::Contains("--side joint"));
    ReadOptions options;
    options.takes_motor_units = true;
    const Log unknown = read_text(text_of(written), options);
    CHECK(unknown.layout.motor_units);
    CHECK(error_factor(unknown) == Approx(100.0));
    options.gear_ratio = 100.0;
    CHECK(error_factor(read_text(text_of(written), options)) == Approx(1.0));
    options.sides = {{Role::velocity, Shaft::joint}};
    CHECK(error_factor(read_text(text_of(written), options)) == Approx(100.0));
}

TEST_CASE("a log without velocity has the slope of its position", "[log]") {
    std::string text = "time_s,torque_nm,position_deg\n";
    for (int k = 0; k < 500; ++k)
        text += std::to_string(k / 500.0) + ",1," +
                std::to_string(std::fmod(350.0 + 60.0 * k / 500.0, 360.0)) + "\n";
    for (const std::size_t piece : {std::size_t{11}, test::whole}) {
        const Log log = read_text(text, {}, piece);
        CHECK(log.layout.velocity_from_position);
        for (const double speed : log.trace.velocity_deg_s) CHECK(speed == Approx(60.0).epsilon(1e-3));
    }
}

TEST_CASE("every convention is found under its own name, in its role, with a unit of it", "[log]") {
    for (const Convention& known : conventions()) {
        INFO(known.family << ": " << known.name);
        std::string name(known.name.front() == '=' ? known.name.substr(1) : known.name);
        const std::vector<std::string> names = {name, std::string(known.beside)};
        const Convention* const found = convention_of(name, known.role, names);
        REQUIRE(found != nullptr);
        CHECK(found->unit == known.unit);
        CHECK_FALSE(known.source.empty());
        // Electrical speeds need the pairs of poles, as counts need their scale.
        CHECK((known.unit == "erpm" || unit_factor(known.role == Role::time       ? Dimension::time
                                                   : known.role == Role::velocity ? Dimension::speed
                                                   : known.role == Role::position ? Dimension::angle
                                                   : known.unit == "A"            ? Dimension::current
                                                                                  : Dimension::torque,
                                                   known.unit)
                                           .has_value()));
    }
}
