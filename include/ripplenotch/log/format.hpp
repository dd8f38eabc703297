// SPDX-License-Identifier: MIT
#pragma once
// A log format is a record: one file in src/log/formats, one line in formats.def. Law tests run over the
// whole list.

#include <cstdint>
#include <exception>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ripplenotch/core/files.hpp"
#include "ripplenotch/log/layout.hpp"

namespace ripplenotch {

/// One joint's part of consecutive rows, in the tool's units, and where its torque stands in their bytes.
struct JointRows {
    std::vector<double> velocity_deg_s, torque_nm, position_deg;  ///< equal lengths; position may be empty
    std::vector<std::uint32_t> torque_begin,
        torque_end;  ///< per row, offsets into the block's bytes of the torque cell
};

/// A run of consecutive rows, in the tool's units, with the bytes they came from. Reused between calls; the
/// vectors keep their capacity.
struct RowBlock {
    std::size_t first_row = 0;  ///< 0-based number of the first row in the log
    std::vector<double> time_s;
    std::vector<JointRows> joints = std::vector<JointRows>(1);  ///< as Layout::all_chosen()
    std::string bytes;                   ///< the rows as they stand in the file, line ends included
    std::vector<std::uint32_t> row_end;  ///< per row, offset just past the row's last byte of content
    std::exception_ptr failure;       ///< what is wrong behind the last row; for when the rows are done with
    std::size_t parsed_bytes = 0;     ///< of `bytes`; between LogReader's steps only
    std::size_t held_bad_values = 0;  ///< cells replaced because hold_bad_values was set

    [[nodiscard]] std::size_t size() const { return time_s.size(); }
    /// Forgets the rows, not their bytes.
    void drop_rows() {
        time_s.clear();
        row_end.clear();
        for (JointRows& joint : joints) {
            for (auto* values : {&joint.velocity_deg_s, &joint.torque_nm, &joint.position_deg})
                values->clear();
            for (auto* places : {&joint.torque_begin, &joint.torque_end}) places->clear();
        }
        held_bad_values = parsed_bytes = 0;
        failure = nullptr;
    }
    void clear() {
        drop_rows();
        bytes.clear();
    }
};

/// Reads one log from start to end in bounded memory.
class LogReader {
  public:
    virtual ~LogReader() = default;
    [[nodiscard]] virtual const Layout& layout() const = 0;
    /// The reader of the file itself, for writers that know it.
    [[nodiscard]] virtual const LogReader& base() const { return *this; }
    /// Fills `block` with the next rows; false when there are none left. Block boundaries carry no meaning; a
    /// block may hold bytes and no row (comments). Throws DataError with file, line and column.
    virtual bool next(RowBlock& block) = 0;

    /// next() in three steps, so that several blocks can be parsed at once: fetch() and accept() take the
    /// blocks one after another, in the order of the log, parse() takes any number of them at a time. A row
    /// that is wrong ends the block before it and is its `failure`, so that what has been done until then
    /// does not depend on how the bytes arrived; next() throws it.
    virtual bool fetch(RowBlock& block) { return next(block); }
    virtual void parse(RowBlock& /*block*/) const {}
    virtual void accept(RowBlock& /*block*/) {}
};

struct WriteOptions {
    enum class Decimals { shortest, fixed };
    Decimals decimals = Decimals::shortest;
    int fixed_decimals = 6;                       ///< by hand: a micronewton-metre
    bool append = false;                          ///< add a column instead of replacing the torque
    std::string append_name = "torque_filtered";  ///< its name; a unit is added as in the torque column
};

/// Filtered torque of a block, in newton-metres: one vector of block.size() entries for each of its joints.
using Torques = std::span<const std::vector<double>>;

/// Writes rows that a reader gave, with other torque values, in the units of their columns.
class LogWriter {
  public:
    virtual ~LogWriter() = default;
    /// prepare() and put().
    void write(RowBlock& block, Torques torque_nm) {
        std::string room;
        put(block, torque_nm, prepare(block, torque_nm, room));
    }
    /// Makes the bytes, of several blocks at a time; they stand in `room`, which only grows, or in place of
    /// block.bytes. Writers that have nothing to prepare do all in put().
    virtual std::string_view prepare(RowBlock& /*block*/, Torques /*torque_nm*/,
                                     std::string& /*room*/) const {
        return {};
    }
    /// Takes the blocks one after another.
    virtual void put(const RowBlock& block, Torques torque_nm, std::string_view bytes) = 0;

    /// Completes the file; nothing appears under its name before.
    virtual void finish() = 0;
};

/// A table of named numeric columns to be written as a new log (simulate, conversions, spectra).
struct NumberColumn {
    std::string name;  ///< with its unit: "torque_nm"
    std::vector<double> values;
};

struct ColumnLog;
class TableWriter;

/// One format: a record of its file.
struct LogFormat {
    std::string_view name, summary;
    std::span<const std::string_view> extensions;  ///< ".csv", ".txt"
    bool binary = false;
    /// Never found out from a file's bytes, which may be anything: it has to be said, with what is in a
    /// record.
    bool told = false;
    /// The library without which this build cannot open such files; empty where it can.
    std::string_view lacks = {};
    /// True when these first bytes of a file are surely this format. Null for CSV, which is what a file is
    /// that no other format knows.
    bool (*sniff)(std::string_view first_bytes) = nullptr;
    /// `first_bytes` have been read from `source` already and come before what it still holds. Where
    /// options.range is given, the rows outside are as if they were not there, and the layout has `outside`;
    /// a format that cannot leave rows out opens the whole log, and the range is then refused. Throws
    /// UsageError where the range is none or keeps fewer than two rows.
    std::unique_ptr<LogReader> (*open)(std::unique_ptr<ByteSource> source, std::string first_bytes,
                                       const ReadOptions& options) = nullptr;
    /// In its place: all rows of the log as columns of numbers.
    ColumnLog (*columns)(std::unique_ptr<ByteSource> source, std::string first_bytes,
                         const ReadOptions& options) = nullptr;
    /// A writer for rows of a log that was read in this same format: other columns pass byte for byte. Null
    /// where such rows are written as those of any log.
    std::unique_ptr<LogWriter> (*rewrite)(std::unique_ptr<ByteSink> sink, const LogReader& reader,
                                          const WriteOptions& options) = nullptr;
    /// A writer of tables of numbers with these names. Null where the format is read and not written.
    std::unique_ptr<TableWriter> (*table)(ByteSink& sink, std::span<const std::string> names,
                                          const WriteOptions& options) = nullptr;

    [[nodiscard]] bool is_written() const { return table != nullptr; }
    /// Writes columns of equal length as a new log; finishing the sink stays with the caller. Throws
    /// std::invalid_argument when their lengths differ.
    void write_columns(ByteSink& sink, std::span<const NumberColumn> columns) const;
};

/// All formats, in the order of formats.def.
[[nodiscard]] std::span<const LogFormat* const> log_formats();
/// What this build cannot read for want of a library: "hdf5 (libhdf5)", "lz4 (liblz4)". Mostly none.
[[nodiscard]] std::vector<std::string> formats_not_built();
/// Throws UsageError that lists the known names.
[[nodiscard]] const LogFormat& find_log_format(std::string_view name);
/// The names of those that are written, as people read them: "csv, npy".
[[nodiscard]] std::string written_log_formats();
/// Throws UsageError, naming `output` and the formats that are written, when `format` is only read.
void require_written(const LogFormat& format, const std::string& output);
/// The format of an output: `asked` if given, else by the path's extension, else CSV. ("-" has no extension.)
/// Throws UsageError where that format is only read.
[[nodiscard]] const LogFormat& output_format(const std::string& path, std::optional<std::string_view> asked);
/// The same for the rows of a log that was read in `log`. Throws UsageError, too, where nothing says the
/// output's format and the log's own is only read: nobody asked for another.
[[nodiscard]] const LogFormat& output_format(const std::string& path, std::optional<std::string_view> asked,
                                             const LogFormat& log);

}  // namespace ripplenotch
