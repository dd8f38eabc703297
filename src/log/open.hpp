// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <deque>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "ripplenotch/core/files.hpp"
#include "ripplenotch/log/format.hpp"

namespace ripplenotch {

// The first rows of a log, by which its clock and its position are judged before anything is done with them.

struct Opening {
    std::deque<RowBlock> blocks;      ///< read ahead
    std::vector<std::size_t> counts;  ///< rows of each block that belong to the opening
    std::vector<double> time_s;       ///< of those
    bool whole_log = false;           ///< nothing is left in the reader
};

/// The first clock_rows rows; fewer of wide logs, still a second or so. Which rows these are depends on the
/// log alone, not on how its bytes arrive: a pipe and a file must give the same coefficients.
[[nodiscard]] Opening read_opening(LogReader& reader);

/// The blocks read ahead, then those of the reader; false when there are none left.
bool next_block(Opening& opening, LogReader& reader, RowBlock& block);

// Internal to the log room: which format the first bytes of a file are.

/// What detect_format() looks at.
inline constexpr std::size_t first_bytes_size = 512;

/// The one of `formats` that knows these bytes, else CSV, whose own messages say what is wrong with them.
/// Throws DataError, naming `source`, for files of other kinds that people hand over by mistake.
[[nodiscard]] const LogFormat& detect_format(std::string_view first_bytes, const std::string& source,
                                             std::span<const LogFormat* const> formats = log_formats());

/// Appends to `bytes` until there are `size` or the source ends; true when it ended before. The room grows
/// with what comes: most logs are short of what is asked for.
bool read_on(ByteSource& source, std::string& bytes, std::size_t size = static_cast<std::size_t>(-1));

// The entries of the format registry, declared from its one list, and what they are made of.

/// Writes a table of numbers a few rows at a time. The sink is the caller's, and so is finishing it.
class TableWriter {
  public:
    virtual ~TableWriter() = default;
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
std::unique_ptr<TableWriter> table_of(ByteSink& sink, std::span<const std::string> names,
                                      const WriteOptions& options) {
    return std::make_unique<Table>(sink, names, options);
}

namespace formats {

#define FORMAT(name) extern const LogFormat name;
#include "log/formats/formats.def"
#undef FORMAT

}  // namespace formats

}  // namespace ripplenotch
