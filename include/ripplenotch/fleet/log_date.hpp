// SPDX-License-Identifier: MIT
#pragma once
// When a log was recorded, and on which robot, as its name says; and dates as numbers.

#include <optional>
#include <string>
#include <string_view>

namespace ripplenotch {

/// "2026-01-05T12:30:00Z" of seconds since 1970 in universal time.
[[nodiscard]] std::string date_text(double seconds);
/// Seconds since 1970 of "2026-01-05", "2026-01-05T12:30", "2026-01-05T12:30:00Z", with a blank for the T as
/// well. Empty for anything else, and for days that no month has.
[[nodiscard]] std::optional<double> date_seconds(std::string_view text);

/// A pattern of names: %Y %m %d %H %M %S are digits of the date, {robot} is any text without a slash, * any
/// text, ? any character; everything else stands for itself. The whole name has to fit, or its end after a
/// slash.
class NamePattern {
  public:
    /// Throws UsageError: no %Y, %m and %d in it, one of them twice, another letter behind %.
    explicit NamePattern(std::string pattern);

    struct Found {
        std::string date;   ///< as date_text() gives it
        std::string robot;  ///< empty where the pattern has none
    };
    /// Empty where the name does not fit, or gives a day that no month has.
    [[nodiscard]] std::optional<Found> match(const std::string& name) const;
    [[nodiscard]] const std::string& text() const { return pattern_; }

  private:
    std::string pattern_;
};

}  // namespace ripplenotch
