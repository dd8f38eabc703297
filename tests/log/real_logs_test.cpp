// SPDX-License-Identifier: MIT
// Real robots' logs, read where they lie. They are not part of the project: without the folder nothing is
// checked, and each case says so.
#include <filesystem>
#include <string>

#include "log_support.hpp"
#include "support/catch.hpp"
#include "support/places.hpp"
#include "support/skipped.hpp"

using namespace ripplenotch;
using namespace ripplenotch::test;
using Catch::Contains;
using Catch::Matchers::WithinAbs;

namespace {

const std::string folder = logs_folder();

bool absent(const std::string& name) {
    if (std::filesystem::exists(folder + "/" + name)) return false;
    skipped(name + " is not in the folder of real logs");
    return true;
}

ReadOptions joint(const std::string& name) {
    ReadOptions options;
    options.joint = name;
    return options;
}

double identity(double torque) { return torque; }

}  // namespace

TEST_CASE("real: the Panda's clock jitters, its samples are held, and its units agree", "[log][real]") {
    for (const std::string name : {"gpl3/panda_gaz_j1.csv", "gpl3/panda_gaz_j4.csv"}) {
        if (absent(name)) return;
        const Log log = read_log(folder + "/" + name, {});
        CHECK(log.trace.size() == 20544);
        // 20543 steps in 20.9993 s; the median step of 1 ms would say 1000 Hz.
        CHECK_THAT(log.trace.sample_rate.value(), WithinAbs(978.28, 0.01));
        CHECK_THAT(log.recording.clock.longest_step.value(), WithinAbs(0.00881, 1e-5));
        CHECK_THAT(log.clock_factor.value(), WithinAbs(1.0, 0.002));
        // Rows that repeat torque, velocity and position while moving, faster than 0.2 deg/s,
        // counted with another program: 1132 and 1123.
        CHECK(log.recording.held.count == (name == "gpl3/panda_gaz_j1.csv" ? 1132 : 1123));
        CHECK(log.layout.warnings.empty());
        const std::string bytes = file_bytes(folder + "/" + name);
        CHECK(rewritten(bytes, identity) == bytes);
    }
}

TEST_CASE("real: six joints of a KUKA in one wide file, each with a right clock", "[log][real]") {
    for (const std::string name : {"kuka_kr300_trajA_all.csv", "kuka_kr300_trajB_all.csv"}) {
        if (absent(name)) return;
        const auto logs = read_joints_in_part(folder + "/" + name, {});
        REQUIRE(logs.size() == 6);
        for (const Log& log : logs) {
            CHECK(log.trace.size() == 2501);
            CHECK_THAT(log.trace.sample_rate.value(), WithinAbs(250.0, 1e-4));
            CHECK_THAT(log.clock_factor.value(), WithinAbs(1.0, 0.001));
            CHECK(log.recording.held.count == 0);
        }
        CHECK(logs[3].trace.joint == "j4");
    }
}

TEST_CASE("real: joints with names, effort for torque", "[log][real]") {
    const std::string name = "ur10_unisa_exciting_all.csv";
    if (absent(name)) return;
    const auto logs = read_joints_in_part(folder + "/" + name, {});
    REQUIRE(logs.size() == 6);
    CHECK(logs[0].trace.joint == "shoulder_pan_joint");
    CHECK(logs[5].trace.joint == "wrist_3_joint");
    for (const Log& log : logs) {
        CHECK_THAT(log.trace.sample_rate.value(), WithinAbs(125.0, 1e-3));
        CHECK_THAT(log.clock_factor.value(), WithinAbs(1.0, 0.002));
    }
}

TEST_CASE("real: the LARA's coarse torque is not taken for holds and its model not for a measurement",
          "[log][real]") {
    const std::string name = "neura_lara8_j3.csv";
    if (absent(name)) return;
    const Log log = read_log(folder + "/" + name, {});
    CHECK(log.layout.columns[log.layout.chosen.torque.value()].name == "torque_Nm");
    CHECK(log.recording.held.count == 0);
    CHECK_THAT(log.trace.sample_rate.value(), WithinAbs(249.064, 0.001));
    CHECK_THAT(log.clock_factor.value(), WithinAbs(1.0, 0.005));
}

TEST_CASE("real: 115 columns with an unnamed index, torque measured in two ways of which one is silent",
          "[log][real]") {
    const std::string name = "raw/neura_lara8_0.5_original.csv";
    if (absent(name)) return;
    const Log log = read_log(folder + "/" + name, joint("j3"));
    CHECK(log.trace.size() == 216);
    CHECK(log.trace.joint == "3");
    CHECK(log.layout.columns.size() == 115);
    CHECK(log.layout.columns[log.layout.chosen.time.value()].name == "Timestamp");
    CHECK(log.layout.columns[log.layout.chosen.torque.value()].name == "joint_torque_current_3");
    CHECK(log.trace.time_s[0] == 2315.505423811);
    REQUIRE(log.layout.warnings.size() == 2);
    CHECK_THAT(log.layout.warnings[0].text, Contains("'encoder_torques_3'") && Contains("does not change"));
    CHECK_THAT(log.layout.warnings[1].text, Contains("no unit is stated"));
    CHECK(log.layout.columns[log.layout.chosen.velocity.value()].unit == "rad/s");
    const std::string bytes = file_bytes(folder + "/" + name);
    CHECK(rewritten(bytes, identity, {}, joint("3")) == bytes);
}

TEST_CASE("real: the same sweep raw and prepared is the same torque", "[log][real]") {
    const std::string raw = "raw/neura_lara8_validate_original.csv", prepared = "neura_lara8_j3.csv";
    if (absent(raw) || absent(prepared)) return;
    ReadOptions options = joint("3");
    options.units = {{"velocity", "rad/s"}, {"position", "rad"}};
    const Log original = read_log(folder + "/" + raw, options);
    const Log log = read_log(folder + "/" + prepared, {});
    CHECK(original.trace.torque_nm == log.trace.torque_nm);
    CHECK(original.trace.velocity_deg_s == log.trace.velocity_deg_s);
    CHECK_THAT(original.trace.sample_rate.value(), WithinAbs(log.trace.sample_rate.value(), 1e-4));
    CHECK_THAT(original.trace.time_s[0], WithinAbs(92125.37781627101, 1e-9));
}
