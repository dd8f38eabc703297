// SPDX-License-Identifier: MIT
#include "log/text/long_table.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "core/text/lower_case.hpp"
#include "log/clock/stamp.hpp"
#include "log/columns/column_name.hpp"
#include "log/columns/units.hpp"
#include "log/read.hpp"
#include "log/text/text_cells.hpp"
#include "log/text/text_dialect.hpp"
#include "log/text/text_header.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {

ReshapedText::ReshapedText(const std::string& name, std::string text, Assumption shape,
                           std::vector<LogWarning> warnings)
    : ByteSource(name, std::make_shared<const std::string>(std::move(text))),
      shape_(std::move(shape)),
      warnings_(std::move(warnings)) {}

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
constexpr std::size_t most_names = 4096;
constexpr double longest_gap_periods = 3.0;  // as signals of topics are joined

bool is_one_of(Words words, std::string_view text) {
    const std::string lower = lower_case(text);
    return std::find(words.begin(), words.end(), lower) != words.end();
}

/// One number over time.
struct Signal {
    std::string name, unit;
    std::vector<double> time;
    std::vector<std::string> cells;  ///< as they are written, with a decimal point
};

/// Lines with their numbers, cut into cells.
class Lines {
  public:
    Lines(std::string_view bytes, std::string source) : bytes_(bytes), source_(std::move(source)) {}
    bool next() {
        while (at_ < bytes_.size()) {
            const std::size_t end = std::min(bytes_.find('\n', at_), bytes_.size());
            line_ = line_content(bytes_.substr(at_, end - at_));
            at_ = end + 1;
            if (number_++ == 0 && line_.starts_with("\xef\xbb\xbf")) line_.remove_prefix(3);
            if (is_blank_line(line_) || is_comment_line(line_)) continue;
            return true;
        }
        return false;
    }
    [[nodiscard]] std::vector<std::string> cells(char delimiter) const {
        CellSplit split;
        split_cells(line_, delimiter, split);
        std::vector<std::string> texts;
        for (const Cell& cell : split.cells) texts.push_back(cell_text(line_, cell));
        while (texts.size() > 1 && texts.back().empty()) texts.pop_back();
        return texts;
    }
    [[nodiscard]] std::string_view line() const { return line_; }
    [[nodiscard]] std::size_t number() const { return number_; }
    [[noreturn]] void complain(const std::string& sentence) const {
        raise<DataError>("{}:{}: {}", source_, number_, sentence);
    }

  private:
    std::string_view bytes_, line_;
    std::string source_;
    std::size_t at_ = 0, number_ = 0;
};

/// A number, with a comma for its decimals where that separates no cells.
std::optional<double> number_in(std::string_view text, char delimiter) {
    auto number = parse_number(text);
    if (!number && delimiter != ',') number = parse_number(text, ',');
    return number;
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

class Signals {
  public:
    Signals(const Lines& lines, std::string time_name) : lines_(lines), time_name_(std::move(time_name)) {}
    std::vector<Signal> all;

    std::size_t index_of(const std::string& name, const std::string& unit) {
        const auto [found, added] = places_.try_emplace(name, all.size());
        if (added && all.size() == most_names)
            lines_.complain("read more than 4096 signals, expected the name of one in each row");
        if (added) all.push_back({name, unit, {}, {}});
        return found->second;
    }
    void add(std::size_t signal, const std::string& time, const std::string& value, char delimiter) {
        auto number = number_in(time, delimiter);
        if (!number) {
            const auto stamp = clock_text(time);
            if (!stamp)
                lines_.complain(fmt::format(
                    "read '{}' in '{}', expected a number, or a time such as {}; correct or remove the line",
                    time, time_name_, stamp_forms));
            if (!origin_s_) origin_s_ = stamp->whole_s;
            number = since(stamp->whole_s, *origin_s_) + stamp->fraction_s;
        }
        const auto read = number_in(value, delimiter);
        if (!read)
            lines_.complain(
                fmt::format("read '{}' as the value of '{}', expected a number; correct or remove the line",
                            value, all[signal].name));
        Signal& one = all[signal];
        if (!one.time.empty() && *number < one.time.back())
            lines_.complain(
                fmt::format("read the time {} of '{}' after {}, expected time to run forward; sort "
                            "the log",
                            time, one.name, shortest(one.time.back())));
        one.time.push_back(*number);
        one.cells.push_back(parse_number(value) ? value : shortest(*read));
    }
    [[nodiscard]] std::string time_name() const { return origin_s_ ? "time [s]" : time_name_; }

  private:
    const Lines& lines_;
    std::string time_name_;
    std::map<std::string, std::size_t> places_;
    std::optional<std::int64_t> origin_s_;
};

std::string quoted_name(const Signal& signal) {
    std::string name = signal.name;
    if (!signal.unit.empty() && split_unit(name).unit.empty()) name += fmt::format(" [{}]", signal.unit);
    for (std::size_t at = 0; (at = name.find('"', at)) != std::string::npos; at += 2) name.insert(at, 1, '"');
    return name.find_first_of(",\"") == std::string::npos ? name : fmt::format("\"{}\"", name);
}

/// The values of `signal` at times that only grow, by `how`; empty before its first and behind its last.
class AtTimes {
  public:
    AtTimes(const std::string& source, const Signal& signal, std::string_view how)
        : source_(source), signal_(signal), how_(how) {
        const double span = signal.time.back() - signal.time.front();
        limit_ = longest_gap_periods * span / std::max(1.0, static_cast<double>(signal.time.size()) - 1.0);
    }
    std::optional<std::string> at(double time) {
        const std::vector<double>& times = signal_.time;
        while (next_ < times.size() && times[next_] <= time) ++next_;
        if (next_ == 0) return std::nullopt;
        const std::size_t before = next_ - 1;
        if (times[before] == time) return signal_.cells[before];
        if (next_ == times.size()) return std::nullopt;
        const double since = time - times[before], until = times[next_] - time;
        const bool nearest = how_ == "nearest", hold = how_ == "hold";
        if ((hold ? since : nearest ? std::min(since, until) : std::max(since, until)) > limit_)
            raise<DataError>(
                "{}: read no value of '{}' within {} of the time {}, expected one; leave the gap out with "
                "--from and --to",
                source_, signal_.name, shortest(limit_), shortest(time));
        if (hold || (nearest && since <= until)) return signal_.cells[before];
        if (nearest) return signal_.cells[next_];
        const double from = *parse_number(signal_.cells[before]), to = *parse_number(signal_.cells[next_]);
        return shortest(from + since / (since + until) * (to - from));
    }

  private:
    const std::string& source_;
    const Signal& signal_;
    std::string_view how_;
    double limit_ = 0.0;
    std::size_t next_ = 0;
};

/// The signal whose times are those of the rows: the torque, else the one with the most.
std::size_t base_of(const std::vector<Signal>& signals) {
    std::size_t base = 0;
    const auto rank = [&](std::size_t s) {
        const ColumnName name = read_column_name(signals[s].name);
        return std::pair(name.role == Role::torque && !name.reference, signals[s].time.size());
    };
    for (std::size_t s = 1; s < signals.size(); ++s)
        if (rank(s) > rank(base)) base = s;
    return base;
}

std::unique_ptr<ByteSource> as_table(const std::string& source, const std::vector<Signal>& signals,
                                     const std::string& time_name, std::string_view shape,
                                     const ReadOptions& options) {
    const std::string how = options.join.value_or("linear");
    const Signal& base = signals[base_of(signals)];
    std::vector<std::string> joined;
    std::string text = quoted_name({time_name.empty() ? "time" : time_name, "", {}, {}});
    std::vector<std::optional<AtTimes>> sides(signals.size());
    for (std::size_t s = 0; s < signals.size(); ++s) {
        text += "," + quoted_name(signals[s]);
        if (signals[s].time == base.time) continue;
        sides[s].emplace(source, signals[s], how);
        joined.push_back(signals[s].name);
    }
    text += '\n';
    std::string row;
    for (std::size_t k = 0; k < base.time.size(); ++k) {
        row = shortest(base.time[k]);
        bool whole = true;
        for (std::size_t s = 0; s < signals.size() && whole; ++s) {
            const auto cell = sides[s] ? sides[s]->at(base.time[k]) : signals[s].cells[k];
            whole = cell.has_value();
            if (whole) row += "," + *cell;
        }
        if (whole) text += row + '\n';
    }
    std::vector<LogWarning> warnings;
    if (!joined.empty())
        warnings.push_back(
            {"joined by time", fmt::format("{} {} times of {} own: joined to those of '{}' by --join {}; "
                                           "nearest, hold and linear are allowed",
                                           fmt::join(joined, ", "), joined.size() == 1 ? "has" : "have",
                                           joined.size() == 1 ? "its" : "their", base.name, how)});
    return std::make_unique<ReshapedText>(
        source, std::move(text),
        Assumption{"shape", fmt::format("{} signals as columns", signals.size()), std::string(shape), "", {}},
        std::move(warnings));
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

std::unique_ptr<ByteSource> widened_tidy(const std::string& source, std::string_view bytes,
                                         const LongHeader& header, const ReadOptions& options) {
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
        const std::size_t before = signals.all[signal].time.size();
        signals.add(signal, cells[header.time], cells[header.value], header.delimiter);
        const std::vector<double>& times = signals.all[signal].time;
        if (header.others && before > 0 && times[before] == times[before - 1])
            lines.complain(
                fmt::format("read a second value of '{}' at the time {}, expected one; leave one value of "
                            "each other column, and remove it",
                            name, cells[header.time]));
    }
    return as_table(source, signals.all, signals.time_name(), "a row holds the value of one signal", options);
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

std::unique_ptr<ByteSource> widened_blocks(const std::string& source, std::string bytes,
                                           const ReadOptions& options) {
    if (!has_blocks(bytes))
        return std::make_unique<ByteSource>(source, std::make_shared<const std::string>(std::move(bytes)));
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
    return as_table(source, signals.all,
                    signals.time_name() == "time" && !time_name.empty() ? time_name : signals.time_name(),
                    "a block of rows holds one variable", options);
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

std::unique_ptr<ByteSource> widened(std::unique_ptr<ByteSource> source, std::string first_bytes,
                                    const ReadOptions& options) {
    const std::string name = source->name();
    std::string bytes = whole_text(*source, std::move(first_bytes));
    if (const auto header = long_header(first_line_of(bytes)))
        return widened_tidy(name, bytes, *header, options);
    return widened_blocks(name, std::move(bytes), options);
}

}  // namespace ripplenotch
