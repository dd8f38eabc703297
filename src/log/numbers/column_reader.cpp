// SPDX-License-Identifier: MIT
#include "log/numbers/column_reader.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "log/clock/stamp.hpp"
#include "log/containers/stored_array.hpp"
#include "log/rows_in_range.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/trace.hpp"

namespace ripplenotch {

namespace {

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
    facts.motion_sample = [this](const Layout& layout, const std::vector<MotionPlace>& places,
                                 std::size_t bytes) {
        read_ahead(bytes / columns().row_bytes());
        return motion_sample(layout, places);
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

MotionSample ColumnReader::motion_sample(const Layout& layout, const std::vector<MotionPlace>& places) const {
    MotionSample sample;
    for (std::size_t row = 0; row < ahead_rows_; ++row)
        sample.time.push_back(layout.chosen.time ? time_at(ahead_, row, layout) : static_cast<double>(row));
    for (const MotionPlace& place : places) {
        auto& [velocity, position] = sample.joints.emplace_back();
        if (place.velocity) velocity = ahead_[*place.velocity].values;
        if (place.position) position = ahead_[*place.position].values;
    }
    return sample;
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
            ? time_backward({before, value, layout_.time_origin})
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
