// SPDX-License-Identifier: MIT
// The clock of a log, and parts of it.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "log/clock/clock_check.hpp"
#include "log/clock/stamp.hpp"
#include "log_support.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/log/clock.hpp"
#include "support/catch.hpp"
#include "support/vectors.hpp"

using namespace ripplenotch;
using Catch::Contains;
using test::complaint;
using test::read_text;
using namespace ripplenotch::testing;
using namespace ripplenotch::test;

// One clock: it says the same of a log however its rows arrive, sees gaps and changes of rate, and knows the
// controller's rate where rows are lost.

namespace {

std::vector<double> even(std::size_t rows, double rate_hz, double from_s = 0.0) {
    std::vector<double> times;
    for (std::size_t k = 0; k < rows; ++k) times.push_back(from_s + static_cast<double>(k) / rate_hz);
    return times;
}

void append(std::vector<double>& times, std::size_t rows, double rate_hz) {
    const double from = times.back();
    for (std::size_t k = 1; k <= rows; ++k) times.push_back(from + static_cast<double>(k) / rate_hz);
}

std::span<const double> opening_of(const std::vector<double>& times) {
    return std::span(times).first(std::min(times.size(), clock_rows));
}

struct Watched {
    ClockFacts facts;
    std::vector<std::size_t> run_starts;
    std::vector<bool> usable;  ///< by row
};

Watched watch(const std::vector<double>& times, const std::function<std::size_t()>& block) {
    Clock clock("log.csv", opening_of(times), std::nullopt);
    Watched watched;
    for (std::size_t at = 0; at < times.size();) {
        const std::size_t count = std::min(block(), times.size() - at);
        for (const RunPart& part : clock.add(std::span(times).subspan(at, count))) {
            if (part.begins_run) watched.run_starts.push_back(at + part.first);
            watched.usable.insert(watched.usable.end(), part.count, part.usable);
        }
        at += count;
    }
    watched.facts = clock.facts();
    return watched;
}

Watched watch(const std::vector<double>& times) {
    return watch(times, [&] { return times.size(); });
}

/// Logs of every kind that the clock tells apart.
std::vector<std::vector<double>> kinds() {
    std::vector<std::vector<double>> all;
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> share;
    all.push_back(even(3000, 1000.0));
    all.push_back(even(40000, 250.0, 1e9));
    for (const auto& [first, second] :
         {std::pair{2000.0, 167.0}, {167.0, 2000.0}, {1000.0, 500.0}, {500.0, 1200.0}}) {
        all.push_back(even(17000, first));
        append(all.back(), 9000, second);
        append(all.back(), 2000, first);
    }
    std::vector<double> lost, jitter, coarse, bursts, slow_spell;
    for (std::size_t k = 0; k < 20000; ++k) {
        const double t = static_cast<double>(k) / 1000.0;
        if (share(random) > 0.02) lost.push_back(t);
        jitter.push_back(t + 4e-4 * share(random));
        coarse.push_back(static_cast<double>(k - k % 3) / 1000.0);
        bursts.push_back(t + 0.05 * static_cast<double>(k / 700));
    }
    slow_spell = even(5000, 1000.0);
    append(slow_spell, 100, 50.0);
    append(slow_spell, 5000, 1000.0);
    all.insert(all.end(), {lost, jitter, coarse, bursts, slow_spell});
    return all;
}

}  // namespace

TEST_CASE("the clock says the same however a log is cut into blocks", "[log]") {
    std::mt19937_64 random(1);
    for (const std::vector<double>& times : kinds()) {
        const Watched whole = watch(times);
        CHECK(whole.facts.rows == times.size());
        CHECK(whole.usable.size() == times.size());
        for (const std::size_t most : {1U, 3U, 64U, 1000U, 20000U}) {
            const Watched parts = watch(times, [&] { return 1 + random() % most; });
            CHECK(parts.run_starts == whole.run_starts);
            CHECK(parts.usable == whole.usable);
            CHECK(parts.facts.mean_rate == whole.facts.mean_rate);
            CHECK(parts.facts.jitter == whole.facts.jitter);
            CHECK(parts.facts.gap_count == whole.facts.gap_count);
            CHECK(parts.facts.rows_left_out == whole.facts.rows_left_out);
            REQUIRE(parts.facts.rate_changes.size() == whole.facts.rate_changes.size());
            for (std::size_t i = 0; i < whole.facts.rate_changes.size(); ++i)
                CHECK(parts.facts.rate_changes[i].row == whole.facts.rate_changes[i].row);
        }
    }
}

TEST_CASE("a rate that falls by twelve is a change at its very row, not a gap a row", "[log]") {
    std::vector<double> times = even(17000, 2000.0);
    append(times, 23000, 167.0);
    const Watched watched = watch(times);
    CHECK(watched.facts.nominal_rate.value() == 2000.0);
    CHECK(watched.facts.mean_rate.value() == Approx(2000.0).epsilon(1e-9));
    CHECK(watched.facts.gap_count == 0);
    REQUIRE(watched.facts.rate_changes.size() == 1);
    const RateChange& change = watched.facts.rate_changes.front();
    CHECK(change.row == 16999);
    CHECK(change.time_s == times[16999]);
    CHECK(change.from.value() == 2000.0);
    CHECK(change.to.value() == Approx(167.0).epsilon(1e-6));
    // The first row behind the change cannot be told from one behind a gap.
    CHECK(std::count(watched.usable.begin(), watched.usable.begin() + 17001, false) == 0);
    CHECK(std::count(watched.usable.begin() + 17001, watched.usable.end(), true) == 0);
    CHECK(watched.facts.rows_left_out == 22999);
}

TEST_CASE("a smaller change of rate is seen at its row, and acted upon 256 rows later", "[log]") {
    for (const auto& [from, to] :
         {std::pair{1000.0, 500.0}, {500.0, 1000.0}, {1000.0, 200.0}, {400.0, 1000.0}}) {
        INFO(from << " to " << to);
        std::vector<double> times = even(18000, from);
        append(times, 4000, to);
        const Watched watched = watch(times);
        CHECK(watched.facts.nominal_rate.value() == from);
        CHECK(watched.facts.gap_count == 0);
        REQUIRE(watched.facts.rate_changes.size() == 1);
        CHECK(watched.facts.rate_changes.front().row == 17999);
        CHECK(watched.facts.rate_changes.front().to.value() == Approx(to).epsilon(1e-6));
        const auto off =
            std::find(watched.usable.begin(), watched.usable.end(), false) - watched.usable.begin();
        CHECK(off > 18000);
        CHECK(off <= 18000 + 6 * 64);
        CHECK(std::count(watched.usable.begin() + off, watched.usable.end(), true) == 0);
    }
}

TEST_CASE(
    "the longest part of the opening at one rate is the nominal one, and a rate that returns is used again",
    "[log]") {
    std::vector<double> times = even(2000, 100.0);
    append(times, 10000, 1000.0);
    append(times, 3000, 100.0);
    append(times, 10000, 1000.0);
    const Watched watched = watch(times);
    CHECK(watched.facts.nominal_rate.value() == 1000.0);
    CHECK(watched.facts.rate_changes.size() == 3);
    CHECK(watched.facts.gap_count == 0);
    CHECK_FALSE(watched.usable.front());
    CHECK(watched.usable[8000]);
    CHECK_FALSE(watched.usable[13500]);
    CHECK(watched.usable.back());
}

TEST_CASE("long steps in a row that do not last are gaps, each of them", "[log]") {
    std::vector<double> times = even(5000, 1000.0);
    append(times, 100, 50.0);
    append(times, 5000, 1000.0);
    const Watched watched = watch(times);
    CHECK(watched.facts.gap_count == 100);
    CHECK(watched.facts.rate_changes.empty());
    CHECK(watched.facts.mean_rate.value() == Approx(1000.0).epsilon(1e-6));
    CHECK(watched.usable.back());
}

TEST_CASE("where rows are lost the steps tell the controller's rate, and rounded stamps do not lose rows",
          "[log]") {
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> share;
    std::vector<double> lost, late = {0.0};
    for (std::size_t k = 0; k < 20000; ++k) {
        if (share(random) > 0.022) lost.push_back(static_cast<double>(k) / 1000.0);
        // A receiver that stamps late: most steps near 1 ms, a tail to 1.8 ms, nothing made up for.
        const double u = share(random);
        late.push_back(late.back() +
                       1e-3 * (u < 0.9 ? 0.9 + 0.2 * share(random) : 1.1 + 0.7 * share(random)));
    }
    for (const auto& times : {lost, late}) {
        const ClockFacts facts = watch(times).facts;
        CHECK(facts.nominal_rate.value() == Approx(1000.0).epsilon(0.02));
        CHECK(facts.mean_rate.value() < 985.0);
        CHECK_THAT(clock_warnings(facts).back().text, Contains("samples are missing or delayed"));
    }
    CHECK(watch(lost).facts.nominal_rate.value() == 1000.0);
    for (const double rate : {800.0, 227.3, 150.0, 666.7, 300.0}) {
        std::vector<double> rounded;
        for (std::size_t k = 0; k < 20000; ++k)
            rounded.push_back(std::floor(1000.0 * static_cast<double>(k) / rate) / 1000.0);
        INFO(rate);
        CHECK(watch(rounded).facts.nominal_rate.value() == Approx(rate).epsilon(2e-3));
    }
}

TEST_CASE(
    "a clock coarser than the rows runs at rows over time, one far coarser, in bursts or standing not at all",
    "[log]") {
    std::vector<double> coarse;
    for (std::size_t k = 0; k < 9000; ++k) coarse.push_back(static_cast<double>(k - k % 3) / 1000.0);
    const ClockFacts facts = watch(coarse).facts;
    CHECK(facts.nominal_rate.value() == 1000.0);
    CHECK(facts.gap_count == 0);
    CHECK(facts.repeated_times == 6000);
    CHECK(facts.refusal.empty());
    std::vector<double> seconds;
    for (std::size_t k = 0; k < 9000; ++k) seconds.push_back(static_cast<double>(k - k % 16) / 1000.0);
    CHECK_THAT(watch(seconds).facts.refusal,
               Contains("time advances once in 16 rows") && Contains("--sample-rate 1000Hz"));
    std::vector<double> bursts;
    for (std::size_t k = 0; k < 9000; ++k)
        bursts.push_back(static_cast<double>(k - k % 8) / 1000.0 + 20e-6 * static_cast<double>(k % 8));
    CHECK_THAT(watch(bursts).facts.refusal,
               Contains("in bursts of 8 rows, 2e-05 s apart") && Contains("--sample-rate 1000Hz"));
    const ClockFacts standing = watch(std::vector<double>(500, 2.0)).facts;
    CHECK_THAT(standing.refusal, Contains("does not advance"));
    CHECK(standing.nominal_rate.value() == 0.0);
}

TEST_CASE("time that runs backward is an error that names the row", "[log]") {
    std::vector<double> times = even(1000, 1000.0);
    times[700] = 0.1;
    Clock clock("log.csv", std::span(times).first(500), std::nullopt);
    CHECK_THROWS_WITH(clock.add(times), Contains("log.csv: data row 701") && Contains("--sample-rate"));
}

// Stamps with more digits than a double holds, in two columns, as dates; the unit of a clock that states
// none.

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

TEST_CASE("steps are summed up as a plain loop does, the same bits on every width of vectors", "[log]") {
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> step(0.0005, 0.0015);
    for (std::size_t count = 2; count < 80; ++count) {
        std::vector<double> time_s = {100.0};
        while (time_s.size() < count) time_s.push_back(time_s.back() + step(random));
        // Four sums side by side, the last few steps behind them.
        double sums[4] = {}, shortest = 1.0, longest = 0.0, rest = 0.0;
        const std::size_t steps = count - 1, even = steps - steps % 4;
        for (std::size_t k = 0; k < steps; ++k) {
            const double now = time_s[k + 1] - time_s[k];
            if (k < even) sums[k % 4] += (now - 0.001) * (now - 0.001);
            shortest = std::min(shortest, now);
            longest = std::max(longest, now);
        }
        rest = (sums[0] + sums[1]) + (sums[2] + sums[3]);
        for (std::size_t k = even; k < steps; ++k) {
            const double off = time_s[k + 1] - time_s[k] - 0.001;
            rest += off * off;
        }
        for (const bool wide : widths()) {
            const Width here(wide);
            const StepSums found = sum_up_steps(time_s, 0.001);
            CHECK(found.squares == rest);
            CHECK(found.shortest_s == shortest);
            CHECK(found.longest_s == longest);
        }
    }
}

// Which rows a range keeps: times as they are typed, times on the axis of a log, and the cut of every format.

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
                                   "1:30s", "2 weeks", "nan", "1:00:00:00", "2024-05-01"}) {
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
