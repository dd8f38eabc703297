// SPDX-License-Identifier: MIT
#pragma once
// Several methods side by side: on signals of the tool's own making, or on a log.

#include <array>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/core/quantity.hpp"
#include "ripplenotch/core/trace.hpp"
#include "ripplenotch/evaluate/contender.hpp"
#include "ripplenotch/evaluate/ledger.hpp"

namespace ripplenotch {

struct OrderAttenuation {
    double order = 0.0;
    double hz = 0.0;  ///< frequency of the line; on a log its mean
    std::optional<double>
        db;  ///< empty where the line is not below half the sample rate, or was not measured
    GearRatio ratio = no_ratio;  ///< under which the order counts

    /// "order 2", "200/turn"
    [[nodiscard]] std::string name() const { return order_in_words(Order(order), ratio); }
};

/// Performance and cost of one method; values that were not requested or are not available are empty.
struct MethodFigures {
    std::string method;                              ///< as it would be typed
    std::string note;                                ///< e.g. "band 4: 72-90 deg/s"
    std::optional<std::array<double, 4>> settle_ms;  ///< per entry of settle_bands_percent (bench.hpp)
    std::optional<double> overshoot_percent, ramp_delay_ms, dc_delay_ms;
    std::optional<double> phase_lag_deg, crossover_db;  ///< at Comparison::crossover
    std::vector<LedgerEntry> ledger;                    ///< empty unless requested
    std::optional<DegPerSec> within_from;               ///< lowest speed above which it keeps a delay limit
    std::vector<OrderAttenuation> attenuation;
    std::optional<double> ripple_rms_nm;  ///< ripple of the orders alone, over the measured windows
    std::optional<double> residual_rms_nm,
        residual_peak_to_peak_nm;             ///< torque minus its trend, as RippleMeter does
    std::optional<double> distortion_rms_nm;  ///< how far it moves that trend
    std::optional<std::size_t> switches;
    std::optional<double> largest_jump_nm;  ///< at a change of filter; empty for methods that do not switch
    std::vector<SwitchEntry>
        switch_ledger;                   ///< on a log: its changes of filter; at most most_listed_switches
    std::optional<double> error_rms_nm;  ///< against ComparedLog::truth_nm
};

/// The part of its method; a contender's where no method has this name.
[[nodiscard]] MethodPart part_of(const MethodFigures& figures);

// What a method does to a torque without ripple.

struct Distortion {
    double in_band_nm = 0.0;  ///< output minus torque within the band, rms
    double added_nm = 0.0;    ///< above the band: by how much its octaves are stronger, rms, added up
};

/// Phase delay and gain over a band, smallest and largest.
struct BandResponse {
    Seconds least_delay, longest_delay;
    double least_gain = 1.0, largest_gain = 1.0;
};

/// One method on the log.
struct JudgedMethod {
    MethodFigures figures;
    /// The longest, at 0 Hz and within the torque's band, at speeds of the log, and where; empty where it is
    /// not known.
    std::optional<Seconds> delay;
    DegPerSec delay_at;
    std::optional<BandResponse> response;  ///< at the log's median speed
    double multiplications = 0.0;          ///< and divisions in a sample
    Distortion distortion;                 ///< of the log's torque without ripple
    double error_nm = 0.0;  ///< of its output: remaining ripple and distortion, root of the sum of squares
    std::vector<std::string> shortfalls;  ///< one clause for each limit that it breaks
    double excess = 0.0;                  ///< by how much, as a share of the limits, added up; 0: none

    [[nodiscard]] bool meets() const { return shortfalls.empty(); }
};

struct Comparison {
    Hertz sample_rate;
    DegPerSec speed;  ///< for delays and attenuation; on a log its median moving speed
    std::optional<double> step_nm, ramp_nm_s;
    std::optional<Hertz> crossover;           ///< crossover of the control loop
    std::optional<Seconds> max_delay;         ///< a limit of the user's
    std::optional<DegPerSec> no_notch_below;  ///< no notch of any method can keep it there
    std::optional<GearAccount>
        lines;  ///< amplitudes weigh them where there is no log; without, all are alike
    std::vector<MethodFigures> methods;
    bool on_log = false;
    DegPerSec slowest, fastest;         ///< |v| of the log
    std::size_t rows = 0, windows = 0;  ///< rows of the log; windows that RippleMeter measured
    double raw_ripple_rms_nm = 0.0;     ///< LogLevels::raw_ripple_rms_nm
    double measured_share = 0.0;
    std::string why_none;              ///< LogLevels::why_none
    std::string best_sentence;         ///< on a log: recommendation_verdict() of its methods
    std::optional<JudgedMethod> best;  ///< empty where it cannot be told, or none is within the limits

    /// The method that the others are compared with: the first contender, else the first rival. Null when
    /// only the control runs.
    [[nodiscard]] const MethodFigures* subject() const;
    /// The first of the rivals, else the first other method; null when there is no other.
    [[nodiscard]] const MethodFigures* rival() const;
};

/// The name of a method among the others of a comparison: as it was typed where that is short; a long one by
/// its name where no other has it, else with the keys that distinguish it from those:
/// "switching,transition=parallel"; where those are long too, with a letter: "switching B".
[[nodiscard]] std::string short_name(const MethodFigures& figures, const Comparison& comparison);

/// One sentence with numbers: how subject and rival differ in settling, delay and ripple.
[[nodiscard]] std::string differences(const Comparison& comparison);

/// Which method is best, on a log, and how subject and rival differ.
[[nodiscard]] std::string verdict(const Comparison& comparison);

/// Fills settling, delays and, with lines, attenuations measured with sines. Empty optionals are left out.
[[nodiscard]] MethodFigures measure_on_signals(const Contender& contender, Hertz sample_rate, DegPerSec speed,
                                               std::optional<double> step_nm, std::optional<double> ramp_nm_s,
                                               const GearAccount* lines);

/// A log in memory.
struct ComparedLog {
    TraceView trace;  ///< its sample_rate is the rate that the filters are designed for
    std::span<const double> truth_nm =
        {};  ///< the torque without ripple and noise, row by row, where it is known
    /// Receives the output of each method, counted from 0, for each block of the log, in the order of the
    /// rows; may be empty.
    std::function<void(std::size_t method, const TraceView& block, std::span<const double> out_nm,
                       std::span<const double> truth_nm)>
        watch = {};
};

/// Median of |v| over the samples that move: faster than a twentieth of the fastest. 0 for a log without
/// motion.
[[nodiscard]] DegPerSec median_moving_speed(const TraceView& trace);

/// The output of one method, row by row.
[[nodiscard]] std::vector<double> output_on_log(const Contender& contender, const ComparedLog& log);

/// The remaining ripple of the log after each method: all run over the log together, and are measured on the
/// same windows.
struct LogLevels {
    std::vector<MethodFigures> methods;  ///< one per contender: attenuation, ripple, residual, switches
    double raw_ripple_rms_nm = 0.0;      ///< of the log as it is
    std::size_t windows = 0;
    double measured_share = 0.0;
    std::string why_none;  ///< a clause with the reason why no window could be measured
};
[[nodiscard]] LogLevels measure_on_log(std::span<const Contender> contenders, const ComparedLog& log,
                                       const GearAccount& lines);

}  // namespace ripplenotch
