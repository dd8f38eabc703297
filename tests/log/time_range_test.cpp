// SPDX-License-Identifier: MIT
// Which rows a range keeps: times as they are typed, times on the axis of a log, and the cut of every format.
#include "log/clock/choose_time.hpp"
#include "log/rows_in_range.hpp"
#include "log_support.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using namespace ripplenotch::test;

namespace {

double seconds_of(const std::string& text, const TimeAxis& axis = {}) {
    return on_axis(parse_time_point(text, "--from"), axis, "--from");
}

// Rows `first` to `last` of a log of milliseconds.
std::vector<NumberColumn> table(int first, int last) {
    std::vector<NumberColumn> columns = {{"time_ms", {}}, {"velocity_deg_s", {}}, {"torque_nm", {}}};
    for (int k = first; k <= last; ++k) {
        columns[0].values.push_back(k);
        columns[1].values.push_back(60.0 + k % 7);
        columns[2].values.push_back(0.25 * (k % 11));
    }
    return columns;
}

ReadOptions between(const std::string& from, const std::string& to) {
    ReadOptions options;
    options.range.from = parse_time_point(from, "--from");
    options.range.to = parse_time_point(to, "--to");
    return options;
}

}  // namespace

TEST_CASE("times are read in seconds, with units, and in fields of sixty", "[log]") {
    CHECK(seconds_of("2") == 2.0);
    CHECK(seconds_of("-0.5s") == -0.5);
    CHECK(seconds_of("500ms") == 0.5);
    CHECK(seconds_of("1.5min") == 90.0);
    CHECK(seconds_of("12:30") == 750.0);
    CHECK(seconds_of("90:00.25") == 5400.25);
    CHECK(seconds_of("1:02:30.5") == 3750.5);
    for (const std::string text : {"", "1:60", "1:2", "1:2:30", "1::30", ":30", "1:30:", "-1:30", "1:30.x",
                                   "1:30s", "2 h", "nan", "1:00:00:00", "2024-05-01"}) {
        INFO(text);
        CHECK_THROWS_AS(parse_time_point(text, "--from"), UsageError);
    }
}

TEST_CASE("in logs of times of day and of dates, fields are times of the first row's day", "[log]") {
    const TimeAxis day{clock_text("12:29:59.5"), 0};
    CHECK(seconds_of("12:30", day) == 45000.0);
    CHECK(seconds_of("12:30:00.25", day) == 45000.25);
    CHECK(seconds_of("750", day) == 750.0);
    CHECK_THROWS_AS(seconds_of("24:01", day), UsageError);
    CHECK_THROWS_AS(seconds_of("12:30.5", day), UsageError);
    CHECK_THROWS_AS(seconds_of("2024-05-01T12:30:00", day), UsageError);
    CHECK_THROWS_AS(seconds_of("2024-05-01T12:30:00"), UsageError);

    // Half past one in the night of a summer in Berlin is still the day before in Greenwich.
    const auto first = clock_text("2024-05-01T01:30:00.5+02:00");
    const TimeAxis date{first, first->whole_s};
    CHECK(seconds_of("01:30", date) == 0.0);
    CHECK(seconds_of("01:31:00.25", date) == 60.25);
    CHECK(seconds_of("00:00:00", date) == -5400.0);
    CHECK(seconds_of("2024-05-01T01:30:10", date) == 10.0);
    CHECK(seconds_of("2024-04-30T23:30:10Z", date) == 10.0);
    CHECK(seconds_of("2024-05-02 00:00:00", date) == 81000.0);
    CHECK(seconds_of("12", date) == 12.0);
}

TEST_CASE("every format cuts a log to the rows that were asked for, however its bytes arrive", "[log]") {
    for (const LogFormat* format : log_formats()) {
        if (!format->is_written()) continue;
        INFO(format->name);
        const std::string bytes = written(*format, table(0, 400));
        const Log expected = read_text(written(*format, table(101, 303)));
        for (const std::size_t piece : {std::size_t{1}, std::size_t{700}, whole}) {
            const Log log = read_text(bytes, between("101ms", "0.303"), piece);
            CHECK(log.trace.time_s == expected.trace.time_s);
            CHECK(log.trace.torque_nm == expected.trace.torque_nm);
            REQUIRE(log.recording.outside);
            CHECK(log.recording.outside->before == 101);
            CHECK(log.recording.outside->after == 97);
            CHECK(log.layout.options == expected.layout.options);
        }
        CHECK_FALSE(expected.recording.outside);
        CHECK_THROWS_AS(read_text(bytes, between("1", "2")), UsageError);
        CHECK_THROWS_AS(read_text(bytes, between("0.2", "0.1")), UsageError);
    }
}

TEST_CASE("a row without a time goes with the row before it", "[log]") {
    const std::string head = "time_s,velocity_deg_s,torque_nm\n", rows = "0.2,1,2\n0.3,1,3\n0.4,1,2\n";
    const Log log =
        read_text(head + "0,1,2\n0.1,1,3\n-,1,2\n" + rows + "0.5,1,2\n,,\n", between("0.2", "0.4"));
    CHECK(log.trace.size() == 3);
    CHECK(log.recording.outside->before == 3);
    CHECK(log.recording.outside->after == 2);
    try {
        static_cast<void>(
            read_text(head + "0,1,2\n0.1,1,3\n" + rows + "-,1,2\n0.5,1,2\n", between("0.2", "0.4")));
        FAIL("the row is inside");
    } catch (const DataError& error) {
        CHECK(std::string(error.what()).find("log.csv:7:1: ") == 0);
    }
}

TEST_CASE("a time column that is another inside the range is refused with the way out", "[log]") {
    // Steps of 1 are milliseconds, steps of 0.002 are seconds.
    std::string text = "time,velocity_deg_s,torque_nm\n";
    for (int k = 0; k < 500; ++k) text += fmt::format("{},1,{}\n", 5 + k, k % 5);
    for (int k = 0; k < 500; ++k) text += fmt::format("{:.3f},1,{}\n", 600 + 0.002 * k, k % 5);
    CHECK_THROWS_WITH(read_text(text, between("600ms", "601ms")), Catch::Contains("--unit time=UNIT"));
}

TEST_CASE("numbers of what was kept are told as they are in the file", "[log]") {
    KeptNumbers numbers(2);
    for (const bool keeps : {false, false, true, true, false, true}) numbers.add(keeps);
    const std::vector<std::size_t> expected = {1, 2, 5, 6, 8, 9};
    for (std::size_t k = 0; k < expected.size(); ++k) CHECK(numbers.in_file(k + 1) == expected[k]);
}
