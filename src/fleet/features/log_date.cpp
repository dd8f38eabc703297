// SPDX-License-Identifier: MIT
#include "ripplenotch/fleet/log_date.hpp"

#include <fmt/format.h>

#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>

#include "ripplenotch/core/error.hpp"

namespace ripplenotch {
namespace {

constexpr std::string_view letters = "YmdHMS";
constexpr std::string_view robot_word = "{robot}";

struct Calendar {
    std::array<int, 6> number = {1970, 1, 1, 0, 0, 0};  // in the order of `letters`
};

std::optional<double> seconds_of(const Calendar& when) {
    const auto [year, month, day, hour, minute, second] = when.number;
    const std::chrono::year_month_day date{std::chrono::year(year),
                                           std::chrono::month(static_cast<unsigned>(month)),
                                           std::chrono::day(static_cast<unsigned>(day))};
    if (year < 1900 || year > 2200 || !date.ok() || hour > 23 || minute > 59 || second > 60)
        return std::nullopt;
    const std::int64_t days = std::chrono::sys_days(date).time_since_epoch().count();
    return static_cast<double>(days * 86400 + hour * 3600 + minute * 60 + second);
}

// So many digits at the front of the text, taken off it.
std::optional<int> take_digits(std::string_view& text, std::size_t count) {
    if (text.size() < count) return std::nullopt;
    int number = 0;
    for (const char c : text.substr(0, count)) {
        if (c < '0' || c > '9') return std::nullopt;
        number = 10 * number + (c - '0');
    }
    text.remove_prefix(count);
    return number;
}

struct Matched {
    Calendar when;
    std::string robot;
};

// The rest of a pattern against the rest of a name. Stars try every length, so a pattern has few of them.
bool fits(std::string_view pattern, std::string_view name, Matched& found) {
    while (!pattern.empty()) {
        if (pattern.front() == '%') {
            const std::size_t field = letters.find(pattern[1]);
            const auto number = take_digits(name, field == 0 ? 4 : 2);
            if (!number) return false;
            found.when.number[field] = *number;
            pattern.remove_prefix(2);
            continue;
        }
        const bool robot = pattern.starts_with(robot_word);
        if (robot || pattern.front() == '*') {
            const std::string_view rest = pattern.substr(robot ? robot_word.size() : 1);
            for (std::size_t length = robot ? 1 : 0; length <= name.size(); ++length) {
                if (robot && name[length - 1] == '/') return false;
                if (robot) found.robot = name.substr(0, length);
                if (fits(rest, name.substr(length), found)) return true;
            }
            return false;
        }
        if (name.empty() || (pattern.front() != '?' && pattern.front() != name.front())) return false;
        pattern.remove_prefix(1);
        name.remove_prefix(1);
    }
    return name.empty();
}

}  // namespace

std::string date_text(double seconds) {
    const std::chrono::sys_seconds time(std::chrono::seconds(static_cast<std::int64_t>(std::floor(seconds))));
    const auto midnight = std::chrono::floor<std::chrono::days>(time);
    const std::chrono::year_month_day date(midnight);
    const auto left = (time - midnight).count();
    return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}Z", static_cast<int>(date.year()),
                       static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()), left / 3600,
                       left / 60 % 60, left % 60);
}

std::optional<double> date_seconds(std::string_view text) {
    if (text.ends_with('Z')) text.remove_suffix(1);
    Calendar when;
    constexpr std::string_view marks = "--T::";
    for (std::size_t field = 0; field < letters.size(); ++field) {
        if (field > 0) {
            // A day or a minute may be the last that is said.
            if (text.empty() && (field == 3 || field == 5)) break;
            const bool blank = field == 3 && text.starts_with(' ');
            if (!blank && !text.starts_with(marks[field - 1])) return std::nullopt;
            text.remove_prefix(1);
        }
        const auto number = take_digits(text, field == 0 ? 4 : 2);
        if (!number) return std::nullopt;
        when.number[field] = *number;
    }
    return text.empty() ? seconds_of(when) : std::nullopt;
}

NamePattern::NamePattern(std::string pattern) : pattern_(std::move(pattern)) {
    std::array<int, letters.size()> seen{};
    for (std::size_t i = 0; i < pattern_.size(); ++i) {
        if (pattern_[i] != '%') continue;
        const std::size_t field = i + 1 < pattern_.size() ? letters.find(pattern_[i + 1]) : std::string::npos;
        if (field == std::string::npos)
            raise<UsageError>("--date-from-name '{}': behind % stands one of Y m d H M S", pattern_);
        if (++seen[field] > 1)
            raise<UsageError>("--date-from-name '{}': %{} stands twice", pattern_, letters[field]);
    }
    for (std::size_t field = 0; field < 3; ++field)
        if (seen[field] == 0)
            raise<UsageError>("--date-from-name '{}': a date needs %Y, %m and %d, and there is no %{}",
                              pattern_, letters[field]);
}

std::optional<NamePattern::Found> NamePattern::match(const std::string& name) const {
    for (std::size_t at = 0; at != std::string::npos;) {
        Matched found;
        if (fits(pattern_, std::string_view(name).substr(at), found)) {
            const auto seconds = seconds_of(found.when);
            if (!seconds) return std::nullopt;
            return Found{date_text(*seconds), found.robot};
        }
        at = name.find('/', at);
        if (at != std::string::npos) ++at;
    }
    return std::nullopt;
}

}  // namespace ripplenotch
