// SPDX-License-Identifier: MIT
#pragma once
// Several methods side by side: on signals of the tool's own making, or on a log.

#include <array>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ripplenotch/analysis/ripple_estimate.hpp"
#include "ripplenotch/analysis/ripple_meter.hpp"
#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/core/quantity.hpp"
#include "ripplenotch/core/trace.hpp"
#include "ripplenotch/evaluate/contender.hpp"

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
    /// Of a step and of a ramp (StepMeasurement, RampMeasurement).
    std::optional<double> overshoot_percent, undershoot_percent, ramp_overshoot_nm;
    std::optional<double> ramp_delay_ms, dc_delay_ms;
    std::optional<double> phase_lag_deg, crossover_db;  ///< at Comparison::crossover
    std::vector<LedgerEntry> ledger;                    ///< empty unless requested
    std::optional<DegPerSec> within_from;               ///< lowest speed above which it keeps a delay limit
    // On a log, the same measurement in every command (measure_on_log):
    std::vector<OrderAttenuation> attenuation;
    std::optional<double> ripple_rms_nm;  ///< remaining ripple of the orders alone, over measured windows
    /// Output minus the torque without ripple and noise (TorqueReference), rms: what methods are ranked by.
    std::optional<double> error_nm;
    std::optional<double> moved_nm;  ///< within the torque's band: output minus torque, both without ripple
    std::optional<double> added_nm;  ///< above the band: by how much octaves of that output are stronger
    /// Largest such error in the first start_seconds of motion, as a multiple of the torque's own.
    std::optional<double> start_ratio;
    std::optional<double> residual_rms_nm,
        residual_peak_to_peak_nm;  ///< torque minus its trend, as RippleMeter does
    std::optional<std::size_t> switches;
    std::optional<double> largest_jump_nm;  ///< at a change of filter; empty for methods that do not switch
    std::vector<SwitchEntry>
        switch_ledger;                   ///< on a log: its changes of filter; at most most_listed_switches
    std::optional<double> error_rms_nm;  ///< against ComparedLog::truth_nm
};

/// The part of its method; a contender's where no method has this name.
[[nodiscard]] MethodPart part_of(const MethodFigures& figures);

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
    std::vector<std::string> shortfalls;   ///< one clause for each limit that it breaks
    double excess = 0.0;                   ///< by how much, as a share of the limits, added up; 0: none

    [[nodiscard]] double error_nm() const { return figures.error_nm.value_or(0.0); }
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
    /// What the only method has given already, row by row; empty: it is run.
    std::span<const double> out_nm = {};
};

/// Median of |v| over the samples that move: faster than a twentieth of the fastest. 0 for a log without
/// motion.
[[nodiscard]] DegPerSec median_moving_speed(const TraceView& trace);

/// The output of one method, row by row.
[[nodiscard]] std::vector<double> output_on_log(const Contender& contender, const ComparedLog& log);

/// The frequencies in which a log's torque moves.
struct TorqueBand {
    Hertz from, to;
    bool stated = false;   ///< by the user
    bool at_rest = false;  ///< the torque does not move above its noise: the band is what the log resolves
    Hertz noise_from;      ///< where its spectrum falls to the noise; `to` where the band is stated
};

/// From 0 Hz to the frequency below which 99 % of the variance above the noise lies, of a torque without
/// ripple: mean and straight line removed, the noise taken as white, at the median density above a quarter of
/// the sample rate. Never less than four periods in the log. Throws DataError for fewer than 64 samples.
[[nodiscard]] TorqueBand torque_band(const TraceView& torque);

/// What a method does to a torque without ripple.
struct Distortion {
    double moved_nm = 0.0, added_nm = 0.0;  ///< as in MethodFigures
};

/// The torque of a log without ripple and noise, estimated from all of it, before and after each row: what a
/// method should give. What is estimated so errs independently of what a method does, as far as the estimate
/// is the best one (the orthogonality principle of least squares). Then the differences of the outputs from
/// it rank methods as their true errors do.
class TorqueReference {
  public:
    /// Borrows the log. `ripple`: the orders that are present are taken out, as ripple_course() fits them.
    /// The rest is smoothed without phase up to TorqueBand::noise_from.
    TorqueReference(const ComparedLog& log, const GearAccount& lines, std::span<const RippleEstimate> ripple,
                    std::optional<TorqueBand> stated);

    [[nodiscard]] const TorqueBand& band() const { return band_; }
    /// Row by row; nan where the ripple is not known; empty where it is known nowhere.
    [[nodiscard]] const std::vector<double>& smooth_nm() const { return smooth_nm_; }
    /// Of a method that runs on the torque less its ripple, over the rows at which that is known; both
    /// band-limited without phase. The method has run over the reflected beginning before, so that its start
    /// (start_ratio) is not part of it. One with a map runs without the ripple known from it.
    [[nodiscard]] Distortion distortion(const Contender& contender) const;
    /// The same of what anything gives for torque_nm().
    [[nodiscard]] Distortion distortion(std::vector<double> out_nm) const;
    [[nodiscard]] const std::vector<double>& torque_nm() const { return torque_nm_; }  ///< less its ripple

  private:
    [[nodiscard]] double power(std::span<const double> values) const;
    [[nodiscard]] std::vector<double> powers_beside(const std::vector<double>& torque_nm) const;
    [[nodiscard]] Trace run_in() const;
    ComparedLog log_;
    std::vector<double> torque_nm_, smooth_nm_, beside_nm2_;
    TorqueBand band_;
};

/// A method that learns is judged from its first sample: seconds of motion that its start is looked for in.
inline constexpr double start_seconds = 2.0;

/// The one measurement of what methods do to a log: all run over the log together, and are measured on the
/// same rows.
struct LogLevels {
    std::vector<MethodFigures> methods;  ///< one per contender
    /// Lines in the log as it is, then in the output of each method; expected gains where one method ran.
    RippleLevels lines;
    double raw_ripple_rms_nm = 0.0;      ///< of the log as it is
    std::string why_none;                ///< a clause with the reason why no window could be measured
    std::vector<RippleEstimate> ripple;  ///< one for each of the lines, as handed over
    std::optional<TorqueBand> band;      ///< empty where nothing tells torque and ripple apart
};
/// What methods are run on besides a log, at one speed.
struct BenchSignals {
    DegPerSec speed;
    double step_nm = usual_step_nm, ramp_nm_s = usual_ramp_nm_s;
};
/// `lines`: null where none are known; then the log is not looked at. `ripple`: of estimate_ripple().
/// `signals`: none is run where it is empty; figures of a method that does not settle on one are left out.
/// `band`: the torque's, where it is stated.
[[nodiscard]] LogLevels measure_on_log(std::span<const Contender> contenders, const ComparedLog& log,
                                       const GearAccount* lines, std::vector<RippleEstimate> ripple,
                                       const std::optional<BenchSignals>& signals,
                                       std::optional<TorqueBand> band = std::nullopt);

}  // namespace ripplenotch
