// SPDX-License-Identifier: MIT
#pragma once
// Which rows of a log are read, by their time (--from, --to), and what became of the others.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace ripplenotch {

/// A time as it was typed. What hours and minutes count from depends on how the log writes its times.
struct TimePoint {
    enum class Form {
        seconds,     ///< on the log's own time axis
        two_fields,  ///< 12:30
        hours,       ///< 1:02:30.5
        date,        ///< 2024-05-01T12:30:00
    };
    std::string text;
    Form form = Form::seconds;
    double seconds = 0.0;      ///< of Form::seconds
    std::int64_t whole_s = 0;  ///< of the others: 12:30 as minutes; since 1970 of a date, less its zone
    double fraction_s = 0.0;   ///< 0 to 1, to be added
    bool zoned = false;        ///< a date that says its zone
};

/// "2", "500ms", "1.5min", "12:30", "1:02:30.5", "2024-05-01T12:30:00Z". Throws UsageError, which begins with
/// `label`, for other texts.
[[nodiscard]] TimePoint parse_time_point(std::string_view text, std::string_view label);

/// Both ends belong to the range; one that is left out is the log's own.
struct TimeRange {
    std::optional<TimePoint> from, to;
    [[nodiscard]] bool given() const { return from || to; }
};

/// Rows that a range left out. The counts are complete when the log has been read to its end.
struct RowsOutside {
    std::optional<double> from_s, to_s;  ///< the range, on the time axis of the whole log
    /// Of the first row that was kept on that axis, where the times that are told count from it; else 0.
    double zero_s = 0.0;
    std::size_t before = 0, after = 0;  ///< a row without a time is counted with the row before it
    [[nodiscard]] std::size_t count() const { return before + after; }
};
/// "only rows from 1 s to 2.5 s"; with what times count from, where that is not the log's own zero.
[[nodiscard]] std::string range_in_words(const RowsOutside& outside);

}  // namespace ripplenotch
