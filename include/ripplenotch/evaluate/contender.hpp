// SPDX-License-Identifier: MIT
#pragma once
// A method with its settings, its table and the gear whose ripple it is measured by, ready to be started as
// often as it is needed.

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/core/quantity.hpp"
#include "ripplenotch/core/spec.hpp"
#include "ripplenotch/design/ripple_map.hpp"
#include "ripplenotch/filter/method.hpp"

namespace ripplenotch {

struct Contender {
    std::string text;  ///< as it would be typed: "fixed,centers=25Hz:50Hz,q=0.25"
    const Method* method = nullptr;
    Settings settings;
    std::shared_ptr<const CandidateTable> table = nullptr;  ///< null unless the method needs one
    std::optional<GearAccount> gear = std::nullopt;         ///< empty when unknown
    std::vector<std::string> files = {};                    ///< files of table and gear, each once
    std::shared_ptr<const RippleMap> map = nullptr;         ///< its ripple map, if any
    /// Maps of the motors of other joints, whose ripple is taken from the torque first; of its own map, or of
    /// another file.
    std::vector<RippleMap> others = {};
    /// The same method without its ripple map, where it has one.
    std::shared_ptr<const Contender> without_ripple = nullptr;

    /// A filter without a past. Throws UsageError on what cannot be designed at this sample rate.
    [[nodiscard]] std::unique_ptr<CausalFilter> start(Hertz sample_rate) const;
    /// Why start() would throw, a sentence; empty where it does not.
    [[nodiscard]] std::string refusal(Hertz sample_rate) const;
    /// The same for signals that have no ripple: without the ripple known from a map.
    [[nodiscard]] std::unique_ptr<CausalFilter> start_on_bench(Hertz sample_rate) const;
    /// The active linear filter at a constant speed; empty for methods that have none.
    [[nodiscard]] std::optional<FrozenFilter> frozen(Hertz sample_rate, DegPerSec speed) const;
    /// The gear ratio that its filter is made for: its key's or its table's, no_ratio where its lines count
    /// by turns of the joint; empty where it follows no line.
    [[nodiscard]] std::optional<GearRatio> made_for() const;
};

/// Finds the method and checks its settings; `table` is needed by some methods. Throws UsageError.
[[nodiscard]] Contender make_contender(const Spec& spec,
                                       std::shared_ptr<const CandidateTable> table = nullptr);

// The test bench: a running filter at one constant joint speed, fed with generated torque signals. It reports
// the output of the filter, sample by sample; no formula replaces it.

/// The paper's step and ramp; a linear filter's figures do not depend on them.
inline constexpr double usual_step_nm = 10.0, usual_ramp_nm_s = 20.0;
/// Per cent of a step within which it counts as settled.
inline constexpr std::array<double, 4> settle_bands_percent = {0.5, 1.0, 2.0, 5.0};

struct StepMeasurement {
    std::array<Seconds, 4>
        settle;  ///< per entry of settle_bands_percent: from the step until it stays within
    double overshoot_percent = 0.0;   ///< above the step, in its direction ...
    double undershoot_percent = 0.0;  ///< ... and below where it began, the other way
};

struct RampMeasurement {
    Seconds delay;  ///< how far the output lags behind once the lag no longer changes, to 1e-5 ms
    /// How far the output leaves the range that the torque has risen through, on either side.
    double overshoot_nm = 0.0;
};

inline constexpr double run_in_seconds = 2.0;  // chosen, not derived: the motor has turned several times

/// Attenuations above this cannot be distinguished from a complete null in double precision and are reported
/// as this.
inline constexpr double most_attenuation_db = 200.0;

class Bench {
  public:
    /// Borrows `contender`; `speed` may be 0. Throws UsageError when a measurement has not settled after 1e7
    /// samples.
    Bench(const Contender& contender, Hertz sample_rate, DegPerSec speed)
        : contender_(contender), sample_rate_(sample_rate), speed_(speed) {}
    Bench(const Contender&& gone, Hertz sample_rate, DegPerSec speed) = delete;  // it is borrowed

    // The filter has run for run_in_seconds at torque 0: one that learns has learnt that there is no ripple.

    /// The torque is `height` Nm (not 0) from t = 0 on.
    [[nodiscard]] StepMeasurement step(NewtonMeters height) const;
    /// The torque rises by `slope_nm_s` (not 0) from t = 0 on.
    [[nodiscard]] RampMeasurement ramp(double slope_nm_s) const;
    /// Input amplitude over output amplitude of a sine at `at`, once the output has settled; between -inf and
    /// most_attenuation_db. Empty unless 0 < at < sample_rate / 2.
    [[nodiscard]] std::optional<double> attenuation_db(Hertz at) const;

  private:
    const Contender& contender_;
    Hertz sample_rate_;
    DegPerSec speed_;
};

// The switching ledger: every change of filter on a log with its effect on the output, measured against the
// known true torque.

/// Errors are |output - truth|, from the change up to the next one, a gap or the end of the log: its stretch.
/// They include all errors there, also the new filter's lag and the remaining ripple.
struct SwitchEntry {
    Switch change;
    Seconds time;
    Seconds stretch;                        ///< from the change to the last sample before the next one
    std::optional<double> error_before_nm;  ///< at the sample before; empty right after a gap, or no truth
    std::optional<double> peak_error_nm;    ///< the largest; empty without truth
    std::optional<Seconds> peak_after;      ///< when, counted from the change
    /// Per entry of settle_bands_percent (bench.hpp), in per cent of the true torque's range over the log:
    /// from the change until the error stays within; empty when it is still outside at the stretch's end.
    std::array<std::optional<Seconds>, 4> settle;
};

/// Takes a running filter's output block by block, in the order of the log.
class SwitchLedger {
  public:
    /// `truth_nm`: row by row, or empty where it is not known.
    explicit SwitchLedger(std::span<const double> truth_nm);

    /// The next samples: their times and the output of the filter, with all its changes so far.
    void add(std::span<const double> time_s, std::span<const double> out_nm, std::span<const Switch> changes);
    /// Between two samples: a gap ends the stretch.
    void split();

    [[nodiscard]] const std::vector<SwitchEntry>& entries() const { return entries_; }

  private:
    void follow(Seconds time, double error_nm);
    std::span<const double> truth_nm_;
    std::array<double, 4> bands_nm_{};
    std::vector<SwitchEntry> entries_;
    std::size_t done_ = 0;  ///< samples seen
    bool watched_ = false;  ///< the last entry's stretch goes on
    std::array<bool, 4> outside_{};
    std::optional<double> last_error_nm_;
};

// The delay ledger: the delays of a method, band by band, measured on the output of the running filter.

/// One filter that can come into force: that of a band, or of a method without bands at one speed.
struct LedgerEntry {
    int band = 0;  ///< 0 when the method has no bands
    /// Range of the band, or twice the speed of a filter that follows it; both 0 for one that does neither.
    DegPerSec from, to;
    std::string filter;                   ///< description of the filter
    Seconds dc_delay;                     ///< group delay at 0 Hz at the log's rate
    std::optional<Seconds> ramp_delay;    ///< how far its output lags on a ramp; empty when not measured
    std::optional<StepMeasurement> step;  ///< empty when not measured
    std::optional<double> phase_lag_deg;  ///< at LedgerRequest::crossover; a lead is negative
    std::optional<double> crossover_db;   ///< gain there
};

struct LedgerRequest {
    std::optional<Hertz> crossover;  ///< crossover of the control loop that the torque is for
    bool measured = true;            ///< run a step and a ramp; else only what follows from the sections
};

/// Phase lag, summed over the sections so that it does not wrap, in degrees, and gain in dB at one frequency.
struct CrossoverFigures {
    double phase_lag_deg = 0.0, gain_db = 0.0;
};
/// Throws UsageError unless 0 < at < sampled.rate / 2.
[[nodiscard]] CrossoverFigures at_crossover(std::span<const Biquad> cascade, Hertz at, SampledAt sampled);

/// One entry for every band of a method's table, at its middle speed; for a method that follows the gear at
/// 5, 10, 20, 50, 100 and 200 deg/s; else one entry.
[[nodiscard]] std::vector<LedgerEntry> delay_ledger(const Contender& contender, Hertz sample_rate,
                                                    const LedgerRequest& request);

/// The longest DC delay of a method, and at which speed, for |v| in `speeds`; a joint slower than a hundredth
/// of the fastest counts as standstill.
struct LongestDelay {
    Seconds delay;
    DegPerSec speed;
    std::string filter;
};
[[nodiscard]] LongestDelay longest_delay(const Contender& contender, Hertz sample_rate,
                                         const SpeedSpan& speeds);

/// The lowest speed above which a method's DC delay stays within `limit`, to 1 %; 0 when it always is, empty
/// when it is not at any speed up to where its lowest order reaches half the sample rate.
[[nodiscard]] std::optional<DegPerSec> within_from(const Contender& contender, Hertz sample_rate,
                                                   Seconds limit);

}  // namespace ripplenotch
