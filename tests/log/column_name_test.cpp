// SPDX-License-Identifier: MIT
// Names of columns as loggers write them: role, unit, joint.
#include <string>
#include <vector>

#include "log/columns/column_name.hpp"
#include "log/columns/units.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;

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
        {"rad/s", "rad/s"},   {"rad_s", "rad/s"},
        {"rad/sec", "rad/s"}, {"rad s^-1", "rad/s"},
        {"deg/s", "deg/s"},   {"\xc2\xb0/s", "deg/s"},
        {"1/min", "rpm"},     {"U/min", "rpm"},
        {"ms", "ms"},         {"\xc2\xb5s", "us"},
        {"sec", "s"},         {"N\xc2\xb7m", "Nm"},
        {"N-m", "Nm"},        {"Degrees", "deg"},
        {"mNm", "mNm"},       {"A", "A"},
        {"mA", "mA"},         {"amps", "A"}};
    for (const auto& [written, usual] : spellings) {
        INFO(written);
        CHECK(usual_unit(written, Role::other) == usual);
    }
    CHECK(usual_unit("nm", Role::torque) == "Nm");
    CHECK_FALSE(usual_unit("furlong", Role::velocity));
    CHECK_FALSE(usual_unit("", Role::other));
    CHECK(role_factor(Role::torque, "mA", {.nm_per_ampere = 2.0, .lead_m = 1.0}) == 2e-3);
    CHECK_FALSE(role_factor(Role::velocity, "Nm"));
}

TEST_CASE("a unit of torque that is not read is sure, and comes behind one that is", "[log]") {
    for (const std::string name : {"torque_percent", "torque_lbf_in", "tau ft_lb", "torque [%]"}) {
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
