// SPDX-License-Identifier: MIT
#include "log/text/own_clocks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

#include "log/columns/units.hpp"
#include "log/rows_in_range.hpp"
#include "log/text/csv_reader.hpp"
#include "log/text/signals.hpp"
#include "log/text/text_dialect.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/trace.hpp"

namespace ripplenotch {
namespace {

Lines rows_of(const std::string& source, std::string_view text, const TextDialect& dialect) {
    return {text, source, dialect.data_offset, dialect.data_line - 1};
}

// False behind the last row.
bool next_row(Lines& lines, const TextDialect& dialect) {
    if (!lines.next() || lines.line() == "EOF") return false;
    lines.split(dialect.rules.delimiter);
    return true;
}

// Whether all columns of times are one clock, in every row.
bool has_one_clock(std::string_view text, const TextDialect& dialect) {
    const std::set<std::size_t> clocks(dialect.clock_of.begin(), dialect.clock_of.end());
    if (clocks.empty()) return false;
    Lines rows = rows_of("", text, dialect);
    const auto number = [&](std::size_t column) {
        const auto read = parse_number(rows.cell(column), dialect.rules.decimal_mark);
        return read && is_reading(*read) ? read : std::nullopt;
    };
    std::optional<double> before, half_step;
    while (next_row(rows, dialect)) {
        if (rows.cell_count() != dialect.columns) return false;
        const std::string_view first = rows.cell(*clocks.begin());
        const bool same = std::all_of(clocks.begin(), clocks.end(),
                                      [&](std::size_t clock) { return rows.cell(clock) == first; });
        if (same && half_step) continue;
        const auto time = number(*clocks.begin());
        if (!time) return same;  // the reader of text says what is wrong
        if (before && !half_step) half_step = 0.5 * std::abs(*time - *before);
        before = time;
        for (const std::size_t clock : clocks) {
            const auto own = number(clock);
            if (!own || std::abs(*own - *time) > half_step.value_or(0.0)) return false;
        }
    }
    return true;
}

/// A column that is read, and that of its times.
struct OwnColumn {
    Role role;
    std::size_t column, clock;
};

// The torque first; where nothing tells the joint, all.
std::vector<OwnColumn> columns_read(const Layout& layout, const TextDialect& dialect) {
    std::vector<OwnColumn> read;
    const auto clock_of = [&](std::size_t column) {
        return dialect.clock_of.empty() ? *layout.chosen.time : dialect.clock_of[column];
    };
    const auto add = [&](Role role, std::optional<std::size_t> column) {
        if (column) read.push_back({role, *column, clock_of(*column)});
    };
    for (const JointColumns& joint : layout.all_chosen()) {
        add(Role::torque, joint.torque);
        add(Role::velocity, joint.velocity);
        add(Role::position, joint.position);
    }
    for (std::size_t c = 0; read.empty() && c < dialect.columns; ++c)
        if (clock_of(c) != c) read.push_back({Role::other, c, clock_of(c)});
    return read;
}

ColumnLog own_columns(const std::string& source, std::string_view text, const CsvReader& table,
                      const ReadOptions& options) {
    const TextDialect& dialect = table.dialect();
    const std::vector<OwnColumn> read = columns_read(table.layout(), dialect);
    // The torque's own rows, which are then not interpolated, unless another clock is named.
    const bool names_time = std::any_of(options.columns.begin(), options.columns.end(),
                                        [](const std::string& entry) { return entry.starts_with("time="); });
    std::size_t base = 0;
    for (std::size_t k = read.size(); names_time && k-- > 0;)
        if (read[k].clock == table.layout().chosen.time) base = k;
    const std::size_t clock = read[base].clock;
    const std::string& time_name =
        dialect.names[clock].empty() ? dialect.names[dialect.clock_of[0]] : dialect.names[clock];
    Lines rows = rows_of(source, text, dialect);
    Signals signals(rows, time_name, dialect.stamp_forms[clock]);
    const auto unit_of = [&](std::size_t column) {
        return column < dialect.units.size() ? dialect.units[column] : std::string();
    };
    for (const OwnColumn& one : read) {
        const std::string& name = dialect.names[one.column];
        const bool repeated = std::count(dialect.names.begin(), dialect.names.end(), name) > 1;
        signals.all.push_back({repeated ? fmt::format("{} (column {})", name, one.column + 1) : name,
                               name,
                               unit_of(one.column),
                               {},
                               {}});
    }
    std::vector<std::pair<std::string_view, std::string_view>> before(read.size());
    while (next_row(rows, dialect)) {
        for (std::size_t k = 0; k < read.size(); ++k) {
            // A signal that has ended, or has no sample in this row; "Fill with previous value" repeats one.
            const std::pair sample(rows.cell(read[k].clock), rows.cell(read[k].column));
            if (sample.first.empty() || sample.second.empty() || sample == before[k]) continue;
            if (sample.first == before[k].first)
                rows.complain(
                    fmt::format("read a second value of '{}' at the time {}, expected time to run "
                                "forward; export again",
                                signals.all[k].name, sample.first));
            before[k] = sample;
            signals.add(k, sample.first, sample.second, dialect.rules.delimiter);
        }
    }
    for (const Signal& signal : signals.all)
        if (signal.values.size() < 2)
            rows.complain(fmt::format("read {} numbers of '{}', expected two at least", signal.values.size(),
                                      signal.name));
    std::vector<std::string> asked;
    // As --columns takes it: by its number where it has no name.
    ColumnInfo times{dialect.names[clock].empty() ? std::to_string(clock + 1) : time_name, "time",
                     unit_of(clock), false, true};
    if (times.unit.empty()) times.unit = split_unit(signals.time_name()).unit;
    if (!options.columns.empty() && read.front().role != Role::other) {
        asked.push_back("time=" + times.path);
        for (std::size_t k = 0; k < read.size(); ++k)
            asked.push_back(fmt::format("{}={}", role_name(read[k].role), signals.all[k].name));
    }
    ColumnLog log = signals.columns(source, std::move(times), base, options);
    log.options = dialect_options(dialect) + (log.options.empty() ? "" : " ") + log.options;
    log.asked = std::move(asked);
    return log;
}

/// A table some of whose cells hold lists, which have as many numbers in every row.
class ListTable {
  public:
    ListTable(const std::string& source, std::string_view text, const TextDialect& dialect)
        : rows_(rows_of(source, text, dialect)), dialect_(dialect) {
        while (next_row(rows_, dialect)) {
            std::size_t place = 0;
            for (std::size_t c = 0; c < dialect.columns; ++c) add_cell(c, rows_.cell(c), place);
            first_ = false;
        }
        for (std::size_t c = 0; c < info_.size(); ++c) info_[c].whole = whole_[c];
    }
    ColumnLog log(const std::string& source) {
        ColumnLog log;
        log.format = "csv";
        log.options = dialect_options(dialect_);
        log.columns = std::make_unique<HeldColumns>(source, std::move(info_), std::move(numbers_));
        return log;
    }

  private:
    void add_cell(std::size_t column, std::string_view cell, std::size_t& place) {
        const std::string name =
            dialect_.names.empty() ? fmt::format("column {}", column + 1) : dialect_.names[column];
        const auto list = list_in(cell);
        const std::size_t length = list ? list->size() : 0;
        if (first_) lengths_.push_back(length);
        if (length != lengths_[column])
            rows_.complain(
                fmt::format("read '{}' in '{}', expected as many numbers as in the first row: {}; "
                            "correct or remove the line",
                            cell.substr(0, 40), name, std::max<std::size_t>(1, lengths_[column])));
        if (!list) {
            auto number = number_in(cell, dialect_.rules.delimiter);
            if (const auto stamp = number ? std::nullopt : clock_text(cell, dialect_.stamp_forms[column])) {
                if (!origin_s_) origin_s_ = stamp->whole_s;
                number = since(stamp->whole_s, *origin_s_) + stamp->fraction_s;
            }
            return add(place, name, column, cell, number);
        }
        for (std::size_t i = 0; i < length; ++i)
            add(place, fmt::format("{}[{}]", name, i), column, "", (*list)[i]);
    }
    void add(std::size_t& place, const std::string& name, std::size_t column, std::string_view cell,
             std::optional<double> number) {
        if (first_) {
            info_.push_back({name, "", column < dialect_.units.size() ? dialect_.units[column] : "", false,
                             number.has_value()});
            whole_.push_back(true);
            numbers_.emplace_back();
        }
        std::int64_t count = 0;
        const char* const end = cell.data() + cell.size();
        const auto whole = std::from_chars(cell.data(), end, count);
        whole_[place] = whole_[place] && whole.ec == std::errc() && whole.ptr == end;
        numbers_[place].values.push_back(number.value_or(not_a_number));
        numbers_[place].counts.push_back(count);
        ++place;
    }

    Lines rows_;
    const TextDialect& dialect_;
    bool first_ = true;  ///< in the first row
    std::vector<ColumnInfo> info_;
    std::vector<bool> whole_;  ///< by column: all its numbers
    NumberRows numbers_;
    std::vector<std::size_t> lengths_;  ///< of the list in a cell, by its place in the row; 0: it is none
    std::optional<std::int64_t> origin_s_;
};

}  // namespace

std::unique_ptr<LogReader> open_table(std::unique_ptr<ByteSource> source, std::string first_bytes,
                                      const ReadOptions& options) {
    const auto plain = [&options](TextOpening opening) {
        return rows_in_range(std::make_unique<CsvReader>(std::move(opening), options_of_whole(options)),
                             options);
    };
    TextOpening opening(std::move(source), std::move(first_bytes), options);
    if (!opening.dialect.own_clocks && !opening.dialect.has_lists) return plain(std::move(opening));
    const std::string name = opening.source->name();
    const auto text = std::make_shared<const std::string>(opening.whole());
    if (opening.dialect.has_lists)
        return read_columns(ListTable(name, *text, opening.dialect).log(name), options);
    const auto again = [&] {
        return TextOpening(std::make_unique<ByteSource>(name, text), std::string(), options);
    };
    if (has_one_clock(*text, opening.dialect)) return plain(again());
    ReadOptions first = options;
    first.range = {};
    first.takes_motor_units = true;  // rows hold samples of several times, which do not tell the side
    const CsvReader table(again(), first);
    if (!table.layout().chosen.time && opening.dialect.clock_of.empty()) return plain(again());
    return read_columns(own_columns(name, *text, table, options), options);
}

}  // namespace ripplenotch
