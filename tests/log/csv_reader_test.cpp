// SPDX-License-Identifier: MIT
// Text logs as people write them.
#include <string>
#include <vector>

#include "log_support.hpp"
#include "ripplenotch/core/error.hpp"
#include "support/catch.hpp"
#include "support/places.hpp"

using namespace ripplenotch;
using namespace ripplenotch::test;
using Catch::Contains;

TEST_CASE("a comma log with a header is read in the tool's units", "[log]") {
    const Log log = read_text(
        "time_s,velocity_rad_s,torque_Nm,position_rad\n0,1,2,0\n0.001,1,2.5,0.001\n0.002,-1,3e-1,0.002\n");
    CHECK(log.trace.time_s == std::vector<double>{0, 0.001, 0.002});
    CHECK(log.trace.torque_nm == std::vector<double>{2, 2.5, 0.3});
    CHECK(log.trace.velocity_deg_s[2] == Approx(-57.29577951308232));
    CHECK(log.trace.position_deg[1] == Approx(0.05729577951308232));
    CHECK(log.trace.sample_rate.value() == Approx(1000.0));
    CHECK(log.layout.warnings.empty());
}

TEST_CASE("each dialect of the same rows gives the same trace", "[log]") {
    const std::vector<double> torque = {2.5, -0.25, 100};
    const std::vector<std::string> dialects = {
        "time_s,velocity_deg_s,torque_nm\n0,10,2.5\n0.01,11,-0.25\n0.02,12,1e2\n",
        "time_s,velocity_deg_s,torque_nm\n+0,10.,2.5\n.01,+11,-.25\n0.02,12,1.00E+02\n",
        "time_s;velocity_deg_s;torque_nm\r\n0;10;2,5\r\n0,01;11;-0,25\r\n0,02;12;100\r\n",
        "time_s velocity_deg_s torque_nm \n 0   10  2.5 \n 0.01  11 -0.25 \n 0.02 12 100 \n",
        "time_s velocity_deg_s torque_nm\n0 10 2,5\n0,01 11 -0,25\n0,02 12 100\n",
        "time_s\tvelocity_deg_s\ttorque_nm\n0\t10\t2,5\n0,01\t11\t-0,25\n0,02\t12\t100\n",
        "time_s  \t velocity_deg_s\ttorque_nm\n0 \t10   2.5\n0.01  \t11\t -0.25\n0.02 12 100\n",
        "\xef\xbb\xbf\"time_s\",\"velocity_deg_s\",\"torque_nm\"\r\n0,10,2.5\r\n0.01,11,-0.25\r\n0.02,12,100",
        "# rig 3\n% second\n// third\ntime_s,velocity_deg_s,torque_nm\n# before\n0,10,2.5\n# "
        "between\n0.01,11,-0.25\n\n0.02,12,100\n# end\n",
        "# time_s velocity_deg_s torque_nm\n0 10 2.5\n0.01 11 -0.25\n0.02 12 100\n",
        "time,velocity,torque\ns,deg/s,Nm\n0,10,2.5\n0.01,11,-0.25\n0.02,12,100\n",
        "time,velocity,torque\n[ms],[deg/s],[mNm]\n0,10,2500\n10,11,-250\n20,12,100000\n",
        "\"Time (ms)\";\"speed (deg/s)\";\"torque [Nm]\"\n0;10;2.5\n10;11;-0.25\n20;12;100\n",
        "\"time_s\",\"velocity_deg_s\",\"torque_nm\"\n\"0\",\"10\",\"2,5\"\n\"0,01\",\"11\",\"-0,25\"\n\"0,"
        "02\",\"12\",\"100\"\n",
        ",time_s,velocity_deg_s,torque_nm\n0,0,10,2.5\n1,0.01,11,-0.25\n2,0.02,12,100\n",
        "note,time_s,velocity_deg_s,torque_nm\n\"a, "
        "\"\"b\"\"\",0,10,2.5\nx,0.01,11,-0.25\n,0.02,12,100\nEOF\n",
        "time_us, velocity_deg_s, torque_nm,\n0, 10, 2.5,\n10000, 11, -0.25,\n20000, 12, 100,\n",
    };
    for (const std::string& text : dialects) {
        INFO(text);
        const Log log = read_text(text);
        CHECK(log.trace.torque_nm == torque);
        CHECK(log.trace.velocity_deg_s == std::vector<double>{10, 11, 12});
        REQUIRE(log.trace.time_s.size() == 3);
        CHECK(log.trace.time_s[2] == Approx(0.02).epsilon(1e-15));
        CHECK(read_text(text, {}, 1).trace.torque_nm == torque);
    }
}

TEST_CASE("a reading can be forced by the option line that it prints", "[log]") {
    for (const auto& entry : std::filesystem::directory_iterator(source_folder() + "/data/dialects")) {
        if (entry.path().extension() != ".csv") continue;
        INFO(entry.path());
        const std::string text = file_bytes(entry.path().string());
        ReadOptions survey;
        survey.needs_torque = false;
        const Layout free = open_log(in_memory(text), survey)->layout();
        CHECK_THAT(free.options, Contains("--format csv --delimiter "));
        ReadOptions forced = survey;
        forced.delimiter = free.options[std::string("--format csv --delimiter ").size()];
        if (free.options.find("--delimiter tab") != std::string::npos) forced.delimiter = '\t';
        if (free.options.find("--delimiter space") != std::string::npos) forced.delimiter = ' ';
        if (free.options.find("--delimiter ';'") != std::string::npos) forced.delimiter = ';';
        forced.decimal_mark = free.options[free.options.find("--decimal ") + 10];
        if (!free.joints.empty() && !free.chosen.joint.empty()) forced.joint = free.chosen.joint;
        const auto force = [&](const std::optional<std::size_t>& column, std::string_view role) {
            if (!column) return;
            forced.columns.push_back(std::string(role) + "=" + std::to_string(*column + 1));
            forced.units[std::string(role)] = free.columns[*column].unit;
        };
        force(free.chosen.time, "time");
        force(free.chosen.velocity, "velocity");
        force(free.chosen.torque, "torque");
        force(free.chosen.position, "position");
        const Layout again = open_log(in_memory(text), forced)->layout();
        CHECK(again.options == free.options);
        CHECK(again.chosen.torque == free.chosen.torque);
        CHECK(again.joints == free.joints);
    }
}

TEST_CASE("a log without header needs its columns by place", "[log]") {
    const std::string text = "0,10,2.5\n0.01,11,-0.25\n";
    CHECK(read_text(text, with_columns({"time", "velocity", "torque"})).trace.torque_nm ==
          std::vector<double>{2.5, -0.25});
    CHECK(read_text(text, with_columns({"time=1", "velocity=2", "torque=3"})).trace.torque_nm ==
          std::vector<double>{2.5, -0.25});
    CHECK_THAT(complaint(text), Contains("no names") && Contains("--columns time,velocity,torque"));
    CHECK(read_text("7,0,10,2.5\n8,0.01,11,-0.25\n", with_columns({"-", "time", "velocity", "torque"}))
              .trace.time_s[1] == 0.01);
    CHECK_THROWS_AS(read_text(text, with_columns({"time", "velocity", "torque", "position"})), UsageError);
    CHECK_THROWS_AS(read_text(text, with_columns({"time", "velocity", "turk"})), UsageError);
}

TEST_CASE("a log without time needs a sample rate", "[log]") {
    const std::string text = "velocity_deg_s,torque_nm\n10,2.5\n11,-0.25\n12,100\n";
    CHECK_THAT(complaint(text), Contains("--sample-rate"));
    ReadOptions options;
    options.sample_rate = Hertz(250.0);
    const Log log = read_text(text, options);
    CHECK(log.trace.time_s == std::vector<double>{0.0, 0.004, 0.008});
    CHECK(log.trace.sample_rate.value() == 250.0);
    const Log other = read_text("time_s,velocity_deg_s,torque_nm\n5,10,2.5\n4,11,1\n", options);
    CHECK(other.trace.time_s == std::vector<double>{0.0, 0.004});
}

TEST_CASE("a column called time that only counts rows is never taken as the clock", "[log]") {
    const std::string rival =
        "time,timestamp,velocity_deg_s,torque_nm\n1,7.5,10,1\n2,7.54,10,2\n3,7.58,10,3\n,7.62,10,4\n";
    const Log log = read_text(rival);
    CHECK(log.trace.time_s[3] == 7.62);
    REQUIRE_FALSE(log.layout.warnings.empty());
    CHECK_THAT(log.layout.warnings.front().text,
               Contains("'time'") && Contains("counts rows") && Contains("'timestamp'"));

    const std::string alone = "time,velocity_deg_s,torque_nm\n0,10,1\n1,10,2\n2,10,3\n3,10,4\n";
    CHECK_THAT(complaint(alone),
               Contains("counts rows") && Contains("--unit time=ms") && Contains("--sample-rate"));
    ReadOptions options;
    options.units["time"] = "ms";
    CHECK(read_text(alone, options).trace.sample_rate.value() == Approx(1000.0));
    // A stated unit is believed: a log of one row a second may exist.
    CHECK(read_text("time_s,velocity_deg_s,torque_nm\n0,10,1\n1,10,2\n2,10,3\n").trace.sample_rate.value() ==
          Approx(1.0));
}

TEST_CASE("two columns that could be meant are an error that lists them and the option", "[log]") {
    CHECK_THAT(complaint("time_s,velocity_deg_s,torque_nm,tau_nm\n0,1,2,3\n1,1,3,4\n"),
               Contains("'torque_nm' (column 3)") && Contains("'tau_nm' (column 4)") &&
                   Contains("--columns torque=torque_nm"));
    CHECK_THAT(complaint("time_s,timestamp_s,velocity_deg_s,torque_nm\n0,0.5,1,2\n1,1.5,1,3\n"),
               Contains("time") && Contains("--columns time=time_s"));
    CHECK_THAT(complaint("time_s,velocity_deg_s,torque_nm,torque_nm\n0,1,2,3\n1,1,3,4\n"),
               Contains("--columns torque=3"));
    const auto options = with_columns({"torque=tau_nm"});
    CHECK(
        read_text("time_s,velocity_deg_s,torque_nm,tau_nm\n0,1,2,3\n1,1,3,4\n", options).trace.torque_nm[1] ==
        4.0);
}

TEST_CASE("what was wished is left alone where a measurement stands beside it", "[log]") {
    for (const std::string wish : {"target_torque_nm", "ref_torque_nm", "desired_torque_nm",
                                   "model_torque_nm", "cmd_torque_nm", "tau_d"}) {
        const Log log = read_text("time_s," + wish + ",velocity_deg_s,torque_nm\n0,9,1,2\n1,8,1,3\n");
        CHECK(log.trace.torque_nm == std::vector<double>{2, 3});
    }
    const Log only = read_text("time_s,target_torque_nm,velocity_deg_s\n0,9,1\n1,8,1\n");
    CHECK(only.trace.torque_nm == std::vector<double>{9, 8});
    CHECK_THAT(only.layout.warnings.at(0).text, Contains("a wish or a model"));
}

TEST_CASE("of several joints one must be chosen, by any of its names", "[log]") {
    const std::string text =
        "time_s,j1_velocity_deg_s,j1_torque_Nm,j3_velocity_deg_s,j3_torque_Nm\n0,1,2,3,4\n0.1,1,2.5,3,5\n";
    CHECK_THAT(complaint(text),
               Contains("2 joints (j1, j3)") && Contains("--joint j1") && Contains("--joint all"));
    for (const std::string name : {"j3", "3", "J3", "joint3"}) {
        ReadOptions options;
        options.joint = name;
        const Log log = read_text(text, options);
        CHECK(log.trace.torque_nm == std::vector<double>{4, 5});
        CHECK(log.trace.joint == "j3");
    }
    ReadOptions wrong;
    wrong.joint = "j2";
    CHECK_THROWS_WITH(read_text(text, wrong), Contains("j1, j3"));
}

TEST_CASE("motor current is torque with its constant, and amperes without", "[log]") {
    const std::string text = "time_s,j3_velocity_rad_s,j3_current_A\n0,1,2\n0.1,1,3\n";
    const Log bare = read_text(text);
    CHECK(bare.trace.torque_nm == std::vector<double>{2, 3});
    CHECK(bare.layout.columns[2].unit == "A");
    CHECK_THAT(bare.layout.warnings.at(0).text, Contains("motor current") && Contains("--kt"));
    ReadOptions options;
    options.nm_per_ampere = 0.5;
    const Log converted = read_text(text, options);
    CHECK(converted.trace.torque_nm == std::vector<double>{1, 1.5});
    CHECK(converted.layout.warnings.empty());
}

TEST_CASE("a column without unit is taken in the tool's own, and that is said", "[log]") {
    const Log log = read_text("time,velocity,torque\n0,60,2\n0.01,61,3\n0.02,62,4\n");
    CHECK(log.trace.velocity_deg_s[0] == 60.0);
    REQUIRE(log.layout.warnings.size() == 1);
    CHECK_THAT(log.layout.warnings[0].text,
               Contains("'velocity' (column 2) as deg/s") && Contains("--unit velocity=deg/s"));
    CHECK(log.layout.assumptions.size() == 2);
    ReadOptions options;
    options.units = {{"velocity", "rad/s"}, {"torque", "mNm"}, {"time", "ms"}};
    const Log told = read_text("time,velocity,torque\n0,1,2\n0.5,1,3\n1,1,4\n", options);
    CHECK(told.trace.velocity_deg_s[0] == Approx(57.29577951308232));
    CHECK(told.trace.torque_nm[2] == 4e-3);
    CHECK(told.trace.time_s[2] == 1e-3);
    CHECK(told.layout.warnings.empty());
}

TEST_CASE("bad values are held on request, counted, and never in the first row", "[log]") {
    const std::string text = "time_s,velocity_deg_s,torque_nm\n0,10,2.5\n0.1,,nan\n0.2,12,NaN\n0.3,13,4\n";
    CHECK_THAT(complaint(text), Contains("log.csv:3:5: read nothing in 'velocity_deg_s' (column 2)") &&
                                    Contains("--hold-bad-values"));
    ReadOptions options;
    options.hold_bad_values = true;
    const Log log = read_text(text, options);
    CHECK(log.trace.torque_nm == std::vector<double>{2.5, 2.5, 2.5, 4});
    CHECK(log.trace.velocity_deg_s == std::vector<double>{10, 10, 12, 13});
    CHECK(log.held_bad_values == 3);
    CHECK_THAT(complaint("time_s,velocity_deg_s,torque_nm\n0,10,nan\n0.1,10,2\n0.2,10,1\n", options),
               Contains("first row"));
    CHECK_THAT(complaint("time_s,velocity_deg_s,torque_nm\n0,10,1\n,10,2\n0.2,10,1\n", options),
               Contains("log.csv:3:1"));
    CHECK_THAT(complaint("time_s,velocity_deg_s,torque_nm\n0,10,1\n0.1,10,inf\n0.2,10,1\n", options),
               Contains("finite"));
}
