// SPDX-License-Identifier: MIT
// What the columns of a log are, and their units.
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "log/columns/column_name.hpp"
#include "log/columns/units.hpp"
#include "log_support.hpp"
#include "ripplenotch/core/quantity.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using test::read_text;

// Names of columns as loggers write them: role, unit, joint.

namespace {

struct Expectation {
    std::string name;
    Role role;
    std::string unit, joint;
};

}  // namespace

TEST_CASE("a column's name gives role, unit and joint", "[log]") {
    const std::vector<Expectation> expectations = {
        {"time_s", Role::time, "s", ""},
        {"torque_percent", Role::torque, "percent", ""},
        {"j2_torque_lbf_in", Role::torque, "lbf_in", "j2"},
        {"torqueNm", Role::torque, "Nm", ""},
        {"tau / Nm", Role::torque, "Nm", ""},
        {"Torque (measured)", Role::torque, "", ""},
        {"speed_min", Role::other, "", ""},
        {"motor_rpm", Role::velocity, "rpm", ""},
        {"Abtriebsdrehzahl [U/min]", Role::velocity, "U/min", ""},
        {"Motordrehzahl_2", Role::velocity, "", "2"},
        {"couple mesuré", Role::torque, "", ""},
        {"vitesse_moteur", Role::velocity, "", ""},
        {"Uhrzeit", Role::time, "", ""},
        {"torque_sm_2", Role::torque, "", "2"},
        {"velocity_actual_value_0x606C", Role::velocity, "counts/s", ""},
        {"axis1_6077h", Role::torque, "per mille", "axis1"},
        {"0x6864:00", Role::position, "counts", "axis2"},
        {"16#6078", Role::torque, "per mille", ""},
        {"Torque actual value", Role::torque, "per mille", ""},
        {"axis_6064_torque_Nm", Role::torque, "Nm", ""},
        {"tau_160641", Role::torque, "", "160641"},
        {"velocity_counts_s", Role::velocity, "counts_s", ""},
        {"MAIN.fbAxis.ActTorque", Role::torque, "", "fbaxis"},
        {"actual_main_voltage", Role::other, "", ""},
        {"Istdrehmoment", Role::torque, "", ""},
        {"j2 Lageistwert", Role::position, "", "j2"},
        {"battery_percent", Role::other, "percent", ""},
        {"Time (ms)", Role::time, "ms", ""},
        {"Time [s]", Role::time, "s", ""},
        {"Timestamp", Role::time, "", ""},
        {"t", Role::time, "", ""},
        {"__time", Role::time, "", ""},
        {"time_us", Role::time, "us", ""},
        {"elapsed time", Role::time, "", ""},
        {"actual_execution_time", Role::other, "", ""},
        {"velocity [rad/s]", Role::velocity, "rad/s", ""},
        {"dq (rad/s)", Role::velocity, "rad/s", ""},
        {"dq_rad_s", Role::velocity, "rad_s", ""},
        {"j4_velocity_deg_s", Role::velocity, "deg_s", "j4"},
        {"joint_velocity_3", Role::velocity, "", "3"},
        {"actual_qd_0", Role::velocity, "", "0"},
        {"state.dq[0]", Role::velocity, "", "0"},
        {"actualVelocity2", Role::velocity, "", "2"},
        {"joint4_speed_rpm", Role::velocity, "rpm", "joint4"},
        {"target_speed_fraction", Role::other, "", ""},
        {"actual_TCP_speed_0", Role::other, "", ""},
        {"torque_Nm", Role::torque, "Nm", ""},
        {"torque_nm", Role::torque, "nm", ""},
        {"tau [N*m]", Role::torque, "N*m", ""},
        {"state.tau_J[6]", Role::torque, "", "6"},
        {"shoulder_pan_joint_effort_Nm", Role::torque, "Nm", "shoulder_pan_joint"},
        {"wrist_1_joint_effort_Nm", Role::torque, "Nm", "wrist_1_joint"},
        {"/joint_states/panda_joint1/effort", Role::torque, "", "joint_panda_joint1"},
        {"joint_torque_current_3", Role::torque, "", "3"},
        {"j3_current_A", Role::torque, "A", "j3"},
        {"actual_current_0", Role::torque, "", "0"},
        {"actual_robot_current", Role::other, "", ""},
        {"actual_TCP_force_0", Role::other, "", ""},
        {"tau_ext_hat_filtered[0]", Role::other, "", ""},
        {"position_deg", Role::position, "deg", ""},
        {"joint_angles_3", Role::position, "", "3"},
        {"actual_q_0", Role::position, "", "0"},
        {"q", Role::position, "", ""},
        {"Drehmoment [Nm]", Role::torque, "Nm", ""},
        {"target_joint_accelerations_1", Role::other, "", ""},
        {"joint_temperatures_0", Role::other, "", ""},
        {"load_encoder_counts", Role::other, "", ""},
        {"State", Role::other, "", ""},
        {"j1_current_a", Role::torque, "A", "j1"},
        {"q_axis_current", Role::torque, "", ""},
        {"d_axis_current", Role::other, "", ""},
        {"163.05 ch1 torq.(P:00A305h)", Role::torque, "", "163_05_ch1"},
        {"tau_friction", Role::other, "", ""},
        {"tau_passive_2", Role::other, "", ""},
        {"passive_joint_velocity", Role::velocity, "", "passive_joint"},
        {"", Role::other, "", ""},
    };
    for (const Expectation& expected : expectations) {
        INFO(expected.name);
        const ColumnName name = read_column_name(expected.name);
        CHECK(name.role == expected.role);
        if (expected.role == Role::other) continue;
        CHECK(name.unit == expected.unit);
        CHECK(name.joint == expected.joint);
        CHECK_FALSE(name.reference);
    }
}

TEST_CASE("a wished quantity is told from a measured one", "[log]") {
    for (const std::string name :
         {"target_q_0", "ref_velocity", "desired torque", "model_torque_Nm", "cmd_vel", "tau_ctrl",
          "j1_ref_velocity_deg_s", "state.dq_d[3]", "tau_J_d", "setpoint_speed"}) {
        INFO(name);
        CHECK(read_column_name(name).reference);
    }
}

TEST_CASE("joints named alike are one joint", "[log]") {
    for (const std::string name : {"3", "j3", "J3", "joint3", "joint_3", "axis3", "A3"})
        CHECK(joint_key(name) == "3");
    CHECK(joint_key("Elbow_Joint") == "elbow_joint");
    CHECK(joint_key("j") == "j");
}

TEST_CASE("units are understood in their usual spellings", "[log]") {
    const std::vector<std::pair<std::string, std::string>> spellings = {
        {"rad/s", "rad/s"},   {"rad_s", "rad/s"},      {"rad/sec", "rad/s"}, {"rad s^-1", "rad/s"},
        {"deg/s", "deg/s"},   {"\xc2\xb0/s", "deg/s"}, {"1/min", "rpm"},     {"U/min", "rpm"},
        {"ms", "ms"},         {"\xc2\xb5s", "us"},     {"sec", "s"},         {"N\xc2\xb7m", "Nm"},
        {"N-m", "Nm"},        {"Degrees", "deg"},      {"mNm", "mNm"},       {"A", "A"},
        {"mA", "mA"},         {"amps", "A"},           {"uNm", "uNm"},       {"N_mm", "Nmm"},
        {"oz-in", "ozf.in"},  {"ft_lb", "lbf.ft"},     {"kgf.cm", "kgf.cm"}, {"days", "d"},
        {"turns/s", "rev/s"}, {"mrad", "mrad"}};
    for (const auto& [written, usual] : spellings) {
        INFO(written);
        CHECK(usual_unit(written, Role::other) == usual);
    }
    CHECK(usual_unit("nm", Role::torque) == "Nm");
    CHECK(usual_unit("cnm", Role::torque) == "cNm");
    CHECK_FALSE(usual_unit("MNm", Role::torque));
    CHECK_FALSE(usual_unit("N/m", Role::torque));
    CHECK_FALSE(usual_unit("r/s", Role::velocity));
    CHECK_FALSE(usual_unit("furlong", Role::velocity));
    CHECK_FALSE(usual_unit("", Role::other));
    CHECK(role_factor(Role::torque, "mA", {.nm_per_ampere = 2.0, .lead_m = 1.0}) == 2e-3);
    CHECK_FALSE(role_factor(Role::velocity, "Nm"));
}

TEST_CASE("a unit of torque that is not read is sure, and comes behind one that is", "[log]") {
    for (const std::string name : {"torque_percent", "torque_V", "torque [stone]", "torque [%]"}) {
        INFO(name);
        CHECK(read_column_name(name).unit_is_sure);
        CHECK(read_column_name(name).rank > read_column_name("torque_nm").rank);
    }
    CHECK_FALSE(read_column_name("torque_nm").unit_is_sure);
}

TEST_CASE("a letter is a quantity where nothing else is, and another reading is asked about", "[log]") {
    const auto role_in = [](const std::vector<std::string>& names, std::size_t column) {
        return read_column_names(names, {})[column].role;
    };
    CHECK(role_in({"t", "v", "tau", "q"}, 1) == Role::velocity);
    CHECK(role_in({"t", "w", "T", "th"}, 1) == Role::velocity);
    CHECK(role_in({"t", "w", "T", "th"}, 2) == Role::torque);
    CHECK(role_in({"t", "w", "T", "th"}, 3) == Role::position);
    CHECK(role_in({"T", "v", "tau"}, 0) == Role::time);
    CHECK(role_in({"time [s]", "v1", "T1 [Nm]", "v2", "T2 [Nm]"}, 4) == Role::torque);
    CHECK(read_column_names({"time [s]", "v1", "T1 [Nm]", "v2", "T2 [Nm]"}, {})[3].joint == "2");
    CHECK(role_in({"t", "v", "velocity", "tau"}, 1) == Role::other);
    CHECK(role_in({"t", "v [V]", "tau"}, 1) == Role::other);
    CHECK(role_in({"t", "i", "v", "tau"}, 2) == Role::other);
    CHECK(read_column_names({"t", "i", "v", "tau"}, {})[2].symbol == Role::velocity);
}

// The law of units that nobody states: what is read is the truth, or the truth is among the readings listed.

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
        INFO(known.family << ": " << known.names);
        for_each_word(known.names, [&](std::string_view name) {
            if (name.front() == '=') name.remove_prefix(1);
            const Convention* const found =
                read_column_names({std::string(name), std::string(known.beside)}, {})[0].convention(
                    known.role);
            REQUIRE(found != nullptr);
            CHECK(found->unit == known.unit);
        });
        CHECK_FALSE(known.source.empty());
        // Electrical speeds need the pairs of poles, as counts need their scale.
        CHECK((known.unit == "erpm" || role_factor(known.role, known.unit).has_value()));
    }
}
