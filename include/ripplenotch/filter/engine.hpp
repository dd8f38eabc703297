// SPDX-License-Identifier: MIT
#pragma once
// A log of any length through a filter in bounded memory: reader, blocks, filter, writer. Gaps in time split
// the log into runs that share nothing.

#include <cstddef>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "ripplenotch/analysis/ripple_meter.hpp"
#include "ripplenotch/core/units.hpp"
#include "ripplenotch/filter/method.hpp"
#include "ripplenotch/log/format.hpp"
#include "ripplenotch/log/timebase.hpp"

namespace ripplenotch {

/// A filter is designed before the log's end is known, so its clock is read off the first rows.
inline constexpr std::size_t clock_rows = 16384;
inline constexpr std::size_t most_listed_gaps = 1000;
inline constexpr double rate_worth_a_word = 0.005;  ///< share by which two rates may differ unmentioned
inline constexpr double rate_refused = 0.05;  ///< share by which a table's rate may differ from the log's

/// The rate a controller was meant to run at: when the rate, or the period, is within 0.1 % of a number with
/// two significant digits, that number, so that two logs of one controller get the same coefficients; else
/// the rate itself. 1000.3 Hz gives 1000 Hz, 124.96 Hz (8.0026 ms) gives 125 Hz, 978.4 Hz stays.
[[nodiscard]] Hertz nominal_rate(Hertz measured);

/// Throws DataError naming both rates and the remedy when a table's rate differs from the log's by more than
/// rate_refused.
void refuse_table_rate(Hertz table, Hertz log, const std::string& source);
/// A warning when they differ by more than rate_worth_a_word.
[[nodiscard]] std::optional<std::string> table_rate_warning(Hertz table, Hertz log,
                                                            const std::string& source);

/// Both in turn, for a log whose rate is known from the start.
[[nodiscard]] std::optional<std::string> compare_table_rate(Hertz table, Hertz log,
                                                            const std::string& source);

struct TimedSwitch {
    Switch change;
    double time_s = 0.0;
};

/// What a whole log turned out to be, for one of its joints.
struct StreamReport {
    std::size_t rows = 0;
    Hertz measured_rate;    ///< of the whole log, gaps left out
    std::vector<Gap> gaps;  ///< the first most_listed_gaps
    std::size_t gap_count = 0;
    std::size_t repeated_times = 0;     ///< steps of exactly zero
    std::size_t held_samples = 0;       ///< rows that repeat the row before while the joint moves
    std::size_t held_bad_values = 0;    ///< cells replaced because the caller asked for it
    std::vector<TimedSwitch> switches;  ///< as listed by the filter
    std::size_t switch_count = 0;
    double slowest_deg_s = 0.0, fastest_deg_s = 0.0;  ///< of |v|; both 0 without a row
};

/// What one joint goes through. The meter may be null; it gets two signals, raw and filtered torque.
struct JointRun {
    CausalFilter* filter = nullptr;
    RippleMeter* meter = nullptr;
};

/// One log on its way through a filter, or through one filter for each joint that is read.
class LogStream {
  public:
    /// Reads the first clock_rows rows (fewer when they are wide) and measures their rate. A gap is a step of
    /// more than `gap_steps` median steps. Throws DataError when there is no time and no stated rate, fewer
    /// than two rows, or time that does not advance.
    LogStream(std::unique_ptr<LogReader> reader, double gap_steps);

    [[nodiscard]] const LogReader& reader() const { return *reader_; }
    [[nodiscard]] Hertz measured_rate() const { return measured_rate_; }  ///< of the first rows
    /// What filters are designed for: the stated rate, else nominal_rate(measured_rate()).
    [[nodiscard]] Hertz design_rate() const { return design_rate_; }
    /// Most digits after the decimal mark in the torque cells of the first rows; empty for logs that are not
    /// text.
    [[nodiscard]] std::optional<int> torque_decimals() const { return torque_decimals_; }

    /// Carries the whole log through the filters, once: one for each joint, in the order of
    /// Layout::all_chosen(), and a report for each. `writer` may be null. Throws DataError when time runs
    /// backward. The result is the same for any number of `threads`; logs that were read whole at once take
    /// one.
    std::vector<StreamReport> run(std::span<const JointRun> joints, LogWriter* writer,
                                  std::size_t threads = 1);
    /// The same for a log that is read for one joint.
    StreamReport run(CausalFilter& filter, LogWriter* writer, RippleMeter* meter, std::size_t threads = 1);

  private:
    std::vector<double> read_head();  ///< times
    void note_head(const RowBlock& block, std::size_t count);
    void measure_clock(const std::vector<double>& head_s, double gap_steps);

    std::unique_ptr<LogReader> reader_;
    std::deque<RowBlock> read_ahead_;
    bool read_whole_ = false;
    Hertz measured_rate_, design_rate_;
    std::optional<int> torque_decimals_;
    std::vector<double> moving_deg_s_;  ///< by joint: slower is standing, as far as held samples go
    double gap_s_ = 0.0;                ///< a longer step is a gap
};

}  // namespace ripplenotch
