// SPDX-License-Identifier: MIT
#pragma once
// A log of any length through a filter in bounded memory: reader, blocks, filter, writer. Gaps in time split
// the log into runs that share nothing.

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ripplenotch/core/quantity.hpp"
#include "ripplenotch/core/spec.hpp"
#include "ripplenotch/core/trace.hpp"
#include "ripplenotch/design/candidate_table.hpp"
#include "ripplenotch/design/running_design.hpp"
#include "ripplenotch/filter/method.hpp"
#include "ripplenotch/log/format.hpp"
#include "ripplenotch/log/recording.hpp"

namespace ripplenotch {

/// The keys of method switching, with the table's own values where they are left out.
[[nodiscard]] SwitchingDesign switching_design(const Settings& settings, Hertz sample_rate,
                                               const CandidateTable& table);

/// The rate that a table was designed for, and that of a log.
struct TableAndLogRate {
    Hertz table, log;
};
/// A warning when a table's rate differs from the log's by more than rate_worth_a_word. Throws DataError,
/// naming both rates and the remedy, by more than rate_refused.
[[nodiscard]] std::optional<std::string> table_rate_warning(const TableAndLogRate& rates,
                                                            const std::string& source);

struct TimedSwitch {
    Switch change;
    double time_s = 0.0;
};

/// Properties of a whole log, for one of its joints.
struct StreamReport {
    Recording recording;
    std::size_t held_bad_values = 0;    ///< cells replaced because the caller requested it
    std::vector<TimedSwitch> switches;  ///< as listed by the filter
    std::size_t switch_count = 0;
    double slowest_deg_s = 0.0, fastest_deg_s = 0.0;  ///< range of |v|; both 0 without a row
};

/// A column other than the motion, along the rows of the same log.
class RowValues {
  public:
    virtual ~RowValues() = default;
    /// The values of the next `count` rows; valid until the next call. Throws what reading throws.
    virtual std::span<const double> next(std::size_t count) = 0;
};

/// Rows of a log with what a filter made of them, kept while they go by so that both can be measured.
struct KeptRows {
    /// Stretches of a long log only, ever further apart: enough for a warning, at a cost that grows with the
    /// logarithm of the log's length.
    bool sparsely = false;
    Trace trace;                 ///< without position unless all of them have one
    std::vector<double> out_nm;  ///< the filtered torque
    std::size_t rows = 0;        ///< that went by
    bool breaks = false;         ///< the next one that is kept begins a run
};
/// The first so many rows, 50 MB, are kept at most.
inline constexpr std::size_t most_rows_kept = std::size_t{1} << 20U;

/// The processing of one joint.
struct JointRun {
    CausalFilter* filter = nullptr;
    KeptRows* kept = nullptr;  ///< or null
    /// Ripple of the motors of other joints, Nm, taken from the torque before the filter; or null.
    RowValues* other_ripple = nullptr;
};

/// One log on its way through a filter, or through one filter for each joint that is read.
class LogStream {
  public:
    /// Reads the first clock_rows rows (fewer when they are wide) and determines the clock of the log from
    /// them. Throws DataError when there is no time
    /// and no stated rate, fewer than two rows, or time that does not advance.
    explicit LogStream(std::unique_ptr<LogReader> reader);
    ~LogStream();
    LogStream(LogStream&&) noexcept;

    [[nodiscard]] const LogReader& reader() const;
    /// The rate that filters are designed for: ClockFacts::nominal_rate.
    [[nodiscard]] Hertz design_rate() const;
    /// Most digits after the decimal mark in the torque cells of the first rows; empty for logs that are not
    /// text.
    [[nodiscard]] std::optional<int> torque_decimals() const;

    /// Carries the whole log through the filters, once: one for each joint, in the order of
    /// Layout::all_chosen(), and a report for each. Rows at another rate than the nominal one pass as they
    /// are. `writer` may be null. Throws DataError when time runs backward. The result is the same for any
    /// number of `threads`; logs that were read whole at once take one.
    std::vector<StreamReport> run(std::span<const JointRun> joints, LogWriter* writer,
                                  std::size_t threads = 1);
    /// The same for a log that is read for one joint.
    StreamReport run(CausalFilter& filter, LogWriter* writer, KeptRows* kept, std::size_t threads = 1);

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace ripplenotch
