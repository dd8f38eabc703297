// SPDX-License-Identifier: MIT
#include "log/rows_in_range.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "log/clock/stamp.hpp"
#include "log/numbers/columns.hpp"
#include "log/text/csv_reader.hpp"
#include "log/text/text_dialect.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {

namespace {

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
    RowsInRange(const ReadOptions& options, const Layout& whole, std::size_t head)
        : source_(whole.source), range_(options.range), head_(head) {
        counts_from_kept_ = whole.stated_rate || whole.time_is_steps;
        if (whole.stated_rate) {
            rate_hz_ = whole.stated_rate->value();
        } else if (whole.chosen.time) {
            factor_ = whole.columns[*whole.chosen.time].factor;
            axis_.origin_s = whole.time_origin;
        } else {
            raise<DataError>("{}: {}: no column is the time; use --columns time=NAME, or --sample-rate 1kHz",
                             source_, asked());
        }
    }
    /// A log of dates or times of day says its first before its rows are judged.
    void first_stamp(std::optional<ClockTime> first) { axis_.first = first; }
    /// Whether the next row is inside. One whose time cannot be read goes with the row before. `time`: as in
    /// the file, less the origin; ignored where a rate was stated, for then rows count the time. Throws
    /// UsageError at the first row where no range can hold.
    bool keeps(std::optional<double> time) {
        if (rate_hz_) time = static_cast<double>(rows_) / *rate_hz_;
        ++rows_;
        if (time) {
            const double time_s = rate_hz_ ? *time : *time * factor_;
            if (!first_s_) begin(time_s);
            last_s_ = time_s;
            const Place place = place_of(time_s);
            if (place < place_)
                raise<DataError>(
                    "{}: {}: read the time {} s behind a later one, expected time to run forward; sort the "
                    "log",
                    source_, asked(), shortest(time_s));
            place_ = place;
            if (counts_from_kept_ && kept_ == 0 && inside()) outside_->zero_s = time_s;
        }
        if (inside())
            ++kept_;
        else
            ++(place_ == Place::before ? outside_->before : outside_->after);
        return keeps_line();
    }
    /// The same of a line that is no row: it goes with the row before.
    bool keeps_line() {
        left_out_ += place_ == Place::before ? 1 : 0;
        return inside();
    }
    [[nodiscard]] bool inside() const { return place_ == Place::inside; }
    [[nodiscard]] std::size_t kept() const { return kept_; }
    /// At the end of the log. Throws UsageError where fewer than two rows are inside: one has no rate.
    void require_rows() const {
        if (kept_ >= 2) return;
        const std::string what = kept_ == 0 ? "no row" : "one row only";
        if (!first_s_)
            raise<DataError>("{}: {} keeps {}: no row has a time; check the time column", source_, asked(),
                             what);
        raise<UsageError>(
            "{}: {} keeps {}: the log covers {} s to {} s in {} rows; ask for two of them or more", source_,
            asked(), what, shortest(*first_s_), shortest(last_s_), rows_);
    }

  private:
    enum class Place { before, inside, after };
    void begin(double first_s) {
        first_s_ = first_s;
        const auto bound = [&](const std::optional<TimePoint>& point, std::string_view option,
                               double& bound_s) {
            if (!point) return std::optional<double>();
            const std::string label = fmt::format("{}: {}", source_, option);
            bound_s = on_axis(*point, axis_, label);
            if (bound_s < 0.0 && first_s >= 0.0)
                raise<UsageError>(
                    "{} {} is below 0 s, and the log begins at {} s; write a time from there on", label,
                    point->text, shortest(first_s));
            return std::optional<double>(bound_s);
        };
        outside_->from_s = bound(range_.from, "--from", from_s_);
        outside_->to_s = bound(range_.to, "--to", to_s_);
        if (from_s_ > to_s_)
            raise<UsageError>("{}: {}: the range ends at {} s, before it begins at {} s; swap the two",
                              source_, asked(), shortest(to_s_), shortest(from_s_));
    }
    [[nodiscard]] Place place_of(double time_s) const {
        // Stamps in ms times 0.001 are not always the nearest numbers to what people type in seconds.
        const auto slack = [time_s](double bound_s) {
            constexpr double some_ulps = 4.0 * std::numeric_limits<double>::epsilon();
            return some_ulps * std::max(std::abs(time_s), std::abs(bound_s));
        };
        if (range_.from && time_s < from_s_ - slack(from_s_)) return Place::before;
        if (range_.to && time_s > to_s_ + slack(to_s_)) return Place::after;
        return Place::inside;
    }
    [[nodiscard]] std::string asked() const {
        std::string words;
        if (range_.from) words += "--from " + range_.from->text;
        if (range_.to) words += (words.empty() ? "--to " : " --to ") + range_.to->text;
        return words;
    }

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

class LinesInRange final : public ByteSource, public RowsInRange {
  public:
    LinesInRange(std::unique_ptr<CsvReader> whole, const ReadOptions& options)
        : ByteSource(Name{whole->layout().source}),
          RowsInRange(options, whole->layout(), whole->dialect().data_line - 1),
          whole_(std::move(whole)),
          parser_({whole_->dialect().rules,
                   whole_->dialect().columns,
                   time_columns(whole_->layout()),
                   {},
                   stamp_rule(whole_->layout(), whole_->dialect().rules.decimal_mark)}),
          lines_(whole_->head()) {}

    std::size_t read(char* into, std::size_t size) override {
        while (given_ == lines_.size()) {
            lines_.clear();
            given_ = 0;
            if (add_lines()) continue;
            require_rows();
            return 0;
        }
        const std::size_t given = lines_.copy(into, size, given_);
        given_ += given;
        return given;
    }

  private:
    /// The next of the log, as far as they are inside; false when there are none left.
    bool add_lines() {
        if (!whole_->fetch(block_)) return false;
        const std::string_view bytes = block_.bytes;
        for (std::size_t begin = 0, end = 0; begin < bytes.size(); begin = end) {
            end = std::min(bytes.find('\n', begin), bytes.size() - 1) + 1;
            const std::string_view line = bytes.substr(begin, end - begin);
            // What is longer than any line comes in pieces, which go where its beginning goes.
            const bool goes_on = std::exchange(unended_, line.back() != '\n');
            if (goes_on ? inside() : keeps_text(line.substr(0, line.size() - (unended_ ? 0 : 1))))
                lines_ += line;
        }
        return true;
    }

    bool keeps_text(std::string_view line) {
        line = line_content(line);
        std::optional<double> time;
        if (parser_.parse_any(line, row_, split_, [](const auto&...) { return std::nullopt; })) {
            const Layout& layout = whole_->layout();
            const bool first = std::exchange(first_, false);
            time = row_.values[time_slot];
            if (layout.time_is_steps) time = sum_ = first ? 0.0 : sum_ + *time;
            if (layout.time_as_text && first) {
                split_cells(line, parser_.plan().rules.delimiter, split_);
                first_stamp(clock_text(split_.cells[*layout.chosen.time].of(line), layout.stamp_form));
            }
        } else if (is_no_row(line)) {
            return keeps_line();
        }
        return keeps(time);
    }

    std::unique_ptr<CsvReader> whole_;
    RowParser parser_;
    ParsedRow row_;
    CellSplit split_;
    RowBlock block_;
    std::string lines_;
    std::size_t given_ = 0;  ///< of lines_
    bool first_ = true;      ///< no row has been seen
    double sum_ = 0.0;       ///< of time steps
    bool unended_ = false;   ///< the bytes before ended within a line
};

class ColumnsInRange final : public Columns, public RowsInRange {
  public:
    ColumnsInRange(std::unique_ptr<ColumnReader> whole, const ReadOptions& options)
        : Columns(whole->columns().name(), whole->columns().info()),
          RowsInRange(options, whole->layout(), 0),
          whole_(std::move(whole)) {}
    void keep(std::vector<bool> wanted) override { whole_->keep(std::move(wanted)); }
    std::size_t next(std::size_t /*rows*/, NumberRows& into, std::string& bytes) override {
        const std::size_t before = kept();
        while (kept() == before && add_rows(into, bytes)) {
        }
        if (kept() == before) require_rows();
        return kept() - before;
    }
    [[nodiscard]] std::size_t number_in_file(std::size_t row) const override {
        return RowsInRange::number_in_file(row);
    }
    [[nodiscard]] std::shared_ptr<const RowsOutside> outside() const override {
        return RowsInRange::outside();
    }
    [[nodiscard]] const Columns& base() const override { return whole_->columns().base(); }
    [[nodiscard]] std::size_t row_bytes() const override { return base().row_bytes(); }

  private:
    /// The next of the log, as far as they are inside; false when there are none left.
    bool add_rows(NumberRows& into, std::string& bytes) {
        const std::size_t count = whole_->take(numbers_, bytes_);
        if (count == 0) return false;
        const bool timed = whole_->layout().chosen.time.has_value();
        const std::size_t size = bytes_.size() / count;
        std::vector<std::size_t> inside;
        for (std::size_t row = 0; row < count; ++row) {
            std::optional<double> time;
            if (timed) time = whole_->time_at(numbers_, row);
            if (!keeps(time && std::isfinite(*time) ? time : std::nullopt)) continue;
            inside.push_back(row);
            bytes.append(bytes_, row * size, size);
        }
        append_rows(numbers_, inside, into);
        return true;
    }

    std::unique_ptr<ColumnReader> whole_;
    NumberRows numbers_;
    std::string bytes_;
};

std::string clock_words(const Layout& layout) {
    if (!layout.chosen.time) return "none";
    const Column& column = layout.columns[*layout.chosen.time];
    return fmt::format("'{}' {}{}", column.name,
                       layout.time_is_steps  ? "as steps in " + column.unit
                       : layout.time_as_text ? "as text"
                                             : "in " + column.unit,
                       layout.time_fraction ? " and nanoseconds" : "");
}

// The range was put to the whole log; what is inside has to be read by the same clock.
std::unique_ptr<LogReader> with_clock_of(const Layout& whole, const std::shared_ptr<RowsOutside>& outside,
                                         std::unique_ptr<LogReader> reader) {
    const Layout& inside = reader->layout();
    const std::string before = clock_words(whole), after = clock_words(inside);
    if (before != after)
        raise<DataError>(
            "{}: --from and --to: the time is read as {} in the whole log, as {} in the rows inside; use "
            "--columns time=NAME and --unit time=UNIT",
            whole.source, before, after);
    if (inside.time_origin != whole.time_origin)
        outside->zero_s =
            since(inside.time_origin, whole.time_origin) * inside.columns[*inside.chosen.time].factor;
    return reader;
}

}  // namespace

std::size_t number_in_file(const ByteSource& source, std::size_t number) {
    const auto* const rows = dynamic_cast<const RowsInRange*>(&source);
    return rows == nullptr ? number : rows->number_in_file(number);
}

std::shared_ptr<const RowsOutside> rows_outside(const ByteSource& source) {
    const auto* const rows = dynamic_cast<const RowsInRange*>(&source);
    return rows == nullptr ? nullptr : rows->outside();
}

std::string range_in_words(const RowsOutside& outside) {
    std::string words = "only rows";
    if (outside.from_s) words += fmt::format(" from {} s", shortest(*outside.from_s));
    if (outside.to_s) words += fmt::format(" to {} s", shortest(*outside.to_s));
    if (outside.zero_s != 0.0) words += fmt::format("; times count from {} s", shortest(outside.zero_s));
    return words;
}

ReadOptions options_of_whole(ReadOptions options) {
    if (!options.range.given()) return options;
    options.joint.reset();
    options.every_joint = options.each_joint = false;
    options.needs_torque = false;
    return options;
}

std::unique_ptr<LogReader> rows_in_range(std::unique_ptr<CsvReader> whole, const ReadOptions& options) {
    if (!options.range.given()) return whole;
    const Layout layout = whole->layout();
    auto lines = std::make_unique<LinesInRange>(std::move(whole), options);
    const auto outside = lines->outside();
    return with_clock_of(layout, outside,
                         std::make_unique<CsvReader>(std::move(lines), std::string(), options));
}

std::unique_ptr<LogReader> rows_in_range(std::unique_ptr<ColumnReader> whole, const ReadOptions& options) {
    if (!options.range.given()) return whole;
    const Layout layout = whole->layout();
    ColumnLog log = whole->same_log(nullptr);
    auto rows = std::make_unique<ColumnsInRange>(std::move(whole), options);
    const auto outside = rows->RowsInRange::outside();
    log.columns = std::move(rows);
    return with_clock_of(layout, outside, std::make_unique<ColumnReader>(std::move(log), options));
}

}  // namespace ripplenotch
