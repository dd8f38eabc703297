// SPDX-License-Identifier: MIT
#include "log/numbers/columns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {

void append_rows(const NumberRows& from, const std::vector<std::size_t>& rows, NumberRows& into) {
    for (std::size_t c = 0; c < from.size(); ++c) {
        for (const std::size_t row : rows) {
            if (row < from[c].values.size()) into[c].values.push_back(from[c].values[row]);
            if (row < from[c].counts.size()) into[c].counts.push_back(from[c].counts[row]);
        }
    }
}

std::size_t Columns::row_bytes() const {
    const auto wanted = static_cast<std::size_t>(std::ranges::count(wanted_, true));
    return sizeof(double) * std::max<std::size_t>(1, wanted);
}

HeldColumns::HeldColumns(std::string name, std::vector<ColumnInfo> info, NumberRows numbers,
                         std::string bytes)
    : Columns(std::move(name), std::move(info)), numbers_(std::move(numbers)), bytes_(std::move(bytes)) {
    for (const ColumnNumbers& column : numbers_) rows_ = std::max(rows_, column.values.size());
}

std::size_t HeldColumns::next(std::size_t rows, NumberRows& into, std::string& bytes) {
    const std::size_t count = std::min(rows, rows_ - row_);
    const auto append = [this, count](const auto& from, auto& to) {
        if (from.empty()) return;
        const auto first = from.begin() + static_cast<std::ptrdiff_t>(row_);
        to.insert(to.end(), first, first + static_cast<std::ptrdiff_t>(count));
    };
    for (std::size_t c = 0; c < numbers_.size(); ++c) {
        append(numbers_[c].values, into[c].values);
        append(numbers_[c].counts, into[c].counts);
    }
    const std::size_t size = bytes_.size() / std::max<std::size_t>(1, rows_);
    bytes.append(bytes_, row_ * size, count * size);
    row_ += count;
    return count;
}

// Signals with clocks of their own, of another topic, another array or other rows, joined to the rows of one.

namespace {

constexpr std::size_t rows_at_once = 4096;  // of which the usual step is measured, too
constexpr double periods_apart = 3.0, least_ns = 1e6, largest_ns = 9.2e18;

enum class Join { nearest, hold, linear };

Join join_named(std::string_view word) {
    if (word == "nearest") return Join::nearest;
    if (word == "hold") return Join::hold;
    if (word == "linear") return Join::linear;
    raise<UsageError>("--join: '{}' is none of nearest, hold, linear", word);
}

/// The clock of columns, their first, in whole nanoseconds; where all that is joined counts alike, as it is.
std::vector<std::int64_t> clock_ns(const Columns& columns, const ColumnNumbers& clock, double ns_per_unit,
                                   bool counted) {
    if (counted) return clock.counts;
    std::vector<std::int64_t> times;
    for (const double value : clock.values) {
        const double ns = value * ns_per_unit;
        if (!(std::abs(ns) < largest_ns))  // nan, too
            raise<DataError>("{}: {}: read a time of {} that is no number of seconds; save it again",
                             columns.name(), columns.info()[0].path, value);
        times.push_back(std::llround(ns));
    }
    return times;
}

/// A signal as its last value and the next.
class Side {
  public:
    Side(SideColumn signal, Join how, bool counted)
        : signal_(std::move(signal)), how_(how), counted_(counted) {
        Columns& columns = *signal_.columns;
        std::vector<bool> wanted(columns.info().size(), false);
        wanted[0] = wanted[signal_.column] = true;
        columns.keep(std::move(wanted));
        read_on();
        double period = 0.0;
        if (times_.size() > 1)
            period = (static_cast<double>(times_.back()) - static_cast<double>(times_.front())) /
                     static_cast<double>(times_.size() - 1);
        unit_ns_ = counted_ ? signal_.ns_per_unit : 1.0;
        limit_ = static_cast<std::int64_t>(periods_apart * std::max(period, least_ns / unit_ns_));
        advance();
        advance();
    }
    [[nodiscard]] const ColumnInfo& info() const { return signal_.columns->info()[signal_.column]; }
    [[nodiscard]] std::string_view noun() const { return signal_.noun; }
    [[nodiscard]] double limit_ns() const { return unit_ns_ * static_cast<double>(limit_); }
    /// At a time that is not before those asked for until now; none before the first value and behind the
    /// last.
    std::optional<double> at(std::int64_t time_ns) {
        while (after_ && after_->time_ns <= time_ns) advance();
        if (!before_ || before_->time_ns > time_ns) return std::nullopt;
        if (before_->time_ns == time_ns) return before_->value;
        if (!after_) return std::nullopt;
        const std::int64_t since = time_ns - before_->time_ns, until = after_->time_ns - time_ns;
        const std::int64_t away = how_ == Join::hold      ? since
                                  : how_ == Join::nearest ? std::min(since, until)
                                                          : std::max(since, until);
        if (away > limit_) {
            raise<DataError>(
                "{}: read no {} of {} within {} s of the row at {} s, expected one; leave the gap out with "
                "--from and --to, or read what has one clock",
                signal_.columns->name(), signal_.noun, info().path, shortest(1e-9 * limit_ns()),
                shortest(1e-9 * unit_ns_ * static_cast<double>(time_ns)));
        }
        if (how_ == Join::hold) return before_->value;
        if (how_ == Join::nearest) return since <= until ? before_->value : after_->value;
        const double part = static_cast<double>(since) / static_cast<double>(since + until);
        return before_->value + part * (after_->value - before_->value);
    }

  private:
    struct Point {
        std::int64_t time_ns = 0;
        double value = 0.0;
    };
    void read_on() {
        std::string bytes;
        row_ = 0;
        numbers_.assign(signal_.columns->info().size(), {});
        signal_.columns->next(rows_at_once, numbers_, bytes);
        times_ = clock_ns(*signal_.columns, numbers_[0], signal_.ns_per_unit, counted_);
    }
    void advance() {
        before_ = after_;
        after_.reset();
        if (row_ == times_.size() && row_ > 0) read_on();
        if (times_.empty()) return;
        after_ = Point{times_[row_], numbers_[signal_.column].values[row_]};
        ++row_;
        if (before_ && after_->time_ns < before_->time_ns)
            raise<DataError>(
                "{}: read a {} of {} that is older than the one before, expected time to run forward",
                signal_.columns->name(), signal_.noun, info().path);
    }

    SideColumn signal_;
    Join how_;
    NumberRows numbers_;
    std::vector<std::int64_t> times_;
    std::size_t row_ = 0;
    bool counted_;
    double unit_ns_ = 1.0;    ///< of a time
    std::int64_t limit_ = 0;  ///< in that unit
    std::optional<Point> before_, after_;
};

class JoinedColumns final : public Columns {
  public:
    JoinedColumns(std::unique_ptr<Columns> base, double ns_per_unit, bool counted, std::vector<Side> sides)
        : Columns(base->name(), with_sides(*base, sides)),
          base_(std::move(base)),
          ns_per_unit_(ns_per_unit),
          counted_(counted),
          sides_(std::move(sides)) {}
    void keep(std::vector<bool> wanted) override {
        std::vector<bool> of_base(wanted.begin(),
                                  wanted.begin() + static_cast<std::ptrdiff_t>(base_->info().size()));
        of_base[0] = true;
        base_->keep(std::move(of_base));
        Columns::keep(std::move(wanted));
    }
    std::size_t next(std::size_t rows, NumberRows& into, std::string& bytes) override {
        std::vector<std::size_t> complete;
        while (complete.empty()) {
            numbers_.assign(base_->info().size(), {});
            const std::size_t count = base_->next(rows, numbers_, bytes);
            if (count == 0) return 0;
            const std::vector<std::int64_t> times = clock_ns(*base_, numbers_[0], ns_per_unit_, counted_);
            for (std::size_t row = 0; row < count; ++row)
                if (read_sides(times[row])) complete.push_back(row);
        }
        append_rows(numbers_, complete, into);
        for (std::size_t s = 0; s < sides_.size(); ++s) {
            std::vector<double>& values = into[base_->info().size() + s].values;
            for (std::size_t at = s; at < values_.size(); at += sides_.size()) values.push_back(values_[at]);
        }
        values_.clear();
        return complete.size();
    }

  private:
    static std::vector<ColumnInfo> with_sides(const Columns& base, const std::vector<Side>& sides) {
        std::vector<ColumnInfo> info = base.info();
        for (const Side& side : sides) {
            info.push_back(side.info());
            info.back().whole = false;
        }
        return info;
    }
    /// False where a side has no value.
    bool read_sides(std::int64_t time_ns) {
        const std::size_t before = values_.size();
        for (Side& side : sides_)
            if (const auto value = side.at(time_ns)) values_.push_back(*value);
        if (values_.size() == before + sides_.size()) return true;
        values_.resize(before);
        return false;
    }

    std::unique_ptr<Columns> base_;
    double ns_per_unit_;
    bool counted_;
    std::vector<Side> sides_;
    NumberRows numbers_;
    std::vector<double> values_;  ///< of all sides, row by row
};

}  // namespace

void join_columns(ColumnLog& log, double ns_per_unit, std::vector<SideColumn> sides,
                  const ReadOptions& options) {
    const std::string how = options.join.value_or("linear");
    const bool counted =
        log.columns->info()[0].whole && std::ranges::all_of(sides, [&](const SideColumn& side) {
            return side.columns->info()[0].whole && side.ns_per_unit == ns_per_unit;
        });
    std::vector<Side> opened;
    for (SideColumn& side : sides) {
        const Side& one = opened.emplace_back(std::move(side), join_named(how), counted);
        log.warnings.push_back(
            {"joined by time",
             fmt::format("{} has a clock of its own: joined to the rows by --join {}, from {}s that are up "
                         "to {:.4g} ms away; nearest, hold and linear are allowed",
                         one.info().path, how, one.noun(), one.limit_ns() / 1e6),
             true});
    }
    log.options += fmt::format("{}--join {}", log.options.empty() ? "" : " ", how);
    log.columns =
        std::make_unique<JoinedColumns>(std::move(log.columns), ns_per_unit, counted, std::move(opened));
}

}  // namespace ripplenotch
