// SPDX-License-Identifier: MIT
#pragma once
// Internal to the log room: the rows that --from and --to keep. Names, units, dialect and clock are decided
// from the rows inside alone, as in a log that holds no others (docs/decisions/0014-one-account.md). So the
// others are left out of the bytes, before the reader of the rows inside sees them; a reader of the whole log
// is asked only how it writes its times.

#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <string>

#include "log/clock/stamp.hpp"
#include "ripplenotch/core/files.hpp"
#include "ripplenotch/log/layout.hpp"

namespace ripplenotch {

/// Says which rows of a log are inside a range, for what gives the others no further. Time runs forward, so
/// they follow each other.
class RowsInRange {
  public:
    virtual ~RowsInRange() = default;
    /// Of the `number`th line or record that is kept. Both count from 1.
    [[nodiscard]] std::size_t number_in_file(std::size_t number) const {
        return number > head_ ? number + left_out_ : number;
    }
    [[nodiscard]] const std::shared_ptr<RowsOutside>& outside() const { return outside_; }

  protected:
    /// `whole`: how the times of the log are read. Throws DataError when there are none. `head`: lines before
    /// the first row.
    RowsInRange(const ReadOptions& options, const Layout& whole, std::size_t head);

    /// A log of dates or times of day says its first before its rows are judged.
    void first_stamp(std::optional<ClockTime> first) { axis_.first = first; }
    /// Whether the next row is inside. One whose time cannot be read goes with the row before. `time`: as in
    /// the file, less the origin; ignored where a rate was stated, for then rows count the time. Throws
    /// UsageError at the first row where no range can hold.
    bool keeps(std::optional<double> time);
    /// The same of a line that is no row: it goes with the row before.
    bool keeps_line();
    [[nodiscard]] bool inside() const { return place_ == Place::inside; }
    [[nodiscard]] std::size_t kept() const { return kept_; }
    /// A log of one row has no rate.
    [[nodiscard]] bool has_enough() const { return kept_ >= 2; }
    /// At the end of the log, or as soon as it has_enough(). Throws UsageError where it does not.
    void require_rows() const;

  private:
    enum class Place { before, inside, after };
    void begin(double first_s);
    [[nodiscard]] Place place_of(double time_s) const;
    [[nodiscard]] std::string asked() const;

    std::string source_;
    TimeRange range_;
    std::optional<double> rate_hz_;
    bool counts_from_kept_ = false;  ///< the times of the rows inside begin at 0
    double factor_ = 1.0;            ///< times in the file to seconds
    TimeAxis axis_;
    std::size_t head_, left_out_ = 0;  ///< lines in front of the first row; those left out behind them
    std::shared_ptr<RowsOutside> outside_ = std::make_shared<RowsOutside>();
    double from_s_ = -std::numeric_limits<double>::infinity(),
           to_s_ = std::numeric_limits<double>::infinity();
    Place place_ = Place::before;
    std::size_t rows_ = 0, kept_ = 0;
    std::optional<double> first_s_;
    double last_s_ = 0.0;
};

/// The number in the file of the `number`th line or record of what `source` gives. Both count from 1.
[[nodiscard]] std::size_t number_in_file(const ByteSource& source, std::size_t number);
/// What a range left out of `source`; null where none was asked for.
[[nodiscard]] std::shared_ptr<const RowsOutside> rows_outside(const ByteSource& source);

class LogReader;
class CsvReader;
class ColumnReader;

/// For the reader of the whole log: where a range is given, whatever it lacks but a clock is not its affair.
[[nodiscard]] ReadOptions options_of_whole(ReadOptions options);
/// `whole`, read by options_of_whole(), or a reader of its rows inside options.range, where one is given.
/// Lines pass as they stand; comments and blank lines go with the row before them.
[[nodiscard]] std::unique_ptr<LogReader> rows_in_range(std::unique_ptr<CsvReader> whole,
                                                       const ReadOptions& options);
[[nodiscard]] std::unique_ptr<LogReader> rows_in_range(std::unique_ptr<ColumnReader> whole,
                                                       const ReadOptions& options);

}  // namespace ripplenotch
