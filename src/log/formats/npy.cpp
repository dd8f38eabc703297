// SPDX-License-Identifier: MIT
// NumPy array files: structured arrays, whose field names are column names, and plain two-dimensional ones.

#include <array>

#include "log/formats.hpp"
#include "log/npy_reader.hpp"
#include "log/npy_writer.hpp"

namespace ripplenotch {
namespace {

constexpr std::array<std::string_view, 1> extensions = {".npy"};

bool sniff(std::string_view first_bytes) { return first_bytes.substr(0, npy_magic.size()) == npy_magic; }

std::unique_ptr<LogReader> open(std::unique_ptr<ByteSource> source, std::string first_bytes,
                                const ReadOptions& options) {
    return std::make_unique<NpyReader>(std::move(source), std::move(first_bytes), options);
}

std::unique_ptr<LogWriter> rewrite(std::unique_ptr<ByteSink> sink, const LogReader& reader,
                                   const WriteOptions& options) {
    return std::make_unique<NpyWriter>(std::move(sink), dynamic_cast<const NpyReader&>(reader), options);
}

std::unique_ptr<TableWriter> table(ByteSink& sink, const WriteOptions& /*options*/) {
    return std::make_unique<NpyTableWriter>(sink);
}

std::unique_ptr<LogWriter> convert(std::unique_ptr<ByteSink> sink, const LogReader& reader,
                                   const WriteOptions& options) {
    return convert_rows(std::move(sink), reader, options, table);
}

void write_columns(ByteSink& sink, std::span<const NumberColumn> columns) {
    write_table(sink, columns, table);
}

}  // namespace

const LogFormat formats::npy{
    .name = "npy",
    .summary = "NumPy array files, structured or plain",
    .extensions = extensions,
    .binary = true,
    .sniff = sniff,
    .open = open,
    .rewrite = rewrite,
    .convert = convert,
    .write_columns = write_columns,
};

}  // namespace ripplenotch
