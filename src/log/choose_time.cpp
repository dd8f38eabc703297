// SPDX-License-Identifier: MIT
// Which column is the clock. A name is not enough: a column called "time" that counts rows is a counter, and
// a log read by it would be wrong without anybody noticing.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "log/column_name.hpp"
#include "log/decide_layout.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch::layout_detail {
namespace {

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
    if (values.size() < 3 || values.front() != std::floor(values.front())) return false;
    for (std::size_t i = 1; i < values.size(); ++i) {
        if (values[i] - values[i - 1] != 1.0) return false;
    }
    return true;
}

bool runs_forward(const std::vector<double>& values) {
    return values.size() > 1 && std::is_sorted(values.begin(), values.end()) &&
           values.front() < values.back();
}

std::string labels(const ColumnFacts& facts, const std::vector<std::size_t>& columns) {
    std::vector<std::string> texts;
    for (const std::size_t c : columns) texts.push_back(column_label(facts.names, c));
    return fmt::format("{}", fmt::join(texts, " and "));
}

}  // namespace

bool varies(const std::vector<double>& values) {
    double first = std::numeric_limits<double>::quiet_NaN();
    for (const double value : values) {
        if (!std::isfinite(value)) continue;
        if (std::isnan(first)) first = value;
        if (value != first) return true;
    }
    return false;
}

std::optional<std::size_t> choose_time(const std::string& source, const ColumnFacts& facts,
                                       const Forced& forced, const ReadOptions& options,
                                       std::vector<std::string>& warnings) {
    if (options.sample_rate) return std::nullopt;
    if (const auto column = forced.column_of(Role::time)) return column;
    std::vector<std::size_t> clocks, counters, broken;
    int best_rank = 1000;
    for (std::size_t c = 0; !forced.by_place && c < facts.names.size(); ++c) {
        const ColumnName name = read_column_name(facts.names[c]);
        if (name.role != Role::time || name.reference || forced.roles[c]) continue;
        if (name.rank > best_rank) continue;
        if (name.rank < best_rank) clocks.clear(), counters.clear(), broken.clear(), best_rank = name.rank;
        const bool has_unit = !name.unit.empty() || (!facts.units.empty() && !facts.units[c].empty()) ||
                              options.units.count("time") + options.units.count(facts.names[c]) > 0;
        const auto values = finite_values(facts, c);
        if (!has_unit && counts_rows(values)) {
            counters.push_back(c);
        } else if (runs_forward(values) || facts.sample.empty() || facts.sample[c].size() < 2) {
            clocks.push_back(c);
        } else {
            broken.push_back(c);
        }
    }
    if (clocks.size() > 1) {
        raise<DataError>("{}: {} could each be the time; say which, with --columns time={}", source,
                         labels(facts, clocks),
                         facts.names[clocks[0]] == facts.names[clocks[1]] ? std::to_string(clocks[0] + 1)
                                                                          : facts.names[clocks[0]]);
    }
    if (clocks.size() == 1) {
        if (!counters.empty()) {
            warnings.push_back(fmt::format(
                "{} only counts rows; the time is taken from {}; --columns time=NAME decides otherwise",
                labels(facts, counters), column_label(facts.names, clocks[0])));
        }
        // A date written as text beside a numeric clock is common; a numeric time that stands still or jumps
        // back means that the columns are not what their names say.
        for (const std::size_t column : broken) {
            if (!finite_values(facts, column).empty()) {
                raise<DataError>(
                    "{}: {} and {} are both named as times, and the first does not run forward; check the "
                    "header, or say which is the time with --columns time={}",
                    source, column_label(facts.names, column), column_label(facts.names, clocks[0]),
                    facts.names[clocks[0]]);
            }
            warnings.push_back(
                fmt::format("{} is not a number of seconds; the time is taken from {}; --columns time=NAME "
                            "decides otherwise",
                            column_label(facts.names, column), column_label(facts.names, clocks[0])));
        }
        return clocks[0];
    }
    // One column called time that is no clock: the reader's own message names the row where it fails.
    if (counters.empty() && broken.size() == 1) return broken[0];
    std::string why = facts.names.empty()
                          ? "the columns have no names, say what they are with --columns time,velocity,torque"
                          : "no column is named as a time";
    if (!counters.empty()) {
        why = fmt::format(
            "{} only counts rows (1, 2, 3, ...), which is a row number, or a time whose unit is not "
            "stated",
            labels(facts, counters));
    }
    if (broken.size() > 1) why = fmt::format("neither of {} runs forward in numbers", labels(facts, broken));
    if (!options.needs_torque) {
        warnings.push_back(fmt::format(
            "{}: no sample rate; say --sample-rate 1kHz, --unit time=ms, or --columns time=NAME", why));
        return std::nullopt;
    }
    raise<DataError>("{}: {}, expected a time column; say --sample-rate 1kHz, {}or --columns time=NAME",
                     source, why, counters.empty() ? "" : "--unit time=ms, ");
}

}  // namespace ripplenotch::layout_detail
