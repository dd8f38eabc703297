// SPDX-License-Identifier: MIT
// NumPy array files: structured arrays, whose field names are column names, and plain two-dimensional ones.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <optional>

#include "log/containers/stored_array.hpp"
#include "log/npy/npy_header.hpp"
#include "log/numbers/columns.hpp"
#include "log/open.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {

namespace {

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

std::string python_string(const std::string& text) {
    std::string quoted(1, '\'');
    for (const char c : text) {
        if (c == '\'' || c == '\\') quoted += '\\';
        quoted += c;
    }
    quoted += '\'';
    return quoted;
}

/// An array whose length is known only at the end: its header is patched in a file, and the rows are spooled
/// when the target is a pipe.
class CountedArray {
  public:
    /// `after_rows`: of the shape, "," or ", 4".
    CountedArray(ByteSink& sink, std::string descr, std::string after_rows)
        : sink_(sink), descr_(std::move(descr)), after_rows_(std::move(after_rows)) {
        if (sink_.can_rewrite())
            sink_.write(head());
        else
            spool_.emplace();
    }
    void put(std::string_view bytes, std::size_t rows) {
        if (spool_)
            spool_->put(bytes);
        else
            sink_.write(bytes);
        rows_ += rows;
    }
    void end() {
        if (!spool_) {
            sink_.rewrite(0, head());
            return;
        }
        sink_.write(head());
        spool_->copy_to(sink_);
    }

  private:
    [[nodiscard]] std::string head() const {
        return make_npy_header(descr_, fmt::format("{}{}", rows_, after_rows_), true);
    }

    ByteSink& sink_;
    std::optional<TemporaryBytes> spool_;
    std::string descr_, after_rows_;
    std::size_t rows_ = 0;
};

/// Records of a reader with another torque; every other byte passes as it is.
class NpyWriter final : public LogWriter {
  public:
    /// Throws UsageError when the torque is an integer and would be rounded (--append adds a float instead).
    NpyWriter(std::unique_ptr<ByteSink> sink, const ColumnReader& reader, const WriteOptions& options)
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
    std::string_view prepare(RowBlock& block, Torques torque_nm, std::string& room) const override {
        char* records = block.bytes.data();
        std::size_t size = block.bytes.size();
        if (append_) {
            size = block.size() * record_out_;
            if (room.size() < size) room.resize(size);
            records = room.data();
            for (std::size_t i = 0; i < block.size(); ++i)
                block.bytes.copy(records + i * record_out_, record_in_, i * record_in_);
        }
        // A value that is not changed keeps its bits, whatever the unit.
        const bool as_written = !append_ && block.held_bad_values == 0;
        for (std::size_t j = 0; j < fields_.size(); ++j) {
            const std::span<const double> raw =
                as_written ? std::span(block.joints[j].torque_nm) : std::span<double>();
            store_column(records, record_out_, fields_[j], std::span(torque_nm[j]).first(block.size()), raw,
                         factors_[j]);
        }
        return {records, size};
    }
    void put(const RowBlock& block, Torques /*torque_nm*/, std::string_view bytes) override {
        if (counted_)
            counted_->put(bytes, block.size());
        else
            sink_->write(bytes);
    }
    void finish() override {
        if (counted_) counted_->end();
        sink_->finish();
    }

  private:
    void begin(const Layout& layout, const RecordColumns& records, const WriteOptions& options) {
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
                    descr += fmt::format(", ({}, '{}f{}')", python_string(names[j]),
                                         field.big_endian ? '>' : '<', field.size);
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

    std::unique_ptr<ByteSink> sink_;
    std::vector<NpyField> fields_;  ///< by joint: where the new torque goes, in a record of the output
    std::vector<double> factors_;   ///< by joint
    std::size_t record_in_ = 0, record_out_ = 0;
    bool append_;
    std::optional<CountedArray> counted_;  ///< where a range leaves rows out
};

/// A structured array of float64 columns.
class NpyTableWriter final : public TableWriter {
  public:
    /// Arrays hold every digit: of the options none concerns them.
    NpyTableWriter(ByteSink& sink, std::span<const std::string> names, const WriteOptions& /*options*/)
        : array_(sink, descr_of(names), ",") {}
    void rows(std::span<const std::span<const double>> columns) override {
        const std::size_t count = columns.empty() ? 0 : columns[0].size();
        const std::size_t width = 8 * columns.size();
        bytes_.resize(count * width);
        for (std::size_t c = 0; c < columns.size(); ++c)
            store_column(bytes_.data(), width, {"", 'f', 8, false, 8 * c}, columns[c]);
        array_.put(bytes_, count);
    }
    void end() override { array_.end(); }

  private:
    static std::string descr_of(std::span<const std::string> names) {
        std::vector<std::string> fields;
        for (const std::string& name : names)
            fields.push_back(fmt::format("({}, '<f8')", python_string(name)));
        return fmt::format("[{}]", fmt::join(fields, ", "));
    }

    CountedArray array_;
    std::string bytes_;
};

constexpr std::array<std::string_view, 1> npy_extensions = {".npy"};

bool sniff(std::string_view first_bytes) { return first_bytes.substr(0, npy_magic.size()) == npy_magic; }

ColumnLog make_npy(std::unique_ptr<ByteSource> source, std::string first_bytes,
                   const ReadOptions& /*options*/) {
    const std::string name = source->name();
    read_on(*source, first_bytes, 12);
    if (first_bytes.substr(0, npy_magic.size()) != npy_magic) {
        raise<DataError>(
            "{}: read '{}...', expected a NumPy file, which begins with \\x93NUMPY; leave out --format", name,
            first_bytes.substr(0, 6));
    }
    const std::size_t header_size = npy_header_size(first_bytes);
    if (header_size <= largest_npy_header) read_on(*source, first_bytes, header_size);
    NpyHeader header = parse_npy_header(first_bytes, name);
    if (header.rows == 0)
        raise<DataError>("{}: read an array without rows, expected rows of numbers; check what wrote it",
                         name);
    std::string head = first_bytes.substr(0, header.data_offset);
    first_bytes.erase(0, header.data_offset);
    if (header.by_columns || header.transposed) {
        read_on(*source, first_bytes);
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

const LogFormat formats::npy{
    .name = "npy",
    .summary = "NumPy array files, structured or plain",
    .extensions = npy_extensions,
    .binary = true,
    .sniff = sniff,
    .columns = make_npy,
    .rewrite = rewrite_with<NpyWriter, ColumnReader>,
    .table = table_of<NpyTableWriter>,
};

}  // namespace ripplenotch
