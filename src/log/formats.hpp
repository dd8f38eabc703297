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

/// Writes a table of numbers a few rows at a time. The sink is the caller's, and so is finishing it.
class TableWriter {
  public:
    virtual ~TableWriter() = default;
    virtual void begin(std::span<const std::string> names) = 0;
    /// One span a column, of equal length.
    virtual void rows(std::span<const std::span<const double>> columns) = 0;
    virtual void end() = 0;
};

/// The time_s, velocity_deg_s, torque_nm and position_deg of the joints that are read as a new log in
/// `format`; with options.append the new torque in a column of its own.
[[nodiscard]] std::unique_ptr<LogWriter> convert_rows(std::unique_ptr<ByteSink> sink, const LogReader& reader,
                                                      const WriteOptions& options, const LogFormat& format);

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

namespace formats {

#define FORMAT(name) extern const LogFormat name;
#include "log/formats/formats.def"
#undef FORMAT

}  // namespace formats

}  // namespace ripplenotch
