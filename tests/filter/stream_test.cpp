// SPDX-License-Identifier: MIT
// A log through a filter: blocks, clocks and runs; and the pipeline of blocks on several threads.
#include <atomic>
#include <chrono>
#include <cmath>
#include <limits>
#include <mutex>
#include <random>
#include <set>
#include <stdexcept>
#include <thread>
#include <vector>

#include "core/rows/row_facts.hpp"
#include "filter/block_pipeline.hpp"
#include "filter/tables.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/filter/engine.hpp"
#include "ripplenotch/log/format.hpp"
#include "support/catch.hpp"
#include "support/vectors.hpp"

using namespace ripplenotch;
using namespace ripplenotch::testing;

namespace {

struct Rows {
    std::vector<double> time_s, velocity_deg_s, torque_nm;
};

Rows uniform(std::size_t count, double rate_hz) {
    Rows rows;
    const Signals s = wandering(count, 41);
    for (std::size_t k = 0; k < count; ++k) rows.time_s.push_back(static_cast<double>(k) / rate_hz);
    rows.velocity_deg_s = s.velocity_deg_s;
    rows.torque_nm = s.torque_nm;
    return rows;
}

/// A log that is in memory, read in blocks of a size of its own.
class FakeReader final : public LogReader {
  public:
    FakeReader(Rows rows, std::size_t block, std::optional<Hertz> stated = {})
        : rows_(std::move(rows)), block_(block) {
        layout_.source = "fake.csv";
        layout_.stated_rate = stated;
    }
    [[nodiscard]] const Layout& layout() const override { return layout_; }
    bool next(RowBlock& block) override {
        block = RowBlock{};
        if (at_ == rows_.time_s.size()) return false;
        const std::size_t count = std::min(block_, rows_.time_s.size() - at_);
        const auto part = [&](const std::vector<double>& from) {
            const auto first = from.begin() + static_cast<std::ptrdiff_t>(at_);
            return std::vector<double>(first, first + static_cast<std::ptrdiff_t>(count));
        };
        block.first_row = at_;
        block.time_s = part(rows_.time_s);
        block.joints[0].velocity_deg_s = part(rows_.velocity_deg_s);
        block.joints[0].torque_nm = part(rows_.torque_nm);
        at_ += count;
        return true;
    }

  private:
    Rows rows_;
    std::size_t block_, at_ = 0;
    Layout layout_;
};

class Collector final : public LogWriter {
  public:
    void put(const RowBlock& block, Torques torque_nm, std::string_view /*bytes*/) override {
        REQUIRE(torque_nm.size() == 1);
        REQUIRE(block.size() == torque_nm[0].size());
        REQUIRE(block.first_row == values.size());
        values.insert(values.end(), torque_nm[0].begin(), torque_nm[0].end());
    }
    void finish() override { finished = true; }
    std::vector<double> values;
    bool finished = false;
};

LogStream stream_of(const Rows& rows, std::size_t block = 1000, std::optional<Hertz> stated = {}) {
    return LogStream(std::make_unique<FakeReader>(rows, block, stated));
}

constexpr std::size_t block_bytes = std::size_t{1} << 19;
constexpr std::size_t blocks = 40;  // 20 MiB: threads start behind the first four

/// Numbered blocks whose steps note what they saw.
struct Course {
    std::size_t fetched = 0;
    std::vector<std::size_t> filtered, put;
    std::atomic<int> on_their_way = 0, most_on_their_way = 0;
    std::mutex mutex;
    std::set<std::thread::id> workers;

    BlockSteps steps() {
        BlockSteps steps;
        steps.fetch = [this](BlockItem& item) {
            if (fetched == blocks) return false;
            item.block.bytes.assign(block_bytes, 'x');
            item.block.first_row = fetched++;
            most_on_their_way = std::max<int>(most_on_their_way, ++on_their_way);
            return true;
        };
        steps.parse = [this](BlockItem&) {
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
            const std::lock_guard lock(mutex);
            workers.insert(std::this_thread::get_id());
        };
        steps.filter = [this](BlockItem& item) { filtered.push_back(item.block.first_row); };
        steps.prepare = [](BlockItem& item) {
            // Every other block takes longer, so that those behind it come to the last door first.
            if (item.block.first_row % 2 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(2));
        };
        steps.put = [this](BlockItem& item) {
            put.push_back(item.block.first_row);
            --on_their_way;
        };
        return steps;
    }
};

std::vector<std::size_t> first(std::size_t count) {
    std::vector<std::size_t> numbers(count);
    for (std::size_t i = 0; i < count; ++i) numbers[i] = i;
    return numbers;
}

}  // namespace

TEST_CASE(
    "a rate near a round number, or with a round period, is taken for what the controller was meant to run "
    "at") {
    const std::vector<std::pair<double, double>> cases = {
        {1000.0, 1000.0}, {1000.3, 1000.0}, {999.6, 1000.0},      {250.01, 250.0},
        {125.0, 125.0},   {124.96, 125.0},  {62.5, 62.5},         {8000.0, 8000.0},
        {25.0, 25.0},     {99.97, 100.0},   {333.3, 1.0 / 0.003}, {978.4, 978.4},
        {984.43, 984.43}, {1002.0, 1002.0}, {0.5, 0.5},           {48000.0, 48000.0}};
    for (const auto& [measured, expected] : cases) {
        INFO(measured);
        CHECK(nominal_rate(Hertz(measured)).value() == expected);
    }
}

TEST_CASE("a round rate is reached exactly, whatever rounding the times carry") {
    for (const double rate : {100.0, 125.0, 200.0, 250.0, 500.0, 1000.0, 2000.0, 4000.0, 8000.0, 10000.0}) {
        for (const double off : {-5e-4, -1e-9, 0.0, 1e-12, 4e-4}) {
            INFO(rate << " " << off);
            CHECK(nominal_rate(Hertz(rate * (1.0 + off))).value() == rate);
        }
    }
}

TEST_CASE("a table's rate may be half a per cent off in silence, five with a warning, and no more") {
    CHECK_FALSE(table_rate_warning({.table = Hertz(1000.0), .log = Hertz(1004.9)}, "a.csv"));
    const auto warning = table_rate_warning({.table = Hertz(1000.0), .log = Hertz(978.28)}, "a.csv");
    REQUIRE(warning);
    CHECK_THAT(*warning,
               Catch::Contains("a.csv") && Catch::Contains("978.28 Hz") && Catch::Contains("1000 Hz"));
    CHECK_NOTHROW(table_rate_warning({.table = Hertz(1000.0), .log = Hertz(951.0)}, "a.csv"));
    CHECK_THROWS_AS(table_rate_warning({.table = Hertz(1000.0), .log = Hertz(949.0)}, "a.csv"), DataError);
    CHECK_THROWS_WITH(
        table_rate_warning({.table = Hertz(1000.0), .log = Hertz(500.0)}, "a.csv"),
        Catch::Contains("500 Hz") && Catch::Contains("1000 Hz") && Catch::Contains("--sample-rate 500Hz"));
}

TEST_CASE("a log comes out as the filter alone would make it, whatever the reader's blocks") {
    const Rows rows = uniform(40000, 1000.0);
    const CandidateTable table = paper_table();
    const auto alone = start("switching,table=t", &table);
    const auto expected = filtered(*alone, {rows.velocity_deg_s, rows.torque_nm, {}});
    for (const std::size_t block : {1U, 777U, 16384U, 100000U}) {
        LogStream stream = stream_of(rows, block);
        CHECK(stream.design_rate().value() == 1000.0);
        Collector out;
        const auto filter = start("switching,table=t", &table);
        const StreamReport report = stream.run(*filter, &out, nullptr);
        CHECK(out.finished);
        CHECK(out.values == expected);
        CHECK(report.recording.rows() == 40000);
        CHECK(report.recording.clock.gap_count == 0);
        CHECK(report.recording.clock.mean_rate.value() == Approx(1000.0).epsilon(1e-9));
        REQUIRE(report.switches.size() == alone->switches().size());
        CHECK(report.switch_count == alone->switch_count());
        for (const TimedSwitch& entry : report.switches) {
            REQUIRE(entry.time_s == rows.time_s[entry.change.sample]);
        }
    }
}

TEST_CASE(
    "a gap in time splits the run: what follows it is filtered as a log of its own, and the gap is "
    "reported") {
    Rows rows = uniform(30000, 1000.0);
    for (std::size_t k = 12345; k < 30000; ++k) rows.time_s[k] += 0.5;
    for (std::size_t k = 20000; k < 30000; ++k) rows.time_s[k] += 2.0;
    for (const std::size_t block : {64U, 5000U, 12345U, 40000U}) {
        LogStream stream = stream_of(rows, block);
        Collector out;
        const auto filter = start("lowpass,cutoff=13rad/s");
        const StreamReport report = stream.run(*filter, &out, nullptr);
        REQUIRE(report.recording.clock.gap_count == 2);
        CHECK(report.recording.clock.gaps[0].row == 12344);
        CHECK(report.recording.clock.gaps[0].from_s == rows.time_s[12344]);
        CHECK(report.recording.clock.gaps[0].to_s == rows.time_s[12345]);
        CHECK(report.recording.clock.gaps[1].row == 19999);
        CHECK(report.recording.clock.mean_rate.value() == Approx(1000.0).epsilon(1e-9));
        for (const auto& [first, last] : {std::pair{0, 12345}, {12345, 20000}, {20000, 30000}}) {
            const std::vector<double> part(rows.torque_nm.begin() + first, rows.torque_nm.begin() + last);
            const auto fresh = start("lowpass,cutoff=13rad/s");
            const auto expected = filtered(*fresh, {part, part, {}});
            CHECK(std::equal(expected.begin(), expected.end(), out.values.begin() + first));
        }
    }
}

TEST_CASE("of even stamps in whole milliseconds the rate is the mean, not one over the median step") {
    Rows rows = uniform(20000, 1000.0);
    // Three steps of 1 ms, then one of 2 ms: the median says 1 kHz, the clock runs at 800 Hz.
    double t = 0.0;
    for (std::size_t k = 0; k < 20000; ++k) {
        rows.time_s[k] = t;
        t += k % 4 == 3 ? 0.002 : 0.001;
    }
    const LogStream stream = stream_of(rows);
    CHECK(stream.design_rate().value() == 800.0);
}

TEST_CASE(
    "time that runs backward is an error that names the row, and repeated times and held samples are "
    "counted") {
    Rows rows = uniform(20000, 1000.0);
    rows.time_s[15000] = rows.time_s[14999];
    const auto hold = [&rows](std::size_t k, double velocity_deg_s, bool torque_too) {
        rows.velocity_deg_s[k - 1] = rows.velocity_deg_s[k] = velocity_deg_s;
        if (torque_too) rows.torque_nm[k] = rows.torque_nm[k - 1];
    };
    hold(15001, 30.0, true);
    hold(15011, 0.0, true);                         // standing still: nothing is held
    hold(15021, 30.0, false);                       // a new torque was measured
    rows.torque_nm[15031] = rows.torque_nm[15030];  // the velocity moved on
    {
        LogStream stream = stream_of(rows);
        const auto filter = start("none");
        const StreamReport report = stream.run(*filter, nullptr, nullptr);
        CHECK(report.recording.clock.repeated_times == 1);
        CHECK(report.recording.held.count == 1);
    }
    rows.time_s[17000] = 3.0;
    LogStream stream = stream_of(rows);
    const auto filter = start("none");
    CHECK_THROWS_AS(stream.run(*filter, nullptr, nullptr), DataError);
    LogStream again = stream_of(rows);
    CHECK_THROWS_WITH(again.run(*filter, nullptr, nullptr),
                      Catch::Contains("fake.csv: data row 17001") && Catch::Contains("--sample-rate"));
}

TEST_CASE(
    "a stated rate is believed, and without time or a stated rate, or with one row, nothing is filtered") {
    Rows rows = uniform(100, 1000.0);
    CHECK(stream_of(rows, 10, Hertz(978.0)).design_rate().value() == 978.0);
    Rows timeless = rows;
    timeless.time_s.assign(100, std::numeric_limits<double>::quiet_NaN());
    CHECK_THROWS_WITH(stream_of(timeless), Catch::Contains("--sample-rate"));
    Rows standing = rows;
    standing.time_s.assign(100, 2.0);
    CHECK_THROWS_WITH(stream_of(standing), Catch::Contains("time does not advance"));
    CHECK_THROWS_AS(stream_of(uniform(1, 1000.0)), DataError);
    CHECK_THROWS_AS(stream_of(Rows{}), DataError);
}

TEST_CASE("what is kept of a log are the rows of every run, raw and filtered, and of a long one stretches") {
    Rows rows;
    for (std::size_t k = 0; k < 40000; ++k) {
        const double t = static_cast<double>(k) / 1000.0;
        rows.time_s.push_back(t < 4.0 ? t : t + 1.0);
        rows.velocity_deg_s.push_back(90.0);
        rows.torque_nm.push_back(3.0 + std::sin(2.0 * std::numbers::pi * 25.0 * t));
    }
    const auto kept_of = [&](bool sparsely) {
        KeptRows kept;
        kept.sparsely = sparsely;
        LogStream stream = stream_of(rows);
        const auto filter = start("lowpass,cutoff=13rad/s");
        stream.run(*filter, nullptr, &kept);
        return kept;
    };
    const KeptRows all = kept_of(false), some = kept_of(true);
    CHECK(all.rows == 40000);
    CHECK(all.trace.torque_nm == rows.torque_nm);
    CHECK(all.trace.time_s == rows.time_s);
    CHECK(all.trace.run_starts == std::vector<std::size_t>{4000});
    CHECK(all.out_nm.size() == 40000);
    // Stretches 0, 1 and 3 of 8192 rows.
    CHECK(some.rows == 40000);
    CHECK(some.trace.size() == 3 * 8192);
    CHECK(some.trace.run_starts == std::vector<std::size_t>{4000, 2 * 8192});
    CHECK(some.out_nm.back() == all.out_nm[4 * 8192 - 1]);
}

TEST_CASE("blocks are filtered and put in their order, and no more are on their way than there are threads") {
    for (const std::size_t threads : {1U, 2U, 3U, 8U}) {
        INFO(threads << " threads");
        Course course;
        run_blocks(course.steps(), threads);
        CHECK(course.filtered == first(blocks));
        CHECK(course.put == first(blocks));
        CHECK(course.most_on_their_way <= static_cast<int>(threads));
        CHECK(course.workers.size() <= threads);
        CHECK((threads == 1 || course.workers.size() > 1));
    }
}

TEST_CASE(
    "a failure comes after every block before it has been put, whichever step it is in and however many "
    "threads") {
    const std::size_t failing = 25;
    for (const std::size_t threads : {1U, 2U, 5U}) {
        for (int which = 0; which < 4; ++which) {
            INFO(threads << " threads, step " << which);
            Course course;
            BlockSteps steps = course.steps();
            const auto fails = [&](const std::function<void(BlockItem&)>& step) {
                return [&, step](BlockItem& item) {
                    // A later block's failure comes earlier in time and must not be told instead.
                    if (item.block.first_row == failing + 1) throw std::runtime_error("later");
                    if (item.block.first_row == failing) {
                        std::this_thread::sleep_for(std::chrono::milliseconds(5));
                        throw std::runtime_error("first");
                    }
                    step(item);
                };
            };
            std::function<void(BlockItem&)>* const chosen[] = {&steps.parse, &steps.filter, &steps.prepare,
                                                               &steps.put};
            *chosen[which] = fails(*chosen[which]);
            CHECK_THROWS_WITH(run_blocks(steps, threads), "first");
            CHECK(course.put == first(failing));
        }
    }
}

TEST_CASE("a source that breaks off is told after everything that came before has been put") {
    for (const std::size_t threads : {1U, 3U}) {
        Course course;
        BlockSteps steps = course.steps();
        steps.fetch = [&course, fetch = steps.fetch](BlockItem& item) {
            if (course.fetched == 20) throw std::runtime_error("broken pipe");
            return fetch(item);
        };
        CHECK_THROWS_WITH(run_blocks(steps, threads), "broken pipe");
        CHECK(course.put == first(20));
        CHECK(course.fetched == 20);
    }
}

// What is noted of rows four at a time is what a plain loop over the rows notes.

namespace {

const double infinity = std::numeric_limits<double>::infinity();

/// Few values, so that neighbours are often equal.
std::vector<double> coarse(std::size_t size, std::mt19937& engine) {
    std::vector<double> values(size);
    for (double& value : values) value = static_cast<double>(engine() % 5) - 2.0;
    return values;
}

/// count_repeats by the words of their description.
RepeatCounts plainly(const JointRows& rows, std::size_t first, std::size_t end, double moving_deg_s) {
    RepeatCounts counts;
    for (std::size_t k = first + 1; k < end; ++k) {
        const auto same = [k](const std::vector<double>& values) {
            return !values.empty() && values[k - 1] == values[k];
        };
        const bool torque = same(rows.torque_nm);
        if (!(std::abs(rows.velocity_deg_s[k - 1]) > moving_deg_s)) continue;
        if (!(std::abs(rows.velocity_deg_s[k]) > moving_deg_s)) continue;
        ++counts.moving;
        if (torque) ++counts.torque;
        if (same(rows.velocity_deg_s)) ++counts.velocity;
        if (same(rows.position_deg)) ++counts.position;
        if (same(rows.velocity_deg_s) && torque) ++counts.velocity_and_torque;
        if (same(rows.position_deg) && torque) ++counts.position_and_torque;
        if (same(rows.velocity_deg_s) && same(rows.position_deg) && torque) ++counts.all;
    }
    return counts;
}

bool equal(const RepeatCounts& a, const RepeatCounts& b) {
    return a.moving == b.moving && a.velocity == b.velocity && a.position == b.position &&
           a.torque == b.torque && a.velocity_and_torque == b.velocity_and_torque &&
           a.position_and_torque == b.position_and_torque && a.all == b.all;
}

}  // namespace

TEST_CASE("repeated rows are counted as a plain loop counts them, with and without positions") {
    std::mt19937 engine(1);
    for (const bool wide : widths())
        for (const bool with_position : {false, true}) {
            const Width here(wide);
            for (std::size_t size = 1; size < 60; ++size) {
                JointRows rows;
                rows.velocity_deg_s = coarse(size, engine);
                rows.torque_nm = coarse(size, engine);
                if (with_position) rows.position_deg = coarse(size, engine);
                for (const double moving_deg_s : {0.0, 0.5, 1.0, 5.0}) {
                    const RepeatCounts found =
                        count_repeats({rows.velocity_deg_s.data(), rows.torque_nm.data(),
                                       with_position ? rows.position_deg.data() : nullptr},
                                      size - 1, moving_deg_s);
                    CHECK(equal(found, plainly(rows, 0, size, moving_deg_s)));
                }
            }
        }
}

TEST_CASE("the range of speeds is that of a plain loop, and what is no number widens nothing") {
    std::mt19937 engine(3);
    std::uniform_real_distribution<double> velocity(-90.0, 90.0);
    for (std::size_t size = 0; size < 60; ++size) {
        std::vector<double> values(size);
        for (double& value : values) value = engine() % 7 == 0 ? not_a_number : velocity(engine);
        SpeedExtent range{30.0, 40.0}, expected = range;
        SpeedExtent narrow = range;
        widen(range, values);
        {
            const NarrowVectors here;
            widen(narrow, values);
        }
        for (const double value : values) {
            if (std::abs(value) < expected.slowest_deg_s) expected.slowest_deg_s = std::abs(value);
            if (std::abs(value) > expected.fastest_deg_s) expected.fastest_deg_s = std::abs(value);
        }
        CHECK(range.slowest_deg_s == expected.slowest_deg_s);
        CHECK(range.fastest_deg_s == expected.fastest_deg_s);
        CHECK(narrow.slowest_deg_s == range.slowest_deg_s);
        CHECK(narrow.fastest_deg_s == range.fastest_deg_s);
    }
}

TEST_CASE("the first step outside a range is found wherever it is, by every instruction set") {
    for (const bool wide : widths()) {
        const Width here(wide);
        CHECK(first_step_outside({}, 0.0, 1.0) == 0);
        for (const std::size_t size : {1UL, 2UL, 16UL, 17UL, 18UL, 64UL, 100UL}) {
            std::vector<double> times(size);
            for (std::size_t k = 0; k < size; ++k) times[k] = 10.0 + 0.25 * static_cast<double>(k);
            CHECK(first_step_outside(times, 0.0, 0.25) == size);
            for (std::size_t at = 1; at < size; ++at) {
                for (const double step : {0.0, -0.25, 0.5, not_a_number, infinity, -infinity}) {
                    std::vector<double> changed = times;
                    for (std::size_t k = at; k < size; ++k) changed[k] += step - 0.25;
                    CHECK(first_step_outside(changed, 0.0, 0.25) == at);
                }
            }
        }
    }
}
