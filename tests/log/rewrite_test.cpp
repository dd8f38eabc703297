// SPDX-License-Identifier: MIT
// What filter passes on: every byte but the torque.
#include <string>

#include "log_support.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "support/catch.hpp"
#include "support/places.hpp"

using namespace ripplenotch;
using namespace ripplenotch::test;
using Catch::Contains;

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
