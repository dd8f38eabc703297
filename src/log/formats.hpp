// SPDX-License-Identifier: MIT
#pragma once
// The entries of the format registry, declared from its one list, and what they are made of.

#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "ripplenotch/log/format.hpp"

namespace ripplenotch {

// New logs, written in the tool's own units: what conversion between formats and write_columns share.

/// Writes a table of numbers a few rows at a time. The sink is the caller's, and so is finishing it.
class TableWriter {
  public:
    virtual ~TableWriter() = default;
    virtual void begin(std::span<const std::string> names) = 0;
    /// One span a column, of equal length.
    virtual void rows(std::span<const std::span<const double>> columns) = 0;
    virtual void end() = 0;
};

using MakeTableWriter = std::unique_ptr<TableWriter> (*)(ByteSink& sink, const WriteOptions& options);

/// The chosen joint's time_s, velocity_deg_s, torque_nm and position_deg as a new log in another format; with
/// options.append the new torque in a column of its own.
[[nodiscard]] std::unique_ptr<LogWriter> convert_rows(std::unique_ptr<ByteSink> sink, const LogReader& reader,
                                                      const WriteOptions& options, MakeTableWriter make);

/// All columns at once. Throws std::invalid_argument when their lengths differ.
void write_table(ByteSink& sink, std::span<const NumberColumn> columns, MakeTableWriter make);

/// Names of the columns that WriteOptions::append adds in the style of the torques' names, one for each joint
/// that is read; with its joint's name before it where there are several.
[[nodiscard]] std::vector<std::string> appended_names(const Layout& layout, const WriteOptions& options);

// A format is its reader, its writer and its writer of tables.

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
