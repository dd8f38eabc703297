// SPDX-License-Identifier: MIT
// NumPy array files: structured arrays, whose field names are column names, and plain two-dimensional ones.

#include "log/npy/npy_columns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>

#include "log/formats.hpp"
#include "log/npy/npy_writer.hpp"
#include "log/open.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {

namespace {

std::vector<ColumnInfo> info_of(const NpyHeader& header) {
    std::vector<ColumnInfo> info;
    for (const NpyField& field : header.fields)
        info.push_back({field.name, "", "", field.whole(), field.kind != '\0'});
    return info;
}

void read_up_to(ByteSource& source, std::string& bytes, std::size_t size) {
    bytes.resize(read_on(source, bytes, bytes.size(), size));
}

// Of an array whose columns stand together, the bytes of its rows: it cannot be read a row at a time.
std::string by_rows(std::string_view data, const NpyHeader& header, const std::string& source) {
    if (data.size() != header.rows * header.record_size) {
        raise<DataError>(
            "{}: read {} bytes of numbers, expected {}; the file is cut off, save the array again", source,
            data.size(), header.rows * header.record_size);
    }
    std::string rows(data);
    if (!header.by_columns) return rows;
    for (const NpyField& field : header.fields)
        for (std::size_t row = 0; row < header.rows; ++row)
            data.copy(rows.data() + row * header.record_size + field.offset, field.size,
                      field.offset * header.rows + row * field.size);
    return rows;
}

constexpr std::array<std::string_view, 1> npy_extensions = {".npy"};

bool sniff(std::string_view first_bytes) { return first_bytes.substr(0, npy_magic.size()) == npy_magic; }

ColumnLog make_npy(std::unique_ptr<ByteSource> source, std::string first_bytes,
                   const ReadOptions& /*options*/) {
    const std::string name = source->name();
    read_up_to(*source, first_bytes, 12);
    if (first_bytes.substr(0, npy_magic.size()) != npy_magic) {
        raise<DataError>(
            "{}: read '{}...', expected a NumPy file, which begins with \\x93NUMPY; leave out --format", name,
            first_bytes.substr(0, 6));
    }
    const std::size_t header_size = npy_header_size(first_bytes);
    if (header_size <= largest_npy_header) read_up_to(*source, first_bytes, header_size);
    NpyHeader header = parse_npy_header(first_bytes, name);
    if (header.rows == 0)
        raise<DataError>("{}: read an array without rows, expected rows of numbers; check what wrote it",
                         name);
    std::string head = first_bytes.substr(0, header.data_offset);
    first_bytes.erase(0, header.data_offset);
    if (header.by_columns || header.transposed) {
        read_up_to(*source, first_bytes, std::numeric_limits<std::size_t>::max());
        first_bytes = by_rows(first_bytes, header, name);
        head = make_npy_header(header.descr, fmt::format("{}{}", header.rows, header.after_rows()), false);
    }
    ColumnLog log;
    log.format = "npy";
    log.columns = std::make_unique<RecordColumns>(std::move(source), std::move(first_bytes),
                                                  std::move(header), std::move(head));
    return log;
}

}  // namespace

RecordColumns::RecordColumns(std::unique_ptr<ByteSource> source, std::string first_bytes, NpyHeader header,
                             std::string head)
    : Columns(source->name(), info_of(header)),
      source_(std::move(source)),
      begun_(std::move(first_bytes)),
      header_(std::move(header)),
      head_(std::move(head)) {}

std::size_t RecordColumns::next(std::size_t rows, NumberRows& into, std::string& bytes) {
    const std::size_t size = header_.record_size, left = header_.rows - rows_, at = bytes.size();
    const std::size_t asked = left == 0 ? 1 : std::min(left, std::max<std::size_t>(1, rows)) * size;
    const std::size_t taken = std::min(asked, begun_.size() - begun_at_);
    bytes.append(begun_, begun_at_, taken);
    begun_at_ += taken;
    bytes.resize(read_on(*source_, bytes, at + taken, at + asked));
    const std::size_t have = bytes.size() - at, whole = left == 0 ? 0 : have / size;
    if (left == 0 && have > 0) {
        raise<DataError>(
            "{}: read more bytes after the {} rows of the array, expected the end; save one array a file",
            name(), header_.rows);
    }
    if (whole == 0 && have > 0 && header_.rows == rows_unknown) complain_of_end(have);
    if (whole == 0 && left > 0 && header_.rows != rows_unknown) {
        raise<DataError>(
            "{}: read {} rows and a part of one, expected {} rows; the file is cut off, save the array again",
            name(), rows_, header_.rows);
    }
    // A part of a row is the end of the file.
    if (have > whole * size) {
        begun_ = bytes.substr(at + whole * size);
        begun_at_ = 0;
    }
    bytes.resize(at + whole * size);
    for (std::size_t c = 0; c < header_.fields.size(); ++c)
        if (wanted(c) && info()[c].number)
            load_column(bytes.data() + at, size, header_.fields[c], whole, into[c]);
    rows_ += whole;
    return whole;
}

void RecordColumns::complain_of_end(std::size_t left_over) const {
    raise<DataError>(
        "{}: read {} rows and {} bytes of one more, expected records of {} bytes; the file is cut off, or "
        "its records differ from its header",
        name(), rows_, left_over, header_.record_size);
}

const LogFormat formats::npy{
    .name = "npy",
    .summary = "NumPy array files, structured or plain",
    .extensions = npy_extensions,
    .binary = true,
    .sniff = sniff,
    .open = open_as_columns<make_npy>,
    .rewrite = rewrite_with<NpyWriter, ColumnReader>,
    .convert = convert_with<NpyTableWriter>,
    .write_columns = write_columns_with<NpyTableWriter>,
};

}  // namespace ripplenotch
