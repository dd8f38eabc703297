// SPDX-License-Identifier: MIT
#include "log/text/signals.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

#include "log/columns/units.hpp"
#include "log/text/text_dialect.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {

namespace {

constexpr std::size_t most_names = 4096;

}  // namespace

bool Lines::next() {
    while (at_ < bytes_.size()) {
        const std::size_t end = std::min(bytes_.find('\n', at_), bytes_.size());
        line_ = line_content(bytes_.substr(at_, end - at_));
        at_ = end + 1;
        if (number_++ == 0 && line_.starts_with("\xef\xbb\xbf")) line_.remove_prefix(3);
        if (!is_blank_line(line_) && !is_comment_line(line_)) return true;
    }
    return false;
}

std::vector<std::string> Lines::cells(char delimiter) const {
    std::vector<std::string> texts = cell_texts(line_, delimiter);
    while (texts.size() > 1 && texts.back().empty()) texts.pop_back();
    return texts;
}

void Lines::complain(const std::string& sentence, std::string_view cell) const {
    const bool inside = !cell.empty() && cell.data() >= line_.data() && cell.data() < line_.data() + line_.size();
    raise<DataError>("{}:{}:{} {}", source_, number_,
                     inside ? fmt::format("{}:", cell.data() - line_.data() + 1) : "", sentence);
}

std::optional<double> number_in(std::string_view text, char delimiter) {
    auto number = parse_number(text);
    if (!number && delimiter != ',') number = parse_number(text, ',');
    return number;
}

std::optional<std::vector<double>> list_in(std::string_view cell) {
    const bool square = cell.starts_with('[') && cell.ends_with(']');
    if (cell.size() < 3 || !(square || (cell.starts_with('(') && cell.ends_with(')')))) return std::nullopt;
    std::string_view rest = cell.substr(1, cell.size() - 2);
    std::vector<double> numbers;
    while (true) {
        constexpr std::string_view between = " \t,;";
        rest.remove_prefix(std::min(rest.find_first_not_of(between), rest.size()));
        if (rest.empty()) break;
        const std::size_t end = std::min(rest.find_first_of(between), rest.size());
        const auto number = parse_number(rest.substr(0, end));
        if (!number) return std::nullopt;
        numbers.push_back(*number);
        rest.remove_prefix(end);
    }
    return numbers.empty() ? std::nullopt : std::optional(std::move(numbers));
}

std::size_t Signals::index_of(const std::string& name, const std::string& unit) {
    const auto [found, added] = places_.try_emplace(name, all.size());
    if (added && all.size() == most_names)
        lines_.complain("read more than 4096 signals, expected the name of one in each row");
    if (added) all.push_back({name, "", unit, {}, {}});
    return found->second;
}

void Signals::add(std::size_t signal, std::string_view time, std::string_view value, char delimiter) {
    auto number = number_in(time, delimiter);
    if (!number) {
        const auto stamp = clock_text(time, form_);
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
            fmt::format("read '{}' in '{}', expected a number; correct or remove the line", value,
                        all[signal].name),
            value);
    Signal& one = all[signal];
    if (!one.values.empty() && *number < one.time.values.back())
        lines_.complain(
            fmt::format("read the time {} of '{}' after {}, expected time to run forward; sort "
                        "the log",
                        time, one.name, shortest(one.time.values.back())));
    std::int64_t count = 0;
    const char* const end = time.data() + time.size();
    const auto whole = std::from_chars(time.data(), end, count);
    all_whole_ = all_whole_ && whole.ec == std::errc() && whole.ptr == end;
    one.time.values.push_back(*number);
    one.time.counts.push_back(count);
    one.values.push_back(*read);
}

// As the clock says, else so that the longest time fits.
double Signals::ns_per_unit(const ColumnInfo& clock) const {
    constexpr double most_ns = 9e18, seconds = 1e9;
    const std::string written = clock.unit.empty() ? split_unit(clock.path).unit : clock.unit;
    if (const auto unit = written.empty() ? std::nullopt : usual_unit(written, Role::time))
        return seconds * role_factor(Role::time, *unit).value_or(1.0);
    double longest = 1.0;
    for (const Signal& signal : all)
        for (const double time : {signal.time.values.front(), signal.time.values.back()})
            longest = std::max(longest, std::abs(time));
    double unit_ns = seconds;
    while (unit_ns > 1.0 && unit_ns * longest > most_ns) unit_ns /= 10.0;
    return unit_ns;
}

ColumnLog Signals::columns(const std::string& source, ColumnInfo clock, std::size_t base,
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

}  // namespace ripplenotch
