// SPDX-License-Identifier: MIT
// Ways to break a text log: each gives one message with file, line, column, what was read, expected, and to
// be done.
#include <string>

#include "log_support.hpp"
#include "ripplenotch/core/error.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using namespace ripplenotch::test;
using Catch::Contains;

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
    CHECK_THAT(complaint("time_s,velocity_deg_s,torque [V]\n0,1,2\n1,2,3\n"), Contains("in 'V'"));
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
