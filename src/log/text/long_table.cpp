// SPDX-License-Identifier: MIT
#include "log/text/long_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <optional>
#include <tuple>
#include <utility>

#include "core/text/lower_case.hpp"
#include "log/clock/stamp.hpp"
#include "log/columns/column_name.hpp"
#include "log/read.hpp"
#include "log/text/own_clocks.hpp"
#include "log/text/signals.hpp"
#include "log/text/text_header.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {

namespace {

using Words = std::span<const std::string_view>;
constexpr std::array<std::string_view, 10> signal_words = {
    "signal", "variable", "name", "channel", "topic", "key", "parameter", "field", "series", "signalname"};
// In addition: whose signal it is.
constexpr std::array<std::string_view, 6> owner_words = {"joint", "axis",  "actuator",
                                                         "motor", "robot", "device"};
constexpr std::array<std::string_view, 7> value_words = {"value", "values", "data",   "wert",
                                                         "werte", "y",      "reading"};
constexpr std::array<std::string_view, 5> name_keys = {"variable", "name", "variablename", "symbol",
                                                       "symbolname"};

bool is_one_of(Words words, std::string_view text) {
    const std::string lower = lower_case(text);
    return std::find(words.begin(), words.end(), lower) != words.end();
}

/// Which columns of a tidy table are what, by its header.
struct LongHeader {
    char delimiter = ',';
    std::size_t cells = 0, time = 0, value = 0;
    std::vector<std::size_t> signal;  ///< the columns that make its name together
    std::optional<std::size_t> unit;
    bool others = false;  ///< there are columns of something else
    std::string time_name;
};

std::optional<LongHeader> long_header(std::string_view line) {
    for (const char delimiter : {',', ';', '\t'}) {
        Lines one(line, "");
        if (!one.next()) return std::nullopt;
        const std::vector<std::string> cells = one.cells(delimiter);
        std::optional<std::size_t> time, value, unit;
        std::vector<std::size_t> signal;
        bool named = false;
        for (std::size_t c = 0; c < cells.size(); ++c) {
            const ColumnName name = read_column_name(cells[c]);
            if (!time && name.role == Role::time) time = c;
            const bool names = is_one_of(signal_words, cells[c]);
            named = named || names;
            if (names || is_one_of(owner_words, cells[c])) signal.push_back(c);
            if (!value && is_one_of(value_words, cells[c])) value = c;
            if (!unit && is_one_of(std::array<std::string_view, 2>{"unit", "units"}, cells[c])) unit = c;
        }
        if (time && named && value)
            return LongHeader{delimiter,
                              cells.size(),
                              *time,
                              *value,
                              signal,
                              unit,
                              cells.size() > signal.size() + 2 + (unit ? 1 : 0),
                              cells[*time]};
    }
    return std::nullopt;
}

/// Two numbers, or a time and a number.
std::optional<std::array<std::string, 2>> pair_in(const Lines& lines) {
    for (const char delimiter : {';', '\t', ',', ' '}) {
        std::vector<std::string> cells = lines.cells(delimiter);
        if (cells.size() != 2) continue;
        const auto reads = [&](const std::string& cell) { return number_in(cell, delimiter).has_value(); };
        if ((reads(cells[0]) || clock_text(cells[0])) && reads(cells[1]))
            return std::array{cells[0], cells[1]};
    }
    return std::nullopt;
}

std::string first_line_of(std::string_view bytes) {
    Lines lines(bytes, "");
    return lines.next() ? std::string(lines.line()) : std::string();
}

/// "Variable;PLC_PRG.rPosition": what a block is called, by a key before it or by the line alone. Columns of
/// times and values name nothing.
std::string name_in_head(const std::vector<std::vector<std::string>>& head, std::string& time_name) {
    std::string name;
    bool by_key = false;
    for (const std::vector<std::string>& cells : head) {
        if (cells.size() >= 2 && read_column_name(cells[0]).role == Role::time) {
            time_name = cells[0];
            if (name.empty() && !is_one_of(value_words, cells[1])) name = cells[1];
            continue;
        }
        std::string key = lower_case(cells[0]);
        std::erase_if(key, [](unsigned char c) { return std::isalpha(c) == 0; });
        if (cells.size() >= 2 && is_one_of(name_keys, key)) {
            name = cells[1];
            by_key = true;
        } else if (!by_key && cells.size() == 1 && has_letters(cells[0]) &&
                   !is_one_of(value_words, cells[0])) {
            name = cells[0];
            while (!name.empty() && (name.back() == ':' || name.back() == ' ')) name.pop_back();
        }
    }
    return name;
}

std::vector<std::string> head_cells(const Lines& lines) {
    for (const char delimiter : {';', '\t', ','}) {
        auto cells = lines.cells(delimiter);
        if (cells.size() > 1) return cells;
    }
    return {std::string(lines.line())};
}

/// The signal whose times are those of the rows: the torque, else the one with the most.
std::size_t base_of(const std::vector<Signal>& signals, const ReadOptions& options) {
    const auto rank = [&](const Signal& signal) {
        const ColumnName name = read_column_name(signal.name);
        const bool asked = std::find(options.columns.begin(), options.columns.end(),
                                     "torque=" + signal.name) != options.columns.end();
        return std::tuple(asked, name.role == Role::torque && !name.reference, signal.values.size());
    };
    std::size_t base = 0;
    for (std::size_t s = 1; s < signals.size(); ++s)
        if (rank(signals[s]) > rank(signals[base])) base = s;
    return base;
}

ColumnLog as_columns(const std::string& source, Signals signals, const std::string& time_name,
                     const std::string& shape, const ReadOptions& options) {
    const std::size_t count = signals.all.size();
    const ColumnInfo clock{time_name.empty() ? "time" : time_name, "", "", false, true};
    ColumnLog log = signals.columns(source, clock, base_of(signals.all, options), options);
    log.inferences.push_back({"shape", fmt::format("{} signals as columns", count), shape, "", {}});
    return log;
}

std::string whole_text(ByteSource& source, std::string bytes) {
    std::size_t have = bytes.size();
    for (std::size_t size = std::max<std::size_t>(2 * have, 1 << 20);; size *= 2) {
        have = read_on(source, bytes, have, size);
        if (have < size) break;
    }
    bytes.resize(have);
    return bytes;
}

ColumnLog tidy_columns(const std::string& source, std::string_view bytes, const LongHeader& header,
                       const ReadOptions& options) {
    Lines lines(bytes, source);
    lines.next();
    Signals signals(lines, header.time_name);
    while (lines.next()) {
        const std::vector<std::string> cells = lines.cells(header.delimiter);
        if (cells.size() <= std::max({header.time, header.signal.back(), header.value}) ||
            cells.size() > header.cells)
            lines.complain(fmt::format("read {} cells, expected {}; correct or remove the line", cells.size(),
                                       header.cells));
        const std::string unit = header.unit && *header.unit < cells.size() ? cells[*header.unit] : "";
        std::string name;
        for (const std::size_t part : header.signal) name += (name.empty() ? "" : ".") + cells[part];
        const std::size_t signal = signals.index_of(name, unit);
        const std::size_t before = signals.all[signal].values.size();
        signals.add(signal, cells[header.time], cells[header.value], header.delimiter);
        const std::vector<double>& times = signals.all[signal].time.values;
        if (header.others && before > 0 && times[before] == times[before - 1])
            lines.complain(
                fmt::format("read a second value of '{}' at the time {}, expected one; leave one value of "
                            "each other column, and remove it",
                            name, cells[header.time]));
    }
    const std::string time_name = signals.time_name();
    return as_columns(source, std::move(signals), time_name, "a row holds the value of one signal", options);
}

bool has_blocks(std::string_view bytes) {
    Lines lines(bytes, "");
    std::size_t blocks = 0;
    for (bool row = false; blocks < 2 && lines.next();) {
        const bool was = std::exchange(row, pair_in(lines).has_value());
        blocks += row && !was ? 1 : 0;
    }
    return blocks > 1;
}

ColumnLog block_columns(const std::string& source, std::string_view bytes, const ReadOptions& options) {
    Lines lines(bytes, source);
    Signals signals(lines, "time");
    std::vector<std::vector<std::string>> head;
    std::optional<std::size_t> block;
    std::string time_name;
    while (lines.next()) {
        const auto pair = pair_in(lines);
        if (!pair) {
            if (block) head.clear();
            block.reset();
            head.push_back(head_cells(lines));
            continue;
        }
        if (!block) {
            std::string name = name_in_head(head, time_name);
            if (name.empty()) name = fmt::format("signal {}", signals.all.size() + 1);
            block = signals.index_of(name, "");
        }
        signals.add(*block, (*pair)[0], (*pair)[1], ';');
    }
    if (signals.time_name() != "time" || time_name.empty()) time_name = signals.time_name();
    return as_columns(source, std::move(signals), time_name, "a block of rows holds one variable", options);
}

}  // namespace

// Of a trace, the first lines hold a head of two lines and more, and rows of a time and a value, which no
// line over them names.
bool may_be_long(std::string_view first_bytes) {
    if (long_header(first_line_of(first_bytes))) return true;
    Lines lines(first_bytes, "");
    std::vector<std::vector<std::string>> head;
    bool row = false;
    while (!row && lines.next()) {
        row = pair_in(lines).has_value();
        if (!row) head.push_back(head_cells(lines));
    }
    if (!row || head.empty()) return false;
    const std::vector<std::string>& last = head.back();
    if (last.size() == 2 && read_column_name(last[0]).role == Role::time)
        return head.size() > 1 && is_one_of(value_words, last[1]);
    std::string ignored;
    return std::any_of(head.begin(), head.end(),
                       [](const auto& cells) { return cells.size() == 1 || cells.size() == 2; }) &&
           last.size() == 1 && !name_in_head(head, ignored).empty() && lines.next() && pair_in(lines);
}

std::unique_ptr<LogReader> open_long(std::unique_ptr<ByteSource> source, std::string first_bytes,
                                     const ReadOptions& options) {
    const std::string name = source->name();
    std::string bytes = whole_text(*source, std::move(first_bytes));
    if (const auto header = long_header(first_line_of(bytes)))
        return read_columns(tidy_columns(name, bytes, *header, options), options);
    if (has_blocks(bytes)) return read_columns(block_columns(name, bytes, options), options);
    auto held = std::make_unique<ByteSource>(name, std::make_shared<const std::string>(std::move(bytes)));
    return open_table(std::move(held), "", options);
}

}  // namespace ripplenotch
