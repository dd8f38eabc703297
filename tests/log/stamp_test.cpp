// SPDX-License-Identifier: MIT
// Stamps with more digits than a double holds, in two columns, as dates; the unit of a clock that states
// none.

#include <fmt/format.h>
#include <cmath>

#include <string>

#include "log/clock/stamp.hpp"
#include "log_support.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using test::complaint;
using test::read_text;

namespace {

/// Rows at 1 kHz whose time cell is written by `cell(row)`.
template <class Cell>
std::string log_of(const std::string& header, Cell cell, int rows = 40) {
    std::string text = header + ",velocity_deg_s,torque_nm\n";
    for (int k = 0; k < rows; ++k) text += cell(k) + ",60," + std::to_string(k % 7) + "\n";
    return text;
}

}  // namespace

TEST_CASE("dates and times of day are seconds, exactly", "[log]") {
    // date -u -d 2024-05-01T12:30:01Z +%s
    CHECK(clock_text("2024-05-01T12:30:01Z")->whole_s == 1714566601);
    CHECK(clock_text("2024-05-01T12:30:01.25Z")->fraction_s == 0.25);
    CHECK(clock_text("2024-05-01 14:30:01+02:00")->whole_s == 1714566601);
    CHECK(clock_text("2024/05/01 12:30:01")->whole_s == 1714566601);
    CHECK(clock_text("2021:10:05:12:08:14.5")->whole_s == 1633435694);
    CHECK(clock_text("2000-02-29T00:00:00")->whole_s == 951782400);
    CHECK(clock_text("00:00:00.001")->fraction_s == 0.001);
    CHECK(clock_text("12:30:01")->whole_s == 45001);
    for (const char* text :
         {"1.5.2024 12:30:01", "01.05.2024 12:30:01", "5/13/2024 12:30:01", "01/05/2024 12:30:01"})
        CHECK(clock_text(text)->whole_s == (std::string(text).starts_with("5/13") ? 1715603401 : 1714566601));
    CHECK(clock_text("05/01/2024 12:30:01", {.day_first = false})->whole_s == 1714566601);
    CHECK(clock_text("13/05/2024 12:30:01", {.day_first = false})->whole_s == 1715603401);
    CHECK(clock_text("5/1/2024 1:30:01 PM", {.day_first = false})->whole_s == 1714570201);
    CHECK(clock_text("5/1/2024, 12:30:01 am", {.day_first = false})->whole_s == 1714523401);
    CHECK(clock_text("2024-05-01 12:30:01,25")->fraction_s == 0.25);
    CHECK(clock_text("12:30:01:025")->fraction_s == 0.025);
    CHECK(clock_text("12:30:01.25", {.milliseconds = true})->fraction_s == 0.025);
    for (const char* text : {"13:30:01 PM", "0:30:01 AM", "31.13.2024 12:30:01", "1.5.24 12:30:01", "",
                             "12:30", "12.5", "2024-05-01", "2024-13-01T00:00:00", "12:61:00", "12:30:01x"})
        CHECK_FALSE(clock_text(text).has_value());
}

TEST_CASE("the difference of two long counts is not rounded", "[log]") {
    const StampRule rule{true, false, 1700000000123456789, '.'};
    CHECK(read_stamp("1700000000123456790", rule) == 1.0);
    CHECK(read_stamp("1700000000124456789", rule) == 1e6);
    CHECK(read_stamp("1700000000.000000125", {true, false, 1700000000, '.'}) == 1.25e-7);
    CHECK_FALSE(read_stamp("soon", rule).has_value());
}

TEST_CASE("whatever a clock counts, a thousandth of a second is one", "[log]") {
    const auto padded = [](int k, int digits) {
        const std::string text = std::to_string(k);
        return std::string(static_cast<std::size_t>(digits) - text.size(), '0') + text;
    };
    const std::vector<std::string> logs = {
        log_of("timestamp", [&](int k) { return "1700000000" + padded(k, 3) + "000000"; }),
        log_of("timestamp", [&](int k) { return "1700000000" + padded(k, 3) + "000"; }),
        log_of("timestamp", [&](int k) { return "1700000000" + padded(k, 3); }),
        log_of("timestamp", [&](int k) { return "1700000000." + padded(k, 3); }),
        log_of("timestamp", [&](int k) { return "13360000000" + padded(k, 3) + "0000"; }),
        log_of("t", [&](int k) { return "0." + padded(k, 3); }),
        log_of("t", [](int k) { return std::to_string(1000 * k); }),
        log_of("t", [](int k) { return std::to_string(1000000 * k); }),
        log_of("t", [&](int k) { return "12:30:01." + padded(k, 3); }),
        log_of("t", [&](int k) { return "2024-05-01T12:30:01." + padded(k, 3) + "Z"; }),
        log_of("secs,nsecs", [&](int k) { return "1700000000," + std::to_string(1000000 * k); }),
    };
    for (std::size_t i = 0; i < logs.size(); ++i) {
        INFO(i << ": " << logs[i].substr(0, 80));
        for (const std::size_t piece : {std::size_t{7}, test::whole}) {
            const Log log = read_text(logs[i], {}, piece);
            REQUIRE(log.trace.size() == 40);
            CHECK(log.trace.sample_rate.value() == Approx(1000.0).epsilon(1e-9));
            CHECK(log.trace.time_s[39] - log.trace.time_s[0] == Approx(0.039).epsilon(1e-9));
        }
    }
}

TEST_CASE("whatever a logger's dates look like, a thousandth of a second is one", "[log]") {
    const auto padded = [](int k) { return std::string(k < 10 ? "00" : "0") + std::to_string(k); };
    const std::vector<std::string> logs = {
        log_of("t", [&](int k) { return "31.12.2025 23:59:59." + padded(k); }),
        log_of("t", [&](int k) { return "12/31/2025 11:59:59." + padded(k) + " PM"; }),
        log_of("t", [&](int k) { return "\"2025-12-31 23:59:59," + padded(k) + "\""; }),
        log_of("t", [&](int k) { return "12:30:01:" + padded(k); }),
        log_of("t", [](int k) { return "12:30:01." + std::to_string(k); }),
        log_of("dt", [](int) { return std::string("0.001"); }),
        log_of("timestep [us]", [](int k) { return std::to_string(1000 + (k % 2 == 0 ? -5 : 5)); }),
        log_of("k,Delta t", [](int k) { return std::to_string(k) + ",0.001"; }),
    };
    for (std::size_t i = 0; i < logs.size(); ++i) {
        INFO(i << ": " << logs[i].substr(0, 80));
        for (const std::size_t piece : {std::size_t{7}, test::whole}) {
            const Log log = read_text(logs[i], {}, piece);
            REQUIRE(log.trace.size() == 40);
            CHECK(log.trace.time_s[39] - log.trace.time_s[0] == Approx(0.039).margin(1e-5));
        }
    }
    CHECK(read_text(logs[5]).layout.time_is_steps);
    CHECK(read_text(logs[4]).layout.stamp_form.milliseconds);
}

TEST_CASE("a date's order is taken from the log, or said where it matters to nobody", "[log]") {
    const auto day = [](const std::string& first, const std::string& second) {
        return log_of("t", [&](int k) {
            return (k < 20 ? first + " 23:59:59.9" : second + " 00:00:00.0") + std::to_string(10 + k);
        });
    };
    CHECK(read_text(day("03/04/2025", "04/04/2025")).layout.stamp_form.day_first);
    CHECK_FALSE(read_text(day("04/03/2025", "04/04/2025")).layout.stamp_form.day_first);
    const Log same =
        read_text(log_of("t", [](int k) { return "03/04/2025 12:00:00.0" + std::to_string(10 + k); }));
    CHECK(same.layout.inferences.front().reason == "no field says which; only the day depends on it");
    CHECK_THAT(complaint(log_of("t", [](int k) { return "3-Apr-2025 12:00:" + std::to_string(10 + k); })),
               Catch::Contains("expected a time of day or a date and time such as 12:30:01.5"));
    CHECK_THAT(complaint(log_of("t", [](int k) { return "2025-12-31 12:00:01,0" + std::to_string(10 + k); })),
               Catch::Contains("the comma of its milliseconds separates cells"));
    const std::string steps = log_of(
        "dt", [](int k) { return std::string(k == 2500 ? "-0.001" : "0.001"); }, 3000);
    CHECK_THAT(complaint(steps), Catch::Contains("log.csv:2502:1: read the time step -0.001"));
}

TEST_CASE("a clock that no unit makes a log's is refused with the option", "[log]") {
    const std::string slow = log_of("t", [](int k) { return std::to_string(k) + "0000000000"; });
    CHECK_THAT(complaint(slow), Catch::Contains("no unit is stated") && Catch::Contains("--unit time="));
    ReadOptions options;
    options.units = {{"time", "ns"}};
    CHECK(read_text(slow, options).trace.time_s[1] == Approx(10.0));
}
