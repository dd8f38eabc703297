// SPDX-License-Identifier: MIT
// Whole logs: in pieces, all joints, written anew, and real ones.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>

#include "core/vectors/lanes.hpp"
#include "fuzz/reading.hpp"
#include "log/text/quick_rows.hpp"
#include "log/unpack/unpacked_source.hpp"
#include "log_support.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "support/catch.hpp"
#include "support/places.hpp"
#include "support/skipped.hpp"

using namespace ripplenotch;
using namespace ripplenotch::test;
using Catch::Contains;
using Catch::Matchers::WithinAbs;

// Logs that are too long to be held: what is kept of them, and what is still said of all of them.

namespace {

struct Course {
    std::size_t rows = 8000, gap_before = 0;
    double turn_deg = 0.0;  ///< where the position starts again; 0: it goes on
    double sign = 1.0;
};

// A joint at 90 deg/s and slowly more; 1 kHz.
void write_log(const std::string& path, const Course& course) {
    std::ofstream log(path);
    log << "time_s,velocity_deg_s,torque_nm,position_deg\n";
    for (std::size_t i = 0; i < course.rows; ++i) {
        const double t = 0.001 * static_cast<double>(i);
        const double gap = course.gap_before > 0 && i >= course.gap_before ? 5.0 : 0.0;
        double position = 90.0 * t + 0.5 * t * t;
        if (course.turn_deg > 0.0) position -= course.turn_deg * std::floor(position / course.turn_deg);
        log << shortest(t + gap) << ',' << shortest(90.0 + t) << ',' << shortest(std::sin(100.0 * t)) << ','
            << shortest(course.sign * position) << '\n';
    }
}

void check_same(const Log& part, const Log& all) {
    CHECK(part.recording.rows() == all.recording.rows());
    CHECK(part.recording.clock.mean_rate == all.recording.clock.mean_rate);
    CHECK(part.recording.clock.gap_count == all.recording.clock.gap_count);
    CHECK(part.recording.angle.verdict == all.recording.angle.verdict);
    CHECK(part.trace.sample_rate == all.trace.sample_rate);
    CHECK(part.trace.source == all.trace.source);
    CHECK(part.position_range_deg == all.position_range_deg);
    REQUIRE(part.clock_factor.has_value() == all.clock_factor.has_value());
    if (all.clock_factor) CHECK(*part.clock_factor == Approx(*all.clock_factor).epsilon(1e-12));
    CHECK(part.layout.warnings.size() == all.layout.warnings.size());
    CHECK(part.recording.warnings.size() == all.recording.warnings.size() + 1);
    CHECK_THAT(part.recording.warnings.back().text,
               Contains("of 8000 rows 1600 are examined, in 16 evenly spaced pieces"));
}

}  // namespace

TEST_CASE("of a long log sixteen evenly spread pieces are held, and all of it is accounted for", "[log]") {
    for (const Course& course :
         {Course{}, Course{.gap_before = 3777}, Course{.turn_deg = 360.0}, Course{.sign = -1.0}}) {
        const test::TemporaryPath path;
        write_log(path.string(), course);
        const Log all = read_log(path.string(), {}), part = read_log_in_part(path.string(), {}, 1600);
        check_same(part, all);
        REQUIRE(part.recording.looked_at);
        CHECK(part.recording.looked_at->rows == 1600);
        CHECK(part.recording.looked_at->pieces == 16);
        REQUIRE(part.trace.size() == 1600);
        REQUIRE(part.trace.position_deg.size() == all.trace.position_deg.size() / 5);
        std::size_t at = 0;
        for (std::size_t i = 0; i < part.trace.size(); ++i, ++at) {
            if (i % 100 == 0) at = (8000 - 100) / 15 * (i / 100);
            CHECK(part.trace.time_s[i] == all.trace.time_s[at]);
            CHECK(part.trace.velocity_deg_s[i] == all.trace.velocity_deg_s[at]);
            CHECK(part.trace.torque_nm[i] == all.trace.torque_nm[at]);
            CHECK(part.trace.position_deg[i] == Approx(all.trace.position_deg[at]).epsilon(1e-13));
            const bool starts = part.trace.view().starts_run(i);
            CHECK(starts == ((i > 0 && i % 100 == 0) || (course.gap_before > 0 && at == course.gap_before)));
        }
    }
}

TEST_CASE("a log that can be held is, to the last row", "[log]") {
    const test::TemporaryPath path;
    write_log(path.string(), {});
    const Log all = read_log(path.string(), {}), part = read_log_in_part(path.string(), {}, 8000);
    CHECK_FALSE(part.recording.looked_at);
    CHECK(part.trace.torque_nm == all.trace.torque_nm);
    CHECK(part.recording.warnings.size() == all.recording.warnings.size());
    CHECK(read_log_in_part(path.string(), {}, 7999).recording.looked_at);
}

// All joints of a log in one pass are what they are one by one.

namespace {

// Joints 1 and 2, whose second position wraps and whose third column of both is in another unit; joint 3 has
// no torque.
std::string rows() {
    std::string text = "time_s,q1_rad,dq1_rad_s,tau1_Nm,q2_deg,dq2_deg_s,tau2_Nm,q3_deg,dq3_deg_s\n";
    for (int k = 0; k < 3000; ++k) {
        const double t = 0.01 * k + (k > 2000 ? 1.0 : 0.0);
        const double turned = 100.0 * t, wrapped = turned - 360.0 * static_cast<int>(turned / 360.0);
        for (const double value :
             {t, 0.5 * t, 0.5, 3.0 + 0.1 * (k % 7), wrapped, 100.0, 4.0 + 0.1 * (k % 5), -10.0 * t})
            text += std::to_string(value) + ",";
        text += "-10\n";
    }
    return text;
}

}  // namespace

TEST_CASE("joints read at once are the joints read one by one", "[log]") {
    const TemporaryPath path;
    std::ofstream(path.string()) << rows();
    const auto one = read_joints_in_part(path.string(), {}), all = read_joints_at_once(path.string(), {});
    REQUIRE(one.size() == 2);
    REQUIRE(all.size() == 2);
    for (std::size_t j = 0; j < 2; ++j) {
        CHECK(all[j].trace.joint == one[j].trace.joint);
        CHECK(all[j].trace.time_s == one[j].trace.time_s);
        CHECK(all[j].trace.position_deg == one[j].trace.position_deg);
        CHECK(all[j].trace.velocity_deg_s == one[j].trace.velocity_deg_s);
        CHECK(all[j].trace.torque_nm == one[j].trace.torque_nm);
        CHECK(all[j].trace.run_starts == one[j].trace.run_starts);
        CHECK(all[j].trace.sample_rate == one[j].trace.sample_rate);
        CHECK(all[j].layout.chosen.torque == one[j].layout.chosen.torque);
        CHECK(all[j].recording.angle.verdict == one[j].recording.angle.verdict);
        CHECK(all[j].position_range_deg == one[j].position_range_deg);
    }
    CHECK(all[0].trace.run_starts.size() == 1);
}

TEST_CASE("what is said of several joints read in one pass is what is said of each alone", "[log]") {
    const TemporaryPath path;
    std::ofstream(path.string()) << rows();
    const Spool log(path.string());
    const auto each = read_each_if_short(log, {}, all_rows);
    REQUIRE(each.size() == 2);
    for (const Log& joint : each) {
        ReadOptions alone;
        alone.joint = joint.trace.joint;
        const Log one = read_log(path.string(), alone);
        CHECK(joint.layout.chosen.torque == one.layout.chosen.torque);
        CHECK(joint.layout.others.empty());
        CHECK(joint.layout.joints == one.layout.joints);
        CHECK(joint.layout.options == one.layout.options);
        CHECK(joint.layout.warnings == one.layout.warnings);
        CHECK(joint.recording.warnings == one.recording.warnings);
        CHECK(joint.trace.position_deg == one.trace.position_deg);
        CHECK(joint.trace.velocity_deg_s == one.trace.velocity_deg_s);
        for (std::size_t c = 0; c < one.layout.columns.size(); ++c) {
            CHECK(joint.layout.columns[c].role == one.layout.columns[c].role);
            CHECK(joint.layout.columns[c].factor == one.layout.columns[c].factor);
            CHECK(joint.layout.columns[c].unused == one.layout.columns[c].unused);
        }
    }
    ReadOptions alone;
    alone.joint = each[0].trace.joint;
    CHECK(read_each_if_short(log, alone, all_rows).empty());
    CHECK(read_each_if_short(log, {}, 5999).empty());
}

TEST_CASE("a joint without a torque is read where its motion is enough", "[log]") {
    const TemporaryPath path;
    std::ofstream(path.string()) << rows();
    ReadOptions options;
    options.torque_of_each = false;
    const auto all = read_joints_at_once(path.string(), options);
    REQUIRE(all.size() == 3);
    CHECK_FALSE(all[2].layout.chosen.torque);
    CHECK(all[2].trace.size() == all[0].trace.size());
    CHECK(all[2].trace.position_deg[100] == Approx(-10.0));
    CHECK(std::isnan(all[2].trace.torque_nm.front()));
}

TEST_CASE("of a long log all joints are looked at in the same pieces as one by one", "[log]") {
    const TemporaryPath path;
    std::ofstream(path.string()) << rows();
    ReadOptions options;
    options.torque_of_each = false;
    const auto all = read_joints_at_once(path.string(), options, 480);
    REQUIRE(all.size() == 3);
    for (const Log& joint : all) {
        REQUIRE(joint.recording.looked_at);
        CHECK(joint.trace.size() == 480);
        CHECK(joint.trace.time_s == all[0].trace.time_s);
        CHECK(joint.layout.others.empty());
    }
    for (const Log& joint : {all[0], all[1]}) {
        ReadOptions alone;
        alone.joint = joint.trace.joint;
        const Log one = read_log_in_part(path.string(), alone, 480);
        CHECK(joint.layout.chosen.torque == one.layout.chosen.torque);
        CHECK(joint.trace.time_s == one.trace.time_s);
        CHECK(joint.trace.position_deg == one.trace.position_deg);
        CHECK(joint.trace.torque_nm == one.trace.torque_nm);
        CHECK(joint.trace.run_starts == one.trace.run_starts);
        CHECK(joint.recording.angle.verdict == one.recording.angle.verdict);
    }
    CHECK_FALSE(all[2].layout.chosen.torque);
    const auto held = read_joints_at_once(path.string(), options, 3000);
    CHECK(held[0].trace.size() == 3000);
    CHECK_FALSE(held[0].recording.looked_at);
}

// What filter passes on: every byte but the torque.

namespace {

WriteOptions append(const std::string& name = "torque_filtered") {
    WriteOptions options;
    options.append = true;
    options.append_name = name;
    return options;
}

}  // namespace

TEST_CASE("a torque that is not changed leaves every byte of every dialect", "[log]") {
    for (const auto& entry : std::filesystem::directory_iterator(source_folder() + "/data/dialects")) {
        if (entry.path().extension() != ".csv") continue;
        INFO(entry.path());
        const std::string text = file_bytes(entry.path().string());
        ReadOptions options;
        if (entry.path().stem() == "no_header") options.columns = {"time", "velocity", "torque"};
        if (entry.path().stem() == "no_time") options.sample_rate = Hertz(100.0);
        if (entry.path().stem() == "libfranka_style") options.joint = "0", options.units["time"] = "ms";
        if (entry.path().stem() == "named_joints") options.joint = "wrist_1_joint";
        CHECK(rewritten(text, same, {}, options) == text);
        CHECK(rewritten(text, same, {}, options, "", 7) == text);
        CHECK(rewritten(text, doubled, {}, options) == rewritten(text, doubled, {}, options, "", 1));
    }
}

TEST_CASE("only the characters of the torque change", "[log]") {
    CHECK(rewritten("\xef\xbb\xbf# c\r\n\"time [s]\";\"dq [deg/s]\";\"tau [mNm]\";x\r\n0;1;\"1500\";a\r\n# "
                    "mid\r\n0,5;1; 250,5 ;\r\n\r\n1;1;3,5;\"b;c\"",
                    doubled) ==
          "\xef\xbb\xbf# c\r\n\"time [s]\";\"dq [deg/s]\";\"tau [mNm]\";x\r\n0;1;\"3000\";a\r\n# "
          "mid\r\n0,5;1; 501 ;\r\n\r\n1;1;7;\"b;c\"");
    CHECK(rewritten("t_s dq_deg_s tau_Nm \n 0   1  2.5 \n 1   1  -4 \nEOF\n", doubled) ==
          "t_s dq_deg_s tau_Nm \n 0   1  5 \n 1   1  -8 \nEOF\n");
}

TEST_CASE("decimals are shortest or fixed", "[log]") {
    const std::string text = "time_s,velocity_deg_s,torque_nm\n0,1,1.250\n1,1,3\n2,1,0.1\n";
    WriteOptions options;
    const auto third = [](double torque) { return torque / 3.0; };
    CHECK(rewritten(text, third, options) ==
          "time_s,velocity_deg_s,torque_nm\n0,1,0.4166666666666667\n1,1,1\n2,1,0.03333333333333333\n");
    options.decimals = WriteOptions::Decimals::fixed;
    options.fixed_decimals = 2;
    CHECK(rewritten(text, same, options) ==
          "time_s,velocity_deg_s,torque_nm\n0,1,1.25\n1,1,3.00\n2,1,0.10\n");
}

TEST_CASE("an appended column is named and unit-marked like the torque's, wherever the row ends", "[log]") {
    CHECK(rewritten("time_s,velocity_deg_s,torque_Nm\r\n0,1,2\r\n1,1,3\r\n", doubled, append()) ==
          "time_s,velocity_deg_s,torque_Nm,torque_filtered_Nm\r\n0,1,2,4\r\n1,1,3,6\r\n");
    CHECK(rewritten("time_s;dq [deg/s];tau [mNm]\n0;1;2\n1;1;3,5\n", doubled, append("clean")) ==
          "time_s;dq [deg/s];tau [mNm];clean [mNm]\n0;1;2;4\n1;1;3,5;7\n");
    CHECK(rewritten("\"time_s\",\"velocity_deg_s\",\"torque\"\n0,1,2\n1,1,3\n", doubled, append()) ==
          "\"time_s\",\"velocity_deg_s\",\"torque\",\"torque_filtered\"\n0,1,2,4\n1,1,3,6\n");
    CHECK(rewritten("time velocity torque \n[s] [deg/s] [Nm] \n0 1 2 \n1 1 3 \n", doubled, append()) ==
          "time velocity torque torque_filtered \n[s] [deg/s] [Nm] [Nm] \n0 1 2 4 \n1 1 3 6 \n");
    CHECK(rewritten("0,1,2\n1,1,3", doubled, append(), with_columns({"time", "velocity", "torque"})) ==
          "0,1,2,4\n1,1,3,6");
    CHECK(rewritten("\"time_s\",\"velocity_deg_s\",\"torque_nm\"\n\"0\",\"1\",\"2\"\n\"0,5\",\"1\",\"2,5\"\n",
                    doubled, append()) ==
          "\"time_s\",\"velocity_deg_s\",\"torque_nm\",\"torque_filtered_nm\"\n\"0\",\"1\",\"2\",\"4\"\n\"0,"
          "5\",\"1\",\"2,5\",\"5\"\n");
}

TEST_CASE("a log with an appended column reads as the original", "[log]") {
    const std::string text = rewritten("time_s,velocity_deg_s,torque_Nm\n0,1,2\n1,1,3\n", doubled, append());
    CHECK(read_text(text).trace.torque_nm == std::vector<double>{2, 3});
    CHECK(read_text(text, with_columns({"torque=torque_filtered_Nm"})).trace.torque_nm ==
          std::vector<double>{4, 6});
}

TEST_CASE("held values are written, not the bad text that they replaced", "[log]") {
    ReadOptions options;
    options.hold_bad_values = true;
    CHECK(rewritten("time_s,velocity_deg_s,torque_nm\n0,1,2\n1,1,nan\n2,1,\n", same, {}, options) ==
          "time_s,velocity_deg_s,torque_nm\n0,1,2\n1,1,2\n2,1,2\n");
}

TEST_CASE("a log converted to another format keeps its numbers", "[log]") {
    const std::string text = "time_ms,velocity_rad_s,tau_Nm,q_rad\n0,1,2.5,0\n10,1.5,-0.1,0.25\n";
    const std::string array = rewritten(text, doubled, {}, {}, "npy");
    const Log log = read_text(array);
    CHECK(log.layout.format == "npy");
    CHECK(log.trace.torque_nm == std::vector<double>{5, -0.2});
    CHECK(log.trace.time_s == std::vector<double>{0, 0.01});
    CHECK(log.trace.velocity_deg_s == read_text(text).trace.velocity_deg_s);
    CHECK(log.trace.position_deg == read_text(text).trace.position_deg);
    CHECK_THAT(rewritten(array, same, {}, {}, "csv"),
               Contains("time_s,velocity_deg_s,torque_nm,position_deg\n0,") && Contains("\n0.01,"));
    CHECK_THAT(rewritten(array, same, append(), {}, "csv"), Contains("position_deg,torque_filtered_nm\n"));
}

TEST_CASE("many rows, with any length of text between their numbers, are put together as one row is",
          "[log]") {
    WriteOptions options;
    options.decimals = WriteOptions::Decimals::fixed;
    options.fixed_decimals = 3;
    std::string text = "time_s,velocity_deg_s,torque_nm,note\n", expected = text;
    for (int row = 0; row < 1500; ++row) {
        const double torque = (row * 37 % 2001 - 1000) * (row % 50 == 0 ? 1e9 : 0.0625);
        const std::string before = std::to_string(row) + "," + std::to_string(row % 7) + ",";
        const std::string behind = "," + std::string(static_cast<std::size_t>(row * row % 97), 'x') + "\n";
        std::string doubled_torque;
        append_fixed(doubled_torque, 2.0 * torque, 3);
        text += before + shortest(torque) + behind;
        expected += before + doubled_torque + behind;
    }
    CHECK(rewritten(text, doubled, options) == expected);
    CHECK(rewritten(text, doubled, options, {}, "", 333) == expected);
}

TEST_CASE("a converted log has the decimals that were asked for", "[log]") {
    WriteOptions options;
    options.decimals = WriteOptions::Decimals::fixed;
    options.fixed_decimals = 2;
    const std::string array =
        rewritten("time_s,velocity_deg_s,torque_nm\n0,1,2.5\n0.5,-0.125,1e12\n", same, {}, {}, "npy");
    CHECK(rewritten(array, doubled, options, {}, "csv") ==
          "time_s,velocity_deg_s,torque_nm\n0.00,1.00,5.00\n0.50,-0.12,2000000000000.00\n");
}

// Real robots' logs, read where they lie. They are not part of the project: without the folder nothing is
// checked, and each case says so.

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

// Logs of strangers: broken, cut off, damaged on the way.

// Ways to break a text log: each gives one message with file, line, column, what was read, expected, and to
// be done.

namespace {

const std::string head = "time_s,velocity_deg_s,torque_nm\n";

}  // namespace

TEST_CASE("a counter that begins anew is told as such, with what the log says and what to do") {
    const std::string tail = ",10,2.5\n";
    const auto after = [&](const std::string& unit, const std::string& before, const std::string& time) {
        return complaint("time_" + unit + ",velocity_deg_s,torque_nm\n" + before + tail + time + tail);
    };
    CHECK_THAT(after("ms", "65535", "0"), Contains("read the time 0 after 65535") &&
                                              Contains("a counter of 16 bits") && Contains("--to") &&
                                              Contains("--sample-rate"));
    CHECK_THAT(after("us", "4294967000", "704"),
               Contains("a counter of 32 bits") && Contains("after 4294967000"));
    CHECK_THAT(after("us", "2147483000", "-2147483296"), Contains("a counter of 32 bits"));
    CHECK_THAT(after("ms", "86399999", "0"), Contains("a time of day"));
    CHECK_THAT(after("ms", "65535", "30000"), !Contains("counter") && Contains("sort or split"));
    CHECK_THAT(after("ms", "65000", "64000"), !Contains("counter"));
    CHECK_THAT(after("ns", "1700000000000001000", "1700000000000000000"),
               Contains("read the time 1700000000000000000 after 1700000000000001000"));
}

TEST_CASE("a broken row is named by line and column with the remedy", "[log]") {
    CHECK_THAT(
        complaint(head + "0,10,2.5\n0.01,abc,3\n0.02,12,4\n"),
        Contains("log.csv:3:6: read 'abc' in 'velocity_deg_s' (column 2), expected a number; correct or "
                 "remove the line"));
    CHECK_THAT(complaint(head + "0,10,2.5\n0.01,11,nan\n0.02,12,4\n"),
               Contains("log.csv:3:9: read 'nan' in 'torque_nm' (column 3), expected a finite number"));
    CHECK_THAT(complaint(head + "0,10,2.5\n0.01,11,-inf\n0.02,12,4\n"), Contains("log.csv:3:9: read '-inf'"));
    CHECK_THAT(complaint(head + "0,10,2.5\n0.01,11,1e999\n0.02,12,4\n"),
               Contains("log.csv:3:9: read '1e999'"));
    CHECK_THAT(complaint(head + "0,10,2.5\n0.01,11\n0.02,12,4\n"),
               Contains("log.csv:3:8: read 2 cells, expected 3; correct"));
    CHECK_THAT(complaint(head + "0,10,2.5\n0.01,11,1,2\n0.02,12,4\n"),
               Contains("log.csv:3:12: read 4 cells, expected 3"));
    CHECK_THAT(complaint(head + "0,10,2.5\n0.01,11,1\n0.0"),
               Contains("log.csv:4:4: read 1 cells, expected 3; the last line is cut off"));
    CHECK_THAT(complaint(head + "0,10,2.5\n0.02,11,1\n0.01,12,4\n"),
               Contains("log.csv:4:1: read the time 0.01 after 0.02, expected time to run forward"));
    CHECK_THAT(complaint(head + "0,10,2.5\n0.01,11,\"1\n0.02,12,4\n"),
               Contains("log.csv:3:9") && Contains("quote"));
    CHECK_THAT(complaint(head + "0,10,2.5\n0.01,11,1 2\n0.02,12,4\n"), Contains("read '1 2'"));
    CHECK_THAT(complaint(head + "0,10,2.5\n0.01,11,0x1F\n0.02,12,4\n"), Contains("read '0x1F'"));
}

TEST_CASE("a broken file is refused with one sentence", "[log]") {
    CHECK_THAT(complaint(""), Contains("log.csv: read an empty file, expected rows of numbers"));
    CHECK_THAT(complaint(head), Contains("log.csv:1: read only a header"));
    CHECK_THAT(complaint("time,velocity,torque\ns,deg/s,Nm\n"), Contains("only a header"));
    CHECK_THAT(complaint("\n\n# nothing\n"), Contains("without a row of numbers"));
    CHECK_THAT(complaint(std::string("\x7f"
                                     "ELF\x02\x01\x01\x00\x00\x00",
                                     10)),
               Contains("read the byte 0x02, expected text"));
    CHECK_THAT(complaint(std::string("time_s,velocity_deg_s,torque_nm\n0,10,\0\n", 39)),
               Contains("log.csv:2:6: read the byte 0x00"));
    CHECK_THAT(complaint("\xff\xfet\0i\0m\0e\0"), Contains("UTF-16") && Contains("iconv"));
    CHECK_THAT(complaint("time_s,velocity_deg_s,torque_nm\r0,1,2\r1,1,2\r"),
               Contains("CR alone") && Contains("tr '"));
    CHECK_THAT(complaint("PK\x03\x04"), Contains("ZIP"));
    CHECK_THAT(complaint("time_s,velocity_deg_s,torque_nm\n0,1,2\n1,2\n"), Contains("cells, expected"));
    CHECK_THAT(complaint("a sentence, that is no log\nand another one here\nand one more\n"),
               Contains("expected numbers"));
    CHECK_THAT(complaint("time_s,velocity_deg_s\n0,1\n1,2\n"),
               Contains("expected a torque column") && Contains("--columns torque=NAME"));
    CHECK_THAT(complaint("time_s,velocity_deg_s,torque_nm\n5,1,2\n5,1,2\n"),
               Contains("time does not advance"));
    CHECK_THAT(complaint("time_s,0.5,torque_nm\n0,10,2.5\n0.01,11,-0.25\n"),
               Contains("half names and half numbers"));
}

TEST_CASE("a unit that does not measure what the column is refused", "[log]") {
    CHECK_THAT(complaint("time_s,velocity [kg],torque_nm\n0,1,2\n1,2,3\n"),
               Contains("'velocity [kg]' (column 2) in 'kg'") && Contains("deg/s") &&
                   Contains("--unit velocity=deg/s"));
    CHECK_THAT(complaint("time_s,velocity [m/s],torque_nm\n0,1,2\n1,2,3\n"),
               Contains("'velocity [m/s]' (column 2) in m/s") && Contains("--lead 5mm"));
    CHECK_THAT(complaint("time_s,velocity_deg_s,torque [V]\n0,1,2\n1,2,3\n"), Contains("in V"));
    ReadOptions options;
    options.units["velocity"] = "furlong";
    CHECK_THROWS_AS(read_text(head + "0,1,2\n1,2,3\n", options), UsageError);
    ReadOptions unknown;
    unknown.units["sped"] = "deg/s";
    CHECK_THROWS_WITH(read_text(head + "0,1,2\n1,2,3\n", unknown), Contains("'sped'"));
}

TEST_CASE("damage after the part that was looked at first is found as well", "[log]") {
    std::string rows = head;
    for (int row = 0; rows.size() < 200000; ++row) rows += std::to_string(row / 1000.0) + ",10,2.5\n";
    CHECK_THAT(complaint(rows + "1000,10,\x01\n1000,10,1\n"), Contains("byte 0x01"));
    CHECK_THAT(complaint(rows + std::string(3 << 20, '7') + "\n"), Contains("more than 1 MiB"));
    CHECK_THAT(complaint(rows + "EOF\n1000,10,1\n"), Contains("EOF"));
    CHECK_THAT(complaint(rows + "1000,10"), Contains("cut off"));
    CHECK_THAT(complaint(head + std::string(20 << 20, '7')), Contains("log.csv:2"));
}

// Packed logs that are damaged on the way: what came before, and what is said, do not depend on the pieces in
// which the bytes arrive. Their blocks are stored as they are, so that they can be written by hand, or are
// the few bytes to which programs pack many equal rows.

namespace {

std::string text_of(int rows) {
    std::string text = "time_s,velocity_deg_s,torque_nm\n";
    for (int k = 0; k < rows; ++k) text += "0." + std::to_string(100 + k) + ",60,1.5\n";
    return text;
}

std::string little_endian(std::size_t number, int bytes) {
    std::string text;
    for (int i = 0; i < bytes; ++i) text += static_cast<char>(number >> (8 * i) & 0xFF);
    return text;
}

// Blocks of equal size, then one of a kind that there is none of.
template <class Block>
std::string stored(const std::string& text, std::size_t blocks, std::string front, const std::string& wrong,
                   const Block& block) {
    const std::size_t size = (text.size() + blocks - 1) / blocks;
    for (std::size_t at = 0; at < text.size(); at += size) front += block(text.substr(at, size));
    return front + wrong + std::string(300, 'x');
}

std::string damaged_zstd(const std::string& text, std::size_t blocks) {
    return stored(text, blocks, {"\x28\xb5\x2f\xfd\0\x50", 6}, {"\x06\0\0", 3},
                  [](const std::string& part) { return little_endian(part.size() << 3U, 3) + part; });
}

// Of another length than its head says: libzstd notices with the last byte.
std::string zstd_of_another_length(const std::string& text) {
    const std::size_t half = text.size() / 2;
    return std::string("\x28\xb5\x2f\xfd\x40\x50", 6) + little_endian(text.size() + 500, 2) +
           little_endian(half << 3U, 3) + text.substr(0, half) +
           little_endian((text.size() - half) << 3U | 1U, 3) + text.substr(half);
}

std::string damaged_lz4(const std::string& text, std::size_t blocks) {
    return stored(text, blocks, {"\x04\x22\x4d\x18\x60\x40\x82", 7}, "\xff\xff\xff\x7f",
                  [](const std::string& part) { return little_endian(part.size() | 0x80000000U, 4) + part; });
}

std::string damaged_gzip(const std::string& text, std::size_t blocks) {
    return stored(text, blocks, {"\x1f\x8b\x08\0\0\0\0\0\0\x03", 10}, "\x06", [](const std::string& part) {
        return '\0' + little_endian(part.size(), 2) + little_endian(~part.size(), 2) + part;
    });
}

std::string bytes_of(std::string_view hex) {
    std::string bytes;
    for (std::size_t i = 0; i + 1 < hex.size(); i += 2)
        bytes += static_cast<char>(std::stoi(std::string(hex.substr(i, 2)), nullptr, 16));
    return bytes;
}

// "velocity_deg_s,torque_nm" and 150 times "60,1.5", packed with a checksum by zstd, lz4 and gzip.
constexpr std::array<std::string_view, 3> packed_rows = {
    "28b52ffd6433033d0100f876656c6f636974795f6465675f732c746f727175655f6e6d0a36302c312e35010047a0bf38014a869a"
    "92",
    "04224d186440a72e000000ff1076656c6f636974795f6465675f732c746f727175655f6e6d0a36302c312e350700ffffffff0050"
    "2c312e350a00000000d76b1463",
    "1f8b08000000000002032b4bcdc94fce2ca98c4f494d8f2fd629c92f2a2c4d8dcfcbe53233d031d4331da546a9516a9442a60040"
    "46b15f33040000"};

}  // namespace

TEST_CASE("a packed log is read alike in pieces of any size, whichever byte of it is wrong", "[log]") {
    for (const std::string_view hex : packed_rows) {
        const std::string good = bytes_of(hex);
        const Packing* const packing = packing_of(good);
        REQUIRE(packing != nullptr);
        if (packing->make == nullptr) continue;
        const ReadOptions options = fuzz::options_of(4);  // a log without time, at 1 kHz
        CHECK(fuzz::reading(good, options, good.size() + 1).back() == '|');
        std::size_t refused = 0;
        for (std::size_t at = 4; at < good.size(); ++at) {
            for (const int wrong : {0x01, 0x10, 0xff}) {
                std::string bytes = good;
                bytes[at] = static_cast<char>(bytes[at] ^ wrong);
                CAPTURE(packing->name, at, wrong);
                const std::string whole = fuzz::reading(bytes, options, bytes.size() + 1);
                refused += whole.back() == '|' ? 0U : 1U;
                for (const std::size_t piece : {1U, 5U, 40U})
                    REQUIRE(fuzz::reading(bytes, options, piece) == whole);
            }
        }
        CHECK(refused > good.size());  // some bytes of a head say nothing of the rows
    }
}

// Of more than 512 bytes, too: those are looked at before the reader reads on, and what is left of their
// block waits within the library while the next one, damaged, comes.
TEST_CASE("where a packed log is damaged is said alike, however its bytes arrive", "[log]") {
    for (const auto& [rows, blocks] : {std::pair{30, 3U}, std::pair{300, 3U}, std::pair{300, 1U}}) {
        const std::string text = text_of(rows), other_length = zstd_of_another_length(text);
        for (const std::string& bytes : {damaged_zstd(text, blocks), other_length, damaged_lz4(text, blocks),
                                         damaged_gzip(text, blocks)}) {
            const Packing* const packing = packing_of(bytes);
            REQUIRE(packing != nullptr);
            if (packing->make == nullptr) continue;
            CAPTURE(rows, blocks, packing->name);
            const std::string whole = fuzz::reading(bytes, {}, bytes.size() + 1);
            CHECK_THAT(whole, Contains("damaged"));
            // How much of a last block of the wrong length comes is up to libzstd.
            if (bytes != other_length)
                CHECK_THAT(whole, Contains("read " + std::to_string(text.size()) + " bytes out of"));
            for (const std::size_t piece : {1U, 2U, 7U, 13U, 100U, 333U})
                CHECK(fuzz::reading(bytes, {}, piece) == whole);
        }
    }
}

// Logs of every dialect with a few bytes changed: vectors, the plain parser, the careful way and small pieces
// give the same rows or the same words. The fuzz targets do the same for hours.

namespace {

std::string log_of(std::mt19937& random) {
    const auto below = [&](std::size_t most) { return random() % most; };
    const char delimiter = std::array{',', ';', '\t', ' '}[below(4)];
    const char mark = delimiter == ';' && below(2) == 0 ? ',' : '.';
    const std::string end = std::array{"\n", "\r\n"}[below(2)];
    std::string text = below(5) == 0 ? "" : "time_s,velocity_deg_s,torque_nm,note" + end;
    const std::size_t rows = 20 + below(150);
    for (std::size_t k = 0; k < rows; ++k) {
        text += fmt::format("0.{:03d},{}.5,{}{}.25,n{}{}", k, below(100), below(2) == 0 ? "-" : "", below(10),
                            k, end);
    }
    for (char& c : text)
        if (c == ',') c = delimiter;
    for (std::size_t i = 1; i + 1 < text.size(); ++i)
        if (text[i] == '.') text[i] = mark;
    return text;
}

void mutate(std::string& text, std::mt19937& random) {
    constexpr std::string_view pieces[] = {
        "\"",   "#", "\n", "\r\n",  ",",         ";",    "\t", " ",  "\x1b", std::string_view("\0", 1), "nan",
        "1e31", "-", "1e", "EOF\n", "# 1,2,3\n", "\n\n", "%",  "//", "\xff", "12345678901234567890",    "é"};
    for (std::size_t changes = 1 + random() % 3; changes > 0; --changes) {
        const std::size_t at = random() % text.size();
        const std::string_view piece = pieces[random() % std::size(pieces)];
        switch (random() % 3) {
            case 0:
                text.replace(at, std::min(piece.size(), text.size() - at), piece);
                break;
            case 1:
                text.insert(at, piece);
                break;
            default:
                text.erase(at, 1 + random() % 12);
        }
    }
}

/// The same rows, or the same words, by vectors, plainly, carefully and in pieces.
void check_every_way(const std::string& text, const ReadOptions& options) {
    INFO(text);
    const std::string usual = fuzz::reading(text, options, text.size() + 1);
    {
        const NarrowVectors narrow;
        CHECK(fuzz::reading(text, options, text.size() + 1) == usual);
    }
    {
        const CarefulRows careful;
        CHECK(fuzz::reading(text, options, text.size() + 1) == usual);
    }
    for (const std::size_t piece : {1U, 7U, 100U}) CHECK(fuzz::reading(text, options, piece) == usual);
}

}  // namespace

TEST_CASE("a time of -0 is one however it is read", "[log]") {
    const std::string head = "time_s,velocity_deg_s,torque_nm,note\n";
    const std::string rest = "0.001,60,1,x\n0.002,60,2,x\n0.003,60,3,x\n";
    for (const std::string first : {"-0.000,60,0,x\n", "\"-0.000\",60,0,x\n", "-0e5,60,0,\"x\"\n"}) {
        check_every_way(head + first + rest, {});
        const auto reader = open_log(
            std::make_unique<ByteSource>("log", std::make_shared<const std::string>(head + first + rest)),
            {});
        RowBlock block;
        REQUIRE(reader->next(block));
        CHECK(std::signbit(block.time_s.front()));
    }
}

// Found by the fuzz target of logs: a time of -0 in a row, and bytes in the last that are no text.
TEST_CASE("a log that the careful and the quick way once took differently", "[log]") {
    check_every_way(
        "time_s\tvelocity_deg_s\ttorque_nm\tnote\r-.000\t60.5\t-0.25\tx\r0.001\t60.05\t-0.25\tx\r"
        "0.022\t60.5\t-\xff\xff"
        "0.2\xff\xff\xff\xff\xff"
        "5\r",
        fuzz::options_of(1));
}

// Found by the same target: "sep=" and a carriage return stated the line's own end as the separator.
TEST_CASE("a line's end is no separator", "[log]") {
    check_every_way("SEP=\r\r\n0\r\r\n0.0EP\"0\r\r\n0.0EP=\r\r\n0\r\r\n" + std::string(25, '\xff') +
                        "0.1c=\r\r\n0\r\n\r0.1cur\r0",
                    fuzz::options_of(13));
    CHECK(fuzz::reading("sep=\r\r\ntime_s\rvelocity_deg_s\n0\r60\n0.001\r60\n", fuzz::options_of(1), 1000)
              .back() != '|');
}

TEST_CASE("mutated logs read the same way by vectors, plainly, carefully and in pieces", "[log]") {
    constexpr std::size_t whole = std::string::npos;
    std::mt19937 random(11);
    std::size_t read = 0;
    const std::size_t rounds = 1500;
    for (std::size_t i = 0; i < rounds; ++i) {
        std::string text = log_of(random);
        mutate(text, random);
        const ReadOptions options = fuzz::options_of(static_cast<unsigned>(random() % 24));
        const std::string usual = fuzz::reading(text, options, whole);
        read += usual.back() == '|' ? 1U : 0U;
        INFO(text);
        {
            const NarrowVectors narrow;
            REQUIRE(fuzz::reading(text, options, whole) == usual);
        }
        const std::string rows = fuzz::reading(text, options, text.size() + 1);
        {
            const CarefulRows careful;
            REQUIRE(fuzz::reading(text, options, text.size() + 1) == rows);
        }
        REQUIRE(fuzz::reading(text, options, 1 + random() % 100) == rows);
    }
    CHECK(read > rounds / 10);  // the others are refused
}
