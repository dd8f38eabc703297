// SPDX-License-Identifier: MIT
#pragma once
// The front door of the log room: open a log as a stream, or read a whole log into memory with an account of
// it.

#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "ripplenotch/core/files.hpp"
#include "ripplenotch/core/trace.hpp"
#include "ripplenotch/log/format.hpp"
#include "ripplenotch/log/layout.hpp"
#include "ripplenotch/log/recording.hpp"

namespace ripplenotch {

/// A log of one joint.
struct Log {
    Layout layout;
    Trace trace;  ///< sample_rate is recording.clock.mean_rate; rows at another rate are left out
    Recording recording;
    std::size_t held_bad_values = 0;
    /// Change of position divided by integrated velocity, by robust regression over the log; 1 when the
    /// clock, the velocity unit and the position unit agree. Empty without position or without motion.
    std::optional<double> clock_factor;
    /// Least and greatest of the position column, made continuous, whether or not the trace has it.
    std::optional<std::pair<double, double>> position_range_deg;
};

// A log of any length, gone through several times instead of held: what read_log finds out about a log in
// memory, found out in passing.

/// What is known of the joint that is read after the first pass.
struct LogFacts {
    std::size_t rows = 0;            ///< without those left out
    double mean_s = 0.0;             ///< of the times
    double mean_position_deg = 0.0;  ///< of the continuous position; 0 where there is none
};

class LogPasses {
  public:
    /// Gets consecutive rows, of the joint that options choose; a run starts at their first or nowhere.
    using Use = std::function<void(const TraceView&)>;

    /// A pipe is kept in a temporary file (Spool). `joint`: by its place, where options.every_joint reads
    /// several. Throws what open_log throws.
    LogPasses(const std::string& path, const ReadOptions& options);
    LogPasses(std::shared_ptr<const Spool> log, const ReadOptions& options, std::size_t joint = 0);
    ~LogPasses();
    LogPasses(const LogPasses&) = delete;
    LogPasses& operator=(const LogPasses&) = delete;

    /// Before the first pass: rows that take no more memory than this are kept for the passes behind it,
    /// which then do not read again what costs more to read than to keep.
    void keep_rows(std::size_t most_bytes);
    /// Once, first. Throws DataError as read_log does.
    void first();
    [[nodiscard]] const LogFacts& facts() const;

    /// Once, second: rows with a sample rate, and a continuous position if it is the joint's. Then all is
    /// known that read_log would say.
    void second(const Use& use);
    /// What read_log gives, without rows: after the first pass all but clock_factor, position_range_deg and
    /// the warning about the motion.
    [[nodiscard]] const Log& log() const;

  private:
    class Work;
    std::unique_ptr<Work> work_;
};

/// Opens a path or "-". Format: options.format, else magic bytes, else CSV. Throws FileError, DataError,
/// UsageError.
[[nodiscard]] std::unique_ptr<LogReader> open_log(const std::string& path, const ReadOptions& options);
[[nodiscard]] std::unique_ptr<LogReader> open_log(std::unique_ptr<ByteSource> source,
                                                  const ReadOptions& options);

/// A writer for the rows of `reader` into `path` or "-": byte for byte when formats agree, converted
/// otherwise.
[[nodiscard]] std::unique_ptr<LogWriter> rewrite_log(const std::string& path, const LogReader& reader,
                                                     const LogFormat& format, const WriteOptions& options,
                                                     ByteSink::Overwrite overwrite);

/// Rows that commands hold which look at pieces of a log anyway.
inline constexpr std::size_t most_rows_held = 320'000;
/// No limit: the log is held whole.
inline constexpr std::size_t all_rows = std::numeric_limits<std::size_t>::max();

/// Where a log has more than `most_rows`, the trace holds sixteen pieces, evenly spread, each a run of its
/// own; all else is of the whole log, which is read twice then (a pipe waits in a temporary file), and
/// recording.looked_at says so. Throws what read_log throws. O(most_rows) memory.
[[nodiscard]] Log read_log_in_part(const std::string& path, const ReadOptions& options,
                                   std::size_t most_rows = most_rows_held);
/// read_log of a log with at most so many rows; nothing of a longer one.
[[nodiscard]] std::optional<Log> read_log_if_short(const Spool& log, const ReadOptions& options,
                                                   std::size_t most_rows);
/// Each of several joints that options.joint asks for, as read_log gives it, in one pass; none where there
/// are fewer than two, where options state columns or hold bad values, and where all of them together have
/// more than `most_rows`.
[[nodiscard]] std::vector<Log> read_each_if_short(const Spool& log, const ReadOptions& options,
                                                  std::size_t most_rows);
/// Each joint that options.joint asks for, as read_log_in_part gives it.
[[nodiscard]] std::vector<Log> read_joints_in_part(const std::string& path, const ReadOptions& options,
                                                   std::size_t most_rows = most_rows_held);
/// Those joints by their names, "" for one that has no name, and what is left out of them.
struct AskedJoints {
    std::vector<std::string> names;
    std::vector<LeftOutJoint> left_out;
};
[[nodiscard]] AskedJoints asked_joints(const Spool& log, ReadOptions options);

/// Reads everything. With several joints in options.joint use read_joints_in_part. Throws what open_log
/// throws, and DataError where options.needs_torque and the clock is of no use (ClockFacts::refusal).
[[nodiscard]] Log read_log(const std::string& path, const ReadOptions& options);
[[nodiscard]] Log read_log(std::unique_ptr<ByteSource> source, const ReadOptions& options);
[[nodiscard]] Log read_log(LogReader& reader, const ReadOptions& options);

/// All joints that have a velocity or position and a torque (options.torque_of_each), in one pass: their rows
/// are the same. The torque of a joint without one is not a number. What the layout says holds for all
/// of them. In the pieces of read_log_in_part where there are more than `most_rows`: the log is gone through
/// twice for each joint then. O(joints most_rows) memory. Throws what open_log and read_log throw.
[[nodiscard]] std::vector<Log> read_joints_at_once(const std::string& path, const ReadOptions& options,
                                                   std::size_t most_rows = all_rows);

}  // namespace ripplenotch
