// SPDX-License-Identifier: MIT
#include "log/text/scope_channels.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

#include "log/numbers/columns.hpp"
#include "log/read.hpp"
#include "log/rows_in_range.hpp"
#include "log/text/csv_reader.hpp"
#include "log/text/text_dialect.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {
namespace {

constexpr std::string_view byte_order_mark = "\xef\xbb\xbf";
constexpr std::size_t opening_size = std::size_t{1} << 16;
constexpr double ns_per_ms = 1e6;
constexpr std::int64_t ns_per_tick = 100;

/// The rows of a text in memory, line by line.
class Rows {
  public:
    Rows(std::string_view text, const TextDialect& dialect)
        : text_(text), dialect_(dialect), at_(dialect.data_offset), number_(dialect.data_line) {}

    /// False behind the last row.
    bool next() {
        while (at_ < text_.size()) {
            const std::size_t found = std::min(text_.find('\n', at_), text_.size());
            line_ = line_content(text_.substr(at_, found - at_));
            at_ = found + 1;
            ++number_;
            if (line_ == "EOF") return false;
            if (is_no_row(line_)) continue;
            split_cells(line_, dialect_.rules.delimiter, split_);
            return true;
        }
        return false;
    }
    /// Empty behind the end of a short row.
    [[nodiscard]] std::string_view cell(std::size_t column) const {
        return column < split_.cells.size() ? split_.cells[column].of(line_) : std::string_view();
    }
    [[nodiscard]] std::size_t cells() const { return split_.cells.size(); }
    [[nodiscard]] std::optional<double> number(std::size_t column) const {
        const auto number = parse_number(cell(column), dialect_.rules.decimal_mark);
        return number && is_reading(*number) ? number : std::nullopt;
    }
    [[noreturn]] void complain(const std::string& source, std::size_t column,
                               const std::string& expected) const {
        raise<DataError>(
            "{}:{}:{}: read {} in {}, expected {}", source, number_ - 1,
            column < split_.cells.size() ? split_.cells[column].begin + 1 : line_.size() + 1,
            cell(column).empty() ? "nothing" : "'" + std::string(cell(column).substr(0, 40)) + "'",
            column_label(dialect_.names, column), expected);
    }

  private:
    std::string_view text_, line_;
    const TextDialect& dialect_;
    std::size_t at_, number_;
    CellSplit split_;
};

std::vector<std::size_t> clocks_of(const TextDialect& dialect) {
    const std::set<std::size_t> clocks(dialect.clock_of.begin(), dialect.clock_of.end());
    return {clocks.begin(), clocks.end()};
}

// Whether all columns of times are one clock, in every row.
bool has_one_clock(std::string_view text, const TextDialect& dialect) {
    const std::vector<std::size_t> clocks = clocks_of(dialect);
    Rows rows(text, dialect);
    std::optional<double> before, half_step;
    while (rows.next()) {
        if (rows.cells() != dialect.columns) return false;
        const std::string_view first = rows.cell(clocks.front());
        const bool same = std::all_of(clocks.begin(), clocks.end(),
                                      [&](std::size_t clock) { return rows.cell(clock) == first; });
        if (same && half_step) continue;
        const auto time = rows.number(clocks.front());
        if (!time) return same;  // the reader of text says what is wrong
        if (before && !half_step) half_step = 0.5 * std::abs(*time - *before);
        before = time;
        for (const std::size_t clock : clocks) {
            const auto own = rows.number(clock);
            if (!own || std::abs(*own - *time) > half_step.value_or(0.0)) return false;
        }
    }
    return true;
}

/// What is taken of one column of times.
struct Group {
    std::size_t clock = 0;
    std::vector<std::size_t> channels;
    std::vector<std::int64_t> time_ns;
    std::vector<std::vector<double>> values;  ///< by channel
};

class Channels {
  public:
    Channels(const std::string& source, std::string_view text, const TextDialect& dialect)
        : source_(source),
          text_(text),
          dialect_(dialect),
          ticks_(!dialect.names.empty() && dialect.names.front().ends_with("[100ns]")) {}

    [[nodiscard]] Group read(std::size_t clock, std::vector<std::size_t> channels) const {
        Group group{clock, std::move(channels), {}, {}};
        group.values.resize(group.channels.size());
        Rows rows(text_, dialect_);
        while (rows.next()) take_row(rows, group);
        if (group.time_ns.size() < 2)
            raise<DataError>("{}: read {} rows of {}, expected two at least", source_, group.time_ns.size(),
                             column_label(dialect_.names, group.clock));
        return group;
    }

  private:
    // A group that has ended, or that has no sample of this row, has no time in it.
    void take_row(const Rows& rows, Group& group) const {
        if (rows.cell(group.clock).empty()) return;
        const std::int64_t time = time_of(rows, group.clock);
        std::vector<double> row;
        for (const std::size_t channel : group.channels) {
            const auto number = rows.number(channel);
            if (!number) rows.complain(source_, channel, "a finite number; correct or remove the line");
            row.push_back(*number);
        }
        if (!group.time_ns.empty() && time <= group.time_ns.back()) {
            // "Fill with previous value" repeats a sample, its time included.
            bool repeated = time == group.time_ns.back();
            for (std::size_t k = 0; k < row.size(); ++k)
                repeated = repeated && row[k] == group.values[k].back();
            if (repeated) return;
            rows.complain(source_, group.clock, "time to run forward; export again");
        }
        group.time_ns.push_back(time);
        for (std::size_t k = 0; k < row.size(); ++k) group.values[k].push_back(row[k]);
    }

    std::int64_t time_of(const Rows& rows, std::size_t clock) const {
        constexpr double longest_ns = 9e18;  // 285 years: what a count of nanoseconds holds
        std::int64_t ticks = 0, since = 0;
        if (ticks_) {
            const std::string_view text = rows.cell(clock);
            const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), ticks);
            if (error == std::errc() && end == text.data() + text.size() &&
                !__builtin_sub_overflow(ticks, dialect_.first_counts.front(), &since) &&
                !__builtin_mul_overflow(since, ns_per_tick, &since))
                return since;
        } else if (const auto ms = rows.number(clock); ms && std::abs(ns_per_ms * *ms) < longest_ns) {
            return std::llround(ns_per_ms * *ms);
        }
        rows.complain(source_, clock, "a time; correct or remove the line");
    }

    const std::string& source_;
    std::string_view text_;
    const TextDialect& dialect_;
    bool ticks_;
};

std::string rest_of(ByteSource& source, std::string bytes) {
    for (std::size_t got = opening_size; got > 0;) {
        const std::size_t have = bytes.size();
        bytes.resize(have + std::max(opening_size, have));
        got = source.read(bytes.data() + have, bytes.size() - have);
        bytes.resize(have + got);
    }
    return bytes;
}

// The columns that are read, role by role; where nothing tells the joint, all.
std::vector<std::pair<Role, std::size_t>> columns_read(const Layout& layout, const TextDialect& dialect) {
    std::vector<std::pair<Role, std::size_t>> read;
    for (const JointColumns& joint : layout.all_chosen()) {
        if (joint.torque) read.emplace_back(Role::torque, *joint.torque);
        if (joint.velocity) read.emplace_back(Role::velocity, *joint.velocity);
        if (joint.position) read.emplace_back(Role::position, *joint.position);
    }
    if (!read.empty()) return read;
    for (std::size_t c = 0; c < dialect.columns; ++c)
        if (dialect.clock_of[c] != c) read.emplace_back(Role::other, c);
    return read;
}

/// A group's clock in ticks or ms, and its channels.
std::unique_ptr<Columns> columns_of(const std::string& name, const TextDialect& dialect, Group group) {
    const bool ticks = dialect.names.front().ends_with("[100ns]");
    const double unit = ticks ? 1.0 / ns_per_tick : 1.0 / ns_per_ms;
    // As --columns takes it: by its number where it has no name.
    std::vector<ColumnInfo> info = {{group.clock == 0 ? dialect.names[0] : std::to_string(group.clock + 1),
                                     "time", ticks ? "100ns" : "ms", false, true}};
    NumberRows numbers(1);
    for (const std::int64_t ns : group.time_ns) numbers[0].values.push_back(static_cast<double>(ns) * unit);
    for (std::size_t k = 0; k < group.channels.size(); ++k) {
        const std::size_t column = group.channels[k];
        info.push_back({dialect.names[column], dialect.names[column], dialect.units[column], false, true});
        numbers.push_back({std::move(group.values[k]), {}});
    }
    return std::make_unique<HeldColumns>(name, std::move(info), std::move(numbers));
}

ColumnLog scope_columns(std::unique_ptr<ByteSource> source, std::string first_bytes,
                        const ReadOptions& options) {
    const std::string name = source->name();
    const auto text = std::make_shared<const std::string>(rest_of(*source, std::move(first_bytes)));
    ReadOptions first = options;
    first.range = {};
    first.takes_motor_units =
        true;  // a row holds samples of several times, from which the side cannot be determined
    const CsvReader whole(std::make_unique<ByteSource>(name, text), "", first);
    const TextDialect& dialect = whole.dialect();
    const auto read = columns_read(whole.layout(), dialect);
    // The torque's own rows, which are then not interpolated, unless another clock is named.
    const bool names_time = std::any_of(options.columns.begin(), options.columns.end(),
                                        [](const std::string& entry) { return entry.starts_with("time="); });
    const auto named = whole.layout().chosen.time;  // none where a rate was stated
    const std::size_t clock = dialect.clock_of[names_time && named ? *named : read.front().second];
    std::vector<std::size_t> of_base;
    for (const auto& [role, column] : read)
        if (dialect.clock_of[column] == clock) of_base.push_back(column);
    const Channels channels(name, *text, dialect);
    ColumnLog log;
    log.format = "csv";
    log.options = dialect_options(dialect);
    log.columns = columns_of(name, dialect, channels.read(clock, of_base));
    std::vector<std::size_t> placed = of_base;
    std::vector<SideColumn> sides;
    const double ns_per_unit = dialect.names.front().ends_with("[100ns]") ? ns_per_tick : ns_per_ms;
    for (const auto& [role, column] : read) {
        if (dialect.clock_of[column] == clock) continue;
        sides.push_back({columns_of(name, dialect, channels.read(dialect.clock_of[column], {column})), 1,
                         ns_per_unit, "value"});
        placed.push_back(column);
    }
    if (!options.columns.empty() && read.front().first != Role::other) {
        log.asked.push_back("time=" + log.columns->info().front().path);
        for (const auto& [role, column] : read) {
            const std::string& called = dialect.names[column];
            const bool repeated = std::count(dialect.names.begin(), dialect.names.end(), called) > 1;
            const auto place = std::find(placed.begin(), placed.end(), column) - placed.begin();
            log.asked.push_back(
                fmt::format("{}={}", role_name(role), repeated ? std::to_string(place + 2) : called));
        }
    }
    if (!sides.empty()) join_columns(log, ns_per_unit, std::move(sides), options);
    return log;
}

}  // namespace

bool may_be_scope_export(std::string_view first_bytes) {
    if (first_bytes.starts_with(byte_order_mark)) first_bytes.remove_prefix(byte_order_mark.size());
    return first_bytes.starts_with("Name");
}

std::unique_ptr<LogReader> open_scope_export(std::unique_ptr<ByteSource> source, std::string first_bytes,
                                             const ReadOptions& options) {
    first_bytes.resize(read_on(*source, first_bytes, first_bytes.size(), opening_size));
    const TextDialect dialect = sniff_text(first_bytes, first_bytes.size() < opening_size, *source, options);
    if (clocks_of(dialect).size() < 2)
        return open_with<CsvReader>(std::move(source), std::move(first_bytes), options);
    const std::string name = source->name();
    const auto text = std::make_shared<const std::string>(rest_of(*source, std::move(first_bytes)));
    auto held = std::make_unique<ByteSource>(name, text);
    if (has_one_clock(*text, dialect)) return open_with<CsvReader>(std::move(held), "", options);
    return open_as_columns<scope_columns>(std::move(held), "", options);
}

}  // namespace ripplenotch
