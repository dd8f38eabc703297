// SPDX-License-Identifier: MIT
#include "log/npy_writer.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <vector>

#include "log/csv_writer.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {
namespace {

std::string python_string(const std::string& text) {
    std::string quoted(1, '\'');
    for (const char c : text) {
        if (c == '\'' || c == '\\') quoted += '\\';
        quoted += c;
    }
    quoted += '\'';
    return quoted;
}

std::string shape_of_rows(std::size_t rows) { return fmt::format("{},", rows); }

}  // namespace

NpyWriter::NpyWriter(std::unique_ptr<ByteSink> sink, const NpyReader& reader, const WriteOptions& options)
    : sink_(std::move(sink)), append_(options.append) {
    const auto torque = reader.layout().chosen.torque;
    if (!torque) raise<UsageError>("{}: there is no torque column to write", reader.layout().source);
    const NpyHeader& header = reader.header();
    factor_ = reader.layout().columns[*torque].factor;
    field_ = header.fields[*torque];
    record_in_ = record_out_ = header.record_size;
    if (field_.kind != 'f' && !(append_ && header.structured)) {
        raise<UsageError>(
            "{}: the torque is stored in integers, which would round the result; write it as CSV with -o "
            "NAME.csv{}",
            reader.layout().source, header.structured ? ", or add a column with --append" : "");
    }
    if (!append_) {
        sink_->write(reader.head());
        return;
    }
    field_.offset = header.record_size;
    if (header.structured) {
        if (field_.kind != 'f') field_ = {"", 'f', 8, false, header.record_size};
        const std::string name = appended_name(options.append_name, reader.layout().columns[*torque].name);
        const std::size_t bracket = header.descr.rfind(']');
        std::string_view before = std::string_view(header.descr).substr(0, bracket);
        while (before.back() == ' ' || before.back() == ',') before.remove_suffix(1);
        sink_->write(make_npy_header(fmt::format("{}, ({}, '{}f{}')]", before, python_string(name),
                                                 field_.big_endian ? '>' : '<', field_.size),
                                     shape_of_rows(header.rows), false));
    } else {
        sink_->write(make_npy_header(header.descr,
                                     fmt::format("{}, {}", header.rows, header.fields.size() + 1), false));
    }
    record_out_ += field_.size;
}

void NpyWriter::write(const RowBlock& block, std::span<const double> torque_nm) {
    if (!append_) records_ = block.bytes;
    if (append_) records_.resize(block.size() * record_out_);
    for (std::size_t i = 0; i < block.size(); ++i) {
        char* const record = records_.data() + i * record_out_;
        if (append_) {
            block.bytes.copy(record, record_in_, i * record_in_);
        } else if (torque_nm[i] == block.torque_nm[i] && block.held_bad_values == 0) {
            continue;  // a value that nobody changed keeps its bits, whatever the unit
        }
        store_float(record, field_, torque_nm[i] / factor_);
    }
    sink_->write(records_);
}

void NpyWriter::finish() { sink_->finish(); }

void NpyTableWriter::begin(std::span<const std::string> names) {
    std::vector<std::string> fields;
    for (const std::string& name : names) fields.push_back(fmt::format("({}, '<f8')", python_string(name)));
    descr_ = fmt::format("[{}]", fmt::join(fields, ", "));
    if (!sink_.can_rewrite()) {
        spool_.reset(std::tmpfile());
        if (!spool_)
            raise<FileError>(
                "no temporary file for an array on its way into a pipe; check the temporary folder");
        return;
    }
    sink_.write(make_npy_header(descr_, shape_of_rows(0), true));
}

void NpyTableWriter::put(std::string_view bytes) {
    if (!spool_) {
        sink_.write(bytes);
    } else if (std::fwrite(bytes.data(), 1, bytes.size(), spool_.get()) != bytes.size()) {
        raise<FileError>("cannot write to a temporary file; check the space in the temporary folder");
    }
}

void NpyTableWriter::rows(std::span<const std::span<const double>> columns) {
    const std::size_t count = columns.empty() ? 0 : columns[0].size();
    const std::size_t width = 8 * columns.size();
    bytes_.resize(count * width);
    for (std::size_t c = 0; c < columns.size(); ++c) {
        const NpyField field{"", 'f', 8, false, 8 * c};
        for (std::size_t r = 0; r < count; ++r) store_float(bytes_.data() + r * width, field, columns[c][r]);
    }
    put(bytes_);
    rows_ += count;
}

void NpyTableWriter::end() {
    const std::string header = make_npy_header(descr_, shape_of_rows(rows_), true);
    if (!spool_) {
        sink_.rewrite(0, header);
        return;
    }
    sink_.write(header);
    std::rewind(spool_.get());
    std::vector<char> buffer(std::size_t{1} << 20);
    while (const std::size_t got = std::fread(buffer.data(), 1, buffer.size(), spool_.get()))
        sink_.write({buffer.data(), got});
    if (std::ferror(spool_.get()) != 0) raise<FileError>("cannot read a temporary file back");
}

}  // namespace ripplenotch
