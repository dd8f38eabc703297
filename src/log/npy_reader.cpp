// SPDX-License-Identifier: MIT
#include "log/npy_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "log/decide_layout.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {
namespace {

constexpr std::size_t piece_size = std::size_t{1} << 20;
constexpr std::size_t sample_size = std::size_t{1} << 16;
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

}  // namespace

NpyReader::NpyReader(std::unique_ptr<ByteSource> source, std::string first_bytes, const ReadOptions& options)
    : source_(std::move(source)),
      hold_bad_values_(options.hold_bad_values),
      time_before_(not_a_number),
      velocity_before_(not_a_number),
      torque_before_(not_a_number),
      position_before_(not_a_number) {
    read_up_to(first_bytes, 12);
    if (first_bytes.substr(0, npy_magic.size()) != npy_magic) {
        raise<DataError>(
            "{}: read '{}...', expected a NumPy file, which begins with \\x93NUMPY; leave out --format",
            source_->name(), first_bytes.substr(0, 6));
    }
    const std::size_t header_size = npy_header_size(first_bytes);
    if (header_size <= piece_size) read_up_to(first_bytes, header_size);
    header_ = parse_npy_header(first_bytes, source_->name());
    read_up_to(first_bytes, header_.data_offset + std::min(sample_size, header_.rows * header_.record_size));
    head_ = first_bytes.substr(0, header_.data_offset);
    carry_ = first_bytes.substr(header_.data_offset);
    if (header_.rows == 0)
        raise<DataError>("{}: read an array without rows, expected rows of numbers; check what wrote it",
                         source_->name());
    decide(options);
}

void NpyReader::read_up_to(std::string& bytes, std::size_t size) {
    std::size_t have = bytes.size();
    if (have >= size) return;
    bytes.resize(size);
    for (std::size_t got = 1; have < size && got > 0; have += got)
        got = source_->read(bytes.data() + have, size - have);
    bytes.resize(have);
}

void NpyReader::decide(const ReadOptions& options) {
    ColumnFacts facts;
    facts.columns = header_.fields.size();
    facts.sample.resize(facts.columns);
    const std::size_t rows = std::min(header_.rows, carry_.size() / header_.record_size);
    for (std::size_t c = 0; c < facts.columns; ++c) {
        if (header_.structured) facts.names.push_back(header_.fields[c].name);
        for (std::size_t r = 0; r < rows; ++r) {
            const bool number = header_.fields[c].kind != '\0';
            facts.sample[c].push_back(
                number ? load_field(carry_.data() + r * header_.record_size, header_.fields[c])
                       : not_a_number);
        }
    }
    ReadOptions with_default = options;
    const bool by_place =
        !header_.structured && options.columns.empty() && (facts.columns == 3 || facts.columns == 4);
    if (by_place) {
        with_default.columns = {"time", "velocity", "torque"};
        if (facts.columns == 4) with_default.columns.emplace_back("position");
    }
    layout_ = decide_layout(source_->name(), "npy", facts, with_default);
    if (by_place) {
        layout_.warnings.insert(
            layout_.warnings.begin(),
            fmt::format(
                "the array names no columns: took time, velocity, torque{} by place; --columns settles it",
                facts.columns == 4 ? ", position" : ""));
    }
    const JointColumns& chosen = layout_.chosen;
    for (const auto& column : {chosen.time, chosen.velocity, chosen.torque, chosen.position}) {
        if (column && header_.fields[*column].kind == '\0') {
            raise<DataError>("{}: {} holds no numbers, expected a {}; say which column with --columns",
                             source_->name(), column_label(facts.names, *column),
                             role_name(layout_.columns[*column].role));
        }
    }
}

bool NpyReader::next(RowBlock& block) {
    block.first_row = rows_;
    block.clear();

    const std::size_t size = header_.record_size;
    const std::size_t left = header_.rows - rows_;
    block.bytes.swap(carry_);
    carry_.clear();
    if (left == 0) {
        if (block.bytes.empty()) read_up_to(block.bytes, 1);
        if (!block.bytes.empty()) {
            raise<DataError>(
                "{}: read more bytes after the {} rows of the array, expected the end; save one array a file",
                source_->name(), header_.rows);
        }
        return false;
    }
    const std::size_t rows = std::min(left, std::max<std::size_t>(1, piece_size / size));
    if (block.bytes.size() < size) read_up_to(block.bytes, rows * size);
    const std::size_t have = std::min(left, block.bytes.size() / size);
    if (have == 0) {
        raise<DataError>(
            "{}: read {} rows and a part of one, expected {} rows; the file is cut off, save the array again",
            source_->name(), rows_, header_.rows);
    }
    carry_.assign(block.bytes, have * size);
    block.bytes.resize(have * size);
    for (std::size_t r = 0; r < have; ++r) take_row(block, r * size);
    return true;
}

double NpyReader::take_value(RowBlock& block, const char* record, std::size_t column, double before) {
    const double value = load_field(record, header_.fields[column]);
    if (std::isfinite(value)) return value;
    const bool time = layout_.chosen.time == column;
    if (std::isnan(value) && hold_bad_values_ && !time && rows_ > 0) {
        ++block.held_bad_values;
        return before;
    }
    complain(column, fmt::format("read {}, expected a finite number; {}", shortest(value),
                                 std::isnan(value) && !time && !hold_bad_values_
                                     ? "remove the row, or say --hold-bad-values to repeat the value before"
                                     : "remove the row"));
}

void NpyReader::take_row(RowBlock& block, std::size_t offset) {
    const char* const record = block.bytes.data() + offset;
    const JointColumns& chosen = layout_.chosen;
    const auto factor = [this](std::size_t column) { return layout_.columns[column].factor; };
    if (chosen.time) {
        const double time = take_value(block, record, *chosen.time, time_before_);
        if (time < time_before_) {
            complain(*chosen.time,
                     fmt::format(
                         "read the time {} after {}, expected time to run forward; sort or split the log, or "
                         "say --sample-rate if the clock is of no use",
                         shortest(time), shortest(time_before_)));
        }
        time_before_ = time;
        block.time_s.push_back(time * factor(*chosen.time));
    } else {
        block.time_s.push_back(layout_.stated_rate ? static_cast<double>(rows_) / layout_.stated_rate->value()
                                                   : not_a_number);
    }
    const auto take = [&](const std::optional<std::size_t>& column, double& before,
                          std::vector<double>& into) {
        if (column) before = take_value(block, record, *column, before);
        into.push_back(column ? before * factor(*column) : not_a_number);
    };
    take(chosen.velocity, velocity_before_, block.velocity_deg_s);
    take(chosen.torque, torque_before_, block.torque_nm);
    if (chosen.position) take(chosen.position, position_before_, block.position_deg);
    const std::size_t torque = chosen.torque ? offset + header_.fields[*chosen.torque].offset : offset;
    const std::size_t torque_end = chosen.torque ? torque + header_.fields[*chosen.torque].size : torque;
    block.torque_begin.push_back(static_cast<std::uint32_t>(torque));
    block.torque_end.push_back(static_cast<std::uint32_t>(torque_end));
    block.row_end.push_back(static_cast<std::uint32_t>(offset + header_.record_size));
    ++rows_;
}

void NpyReader::complain(std::size_t column, const std::string& sentence) const {
    std::vector<std::string> names;
    if (header_.structured) {
        for (const NpyField& field : header_.fields) names.push_back(field.name);
    }
    raise<DataError>("{}: row {}, {}: {}", source_->name(), rows_ + 1, column_label(names, column), sentence);
}

}  // namespace ripplenotch
