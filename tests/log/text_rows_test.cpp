// SPDX-License-Identifier: MIT
// Text logs as rows: quick, careful, one value a row.
#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "log/text/quick_rows.hpp"
#include "log_support.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/trace.hpp"
#include "support/catch.hpp"
#include "support/places.hpp"
#include "support/vectors.hpp"

using namespace ripplenotch;
using namespace ripplenotch::testing;
using namespace ripplenotch::test;
using Catch::Contains;

// The quick way through a row agrees with the careful way, bit for bit.

TEST_CASE("numbers read the quick way are correctly rounded", "[log]") {
    std::mt19937_64 random(21);
    const RowParser parser({{',', '.'}, 1, {{0, 0}}});
    for (int round = 0; round < 200000; ++round) {
        std::string text;
        if (random() % 2 == 0) text += '-';
        for (std::uint64_t k = random() % 12 + 1; k > 0; --k) text += static_cast<char>('0' + random() % 10);
        if (random() % 4 != 0) {
            text += '.';
            for (std::uint64_t k = random() % 12; k > 0; --k) text += static_cast<char>('0' + random() % 10);
        }
        ParsedRow row;
        INFO(text);
        REQUIRE(parser.parse(text, row));
        REQUIRE(row.values[0] == *parse_number(text));
        REQUIRE(std::signbit(row.values[0]) == std::signbit(*parse_number(text)));
    }
}

TEST_CASE("a row that is not plain is left to the careful way", "[log]") {
    const RowParser parser({{',', '.'}, 3, {{0, 0}, {2, 2}}});
    for (const std::string text :
         {"", "1", "1,2", "1,2,3,4", "a,2,3", "1,2,x", "1,2,", ",2,3", "1,2,nan", "1,2,inf", "1,\"2\",3",
          "1,2,\"3\"", "1 2,2,3", "1,2,3 4", "--1,2,3", "1,2,3e", "1,2,.", "1,2,-", "1,2,1e999"}) {
        ParsedRow row;
        INFO(text);
        CHECK_FALSE(parser.parse(text, row));
    }
    const std::string good = "1, anything at all , -2.50e1 ";
    ParsedRow row;
    REQUIRE(parser.parse(good, row));
    CHECK(row.values[2] == -25.0);
    CHECK(std::string(row.torques[0].begin, row.torques[0].end) == "-2.50e1");
}

namespace {

constexpr double no_time = std::numeric_limits<double>::quiet_NaN();

/// Three columns, all wanted: velocity, torque, position.
RowParser three_columns(char delimiter = ',', char mark = '.') {
    return RowParser({{delimiter, mark},
                      3,
                      {{0, velocity_slot}, {1, torque_slot}, {2, position_slot}},
                      std::vector<double>(4, 1.0)});
}

bool same_number(double a, double b) {
    return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

/// A number as some program may have written it.
std::string written(std::mt19937_64& random) {
    const auto pick = [&](int below) {
        return static_cast<int>(random() % static_cast<std::uint64_t>(below));
    };
    const double value = std::bit_cast<double>(random());
    switch (pick(8)) {
        case 0:
            return fmt::format("{:.{}f}", (static_cast<double>(random() >> 11) - 4.5e15) * 1e-12, pick(10));
        case 1:
            return fmt::format("{}", static_cast<std::int64_t>(random() >> pick(60)));
        case 2:
            return fmt::format("{}", is_reading(value) ? value : 0.0);  // any exponent up to 30
        case 3:
            return fmt::format("{:.17g}", std::sin(static_cast<double>(random() % 1000000)));
        case 4:
            return fmt::format("{:.18e}", is_reading(value) ? value : 1.0);  // numpy.savetxt
        case 5:
            return fmt::format("{}{}.", pick(2) == 0 ? "-" : "", pick(1000));
        case 6:
            return fmt::format("{}.{}", pick(2) == 0 ? "-" : "", pick(1000000));
        default:
            return fmt::format("-0.{:0{}d}", pick(10), 1 + pick(12));
    }
}

/// What one way takes of a text with three columns.
struct Taken {
    std::size_t end = 0;
    RowBlock block;
};

Taken taken(const std::string& text, bool wide) {
    const Width here(wide);
    const RowParser quick = three_columns();
    Taken result;
    result.block.bytes = text;
    result.end = quick.read(result.block, 0, no_time);
    return result;
}

bool same(const std::vector<double>& a, const std::vector<double>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), same_number);
}

bool same(const Taken& a, const Taken& b) {
    const JointRows &first = a.block.joints[0], &second = b.block.joints[0];
    return a.end == b.end && same(first.velocity_deg_s, second.velocity_deg_s) &&
           same(first.torque_nm, second.torque_nm) && same(first.position_deg, second.position_deg) &&
           first.torque_begin == second.torque_begin && first.torque_end == second.torque_end &&
           a.block.row_end == b.block.row_end;
}

/// Numbers, of 3 * rows, that the vectors or the scalar way read otherwise than parse_number does.
std::size_t misread(std::uint64_t seed, std::size_t rows) {
    std::mt19937_64 random(seed);
    std::vector<std::string> cells;
    std::string text;
    for (std::size_t i = 0; i < 3 * rows; ++i) {
        cells.push_back(written(random));
        text += cells.back() + (i % 3 < 2 ? "," : i % 7 == 0 ? "\r\n" : "\n");
    }
    const Taken careful = taken(text, false);
    REQUIRE(careful.end == text.size());
    REQUIRE(careful.block.size() == rows);
    REQUIRE(same(taken(text, true), careful));
    std::size_t different = 0;
    const JointRows& joint = careful.block.joints[0];
    for (std::size_t i = 0; i < rows; ++i) {
        const auto expect = [&](std::size_t column, double got) {
            different += same_number(got, *parse_number(cells[3 * i + column])) ? 0 : 1;
        };
        expect(0, joint.velocity_deg_s[i]);
        expect(1, joint.torque_nm[i]);
        expect(2, joint.position_deg[i]);
        const std::size_t begin = joint.torque_begin[i], size = joint.torque_end[i] - begin;
        different += text.compare(begin, size, cells[3 * i + 1]) == 0 ? 0 : 1;
    }
    return different;
}

}  // namespace

TEST_CASE("numbers of many rows at once are those of the careful reader, bit for bit", "[log]") {
    for (std::uint64_t seed = 7; seed < 10; ++seed) CHECK(misread(seed, 100000) == 0);
}

TEST_CASE("a byte that is not as it was is read as the careful way reads it, wherever it stands", "[log]") {
    std::mt19937_64 random(11);
    const std::string_view junk = "0123456789.,-+eE \r\n\"x;:/\t";
    std::size_t stopped = 0;
    for (int trial = 0; trial < 20000; ++trial) {
        std::string text;
        const auto decimals = static_cast<int>(random() % 7);
        for (int i = 0; i < 24; ++i) {
            const double angle = static_cast<double>(random() % 1000000) * 1e-3 - 500.0;
            text += fmt::format("{:.4f},{:.{}f},{:.6f}\n", i * 0.0005, angle, decimals, -angle);
        }
        text[random() % text.size()] = junk[random() % junk.size()];
        CAPTURE(text);
        const Taken careful = taken(text, false);
        REQUIRE(same(taken(text, true), careful));
        stopped += careful.end < text.size() ? 1 : 0;
    }
    CHECK(stopped > 5000);  // and many were read
    CHECK(stopped < 15000);
}

TEST_CASE("rows are taken at once up to the first that is not certainly right, wherever it stands", "[log]") {
    const std::string good = "1.5,-2.25,300\n";
    for (const std::string bad :
         {"1.5,-2.25\n", "1.5,-2.25,3,4\n", "# 1,2,3\n", "\n", "1.5,\"2\",3\n", "1.5,2x,3\n", "1.5,,3\n",
          "1.5,.,3\n", "1.5,-,3\n", "1.5,--2,3\n", "1.5,1.2.3,3\n", "1.5,nan,3\n", "1.5,1e999,3\n", "EOF\n",
          "1.5,2;3,4\n", "1.5,2,3", "1,2,\n", "1,2,0x10\n", "1,2,3\r\r\n"}) {
        for (const int before : {0, 1, 2, 5, 600, 2000}) {
            for (const bool wide : widths()) {
                const Width here(wide);
                CAPTURE(bad, before, wide);
                RowBlock block;
                for (int i = 0; i < before; ++i) block.bytes += good;
                block.bytes += bad + good;
                const RowParser quick = three_columns();
                CHECK(quick.read(block, 0, no_time) == static_cast<std::size_t>(before) * good.size());
                CHECK(block.size() == static_cast<std::size_t>(before));
            }
        }
    }
}

TEST_CASE("a delimiter within quotes is none, in columns that nobody reads as well", "[log]") {
    std::string text;
    for (int i = 0; i < 40; ++i) text += "1.5,a,b,-2.25\n";
    const std::size_t end = text.size();
    text += "3,\"a,b\",4\n";
    for (const bool wide : widths()) {
        const Width here(wide);
        RowBlock block;
        block.bytes = text;
        const RowParser quick(
            {{',', '.'}, 4, {{0, velocity_slot}, {3, torque_slot}}, std::vector<double>(4, 1.0)});
        CHECK(quick.read(block, 0, no_time) == end);
        CHECK(block.size() == 40);
    }
}

TEST_CASE("taking goes on behind a row that was taken otherwise, and keeps what it has", "[log]") {
    RowBlock block;
    block.bytes = "1,2,3\n4,5\n6,7,8\n9,10,11\n";
    const RowParser quick = three_columns();
    CHECK(quick.read(block, 0, no_time) == 6);
    CHECK(quick.read(block, 10, no_time) == block.bytes.size());
    CHECK(block.joints[0].torque_nm == std::vector<double>{2, 7, 10});
    CHECK(block.joints[0].torque_begin == std::vector<std::uint32_t>{2, 12, 18});
}

TEST_CASE("time that runs backward ends what is taken at once", "[log]") {
    for (const bool wide : widths()) {
        const Width here(wide);
        const RowParser quick(
            {{',', '.'}, 2, {{0, time_slot}, {1, torque_slot}}, std::vector<double>(4, 1.0)});
        RowBlock block;
        block.bytes = "1,5\n2,5\n2,6\n1.999,7\n3,8\n";
        CHECK(quick.read(block, 0, no_time) == 12);
        CHECK(quick.read(block, 12, 2.0) == 12);
        CHECK(block.time_s == std::vector<double>{1, 2, 2});
    }
}

TEST_CASE("decimal commas, semicolons and wide rows are taken at once as well", "[log]") {
    RowBlock block;
    block.bytes = "1,5;-2,25;3\n4;5,125;6\n";
    const RowParser quick = three_columns(';', ',');
    CHECK(quick.read(block, 0, no_time) == block.bytes.size());
    CHECK(block.joints[0].torque_nm == std::vector<double>{-2.25, 5.125});
    // 400 columns of 30 characters: a row longer than the stretch that is searched at once is left alone.
    const RowPlan plan{{',', '.'}, 400, {{399, torque_slot}}, std::vector<double>(4, 1.0)};
    RowBlock rows;
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 399; ++column) rows.bytes += std::string(29, 'x') + ",";
        rows.bytes += "7.5\n";
    }
    const std::size_t taken = RowParser(plan).read(rows, 0, no_time);
    CHECK((taken == 0 || taken == rows.bytes.size()));
    const NarrowVectors here;
    CHECK(RowParser(plan).read(rows, taken, no_time) == rows.bytes.size());
    CHECK(rows.joints[0].torque_nm == std::vector<double>{7.5, 7.5, 7.5});
}

// Text logs as people write them.

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

// Logs in which a row holds one number, files of one signal each, and columns that are paired one joint off.

namespace {

const std::vector<double> torques = {2.5, -0.25, 100, 7};

std::string tidy(const std::string& head, const std::string& mark = ",") {
    std::string text = head + "\n";
    for (std::size_t k = 0; k < torques.size(); ++k) {
        text += fmt::format("{0}{2}velocity{2}{1}\n", 10 * k, 10 + k, mark);
        text += fmt::format("{0}{2}torque{2}{1}\n", 10 * k, torques[k], mark);
    }
    return text;
}

std::string trace(const std::string& head, const std::string& columns) {
    std::string text;
    for (const bool torque : {false, true}) {
        text += fmt::format("{}{}\n{}", head, torque ? "PLC.fTorque" : "PLC.fVelocity", columns);
        for (std::size_t k = 0; k < torques.size(); ++k)
            text += fmt::format("{};{}\n", 10 * k, torque ? torques[k] : 10.0 + static_cast<double>(k));
        text += "\n";
    }
    return text;
}

}  // namespace

TEST_CASE("a table of one value a row and a trace of one block a variable are logs of columns", "[log]") {
    const std::vector<std::string> logs = {
        tidy("time_ms,signal,value"),
        tidy("Time [ms];Variable;Value", ";"),
        tidy("timestamp\tchannel\tdata", "\t"),
        trace("", ""),
        trace("Trace;MyTrace\nVariable;", "Data type;LREAL\nTimestamp [ms];Value\n"),
        trace("", "Time [ms];Value\n"),
    };
    for (const std::string& text : logs) {
        INFO(text);
        for (const std::size_t piece : {std::size_t{3}, whole}) {
            const Log log = read_text(text, {}, piece);
            CHECK(log.trace.torque_nm == torques);
            CHECK(log.trace.velocity_deg_s == std::vector<double>{10, 11, 12, 13});
            CHECK(log.trace.time_s[3] == Approx(0.03));
            const auto& said = log.layout.inferences;
            CHECK(std::any_of(said.begin(), said.end(),
                              [](const Assumption& one) { return one.about == "shape"; }));
        }
    }
    const std::string broken = tidy("time_ms,signal,value") + "40,torque,soon\n";
    CHECK_THAT(complaint(broken), Contains("log.csv:10: read 'soon' in 'torque', expected a number"));
    const std::string backward = tidy("time_ms,signal,value") + "20,torque,1\n";
    CHECK_THAT(complaint(backward), Contains("log.csv:10: read the time 20 of 'torque' after 30"));
}

TEST_CASE("joints of a table are told apart by their column, and others are asked about", "[log]") {
    std::string text = "time,joint,signal,run,value\n";
    for (int k = 0; k < 4; ++k)
        for (const char* joint : {"j1", "j2"})
            for (const char* signal : {"velocity_deg_s", "torque_nm"})
                text += fmt::format("{},{},{},3,{}\n", 0.01 * k, joint, signal, joint[1] == '1' ? k : 10 + k);
    ReadOptions options;
    options.joint = "j2";
    CHECK(read_text(text, options).trace.torque_nm == std::vector<double>{10, 11, 12, 13});
    CHECK_THAT(complaint(text + "0.03,j2,torque_nm,4,9\n", options),
               Contains("log.csv:18: read a second value of 'j2.torque_nm' at the time 0.03"));
}

TEST_CASE("signals with times of their own are joined to the torque's", "[log]") {
    std::string text = "time,name,value,unit\n";
    for (int k = 0; k < 20; ++k)
        text += fmt::format("{0}.5,velocity,{0},deg/s\n{1},torque,{0},Nm\n", k, k + 1);
    ReadOptions options;
    options.units = {{"time", "s"}};
    for (const auto& [how, first] : {std::pair{"linear", 0.5}, std::pair{"hold", 0.0}}) {
        options.join = how;
        const Log log = read_text(text, options);
        CHECK(log.trace.size() == 19);
        CHECK(log.trace.velocity_deg_s.front() == first);
        CHECK_THAT(log.layout.warnings.front().text, Contains("velocity has a clock of its own"));
    }
}

TEST_CASE("columns with times of their own, in columns or in rows of their own, are joined to the torque's",
          "[log]") {
    // Velocity is the time in s, torque that of its own row.
    std::string columns = "time,velocity_deg_s,time,torque_nm\n", rows = "stamp,velocity_deg_s,torque_nm\n";
    const std::int64_t epoch_ns = 1716537600000000000;
    for (int k = 0; k < 100; ++k) {
        columns += fmt::format("{:.3f},{:.3f},{:.3f},{:.3f}\n", 0.002 * k, 0.002 * k, 0.003 * k, 0.003 * k);
        rows += fmt::format("{},{:.3f},\n{},,{:.7f}\n", epoch_ns + 2000000 * k, 0.002 * k,
                            epoch_ns + 2000000 * k + 400001, 0.002 * k + 0.000400001);
    }
    for (const std::string& text : {columns, rows}) {
        const Log log = read_text(text);
        REQUIRE(log.trace.size() > 60);
        for (std::size_t k = 0; k < log.trace.size(); ++k) {
            CHECK(log.trace.velocity_deg_s[k] == Approx(log.trace.torque_nm[k]).margin(1e-7));
            CHECK(log.trace.time_s[k] - log.trace.time_s[0] ==
                  Approx(log.trace.torque_nm[k] - log.trace.torque_nm[0]).margin(1e-7));
        }
    }
    // One clock in two columns leaves the rows as they are.
    std::string same = "time,velocity_deg_s,time,torque_nm\n";
    for (int k = 0; k < 9; ++k) same += fmt::format("{0:.3f},{1},{0:.3f},{1}\n", 0.001 * k, k);
    CHECK(rewritten(same, [](double torque) { return torque; }) == same);
}

TEST_CASE("a list in a cell is a column for each of its numbers, and as long in every row", "[log]") {
    std::string text = "kind,stamp_ms,velocities,torques\n", round = text;
    for (int k = 0; k < 9; ++k) {
        text += fmt::format("M,{},\"[{}, {}]\",\"[{}, {}]\"\n", 10 * k, k, 10 + k, 20 + k, 30 + k);
        round += fmt::format("M,{},({} {}),({} {})\n", 10 * k, k, 10 + k, 20 + k, 30 + k);
    }
    ReadOptions options;
    options.joint = "1";
    options.units = {{"velocity", "deg/s"}, {"torque", "Nm"}};
    for (const std::string& log : {text, round}) {
        CHECK(read_text(log, options).trace.velocity_deg_s[8] == 18);
        CHECK(read_text(log, options).trace.torque_nm[8] == 38);
        CHECK(read_text(log, options).trace.time_s[8] == Approx(0.08));
    }
    CHECK_THAT(complaint(text + "M,90,\"[1]\",\"[1, 2]\"\n", options),
               Contains("log.csv:11: read '[1]' in 'velocities', expected as many numbers"));
}

TEST_CASE("JSON is read from lines, from a list of objects and from an object of lists alike", "[log]") {
    std::string lines, objects, lists[3];
    for (int k = 0; k < 40; ++k) {
        const std::string object = fmt::format(
            R"({{"t": {{"sec": 1716537600, "nanosec": {}}}, "arm": {{"velocity_deg_s": {}, "torque_nm": {}.5}}}})",
            1000001 * k, k, 2 * k);
        const std::string between = k == 0 ? "" : ",";
        lines += object + "\n";
        objects += between + object;
        lists[0] += fmt::format("{}{}", between, 1716537600000000000 + 1000001 * k);
        lists[1] += fmt::format("{}{}", between, k);
        lists[2] += fmt::format("{}{}.5", between, 2 * k);
    }
    const std::string columns = fmt::format(
        R"({{"gains": [1, 2], "log": {{"t_ns": [{}], "velocity_deg_s": [{}], "torque_nm": [{}]}}}})",
        lists[0], lists[1], lists[2]);
    for (const std::string& text :
         {lines, "[" + objects + "]", R"({"run": 7, "rows": [)" + objects + "]}", columns}) {
        INFO(text.substr(0, 60));
        const Log log = read_text(text, text == columns ? ReadOptions() : with_columns({"time=t"}));
        CHECK(log.layout.format == "json");
        CHECK(log.trace.size() == 40);
        CHECK(log.trace.torque_nm[39] == 78.5);
        CHECK(log.trace.time_s[39] - log.trace.time_s[0] == Approx(39e-3 + 39e-9).epsilon(1e-12));
    }
    CHECK_THAT(complaint(lines + "{\"t\": 1}\n"), Contains("log.csv: line 41: read no number as t"));
}

TEST_CASE("a title over two columns makes no trace of them", "[log]") {
    std::string text = "run 3\n";
    for (int k = 0; k < 9; ++k) text += fmt::format("{};{}\n", 10 + k % 2, 5 + k % 3);
    ReadOptions options = with_columns({"velocity,torque"});
    options.columns = {"velocity", "torque"};
    options.sample_rate = Hertz(100.0);
    CHECK(read_text(text, options).trace.size() == 9);
}

TEST_CASE("joints numbered from 0 and from 1 beside each other are asked about", "[log]") {
    const std::string rows = "\n0,10,11,1,2\n0.01,12,13,2,3\n0.02,14,15,3,4\n";
    const std::string mixed = "t,dq0,dq1,tau1,tau2" + rows;
    CHECK_THAT(
        complaint(mixed,
                  [] {
                      ReadOptions options;
                      options.joint = "1";
                      return options;
                  }()),
        Contains("joints are numbered from 0 and from 1") && Contains("--columns velocity=dq0,torque=tau1"));
    const Log log = read_text(mixed, with_columns({"velocity=dq1", "torque=tau2"}));
    CHECK(log.trace.torque_nm == std::vector<double>{2, 3, 4});
    CHECK_THAT(complaint("t,dq1,tau2\n0,1,2\n0.01,2,3\n"), Contains("numbered from 1 and from 2"));
    ReadOptions first;
    first.joint = "1";
    CHECK(read_text("t,dq0,dq1,dq2,tau1\n0,1,2,3,4\n0.01,1,2,3,5\n", first).trace.velocity_deg_s.front() >
          100.0);
}

TEST_CASE("several torques of one joint are listed, and parts of a torque are none", "[log]") {
    const std::string rows = "\n0,10,1,2\n0.01,11,2,3\n";
    CHECK_THAT(complaint("t,velocity,tau_sensed,tau_drive" + rows),
               Contains("--columns torque=tau_sensed or --columns torque=tau_drive"));
    CHECK(read_text("t,velocity,tau,tau_friction" + rows).trace.torque_nm == std::vector<double>{1, 2});
    CHECK_THAT(complaint("t,velocity,i,v" + rows), Contains("expected a torque column"));
}
