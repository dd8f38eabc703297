// SPDX-License-Identifier: MIT
// Whole logs: in pieces, all joints, written anew, and real ones.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

#include "log_support.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "support/catch.hpp"
#include "support/places.hpp"
#include "support/skipped.hpp"

using namespace ripplenotch;
using Catch::Contains;
using namespace ripplenotch::test;
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
