// SPDX-License-Identifier: MIT
#pragma once
// The clock of a log, row by row: what its rate is, where it stumbles and where it changes. Whoever reads a
// log, whole or in passing, asks this one, so that all say the same of it.

#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ripplenotch/core/quantity.hpp"
#include "ripplenotch/log/layout.hpp"

namespace ripplenotch {

// The rate of times that run at one rate.

/// A gap is a step of more than so many usual ones.
inline constexpr double gap_steps = 10.0;

/// A controller's rate when the measured rate, or its period, is within 0.1 % of a number with two
/// significant digits: that number, so that two logs of one controller get the same coefficients. 1000.3 Hz
/// gives 1000 Hz, 124.96 Hz (8.0026 ms) gives 125 Hz, 978.4 Hz stays.
[[nodiscard]] Hertz nominal_rate(Hertz measured);

/// Steps and rates of times that run at one rate.
struct RateEstimate {
    Hertz nominal, mean;
    double step_s = 0.0;  ///< median of the steps that advance; 0 when none does
};
[[nodiscard]] RateEstimate estimate_rate(std::span<const double> time_s);

/// Filters are designed before the log's end is known, so the clock is judged by so many first rows.
inline constexpr std::size_t clock_rows = 16384;
inline constexpr std::size_t most_listed_gaps = 1000;
inline constexpr double rate_worth_a_word = 0.005;  ///< share by which two rates may differ unmentioned
inline constexpr double rate_refused = 0.05;  ///< share by which a filter's rate may differ from its rows'

/// A step longer than the gap limit: rows `row` and `row + 1` belong to different runs.
struct Gap {
    std::size_t row = 0;  ///< last row before the gap, 0-based
    double from_s = 0.0, to_s = 0.0;
};

/// From here on the steps are of another length, for 256 rows at least.
struct RateChange {
    std::size_t row = 0;  ///< last row at the old rate, 0-based
    double time_s = 0.0;  ///< of that row
    Hertz from, to;
};

/// What a clock turned out to be. Rates are 0 where no time passes.
struct ClockFacts {
    std::size_t rows = 0;
    double first_s = 0.0, last_s = 0.0;
    bool stated = false;  ///< the rate is from --sample-rate: there are no times to look at
    std::string refusal;  ///< why nothing can be filtered by this clock, and what to do; empty where it can
    /// What the controller runs at, and filters are designed for: the stated rate, else one over the median
    /// step where steps cluster there and rows are lost or late, else the mean of the first rows; a number of
    /// two digits where one is within 0.1 %.
    Hertz nominal_rate;
    Hertz mean_rate;  ///< rows over time, of the rows at the nominal rate, gaps left out
    Seconds usual_step;
    Seconds shortest_step, longest_step;
    Seconds jitter;         ///< rms deviation of the steps from their mean, of the same rows
    std::vector<Gap> gaps;  ///< the first most_listed_gaps
    std::size_t gap_count = 0;
    Gap longest_gap;
    std::vector<RateChange> rate_changes;
    std::size_t rows_left_out = 0;   ///< at a rate more than rate_refused off the nominal one: not used
    std::size_t repeated_times = 0;  ///< steps of exactly zero
};

/// Consecutive rows of a block that belong together.
struct RunPart {
    std::size_t first = 0, count = 0;
    bool begins_run = false;  ///< what was before is no past of these rows
    bool usable = true;       ///< false: at another rate than the nominal one
};

/// Watches times row by row. What it says of a row depends on the opening and on the rows up to it alone.
class Clock {
  public:
    /// `opening_s`: the first rows' times; nan where the log has none. Of an opening in which the rate
    /// changes, the longest part at one rate tells the nominal one.
    Clock(std::string source, std::span<const double> opening_s, std::optional<Hertz> stated);

    /// The next times, from the first row on, and how they belong together; valid until the next call.
    /// Throws DataError when time runs backward.
    std::span<const RunPart> add(std::span<const double> time_s);
    [[nodiscard]] ClockFacts facts() const;
    [[nodiscard]] Hertz nominal_rate() const { return facts_.nominal_rate; }

    /// Throws DataError with ClockFacts::refusal, where there is one.
    void require() const;

  private:
    static constexpr std::size_t window_steps = 64;  ///< by hand: steps that tell a rate
    struct Rate {
        double step_s = 0.0, rows_step_s = 0.0;  ///< median of advancing steps; time over rows
        Hertz rate;                              ///< as it is told
    };
    struct Window {
        std::size_t first_row = 0;
        std::vector<double> time_s;
    };

    Clock(std::string source, Rate rate, Hertz nominal);
    void open(std::span<const double> opening_s);
    [[nodiscard]] std::string refusal(std::size_t rows) const;
    void run_at(Rate rate);
    void begin_part(std::size_t at, bool usable);
    void begin_run(double time_s, std::size_t at);
    void end_run();
    void sum_up_window();
    std::size_t usual_rows(std::span<const double> time_s) const;
    void add_rows(std::span<const double> time_s);
    void add_odd(double time_s, std::size_t at);
    void add_long(double time_s, std::size_t at);
    void note(const Gap& gap);
    void note_pending_gap();
    void end_slow_spell();
    void end_window();
    void look_closely(std::vector<double> steps_s);
    [[nodiscard]] std::size_t change_row(double step_s) const;
    void change_rate();

    std::string source_;
    bool timed_ = false, advances_ = false;
    double rows_a_time_ = 0.0;   ///< more than 1 where times repeat
    double rows_a_burst_ = 0.0;  ///< 0 where rows do not come in bursts
    Hertz over_all_;             ///< rows over time, gaps included, of the opening
    ClockFacts facts_;
    Rate now_;
    double limit_s_ = 0.0;
    std::vector<RunPart> parts_;
    bool usable_ = true, restart_ = false;
    std::optional<double> last_s_;
    double long_step_s_ = 0.0;        ///< the step before, when it was beyond the limit
    std::optional<Gap> pending_gap_;  ///< or the first step at a slower rate
    std::vector<Gap> slow_steps_;     ///< beyond the limit and alike: gaps, or the clock has slowed down
    Window before_, window_;
    std::size_t summed_up_ = 0;  ///< of the window's times: steps up to this one are in the sums
    std::size_t odd_windows_ = 0, odd_row_ = 0;
    double odd_step_s_ = 0.0, odd_since_s_ = 0.0, odd_row_s_ = 0.0;
    double shortest_s_ = std::numeric_limits<double>::infinity(), longest_s_ = 0.0;
    std::optional<double> run_begin_s_;        ///< of the run under way, if its rows are used
    double duration_s_ = 0.0, squares_ = 0.0;  ///< of the runs that are over; of steps about the usual one
    std::size_t steps_ = 0;
};

/// What there is to say about gaps, changes of rate, repeated times and a mean far from the nominal rate.
[[nodiscard]] std::vector<LogWarning> clock_warnings(const ClockFacts& clock);

}  // namespace ripplenotch
