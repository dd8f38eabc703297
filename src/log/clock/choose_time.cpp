// SPDX-License-Identifier: MIT
// Which column is the clock. A name is not enough: a column called "time" that counts rows is a counter, and
// a log read by it would be wrong without anybody noticing.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "core/text/lower_case.hpp"
#include "log/clock/stamp.hpp"
#include "log/columns/column_name.hpp"
#include "log/columns/decide_layout.hpp"
#include "log/columns/units.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {

namespace {

// The unit of a clock that does not say it: from where it counts, or from the rate that it gives.

constexpr double lowest_rate_hz = 10.0, highest_rate_hz = 1e5;  // of logs, where a rate decides the unit
constexpr double least_assumed_hz = 1.0;                        // by hand
constexpr double long_ago = 1e9;  // counts from here on are taken relative to the first

struct ClockUnit {
    std::string_view name;
    double seconds;
    double epoch_from, epoch_to;  ///< counts since 1970 (since 1601 for ticks) between 1990 and 2090
    std::string_view since;
};
constexpr std::array clock_units = {
    ClockUnit{"s", 1.0, 6.3e8, 3.8e9, "seconds since 1970"},
    ClockUnit{"ms", 1e-3, 6.3e11, 3.8e12, "milliseconds since 1970"},
    ClockUnit{"us", 1e-6, 6.3e14, 3.8e15, "microseconds since 1970"},
    ClockUnit{"ns", 1e-9, 6.3e17, 3.8e18, "nanoseconds since 1970"},
    ClockUnit{"100ns", 1e-7, 1.22e17, 1.55e17, "ticks of 100 ns since 1601 (FILETIME)"},
    ClockUnit{"d", 86400.0, 3.29e4, 6.95e4, "days since 1900, as of a spreadsheet"},
    ClockUnit{"d", 86400.0, 7.26e5, 7.64e5, "days since the year 0, as of MATLAB"},
};
constexpr std::size_t counted_units = 5;  // those that a rate alone decides between

struct ClockOpening {
    double first = 0.0;
    double step = 0.0;  ///< the median of those that advance; 0 when none does
};

// Of a column of times, or of steps that are summed.
ClockOpening opening_of(const ColumnFacts& facts, std::size_t column, bool summed) {
    ClockOpening opening;
    if (column >= facts.sample.size()) return opening;
    std::vector<double> steps;
    double before = std::numeric_limits<double>::quiet_NaN();
    for (const double value : facts.sample[column]) {
        if (summed && value > 0.0) steps.push_back(value);
        if (summed) continue;
        if (std::isfinite(value) && !std::isfinite(before)) opening.first = value;
        if (value > before) steps.push_back(value - before);
        if (std::isfinite(value)) before = value;
    }
    if (steps.empty()) return opening;
    opening.step = median_in(steps);
    return opening;
}

double rate_in(const ClockOpening& opening, const ClockUnit& unit) {
    return 1.0 / (opening.step * unit.seconds);
}

// Decimals in a step: the unit is seconds, if that gives a rate at all; so are the least of rates first.
const ClockUnit* unit_of(const ClockOpening& opening, std::string& reason) {
    for (const ClockUnit& unit : clock_units) {
        const bool epoch = opening.first >= unit.epoch_from && opening.first <= unit.epoch_to;
        const double rate = rate_in(opening, unit);
        if (!epoch || rate < least_assumed_hz || rate > 10.0 * highest_rate_hz) continue;
        reason = fmt::format("{:.4g} is a count of {}", opening.first, unit.since);
        return &unit;
    }
    for (const ClockUnit& unit : std::span(clock_units).first(counted_units)) {
        const double rate = rate_in(opening, unit);
        if (rate < lowest_rate_hz * 0.999 || rate > highest_rate_hz * 1.001) continue;
        reason = fmt::format("a step of {:.4g} is then {:.4g} Hz", opening.step, rate);
        return &unit;
    }
    const double seconds_hz = rate_in(opening, clock_units[0]);
    const bool seconds = seconds_hz >= least_assumed_hz && seconds_hz <= highest_rate_hz;
    return seconds ? &clock_units[0] : nullptr;
}

void set_origin(const ColumnFacts& facts, const ClockOpening& opening, Layout& layout) {
    const std::size_t column = *layout.chosen.time;
    const bool days = layout.columns[column].unit == "d";
    if (std::abs(opening.first) < (days ? 1.0 : long_ago) || std::abs(opening.first) > 9.2e18) return;
    const std::int64_t exact = column < facts.first_counts.size() ? facts.first_counts[column] : 0;
    layout.time_origin = exact != 0 ? exact : static_cast<std::int64_t>(opening.first);
}

void find_unit(const ColumnFacts& facts, const ClockOpening& opening, Layout& layout) {
    Column& column = layout.columns[*layout.chosen.time];
    const std::string label = column_label(facts.names, *layout.chosen.time);
    std::string reason;
    const ClockUnit* const unit = unit_of(opening, reason);
    if (unit == nullptr) {
        ask("{}: {} advances by {} a row and no unit is stated: in seconds that is {:.3g} rows a second, and "
            "no unit from s to ns gives {:g} Hz to {:g} kHz; use --unit time=d (or s, ms, us, ns, min, h), "
            "or --sample-rate 1kHz",
            layout.source, label, shortest(opening.step), 1.0 / opening.step, lowest_rate_hz,
            1e-3 * highest_rate_hz);
    }
    column.unit = unit->name;
    column.factor = unit->seconds;
    column.unit_assumed = reason.empty();
    if (reason.empty()) reason = "no unit gives a usual rate; seconds are the commonest";
    Assumption read{fmt::format("unit of {}", label),
                    std::string(unit->name),
                    reason,
                    fmt::format("--unit time={}", unit->name),
                    {}};
    (column.unit_assumed ? layout.assumptions : layout.inferences).push_back(std::move(read));
}

struct Round {
    double length = 0.0;  ///< in the unit of the column
    const char* words = "";
};

constexpr std::array rounds{
    Round{65536.0, "a counter of 16 bits"}, Round{4294967296.0, "a counter of 32 bits"},
    Round{86400.0, "a time of day"},        Round{86400e3, "a time of day"},
    Round{86400e6, "a time of day"},        Round{86400e9, "a time of day"}};

// By hand: a step longer than a hundredth of the round would be a gap of ten minutes in a day.
constexpr double longest_step_share = 0.01;

std::string shown_time(double value, std::int64_t origin) {
    if (origin == 0 || std::abs(value) > 9e15 || value != std::floor(value)) return shortest(value);
    std::int64_t whole = 0;
    return __builtin_add_overflow(static_cast<std::int64_t>(value), origin, &whole)
               ? shortest(value)
               : fmt::format("{}", whole);
}

const Round* round_of(double before, double read) {
    for (const Round& round : rounds) {
        const double on = read + round.length - before;
        if (on >= 0.0 && on <= longest_step_share * round.length) return &round;
    }
    return nullptr;
}

std::vector<double> finite_values(const ColumnFacts& facts, std::size_t column) {
    std::vector<double> values;
    if (column >= facts.sample.size()) return values;
    for (const double value : facts.sample[column]) {
        if (std::isfinite(value)) values.push_back(value);
    }
    return values;
}

// Whole numbers that go up by one each row.
bool counts_rows(const std::vector<double>& values) {
    constexpr double most_rows = 1e9;  // what begins beyond counts something else, from long ago
    if (values.size() < 3 || values.front() != std::floor(values.front()) || values.front() > most_rows)
        return false;
    for (std::size_t i = 1; i < values.size(); ++i) {
        if (values[i] - values[i - 1] != 1.0) return false;
    }
    return true;
}

bool runs_forward(const std::vector<double>& values) {
    return values.size() > 1 && std::ranges::is_sorted(values) && values.front() < values.back();
}

std::string labels(const ColumnFacts& facts, const std::vector<std::size_t>& columns) {
    std::vector<std::string> texts;
    for (const std::size_t c : columns) texts.push_back(column_label(facts.names, c));
    return fmt::format("{}", fmt::join(texts, " and "));
}

// "header.stamp." of "header.stamp.nanosec", when the name ends in one of the words.
std::optional<std::string> name_before(const std::string& name, std::string_view words) {
    const std::string text = lower_case(name);
    std::size_t begin = text.size();
    while (begin > 0 && std::isalpha(static_cast<unsigned char>(text[begin - 1])) != 0) --begin;
    if (!has_word(words, std::string_view(text).substr(begin))) return std::nullopt;
    return text.substr(0, begin);
}

/// Seconds and nanoseconds of one stamp, as ROS writes them.
struct StampPair {
    std::size_t seconds, nanoseconds;
};
std::optional<StampPair> find_stamp_pair(const ColumnFacts& facts, const Forced& forced) {
    constexpr std::string_view whole = "sec secs seconds s",
                               parts = "nanosec nsec nsecs nanosecs nanoseconds";
    for (std::size_t n = 0; n < facts.names.size(); ++n) {
        const auto before = name_before(facts.names[n], parts);
        if (!before || forced.roles[n]) continue;
        for (std::size_t s = 0; s < facts.names.size(); ++s) {
            if (forced.roles[s].value_or(Role::time) != Role::time ||
                name_before(facts.names[s], whole) != before)
                continue;
            std::vector<double> values = finite_values(facts, s);
            const std::vector<double> below = finite_values(facts, n);
            for (std::size_t i = 0; i < std::min(values.size(), below.size()); ++i)
                values[i] += 1e-9 * below[i];
            if (runs_forward(values)) return StampPair{s, n};
        }
    }
    return std::nullopt;
}

/// "dt", "timestep", "Delta t": a column of steps, whose values are steps, too.
bool holds_steps(const ColumnFacts& facts, std::size_t column) {
    constexpr std::string_view words =
        "dt timestep timesteps deltat deltatime sampletime samplestep steptime tdelta";
    if (!facts.sums_steps || facts.names.empty()) return false;
    std::string name = lower_case(split_unit(facts.meanings()[column]).name);
    std::erase_if(name, [](char c) { return c == '_' || c == ' ' || c == '-' || c == '.'; });
    if (!has_word(words, name)) return false;
    const auto values = finite_values(facts, column);
    return !values.empty() && *std::ranges::min_element(values) >= 0.0 && !runs_forward(values);
}

void take_steps(const ColumnFacts& facts, std::size_t column, Layout& layout) {
    layout.chosen.time = column;
    layout.time_is_steps = true;
    layout.infer("time", fmt::format("the sum of the steps in {}", column_label(facts.names, column)),
                 "its name and its values are those of steps from row to row",
                 "--sample-rate, or --columns time=NAME");
}

/// Columns that could be the clock: by name, and by what their values do.
struct Clocks {
    std::vector<std::size_t> forward, texts, counters, broken;
};
Clocks find_clocks(const ColumnFacts& facts, const std::vector<ColumnName>& names, const Forced& forced,
                   const ReadOptions& options) {
    Clocks found;
    int best_rank = 1000;
    for (std::size_t c = 0; !forced.by_place && c < facts.names.size(); ++c) {
        const ColumnName& name = names[c];
        const Convention* const known = name.convention(Role::time);
        if ((name.role != Role::time && known == nullptr) || name.reference || forced.roles[c]) continue;
        const auto values = finite_values(facts, c);
        if (!facts.clock_texts.empty() && facts.clock_texts[c]) {
            if (runs_forward(values)) found.texts.push_back(c);
            continue;
        }
        if (name.rank > best_rank) continue;
        if (name.rank < best_rank) found = {{}, found.texts, {}, {}}, best_rank = name.rank;
        const bool has_unit = known != nullptr || !name.unit.empty() ||
                              (!facts.units.empty() && !facts.units[c].empty()) ||
                              stated_of(options.units, facts.names[c], Role::time) != nullptr ||
                              stated_of(options.scales, facts.names[c], Role::time) != nullptr;
        if (!has_unit && counts_rows(values)) {
            found.counters.push_back(c);
        } else if (runs_forward(values) || facts.sample.empty() || facts.sample[c].size() < 2) {
            found.forward.push_back(c);
        } else {
            found.broken.push_back(c);
        }
    }
    return found;
}

// No column is the clock: an error that says what to state, or a warning where a log may go without.
void refuse_clocks(const ColumnFacts& facts, const Clocks& clocks, const ReadOptions& options,
                   Layout& layout) {
    std::string why =
        facts.names.empty()
            ? "the columns have no names, state what they are with --columns time,velocity,torque"
            : "no column is named as a time";
    if (!clocks.counters.empty()) {
        why = fmt::format(
            "{} only counts rows (1, 2, 3, ...), which is a row number, or a time whose unit is not stated",
            labels(facts, clocks.counters));
    }
    if (clocks.broken.size() > 1)
        why = fmt::format("neither of {} runs forward in numbers", labels(facts, clocks.broken));
    if (!options.needs_torque) {
        layout.warn(
            "no sample rate",
            fmt::format("{}: no sample rate; use --sample-rate 1kHz, --unit time=ms, or --columns time=NAME",
                        why));
        return;
    }
    raise<DataError>("{}: {}, expected a time column; use --sample-rate 1kHz{}{}", layout.source, why,
                     clocks.counters.empty() ? "" : ", --unit time=ms",
                     facts.names.empty() ? "" : ", or --columns time=NAME");
}

// A file without a clock whose head says how long a row is.
bool use_step_of_head(const ColumnFacts& facts, const Clocks& clocks, Layout& layout) {
    const auto is_empty = [&](std::size_t column) { return finite_values(facts, column).empty(); };
    if (!facts.row_step_s || !std::ranges::all_of(clocks.broken, is_empty)) return false;
    layout.stated_rate = Hertz(1.0 / *facts.row_step_s);
    layout.infer("time", fmt::format("{} s a row", *facts.row_step_s),
                 "no column is a time, and the head of the file states " + facts.row_step_key,
                 fmt::format("--sample-rate {}Hz", shortest(layout.stated_rate->value())));
    return true;
}

}  // namespace

void settle_clock(const ColumnFacts& facts, bool unit_is_stated, Layout& layout) {
    if (!layout.chosen.time) return;
    Column& column = layout.columns[*layout.chosen.time];
    const ClockOpening opening = opening_of(facts, *layout.chosen.time, layout.time_is_steps);
    layout.time_as_text = !facts.clock_texts.empty() && facts.clock_texts[*layout.chosen.time];
    if (layout.time_as_text) layout.stamp_form = facts.stamp_forms[*layout.chosen.time];
    if (!unit_is_stated && !layout.time_as_text && !layout.time_fraction && opening.step > 0.0)
        find_unit(facts, opening, layout);
    set_origin(facts, opening, layout);
    const std::string label = column_label(facts.names, *layout.chosen.time);
    if (layout.time_as_text && layout.stamp_form.either_order && layout.stamp_form.other_s != 0)
        layout.infer(fmt::format("dates in {}", label),
                     layout.stamp_form.day_first ? "day/month/year" : "month/day/year",
                     "no field says which; only the day depends on it", "dates as 2024-05-01");
    if (layout.time_as_text && layout.stamp_form.milliseconds)
        layout.infer(fmt::format("digits behind the seconds in {}", label), "milliseconds",
                     "as decimals they would run backward", "--sample-rate");
    if (layout.time_as_text || layout.time_fraction) {
        column.unit = "s";
        column.factor = 1.0;
        column.unit_assumed = false;
        return;
    }
}

std::string time_backward(double before, double read, std::int64_t origin) {
    const std::string seen =
        fmt::format("read the time {} after {}, ", shown_time(read, origin), shown_time(before, origin));
    if (const Round* round = round_of(before, read)) {
        return seen + fmt::format(
                          "expected time to run forward; it falls as {} does that begins anew (at {}): take "
                          "the rows before with --to, or count rows with --sample-rate",
                          round->words, shortest(round->length));
    }
    return seen +
           "expected time to run forward; sort or split the log, or use --sample-rate if the clock is of no "
           "use";
}

bool varies(const std::vector<double>& values) {
    double first = std::numeric_limits<double>::quiet_NaN();
    for (const double value : values) {
        if (!std::isfinite(value)) continue;
        if (std::isnan(first)) first = value;
        if (value != first) return true;
    }
    return false;
}

void choose_time(const ColumnFacts& facts, const std::vector<ColumnName>& names, const Forced& forced,
                 const ReadOptions& options, Layout& layout) {
    if (options.sample_rate) return;
    layout.chosen.time = forced.column_of(Role::time);
    const auto pair = forced.by_place ? std::nullopt : find_stamp_pair(facts, forced);
    if (pair && layout.chosen.time.value_or(pair->seconds) == pair->seconds) {
        layout.chosen.time = pair->seconds;
        layout.time_fraction = pair->nanoseconds;
    }
    if (layout.chosen.time && !pair && holds_steps(facts, *layout.chosen.time))
        take_steps(facts, *layout.chosen.time, layout);
    if (layout.chosen.time) return;
    const Clocks found = find_clocks(facts, names, forced, options);
    const auto& [clocks, texts, counters, broken] = found;
    if (clocks.size() > 1) {
        raise<DataError>("{}: {} could each be the time; state which, with --columns time={}", layout.source,
                         labels(facts, clocks),
                         facts.names[clocks[0]] == facts.names[clocks[1]] ? std::to_string(clocks[0] + 1)
                                                                          : facts.names[clocks[0]]);
    }
    if (clocks.size() == 1) {
        layout.chosen.time = clocks[0];
        if (!counters.empty()) {
            layout.warn(
                "row counter",
                fmt::format(
                    "{} only counts rows; the time is taken from {}; --columns time=NAME decides otherwise",
                    labels(facts, counters), column_label(facts.names, clocks[0])));
        }
        // A date written as text beside a numeric clock is common; a numeric time that stands still or jumps
        // back means that the columns are not what their names say.
        for (const std::size_t column : broken) {
            if (!finite_values(facts, column).empty()) {
                raise<DataError>(
                    "{}: {} and {} are both named as times, and the first does not run forward; check the "
                    "header, or state which is the time with --columns time={}",
                    layout.source, column_label(facts.names, column), column_label(facts.names, clocks[0]),
                    facts.names[clocks[0]]);
            }
            layout.warn("time as text",
                        fmt::format("{} is not a number of seconds; the time is taken from {}; --columns "
                                    "time=NAME decides otherwise",
                                    column_label(facts.names, column), column_label(facts.names, clocks[0])));
        }
        return;
    }
    if (!texts.empty()) {
        layout.chosen.time = texts[0];
        return;
    }
    for (std::size_t c = 0; c < facts.columns && !forced.by_place; ++c) {
        if (!forced.roles[c] && holds_steps(facts, c)) return take_steps(facts, c, layout);
    }
    if (use_step_of_head(facts, found, layout)) return;
    // One column called time that is no clock: the reader's own message names the row where it fails.
    if (counters.empty() && broken.size() == 1) {
        layout.chosen.time = broken[0];
        return;
    }
    refuse_clocks(facts, found, options, layout);
}

}  // namespace ripplenotch
