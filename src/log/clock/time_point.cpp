// SPDX-License-Identifier: MIT
// Times as people type them, read, and put on the time axis of a log.

#include <fmt/format.h>

#include <cctype>
#include <optional>

#include "log/clock/stamp.hpp"
#include "log/clock/time_axis.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/quantity.hpp"

namespace ripplenotch {
namespace {

constexpr std::int64_t day_s = 86400;

std::optional<std::int64_t> whole_number(std::string_view text) {
    constexpr std::size_t most_digits = 9;  // of nanoseconds, and what an int holds
    if (text.empty() || text.size() > most_digits) return std::nullopt;
    std::int64_t value = 0;
    for (const char c : text) {
        if (std::isdigit(static_cast<unsigned char>(c)) == 0) return std::nullopt;
        value = 10 * value + (c - '0');
    }
    return value;
}

/// "05" to "59".
std::optional<std::int64_t> sixtieths(std::string_view text) {
    const auto value = text.size() == 2 ? whole_number(text) : std::nullopt;
    return value && *value < 60 ? value : std::nullopt;
}

/// "12:30", "1:02:30.5", "90:00.25"; empty for what is none.
std::optional<TimePoint> sexagesimal(std::string_view text) {
    TimePoint point;
    point.text = text;
    const std::size_t dot = std::min(text.find('.'), text.size());
    if (dot < text.size()) {
        if (!whole_number(text.substr(dot + 1, 9))) return std::nullopt;
        const auto fraction = parse_number("0" + std::string(text.substr(dot)));
        if (!fraction) return std::nullopt;
        point.fraction_s = *fraction;
        text = text.substr(0, dot);
    }
    const std::size_t last = text.rfind(':'), first = text.find(':');
    if (last == std::string_view::npos) return std::nullopt;
    const bool hours = first != last;
    const auto lead = whole_number(text.substr(0, first));
    const auto middle =
        hours ? sixtieths(text.substr(first + 1, last - first - 1)) : std::optional<std::int64_t>(0);
    const auto end = sixtieths(text.substr(last + 1));
    if (!lead || !middle || !end) return std::nullopt;
    point.form = hours ? TimePoint::Form::hours : TimePoint::Form::two_fields;
    point.whole_s = (hours ? 3600 : 60) * *lead + 60 * *middle + *end;
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

/// Of the day of `first` as it was written, where dates are.
std::int64_t midnight_s(const ClockTime& first) {
    if (!first.dated) return 0;
    const std::int64_t zone = first.zone_s.value_or(0), local = first.whole_s + zone;
    return local - (local % day_s + day_s) % day_s - zone;
}

}  // namespace

TimePoint parse_time_point(std::string_view text, std::string_view label) {
    if (const auto date = clock_text(text); date && date->dated) {
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
