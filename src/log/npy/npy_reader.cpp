// SPDX-License-Identifier: MIT
#include "log/npy/npy_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "log/clock/time_backward.hpp"
#include "log/read_on.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/reading.hpp"

namespace ripplenotch {
namespace {

constexpr std::size_t npy_piece = std::size_t{1} << 18;

}  // namespace

NpyReader::NpyReader(std::unique_ptr<ByteSource> source, std::string first_bytes, const ReadOptions& options)
    : source_(std::move(source)), hold_bad_values_(options.hold_bad_values) {
    table_.format = "npy";
    read_up_to(first_bytes, 12);
    if (first_bytes.substr(0, npy_magic.size()) != npy_magic) {
        raise<DataError>(
            "{}: read '{}...', expected a NumPy file, which begins with \\x93NUMPY; leave out --format",
            source_->name(), first_bytes.substr(0, 6));
    }
    const std::size_t header_size = npy_header_size(first_bytes);
    if (header_size <= largest_npy_header) read_up_to(first_bytes, header_size);
    header_ = parse_npy_header(first_bytes, source_->name());
    if (header_.by_columns || header_.transposed) read_whole(first_bytes);
    read_up_to(first_bytes,
               header_.data_offset + std::min(npy_sample_bytes, header_.rows * header_.record_size));
    head_ = first_bytes.substr(0, header_.data_offset);
    carry_ = first_bytes.substr(header_.data_offset);
    if (header_.rows == 0)
        raise<DataError>("{}: read an array without rows, expected rows of numbers; check what wrote it",
                         source_->name());
    decide(options);
}

void NpyReader::read_up_to(std::string& bytes, std::size_t size) {
    bytes.resize(read_behind(bytes, bytes.size(), size));
}

// Behind the first `have` bytes, until there are `size`; returns how many there are.
std::size_t NpyReader::read_behind(std::string& bytes, std::size_t have, std::size_t size) {
    return read_on(*source_, bytes, have, size);
}

void NpyReader::decide(const ReadOptions& options) {
    const ColumnFacts facts = column_facts();
    ReadOptions with_default = options;
    const bool by_place =
        !header_.structured && options.columns.empty() && (facts.columns == 3 || facts.columns == 4);
    if (by_place) {
        with_default.columns = {"time", "velocity", "torque"};
        with_default.every_joint = false;  // there is one
        if (facts.columns == 4) with_default.columns.emplace_back("position");
    }
    layout_ = decide_layout(source_->name(), table_.format, facts, with_default);
    layout_.contents = table_.contents;
    layout_.warnings.insert(layout_.warnings.begin(), table_.warnings.begin(), table_.warnings.end());
    if (by_place) {
        layout_.warnings.insert(
            layout_.warnings.begin(),
            LogWarning{"columns by place", fmt::format("the {} names no columns: took time, velocity, "
                                                       "torque{} by place; --columns settles it",
                                                       table_.format == "npy" ? "array" : "layout",
                                                       facts.columns == 4 ? ", position" : "")});
    }
    plan_columns(facts.names);
}

void NpyReader::plan_columns(const std::vector<std::string>& names) {
    wanted_ = wanted_columns(layout_);
    // time_at() adds the fraction of a second.
    wanted_.erase(
        std::remove_if(wanted_.begin(), wanted_.end(), [](const auto& one) { return one.fraction; }),
        wanted_.end());
    factors_ = slot_factors(layout_, wanted_);
    before_.assign(factors_.size(), not_a_number);
    for (const WantedColumn& wanted : wanted_) {
        if (header_.fields[wanted.column].kind != '\0') continue;
        raise<DataError>("{}: {} holds no numbers, expected a {}; say which column with --columns",
                         source_->name(), column_label(names, wanted.column),
                         role_name(layout_.columns[wanted.column].role));
    }
}

bool NpyReader::next(RowBlock& block) {
    if (!fetch(block)) return false;
    parse(block);
    accept(block);
    if (block.failure) std::rethrow_exception(block.failure);
    return true;
}

// Of what was read ahead, no more than `most`: how the log is written may have been looked for in 8 MiB.
std::size_t NpyReader::unload(std::string& bytes, std::size_t most) {
    const std::size_t count = std::min(carry_.size() - carried_, most);
    if (bytes.size() < count) bytes.resize(count);
    std::copy_n(carry_.data() + carried_, count, bytes.data());
    carried_ += count;
    if (carried_ < carry_.size()) return count;
    carry_ = {};
    carried_ = 0;
    return count;
}

// Whole records into block.bytes, the rest into carry_. The block's old bytes and numbers are read over: what
// is made longer is filled first.
bool NpyReader::fetch(RowBlock& block) {
    block.forget_verdict();
    block.joints.resize(1 + layout_.others.size());
    std::string& bytes = block.bytes;
    const std::size_t size = header_.record_size, left = header_.rows - fetched_;
    const std::size_t wanted = std::min(left, std::max<std::size_t>(1, npy_piece / size));
    std::size_t have = unload(bytes, std::max<std::size_t>(1, wanted * size));
    if (left == 0) {
        if (have == 0) have = read_behind(bytes, have, 1);
        if (have > 0) {
            raise<DataError>(
                "{}: read more bytes after the {} rows of the array, expected the end; save one array a file",
                source_->name(), header_.rows);
        }
        block.clear();
        return false;
    }
    if (have < size) have = read_behind(bytes, have, wanted * size);
    const std::size_t rows = std::min(left, have / size);
    if (rows == 0 && endless_) {
        if (have > 0) complain_of_end(have);
        block.clear();
        return false;
    }
    if (rows == 0) {
        raise<DataError>(
            "{}: read {} rows and a part of one, expected {} rows; the file is cut off, save the array again",
            source_->name(), fetched_, header_.rows);
    }
    if (have > rows * size) carry_.assign(bytes, rows * size, have - rows * size);
    bytes.resize(rows * size);
    fetched_ += rows;
    return true;
}

void NpyReader::parse(RowBlock& block) const {
    if (read_columns(block))
        block.parsed_bytes = block.bytes.size();
    else
        block.drop_rows();
}

void NpyReader::accept(RowBlock& block) {
    block.first_row = rows_;
    if (block.parsed_bytes > 0 && continues(block)) {
        count_rows(block);
        return;
    }
    block.drop_rows();
    std::size_t at = 0;
    try {
        for (; at < block.bytes.size(); at += header_.record_size) read_row(block, at);
    } catch (const Error&) {
        block.failure = std::current_exception();
        block.bytes.resize(at);
    }
}

// False where a number is not finite or time runs backward: the careful way has the place and the words.
bool NpyReader::read_columns(RowBlock& block) const {
    const std::size_t rows = block.bytes.size() / header_.record_size;
    for (const WantedColumn& wanted : wanted_) {
        std::vector<double>& numbers = numbers_of(block, wanted.slot);
        numbers.resize(rows);
        if (!read_column(block.bytes.data(), wanted, numbers)) return false;
        if (wanted.slot == time_slot && !std::is_sorted(numbers.begin(), numbers.end())) return false;
        const double factor = factors_[wanted.slot];
        if (factor != 1.0)
            for (double& number : numbers) number *= factor;
    }
    // Columns that the log has not.
    for (std::size_t slot = 0; slot < factors_.size(); ++slot) {
        const bool wanted =
            std::any_of(wanted_.begin(), wanted_.end(), [slot](const auto& one) { return one.slot == slot; });
        if (!wanted && !is_position(slot)) numbers_of(block, slot).resize(rows, not_a_number);
    }
    return true;
}

bool NpyReader::continues(const RowBlock& block) const {
    if (!layout_.chosen.time) return true;
    return !(time_at(block.bytes.data(), layout_) < before_[time_slot]);
}

void NpyReader::count_rows(RowBlock& block) {
    const std::size_t count = block.size();
    if (!layout_.chosen.time && layout_.stated_rate) {
        for (std::size_t i = 0; i < count; ++i)
            block.time_s[i] = static_cast<double>(rows_ + i) / layout_.stated_rate->value();
    }
    const char* const last = block.bytes.data() + (count - 1) * header_.record_size;
    for (const WantedColumn& wanted : wanted_) before_[wanted.slot] = value_at(last, wanted);
    rows_ += count;
}

double NpyReader::read_value(RowBlock& block, const char* record, const WantedColumn& wanted) {
    const double value = value_at(record, wanted);
    const bool time = wanted.slot == time_slot;
    if (time && value < before_[time_slot]) {
        complain(wanted.column, time_backward({before_[time_slot], value, layout_.time_origin}));
    }
    if (is_reading(value)) return value;
    if (std::isnan(value) && hold_bad_values_ && !time && rows_ > 0) {
        ++block.held_bad_values;
        return before_[wanted.slot];
    }
    complain(wanted.column,
             fmt::format("read {}, expected a {}; {}", shortest(value),
                         std::isfinite(value) ? "number from -1e30 to 1e30" : "finite number",
                         std::isnan(value) && !time && !hold_bad_values_
                             ? "remove the row, or say --hold-bad-values to repeat the value before"
                             : "remove the row"));
}

void NpyReader::read_row(RowBlock& block, std::size_t offset) {
    std::vector<double> row = before_;
    for (const WantedColumn& wanted : wanted_)
        row[wanted.slot] = read_value(block, block.bytes.data() + offset, wanted);
    before_ = row;
    for (std::size_t slot = 0; slot < row.size(); ++slot) row[slot] *= factors_[slot];
    if (!layout_.chosen.time && layout_.stated_rate)
        row[time_slot] = static_cast<double>(rows_) / layout_.stated_rate->value();
    for (std::size_t slot = 0; slot < row.size(); ++slot) {
        if (!is_position(slot) || !std::isnan(row[slot])) numbers_of(block, slot).push_back(row[slot]);
    }
    ++rows_;
}

void NpyReader::complain(std::size_t column, const std::string& sentence) const {
    std::vector<std::string> names;
    if (header_.structured) {
        for (const NpyField& field : header_.fields) names.push_back(field.name);
    }
    raise<DataError>("{}: row {}, {}: {}", source_->name(), source_->number_in_file(rows_ + 1),
                     column_label(names, column), sentence);
}

}  // namespace ripplenotch
