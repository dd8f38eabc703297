// SPDX-License-Identifier: MIT
#pragma once
// The entries of the format registry, declared from its one list.

#include <utility>

#include "log/table_writer.hpp"

namespace ripplenotch {

// What the entries are made of: a format is its reader, its writer and its writer of tables.

template <class Writer, class Reader>
std::unique_ptr<LogWriter> rewrite_with(std::unique_ptr<ByteSink> sink, const LogReader& reader,
                                        const WriteOptions& options) {
    return std::make_unique<Writer>(std::move(sink), dynamic_cast<const Reader&>(reader.base()), options);
}

template <class Table>
std::unique_ptr<TableWriter> table_of(ByteSink& sink, const WriteOptions& options) {
    return std::make_unique<Table>(sink, options);
}

template <class Table>
std::unique_ptr<LogWriter> convert_with(std::unique_ptr<ByteSink> sink, const LogReader& reader,
                                        const WriteOptions& options) {
    return convert_rows(std::move(sink), reader, options, table_of<Table>);
}

template <class Table>
void write_columns_with(ByteSink& sink, std::span<const NumberColumn> columns) {
    write_table(sink, columns, table_of<Table>);
}

namespace formats {

#define FORMAT(name) extern const LogFormat name;
#include "log/formats/formats.def"
#undef FORMAT

}  // namespace formats

}  // namespace ripplenotch
