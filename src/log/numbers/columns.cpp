// SPDX-License-Identifier: MIT
#include "log/numbers/columns.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "log/clock/stamp.hpp"
#include "log/containers/stored_array.hpp"
#include "log/rows_in_range.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/trace.hpp"

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

// The one reader of them all.

/// So many bytes of rows are looked at before columns are chosen, and taken at once.
constexpr std::size_t opening_bytes = std::size_t{1} << 16, fewest_opening_rows = 64;
constexpr std::size_t bytes_at_once = std::size_t{1} << 18;

// Links to other files, arrays of another length: what the names speak of and the columns do not hold.
std::string left_out_of(const std::vector<ContentEntry>& contents) {
    constexpr std::size_t most = 4;
    std::vector<std::string> found;
    for (const ContentEntry& entry : contents) {
        const bool object = entry.type.starts_with("an object");
        if (entry.read || found.size() == most || (names_tell({entry.path}) == 0 && !object)) continue;
        found.push_back(in_words(entry));
    }
    return found.empty() ? std::string() : fmt::format(" and not {}", fmt::join(found, ", "));
}

// One text of each column; none where all are empty.
std::vector<std::string> texts_of(const std::vector<ColumnInfo>& info, std::string ColumnInfo::*text) {
    std::vector<std::string> texts;
    for (const ColumnInfo& column : info) texts.push_back(column.*text);
    const bool any = std::ranges::any_of(texts, [](const auto& one) { return !one.empty(); });
    return any ? texts : std::vector<std::string>();
}

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

ColumnReader::ColumnReader(ColumnLog log, const ReadOptions& options)
    : log_(std::move(log)), hold_bad_values_(options.hold_bad_values) {
    ahead_.resize(columns().info().size());
    read_ahead(std::max(fewest_opening_rows, opening_bytes / columns().row_bytes()));
    if (ahead_rows_ == 0)
        raise<DataError>("{}: read no row, expected rows of numbers; check what wrote it", columns().name());
    ReadOptions settled = options;
    if (!log_.asked.empty()) settled.columns = log_.asked;
    decide(settled);
    std::vector<bool> kept(columns().info().size(), false);
    for (const WantedColumn& one : wanted_) kept[one.column] = true;
    // Of a range, the reader of the rows inside says what it wants.
    if (!options.range.given() && !wanted_.empty()) keep(std::move(kept));
    at_once_ = std::max<std::size_t>(1, bytes_at_once / columns().row_bytes());
    held_.emplace(columns().name(), columns().info(), std::move(ahead_), std::move(ahead_bytes_));
}

ColumnLog ColumnReader::same_log(std::unique_ptr<Columns> columns) const {
    return {std::move(columns), log_.format,   log_.options,   log_.contents,
            log_.asked,         log_.warnings, log_.inferences};
}

void ColumnReader::read_ahead(std::size_t rows) {
    while (ahead_rows_ < rows) {
        const std::size_t more = log_.columns->next(rows - ahead_rows_, ahead_, ahead_bytes_);
        if (more == 0) return;
        ahead_rows_ += more;
    }
}

std::vector<std::string> ColumnReader::names() const { return texts_of(columns().info(), &ColumnInfo::path); }

ColumnFacts ColumnReader::column_facts() {
    ColumnFacts facts;
    const std::vector<ColumnInfo>& info = columns().info();
    facts.names = names();
    facts.read_as = texts_of(info, &ColumnInfo::read_as);
    facts.units = texts_of(info, &ColumnInfo::unit);
    facts.columns = info.size();
    for (std::size_t c = 0; c < info.size(); ++c) {
        facts.sample.push_back(info[c].number ? ahead_[c].values
                                              : std::vector<double>(ahead_rows_, not_a_number));
        const double first = info[c].number ? ahead_[c].values.front() : 0.0;
        facts.first_counts.push_back(info[c].whole            ? ahead_[c].counts.front()
                                     : std::abs(first) < 9e18 ? static_cast<std::int64_t>(first)
                                                              : 0);
    }
    facts.left_out = left_out_of(log_.contents);
    facts.dialect_options = log_.options;
    facts.motion_sample = [this](const Layout& layout, const std::vector<std::size_t>& wanted,
                                 std::size_t bytes) {
        read_ahead(bytes / columns().row_bytes());
        MotionSample sample;
        for (std::size_t row = 0; row < ahead_rows_; ++row)
            sample.time.push_back(layout.chosen.time ? time_at(ahead_, row, layout)
                                                     : static_cast<double>(row));
        for (const std::size_t c : wanted) sample.values.push_back(ahead_[c].values);
        return sample;
    };
    return facts;
}

void ColumnReader::decide(const ReadOptions& options) {
    const ColumnFacts facts = column_facts();
    ReadOptions with_default = options;
    const bool by_place =
        facts.names.empty() && options.columns.empty() && (facts.columns == 3 || facts.columns == 4);
    if (by_place) {
        with_default.columns = {"time", "velocity", "torque"};
        with_default.every_joint = with_default.each_joint = false;  // there is one
        if (facts.columns == 4) with_default.columns.emplace_back("position");
    }
    layout_ = decide_layout(columns().name(), log_.format, facts, with_default);
    layout_.change_all([&](Layout& layout) {
        layout.outside = columns().outside();
        layout.contents = log_.contents;
        layout.warnings.insert(layout.warnings.begin(), log_.warnings.begin(), log_.warnings.end());
        layout.inferences.insert(layout.inferences.end(), log_.inferences.begin(), log_.inferences.end());
        if (!by_place) return;
        layout.warnings.insert(
            layout.warnings.begin(),
            LogWarning{
                "columns by place",
                fmt::format(
                    "the {} names no columns: took time, velocity, torque{} by place; --columns settles it",
                    log_.format == "npy" ? "array" : "layout", facts.columns == 4 ? ", position" : "")});
    });
    wanted_ = wanted_columns(layout_);
    // time_at() adds the fraction of a second.
    std::erase_if(wanted_, [](const WantedColumn& one) { return one.fraction; });
    factors_ = slot_factors(layout_, wanted_);
    before_.assign(factors_.size(), not_a_number);
    for (const WantedColumn& wanted : wanted_) {
        if (columns().info()[wanted.column].number) continue;
        raise<DataError>("{}: {} holds no numbers, expected a {}; state which column with --columns",
                         columns().name(), column_label(names(), wanted.column),
                         role_name(layout_.columns[wanted.column].role));
    }
}

void ColumnReader::keep(std::vector<bool> wanted) {
    for (const auto& of_time : {layout_.chosen.time, layout_.time_fraction})
        if (of_time) wanted[*of_time] = true;
    log_.columns->keep(std::move(wanted));
}

double ColumnReader::time_at(const NumberRows& numbers, std::size_t row, const Layout& layout) const {
    const std::size_t c = *layout.chosen.time;
    const ColumnNumbers& column = numbers[c];
    double time = columns().info()[c].whole && layout.time_origin != 0
                      ? since(column.counts[row], layout.time_origin)
                      : column.values[row] - static_cast<double>(layout.time_origin);
    if (layout.time_fraction) time += seconds_per_nanosecond * numbers[*layout.time_fraction].values[row];
    return time;
}

std::size_t ColumnReader::take(NumberRows& numbers, std::string& bytes) {
    bytes.clear();
    numbers.resize(columns().info().size());
    for (ColumnNumbers& column : numbers) column.clear();
    if (held_) {
        if (const std::size_t rows = held_->next(at_once_, numbers, bytes); rows > 0) return rows;
        held_.reset();
    }
    return log_.columns->next(at_once_, numbers, bytes);
}

bool ColumnReader::next(RowBlock& block) {
    if (!fetch(block)) return false;
    if (block.failure) std::rethrow_exception(block.failure);
    return true;
}

bool ColumnReader::fetch(RowBlock& block) {
    block.drop_rows();
    block.joints.resize(1 + layout_.others.size());
    block.first_row = rows_;
    const std::size_t rows = take(numbers_, block.bytes);
    std::size_t good = rows;
    for (const WantedColumn& wanted : wanted_) good = judge(block, wanted, good);
    for (std::size_t slot = 0; slot < factors_.size(); ++slot) {
        std::vector<double>& numbers = numbers_of(block, slot);
        // Columns that the log has not.
        const bool wanted =
            std::ranges::any_of(wanted_, [slot](const auto& one) { return one.slot == slot; });
        if (wanted || !is_position(slot)) numbers.resize(good, not_a_number);
        if (wanted && good > 0) before_[slot] = numbers.back();
        if (factors_[slot] != 1.0)
            for (double& number : numbers) number *= factors_[slot];
    }
    for (std::size_t row = 0; !layout_.chosen.time && layout_.stated_rate && row < good; ++row)
        block.time_s[row] = static_cast<double>(rows_ + row) / layout_.stated_rate->value();
    if (rows > 0) block.bytes.resize(block.bytes.size() / rows * good);
    rows_ += good;
    return rows > 0;
}

std::size_t ColumnReader::judge(RowBlock& block, const WantedColumn& wanted, std::size_t rows) const {
    const bool time = wanted.slot == time_slot;
    std::vector<double>& numbers = numbers_of(block, wanted.slot);
    if (time && (layout_.time_origin != 0 || layout_.time_fraction)) {
        for (std::size_t row = 0; row < rows; ++row) numbers.push_back(time_at(numbers_, row));
    } else {
        numbers = numbers_[wanted.column].values;
    }
    double before = before_[wanted.slot];
    for (std::size_t row = 0; row < rows; ++row) {
        double& number = numbers[row];
        const bool backward = time && number < before;
        if (is_reading(number) && !backward) {
            before = number;
        } else if (std::isnan(number) && hold_bad_values_ && !time && rows_ + row > 0) {
            number = before;
            ++block.held_bad_values;
        } else {
            try {
                complain(wanted, row, number, before);
            } catch (const DataError&) {
                block.failure = std::current_exception();
            }
            return row;
        }
    }
    return rows;
}

void ColumnReader::complain(const WantedColumn& wanted, std::size_t row, double value, double before) const {
    const bool time = wanted.slot == time_slot;
    const std::string sentence =
        time && value < before
            ? time_backward(before, value, layout_.time_origin)
            : fmt::format("read {}, expected a {}; {}", shortest(value),
                          std::isfinite(value) ? "number from -1e30 to 1e30" : "finite number",
                          std::isnan(value) && !time && !hold_bad_values_
                              ? "remove the row, or use --hold-bad-values to repeat the value before"
                              : "remove the row");
    raise<DataError>("{}: row {}, {}: {}", columns().name(), columns().number_in_file(rows_ + row + 1),
                     column_label(names(), wanted.column), sentence);
}

std::unique_ptr<LogReader> read_columns(ColumnLog log, const ReadOptions& options) {
    return rows_in_range(std::make_unique<ColumnReader>(std::move(log), options_of_whole(options)), options);
}

}  // namespace ripplenotch
