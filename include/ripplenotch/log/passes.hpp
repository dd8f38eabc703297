// SPDX-License-Identifier: MIT
#pragma once
// A log of any length, gone through several times instead of held: what read_log finds out about a log in
// memory, found out in passing.

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "ripplenotch/core/spool.hpp"
#include "ripplenotch/core/trace.hpp"
#include "ripplenotch/log/layout.hpp"
#include "ripplenotch/log/recording.hpp"

namespace ripplenotch {

/// Of the joint that is read, known after the first pass.
struct LogFacts {
    std::size_t rows = 0;  ///< without those left out
    Hertz sample_rate;     ///< ClockFacts::mean_rate
    double first_s = 0.0, last_s = 0.0;
    double mean_s = 0.0;             ///< of the times
    double mean_position_deg = 0.0;  ///< of the continuous position; 0 where there is none
    std::size_t held_bad_values = 0;
    // Known after the second pass, as in Log:
    std::optional<double> clock_factor;
    std::optional<std::pair<double, double>> position_range_deg;
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
    /// Once, first: rows without a sample rate, their position as it stands in the file. Throws DataError as
    /// read_log does.
    void first(const Use& use);
    [[nodiscard]] const LogFacts& facts() const;

    /// Once, second: rows with a sample rate, and a continuous position if it is the joint's. Then all is
    /// known that read_log would say.
    void second(const Use& use);
    [[nodiscard]] const Layout& layout() const;        ///< as Log::layout
    [[nodiscard]] const Recording& recording() const;  ///< as Log::recording

    /// Any number of times: as second.
    void again(const Use& use);

  private:
    class Work;
    std::unique_ptr<Work> work_;
};

}  // namespace ripplenotch
