// SPDX-License-Identifier: MIT
#include "log/npy/npy_writer.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <cerrno>

#include "core/files/byte_sink.hpp"
#include "log/text/csv_writer.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {

TemporaryBytes::TemporaryBytes() {
    TemporaryFile file(temporary_folder() + "/ripplenotch-rows", std::nullopt);
    const int descriptor = file.release_without_name();
    file_.reset(::fdopen(descriptor, "w+b"));
    if (file_) return;
    ::close(descriptor);
    raise<FileError>("cannot make a temporary file for an array; check the temporary folder");
}

void TemporaryBytes::put(std::string_view bytes) {
    flushed_ = false;
    if (std::fwrite(bytes.data(), 1, bytes.size(), file_.get()) != bytes.size())
        raise<FileError>("cannot write to a temporary file; check the space in the temporary folder");
}

void TemporaryBytes::read_at(std::uint64_t offset, char* into, std::size_t size) {
    if (!flushed_ && std::fflush(file_.get()) != 0)
        raise<FileError>("cannot write to a temporary file; check the space in the temporary folder");
    flushed_ = true;
    while (size > 0) {
        const ssize_t got = ::pread(::fileno(file_.get()), into, size, static_cast<off_t>(offset));
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) raise<FileError>("cannot read a temporary file back");
        into += got;
        size -= static_cast<std::size_t>(got);
        offset += static_cast<std::uint64_t>(got);
    }
}

void TemporaryBytes::rewind() { std::rewind(file_.get()); }

std::size_t TemporaryBytes::read(char* into, std::size_t size) {
    const std::size_t got = std::fread(into, 1, size, file_.get());
    if (std::ferror(file_.get()) != 0) raise<FileError>("cannot read a temporary file back");
    return got;
}

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

}  // namespace

CountedArray::CountedArray(ByteSink& sink, std::string descr, std::string after_rows)
    : sink_(sink), descr_(std::move(descr)), after_rows_(std::move(after_rows)) {
    if (sink_.can_rewrite())
        sink_.write(head());
    else
        spool_.emplace();
}

std::string CountedArray::head() const {
    return make_npy_header(descr_, fmt::format("{}{}", rows_, after_rows_), true);
}

void CountedArray::put(std::string_view bytes, std::size_t rows) {
    if (spool_)
        spool_->put(bytes);
    else
        sink_.write(bytes);
    rows_ += rows;
}

void CountedArray::end() {
    if (!spool_) {
        sink_.rewrite(0, head());
        return;
    }
    sink_.write(head());
    spool_->rewind();
    std::vector<char> buffer(std::size_t{1} << 20);
    while (const std::size_t got = spool_->read(buffer.data(), buffer.size()))
        sink_.write({buffer.data(), got});
}

NpyWriter::NpyWriter(std::unique_ptr<ByteSink> sink, const ColumnReader& reader, const WriteOptions& options)
    : sink_(std::move(sink)), append_(options.append) {
    const Layout& layout = reader.layout();
    const auto& records = dynamic_cast<const RecordColumns&>(reader.columns().base());
    const NpyHeader& header = records.header();
    for (const JointColumns& joint : layout.all_chosen()) {
        if (!joint.torque) raise<UsageError>("{}: there is no torque column to write", layout.source);
        fields_.push_back(header.fields[*joint.torque]);
        factors_.push_back(layout.columns[*joint.torque].factor);
        if (fields_.back().kind == 'f' || (append_ && header.structured)) continue;
        raise<UsageError>(
            "{}: the torque is stored in integers, which would round the result; write it as CSV with -o "
            "NAME.csv{}",
            layout.source, header.structured ? ", or add a column with --append" : "");
    }
    sink_->expect(records.source_bytes());
    record_in_ = record_out_ = header.record_size;
    begin(layout, records, options);
}

void NpyWriter::begin(const Layout& layout, const RecordColumns& records, const WriteOptions& options) {
    const NpyHeader& header = records.header();
    std::string descr = header.descr;
    if (append_) {
        const std::vector<std::string> names = appended_names(layout, options);
        if (header.structured) {
            descr.resize(descr.rfind(']'));
            while (descr.back() == ' ' || descr.back() == ',') descr.pop_back();
        }
        for (std::size_t j = 0; j < fields_.size(); ++j) {
            NpyField& field = fields_[j];
            if (field.kind != 'f') field = {"", 'f', 8, false, 0};
            field.offset = record_out_;
            record_out_ += field.size;
            if (header.structured)
                descr += fmt::format(", ({}, '{}f{}')", python_string(names[j]), field.big_endian ? '>' : '<',
                                     field.size);
        }
        if (header.structured) descr += ']';
    }
    const std::string after_rows = header.after_rows(append_ ? fields_.size() : 0);
    if (layout.outside)
        counted_.emplace(*sink_, descr, after_rows);
    else if (append_)
        sink_->write(make_npy_header(descr, fmt::format("{}{}", header.rows, after_rows), false));
    else
        sink_->write(records.head());
}

std::string_view NpyWriter::prepare(RowBlock& block, Torques torque_nm, std::string& room) const {
    char* records = block.bytes.data();
    std::size_t size = block.bytes.size();
    if (append_) {
        size = block.size() * record_out_;
        if (room.size() < size) room.resize(size);
        records = room.data();
        for (std::size_t i = 0; i < block.size(); ++i)
            block.bytes.copy(records + i * record_out_, record_in_, i * record_in_);
    }
    // A value that nobody changed keeps its bits, whatever the unit.
    const bool as_written = !append_ && block.held_bad_values == 0;
    for (std::size_t j = 0; j < fields_.size(); ++j) {
        const std::span<const double> raw =
            as_written ? std::span(block.joints[j].torque_nm) : std::span<double>();
        store_column(records, record_out_, fields_[j],
                     {std::span(torque_nm[j]).first(block.size()), raw, factors_[j]});
    }
    return {records, size};
}

void NpyWriter::put(const RowBlock& block, Torques /*torque_nm*/, std::string_view bytes) {
    if (counted_)
        counted_->put(bytes, block.size());
    else
        sink_->write(bytes);
}

void NpyWriter::finish() {
    if (counted_) counted_->end();
    sink_->finish();
}

void NpyTableWriter::begin(std::span<const std::string> names) {
    std::vector<std::string> fields;
    for (const std::string& name : names) fields.push_back(fmt::format("({}, '<f8')", python_string(name)));
    array_.emplace(sink_, fmt::format("[{}]", fmt::join(fields, ", ")), ",");
}

void NpyTableWriter::rows(std::span<const std::span<const double>> columns) {
    const std::size_t count = columns.empty() ? 0 : columns[0].size();
    const std::size_t width = 8 * columns.size();
    bytes_.resize(count * width);
    for (std::size_t c = 0; c < columns.size(); ++c) {
        const NpyField field{"", 'f', 8, false, 8 * c};
        for (std::size_t r = 0; r < count; ++r) store_float(bytes_.data() + r * width, field, columns[c][r]);
    }
    array_->put(bytes_, count);
}

}  // namespace ripplenotch
