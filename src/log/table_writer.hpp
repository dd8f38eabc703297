// SPDX-License-Identifier: MIT
#pragma once
// New logs, written in the tool's own units: what conversion between formats and write_columns share.

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "ripplenotch/log/format.hpp"

namespace ripplenotch {

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

}  // namespace ripplenotch
