// SPDX-License-Identifier: MIT
#include "log/clock/stamp.hpp"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>

#include "log/columns/units.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/quantity.hpp"

namespace ripplenotch {

namespace {

/// Takes digits off the front of `text`: at least `fewest`, at most `most` of them.
std::optional<int> read_number(std::string_view& text, std::size_t fewest, std::size_t most) {
    std::size_t length = 0;
    while (length < text.size() && length < most && is_digit(text[length])) ++length;
    if (length < fewest) return std::nullopt;
    int value = 0;
    std::from_chars(text.data(), text.data() + length, value);
    text.remove_prefix(length);
    return value;
}

bool skip(std::string_view& text, std::string_view one_of) {
    if (text.empty() || one_of.find(text.front()) == std::string_view::npos) return false;
    text.remove_prefix(1);
    return true;
}

/// "2024-05-01T" or "2024/05/01 ", "2024:05:01:" as some loggers write it, "1.5.2024 " and "5/1/2024 ".
std::optional<std::int64_t> read_date(std::string_view& text, bool day_first) {
    std::string_view rest = text;
    const auto first = read_number(rest, 1, 4);
    const std::size_t digits = text.size() - rest.size();
    const bool year_first = digits == 4;
    if (!first || digits == 3 || rest.empty()) return std::nullopt;
    const char mark = rest.front();
    if (!skip(rest, year_first ? "-/:" : "./-")) return std::nullopt;
    const auto second = read_number(rest, 1, 2);
    if (!second || !skip(rest, year_first ? "-/:" : "./-")) return std::nullopt;
    const auto third = year_first ? read_number(rest, 1, 2) : read_number(rest, 4, 4);
    if (!third) return std::nullopt;
    // Only with slashes do people put the month first.
    const bool month_first = mark == '/' && *first <= 12 && (*second > 12 || !day_first);
    const int year = year_first ? *first : *third;
    const int month = year_first ? *second : month_first ? *first : *second;
    const int day = year_first ? *third : month_first ? *second : *first;
    skip(rest, ",");
    if (!skip(rest, year_first ? "T :_" : " T")) return std::nullopt;
    while (skip(rest, " ")) {
    }
    if (month < 1 || month > 12 || day < 1 || day > 31) return std::nullopt;
    text = rest;
    using namespace std::chrono;
    const sys_days first_of_month(std::chrono::year(year) / month / 1);
    return first_of_month.time_since_epoch().count() + day - 1;
}

/// "AM" or "PM" behind the time, and its blanks; the hours to be added to it. Empty where 13 PM is no hour.
std::optional<int> read_half_day(std::string_view& text, int hours) {
    while (skip(text, " ")) {
    }
    const bool noon = hours == 12;
    for (const bool after_noon : {false, true}) {
        for (const std::string_view word : {after_noon ? "PM" : "AM", after_noon ? "pm" : "am"}) {
            if (!text.starts_with(word)) continue;
            text.remove_prefix(word.size());
            if (hours < 1 || hours > 12) return std::nullopt;
            return after_noon ? (noon ? 0 : 12) : (noon ? -12 : 0);
        }
    }
    return 0;
}

/// "Z", "+02:00", "-0700"; in seconds.
std::optional<std::int64_t> read_zone(std::string_view& text) {
    if (text == "Z" || text == "UTC") return 0;
    const bool west = text.front() == '-';
    if (!skip(text, "+-")) return std::nullopt;
    const auto hours = read_number(text, 2, 2);
    skip(text, ":");
    const auto minutes = text.empty() ? std::optional<int>(0) : read_number(text, 2, 2);
    if (!hours || !minutes || !text.empty()) return std::nullopt;
    const std::int64_t offset = 3600 * *hours + 60 * *minutes;
    return west ? -offset : offset;
}

/// "0.002 sec", "12 ms": durations as MATLAB writes them.
std::optional<ClockTime> with_unit(std::string_view text) {
    const std::size_t digits = text.find_last_of("0123456789.") + 1;
    if (digits == 0 || digits == text.size()) return std::nullopt;
    const auto number = parse_number(text.substr(0, digits));
    const auto unit = usual_unit(text.substr(digits), Role::time);
    if (!number || !unit) return std::nullopt;
    const double seconds = *number * role_factor(Role::time, *unit).value_or(1.0);
    constexpr double longest = 1e12;
    if (!(std::abs(seconds) < longest)) return std::nullopt;
    return ClockTime{
        static_cast<std::int64_t>(std::floor(seconds)), seconds - std::floor(seconds), false, {}};
}

// Times as people type them, read, and put on the time axis of a log.

constexpr std::int64_t day_s = 86400;

/// "12:30", "1:02:30.5", "90:00.25"; empty for what is none.
std::optional<TimePoint> sexagesimal(std::string_view text) {
    constexpr std::size_t most_digits = 9;  // of nanoseconds, and what an int holds
    TimePoint point;
    point.text = text;
    const auto lead = read_number(text, 1, most_digits);
    const auto middle = lead && skip(text, ":") ? read_number(text, 2, 2) : std::nullopt;
    const bool hours = middle && skip(text, ":");
    const auto last = hours ? read_number(text, 2, 2) : middle;
    if (!last || *middle > 59 || *last > 59) return std::nullopt;
    point.form = hours ? TimePoint::Form::hours : TimePoint::Form::two_fields;
    point.whole_s =
        hours ? std::int64_t{3600} * *lead + 60 * *middle + *last : std::int64_t{60} * *lead + *last;
    if (text.empty()) return point;
    const auto fraction = text.front() == '.' ? parse_number("0" + std::string(text)) : std::nullopt;
    const std::string_view digits = text.substr(1, most_digits);
    if (!fraction || !is_digits(digits)) return std::nullopt;
    point.fraction_s = *fraction;
    return point;
}

std::int64_t of_day(const TimePoint& point, std::string_view label) {
    const bool fields = point.form == TimePoint::Form::two_fields;
    if (fields && point.fraction_s > 0.0)
        raise<UsageError>("{} {}: the log's times are times of day; write HH:MM:SS, or seconds as 90s", label,
                          point.text);
    const std::int64_t time_s = fields ? 60 * point.whole_s : point.whole_s;
    if (time_s > day_s)
        raise<UsageError>("{} {}: the log's times are times of day, which end at 24:00", label, point.text);
    return time_s;
}

/// The midnight before `first`, of its day as it was written where it is a date.
std::int64_t midnight_s(const ClockTime& first) {
    if (!first.dated) return 0;
    const std::int64_t zone = first.zone_s.value_or(0), local = first.whole_s + zone;
    return local - (local % day_s + day_s) % day_s - zone;
}

}  // namespace

std::optional<ClockTime> clock_text(std::string_view text, StampForm form) {
    if (const auto duration = with_unit(text)) return duration;
    const auto days = read_date(text, form.day_first);
    const auto hours = read_number(text, 1, 2);
    if (!hours || !skip(text, ":")) return std::nullopt;
    const auto minutes = read_number(text, 2, 2);
    if (!minutes || !skip(text, ":")) return std::nullopt;
    const auto seconds = read_number(text, 2, 2);
    if (!seconds || *hours > 24 || *minutes > 59 || *seconds > 60) return std::nullopt;
    ClockTime time{
        days.value_or(0) * 86400 + *hours * 3600 + *minutes * 60 + *seconds, 0.0, days.has_value(), {}};
    // ISO 8601 allows the comma; LabVIEW puts a colon before the point, others one in its place.
    if (skip(text, ":") | skip(text, ".,")) {
        const std::size_t digits = std::min(text.find_first_not_of("0123456789"), text.size());
        if (digits == 0 || (form.milliseconds && digits > 3)) return std::nullopt;
        const std::string zeros(form.milliseconds ? 3 - digits : 0, '0');
        time.fraction_s = parse_number("0." + zeros + std::string(text.substr(0, digits))).value_or(0.0);
        text.remove_prefix(digits);
    }
    const auto half_day = read_half_day(text, *hours);
    if (!half_day) return std::nullopt;
    time.whole_s += 3600 * *half_day;
    while (skip(text, " ")) {
    }
    if (text.empty()) return time;
    time.zone_s = read_zone(text);
    if (!time.zone_s || (!days && *time.zone_s != 0)) return std::nullopt;
    time.whole_s -= *time.zone_s;
    return time;
}

std::optional<double> read_stamp(std::string_view text, const StampRule& rule) {
    if (rule.text) {
        const auto time = clock_text(text, rule.form);
        if (!time) return std::nullopt;
        double whole_s = since(time->whole_s, rule.origin);
        if (rule.form.either_order) {
            StampForm other = rule.form;
            other.day_first = !other.day_first;
            const auto by_other = clock_text(text, other);
            const double other_s =
                by_other ? since(by_other->whole_s - rule.form.other_s, rule.origin) : -1.0;
            if (other_s >= 0.0 && (whole_s < 0.0 || other_s < whole_s)) whole_s = other_s;
        }
        return whole_s + time->fraction_s;
    }
    std::int64_t whole = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), whole);
    const auto digits = static_cast<std::size_t>(end - text.data());
    const bool decimals =
        digits < text.size() && text[digits] == rule.decimal_mark &&
        std::all_of(text.begin() + static_cast<std::ptrdiff_t>(digits) + 1, text.end(), is_digit);
    if (error != std::errc() || whole < 0 || (digits < text.size() && !decimals)) {
        // Something else than digits, as in 1.7e18: rounded as it was written.
        const auto number = parse_number(text, rule.decimal_mark);
        if (!number) return std::nullopt;
        return *number - static_cast<double>(rule.origin);
    }
    double fraction = 0.0;
    if (decimals && digits + 1 < text.size())
        fraction = parse_number("0." + std::string(text.substr(digits + 1))).value_or(0.0);
    return since(whole, rule.origin) + fraction;
}

TimePoint parse_time_point(std::string_view text, std::string_view label) {
    // With slashes and the year at the end, people mean either order.
    const bool ordered = text.find('/') >= 4;
    if (const auto date = clock_text(text); date && date->dated && ordered) {
        return {std::string(text), TimePoint::Form::date, 0.0,
                date->whole_s,     date->fraction_s,      date->zone_s.has_value()};
    }
    if (text.find(':') != std::string_view::npos) {
        if (auto point = sexagesimal(text)) return *std::move(point);
        raise<UsageError>(
            "{}: cannot read '{}' as a time; write seconds (90, 500ms, 1.5min), MM:SS, HH:MM:SS, or a date "
            "and time (2024-05-01T12:30:00)",
            label, text);
    }
    TimePoint point;
    point.text = text;
    point.seconds = parse_quantity(text, Dimension::time, label);
    return point;
}

double on_axis(const TimePoint& point, const TimeAxis& axis, std::string_view label) {
    if (point.form == TimePoint::Form::seconds) return point.seconds;
    std::int64_t whole_s = point.whole_s;
    if (point.form == TimePoint::Form::date) {
        if (!axis.first || !axis.first->dated)
            raise<UsageError>("{} {}: the log's times have no date; write seconds, MM:SS or HH:MM:SS", label,
                              point.text);
        if (!point.zoned) whole_s -= axis.first->zone_s.value_or(0);
    } else if (axis.first) {
        whole_s = midnight_s(*axis.first) + of_day(point, label);
    }
    return since(whole_s, axis.first ? axis.origin_s : 0) + point.fraction_s;
}

}  // namespace ripplenotch
