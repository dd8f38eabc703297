// SPDX-License-Identifier: MIT
// One clock: it says the same of a log however its rows arrive, sees gaps and changes of rate, and knows the
// controller's rate where rows are lost.
#include "ripplenotch/log/clock.hpp"

#include <algorithm>
#include <functional>
#include <random>

#include "ripplenotch/core/error.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using Catch::Contains;

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
