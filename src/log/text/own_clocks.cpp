// SPDX-License-Identifier: MIT
// Text logs that are no table of one clock: a row or a block holds one signal, columns have times of their
// own, cells hold lists.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "core/text/lower_case.hpp"
#include "log/clock/stamp.hpp"
#include "log/columns/column_name.hpp"
#include "log/columns/units.hpp"
#include "log/numbers/columns.hpp"
#include "log/open.hpp"
#include "log/rows_in_range.hpp"
#include "log/text/csv_reader.hpp"
#include "log/text/text_cells.hpp"
#include "log/text/text_dialect.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/trace.hpp"

namespace ripplenotch {

namespace {

constexpr std::size_t most_names = 4096;

/// Lines with their numbers, cut into cells; blank ones and comments are passed over.
class Lines {
  public:
    /// From the byte `at`, in front of which there are `number` lines.
    Lines(std::string_view bytes, std::string source, std::size_t at = 0, std::size_t number = 0)
        : bytes_(bytes), source_(std::move(source)), at_(at), number_(number) {}
    bool next() {
        while (at_ < bytes_.size()) {
            const std::size_t end = std::min(bytes_.find('\n', at_), bytes_.size());
            line_ = line_content(bytes_.substr(at_, end - at_));
            at_ = end + 1;
            if (number_++ == 0 && line_.starts_with("\xef\xbb\xbf")) line_.remove_prefix(3);
            if (!is_blank_line(line_) && !is_comment_line(line_)) return true;
        }
        return false;
    }
    /// Without empty ones at the end.
    [[nodiscard]] std::vector<std::string> cells(char delimiter) const {
        std::vector<std::string> texts = cell_texts(line_, delimiter);
        while (texts.size() > 1 && texts.back().empty()) texts.pop_back();
        return texts;
    }
    void split(char delimiter) { split_cells(line_, delimiter, split_); }
    /// Of the line that was split; empty behind the end of a short one.
    [[nodiscard]] std::string_view cell(std::size_t column) const {
        return column < split_.cells.size() ? split_.cells[column].of(line_) : std::string_view();
    }
    [[nodiscard]] std::size_t cell_count() const { return split_.cells.size(); }
    [[nodiscard]] std::string_view line() const { return line_; }
    /// `cell`: of the line, whose place is told; or text of something else.
    [[noreturn]] void complain(const std::string& sentence, std::string_view cell = {}) const {
        const bool inside =
            !cell.empty() && cell.data() >= line_.data() && cell.data() < line_.data() + line_.size();
        raise<DataError>("{}:{}:{} {}", source_, number_,
                         inside ? fmt::format("{}:", cell.data() - line_.data() + 1) : "", sentence);
    }

  private:
    std::string_view bytes_, line_;
    std::string source_;
    std::size_t at_ = 0, number_ = 0;
    CellSplit split_;
};

// A number, with a comma for its decimals where that separates no cells.
std::optional<double> number_in(std::string_view text, char delimiter) {
    const auto number = parse_number(text);
    return number || delimiter == ',' ? number : parse_number(text, ',');
}

// The same, or a date or time of day in seconds since `origin_s`, the second of the first that was read.
std::optional<double> number_or_time_in(std::string_view text, char delimiter, StampForm form,
                                        std::optional<std::int64_t>& origin_s) {
    if (const auto number = number_in(text, delimiter)) return number;
    const auto stamp = clock_text(text, form);
    if (!stamp) return std::nullopt;
    if (!origin_s) origin_s = stamp->whole_s;
    return since(stamp->whole_s, *origin_s) + stamp->fraction_s;
}

// Appends a whole number as it is; false, and 0, where it is something else.
bool add_count(std::string_view text, std::vector<std::int64_t>& counts) {
    std::int64_t& count = counts.emplace_back(0);
    const char* const end = text.data() + text.size();
    const auto whole = std::from_chars(text.data(), end, count);
    return whole.ec == std::errc() && whole.ptr == end;
}

/// One number over time.
struct Signal {
    std::string name, read_as, unit;  ///< as ColumnInfo has them
    ColumnNumbers time;               ///< its counts are those of whole numbers
    std::vector<double> values;
};

/// Signals that are read from lines.
class Signals {
  public:
    Signals(const Lines& lines, std::string time_name, StampForm form = {})
        : lines_(lines), time_name_(std::move(time_name)), form_(form) {}
    std::vector<Signal> all;

    /// The one of this name, which is added where there is none.
    std::size_t index_of(const std::string& name, const std::string& unit) {
        const auto [found, added] = places_.try_emplace(name, all.size());
        if (added && all.size() == most_names)
            lines_.complain("read more than 4096 signals, expected the name of one in each row");
        if (added) all.push_back({name, "", unit, {}, {}});
        return found->second;
    }
    /// Cells of numbers with either decimal mark, or of dates and times of day.
    void add(std::size_t signal, std::string_view time, std::string_view value, char delimiter) {
        Signal& one = all[signal];
        const auto number = number_or_time_in(time, delimiter, form_, origin_s_);
        if (!number)
            lines_.complain(fmt::format(
                "read '{}' in '{}', expected a number, or a time such as {}; correct or remove the line",
                time, time_name_, stamp_forms));
        const auto read = number_in(value, delimiter);
        if (!read)
            lines_.complain(fmt::format("read '{}' in '{}', expected a number; correct or remove the line",
                                        value, one.name),
                            value);
        if (!one.values.empty() && *number < one.time.values.back())
            lines_.complain(
                fmt::format("read the time {} of '{}' after {}, expected time to run forward; sort the log",
                            time, one.name, shortest(one.time.values.back())));
        all_whole_ = add_count(time, one.time.counts) && all_whole_;
        one.time.values.push_back(*number);
        one.values.push_back(*read);
    }
    /// "time [s]" where the times are dates or times of day.
    [[nodiscard]] std::string time_name() const { return origin_s_ ? "time [s]" : time_name_; }
    /// In columns: those with the times of the signal `base` with it, the others joined to them. `clock`: how
    /// the column of times is called.
    [[nodiscard]] ColumnLog columns(const std::string& source, ColumnInfo clock, std::size_t base,
                                    const ReadOptions& options) {
        clock.whole = all_whole_;
        const double unit_ns = ns_per_unit(clock);
        std::vector<ColumnInfo> info = {clock};
        NumberRows numbers = {all[base].time};
        std::vector<SideColumn> sides;
        for (Signal& signal : all) {
            const ColumnInfo own{signal.name, signal.read_as, signal.unit, false, true};
            ColumnNumbers values{std::move(signal.values), {}};
            if (signal.time.values == numbers[0].values) {
                info.push_back(own);
                numbers.push_back(std::move(values));
            } else {
                sides.push_back(
                    {std::make_unique<HeldColumns>(source, std::vector{clock, own},
                                                   NumberRows{std::move(signal.time), std::move(values)}),
                     1, unit_ns, "value"});
            }
        }
        ColumnLog log;
        log.format = "csv";
        log.columns = std::make_unique<HeldColumns>(source, std::move(info), std::move(numbers));
        if (!sides.empty()) join_columns(log, unit_ns, std::move(sides), options);
        return log;
    }

  private:
    // As the clock says, else so that the longest time fits.
    [[nodiscard]] double ns_per_unit(const ColumnInfo& clock) const {
        constexpr double most_ns = 9e18, seconds = 1e9;
        if (const auto stated = stated_clock_ns(clock.unit, clock.path)) return *stated;
        double longest = 1.0;
        for (const Signal& signal : all)
            for (const double time : {signal.time.values.front(), signal.time.values.back()})
                longest = std::max(longest, std::abs(time));
        double unit_ns = seconds;
        while (unit_ns > 1.0 && unit_ns * longest > most_ns) unit_ns /= 10.0;
        return unit_ns;
    }

    const Lines& lines_;
    std::string time_name_;
    StampForm form_;
    std::map<std::string, std::size_t> places_;
    std::optional<std::int64_t> origin_s_;
    bool all_whole_ = true;  ///< the times
};

constexpr std::string_view signal_words =
    "signal variable name channel topic key parameter field series signalname";
constexpr std::string_view owner_words = "joint axis actuator motor robot device";  // whose signal it is
constexpr std::string_view value_words = "value values data wert werte y reading";
constexpr std::string_view name_keys = "variable name variablename symbol symbolname";

bool is_one_of(std::string_view words, std::string_view text) { return has_word(words, lower_case(text)); }

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
            if (!unit && is_one_of("unit units", cells[c])) unit = c;
        }
        const bool others = cells.size() > signal.size() + 2 + (unit ? 1 : 0);
        if (time && named && value)
            return LongHeader{delimiter, cells.size(), *time, *value, signal, unit, others, cells[*time]};
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
        const bool asked = asked_role(options, signal.name) == "torque";
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
        const bool same =
            std::ranges::all_of(clocks, [&](std::size_t clock) { return rows.cell(clock) == first; });
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
    const bool names_time = std::ranges::any_of(
        options.columns, [](const std::string& entry) { return entry.starts_with("time="); });
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
        const bool repeated = std::ranges::count(dialect.names, name) > 1;
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
                rows.complain(fmt::format(
                    "read a second value of '{}' at the time {}, expected time to run forward; export again",
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
    log.options = dialect.dialect_options + (log.options.empty() ? "" : " ") + log.options;
    log.asked = std::move(asked);
    return log;
}

// A table some of whose cells hold lists, which have as many numbers in every row.
ColumnLog list_columns(const std::string& source, std::string_view text, const TextDialect& dialect) {
    std::vector<ColumnInfo> info;
    NumberRows numbers;
    std::vector<std::size_t> lengths;  // of the list in a cell, by its place in the row; 0: it is none
    std::optional<std::int64_t> origin_s;
    Lines rows = rows_of(source, text, dialect);
    for (bool first = true; next_row(rows, dialect); first = false) {
        std::size_t place = 0;
        const auto add = [&](const std::string& name, std::size_t column, std::string_view cell,
                             std::optional<double> number) {
            if (first) {
                const std::string unit = column < dialect.units.size() ? dialect.units[column] : "";
                info.push_back({name, "", unit, true, number.has_value()});
                numbers.emplace_back();
            }
            info[place].whole = add_count(cell, numbers[place].counts) && info[place].whole;
            numbers[place].values.push_back(number.value_or(not_a_number));
            ++place;
        };
        for (std::size_t c = 0; c < dialect.columns; ++c) {
            const std::string_view cell = rows.cell(c);
            const std::string name =
                dialect.names.empty() ? fmt::format("column {}", c + 1) : dialect.names[c];
            const auto list = list_in(cell);
            const std::size_t length = list ? list->size() : 0;
            if (first) lengths.push_back(length);
            if (length != lengths[c])
                rows.complain(fmt::format(
                    "read '{}' in '{}', expected as many numbers as in the first row: {}; correct or remove "
                    "the line",
                    cell.substr(0, 40), name, std::max<std::size_t>(1, lengths[c])));
            if (!list)
                add(name, c, cell,
                    number_or_time_in(cell, dialect.rules.delimiter, dialect.stamp_forms[c], origin_s));
            for (std::size_t i = 0; i < length; ++i) add(fmt::format("{}[{}]", name, i), c, "", (*list)[i]);
        }
    }
    ColumnLog log;
    log.format = "csv";
    log.options = dialect.dialect_options;
    log.columns = std::make_unique<HeldColumns>(source, std::move(info), std::move(numbers));
    return log;
}

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
    return std::ranges::any_of(head,
                               [](const auto& cells) { return cells.size() == 1 || cells.size() == 2; }) &&
           last.size() == 1 && !name_in_head(head, ignored).empty() && lines.next() && pair_in(lines);
}

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
    if (opening.dialect.has_lists) return read_columns(list_columns(name, *text, opening.dialect), options);
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

}  // namespace

std::unique_ptr<LogReader> open_text(std::unique_ptr<ByteSource> source, std::string first_bytes,
                                     const ReadOptions& options) {
    if (options.skip_lines > 0 || !may_be_long(first_bytes))
        return open_table(std::move(source), std::move(first_bytes), options);
    const std::string name = source->name();
    std::string bytes = std::move(first_bytes);
    read_on(*source, bytes);
    if (const auto header = long_header(first_line_of(bytes)))
        return read_columns(tidy_columns(name, bytes, *header, options), options);
    if (has_blocks(bytes)) return read_columns(block_columns(name, bytes, options), options);
    auto held = std::make_unique<ByteSource>(name, std::make_shared<const std::string>(std::move(bytes)));
    return open_table(std::move(held), "", options);
}

}  // namespace ripplenotch
