// SPDX-License-Identifier: MIT
#pragma once
// What the commands found, as figures.

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ripplenotch/analysis/identification.hpp"
#include "ripplenotch/analysis/line_search.hpp"
#include "ripplenotch/analysis/order_map.hpp"
#include "ripplenotch/analysis/order_track.hpp"
#include "ripplenotch/analysis/spectrum.hpp"
#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/core/trace.hpp"
#include "ripplenotch/design/candidate_table.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"
#include "ripplenotch/evaluate/comparison.hpp"
#include "ripplenotch/figure/figure.hpp"
#include "ripplenotch/figure/min_max.hpp"
#include "ripplenotch/filter/engine.hpp"
#include "ripplenotch/filter/map_fit.hpp"
#include "ripplenotch/fleet/trend.hpp"

namespace ripplenotch {

// Lines, spectra, and maps over speed.

/// Line frequency against speed with the fitted ratio, the residual of the fit, and amplitude against speed:
/// of the orders by direction with 95 % intervals, without a ratio of the lines.
[[nodiscard]] Figure identification_figure(const std::string& source, const Identification& identification);

/// The largest amplitude of each motor (along x) in each torque (along y), by the numbers of the joints;
/// cells where nothing was found are empty.
[[nodiscard]] Figure motor_matrix_figure(const std::string& source, std::span<const Identification> joints);

/// Lines that get their name in a spectrum, strongest first.
inline constexpr std::size_t max_named_lines = 12;

/// Amplitude against frequency with the noise floor, lines named by frequency and amplitude.
/// `smears_orders`: as Stretch::smears_orders.
[[nodiscard]] Figure spectrum_figure(const std::string& source, const Spectrum& spectrum, bool smears_orders);

/// Amplitude against output order, order lines named.
[[nodiscard]] Figure order_spectrum_figure(const std::string& source, const Stack& stack,
                                           const MotionLines& lines);

/// Campbell diagram or order map: speed along x. With a gear the lines of its orders are drawn;
/// `axis_per_motor_turn`: the map's own orders are per motor turn, not per output turn.
struct MapLines {
    std::optional<GearAccount> gear;
    bool axis_per_motor_turn = false;
};
[[nodiscard]] Figure speed_map_figure(const std::string& source, const SpeedMap& map, const MapLines& lines);

// Orders along a log, ripple maps, and a torque before and after a filter.

/// A ripple map, amplitude and phase of each order over speed, by direction: curves of the mean over the
/// joint's turn, at the middle load; ribbons of 95 % by the errors of the values at the speeds, taken as
/// independent. Two panels, empty for an empty map.
[[nodiscard]] Figure map_figure(const std::string& source, const MapFit& fit);

/// One sample, before and after a filter.
struct CourseSample {
    double time_s = 0.0, speed_deg_s = 0.0, before_nm = 0.0, after_nm = 0.0;
};

/// The stretch of half a second in which a filter attenuates fast changes most: there ripple is visible,
/// which a picture of a whole log blurs.
class CloseUp {
  public:
    void add(const CourseSample& sample);
    /// Empty while the log is not some times as long as the stretch.
    [[nodiscard]] std::optional<Panel> panel() const;

  private:
    struct Stretch {
        std::vector<double> time_s, before_nm, after_nm;
        double taken_off = 0.0;  ///< squares of the steps of before less after in its median fifth
    };
    void end_stretch();

    Stretch now_, best_;
    std::size_t ended_ = 0;
};

/// Torque before and after a filter along a log of any length, in bounded memory, with the ledger of its
/// switches.
class TorqueCourse {
  public:
    /// In the order of the log.
    void add(const CourseSample& sample);

    /// Panels: a close-up where the log is long enough, torque before and after, joint speed, and for a
    /// filter that switches the active band and the jump of the output at each switch.
    [[nodiscard]] Figure figure(const std::string& source, const std::string& method,
                                const StreamReport& report) const;

  private:
    MinMaxCourse speed_, before_, after_;
    CloseUp close_up_;
    double first_s_ = 0.0, last_s_ = 0.0;
    bool any_ = false;
};

/// A line in the legend, and what gives its colour: an order of the motor, a tone, or neither.
struct TrackName {
    std::string words;
    std::optional<double> order = {};
    bool is_tone = false;
};

/// Amplitude of each line against time with twice its standard error as a ribbon, and its phase.
[[nodiscard]] Figure track_figure(const std::string& source, const OrderTracks& tracks,
                                  std::span<const TrackName> names);

/// The same against signed speed, the ribbon being the spread over the rows of a speed.
[[nodiscard]] Figure track_figure(const std::string& source, const SpeedTrack& tracks,
                                  std::span<const TrackName> names);

// Candidate tables over speed, and a filter over frequency.

/// The centres of every band over the speed, with the ripple that they are for (Kim, Kim, Song 2011, fig. 4),
/// the worst attenuation in each band, and its delay and settling time.
[[nodiscard]] Figure table_figure(const CandidateTable& table);

/// A cascade at these frequencies.
struct FilterResponse {
    std::vector<double> hz;
    std::vector<double> magnitude_db;  ///< at least lowest_magnitude_db
    std::vector<double> phase_deg;     ///< sum over sections, not folded; nan at a null, like the delay
    std::vector<double> group_delay_ms;
};
inline constexpr double lowest_magnitude_db = -120.0;
/// From 1e-4 of the sample rate to just below its half, even on a logarithmic axis; the nulls of every
/// section and `also_hz` are among the frequencies, so that none is missed between two points.
[[nodiscard]] FilterResponse filter_response(std::span<const Biquad> cascade, Hertz sample_rate,
                                             std::span<const double> also_hz);

// Methods side by side: frequency responses, a step and a ramp; on a log whose true torque is known, their
// outputs.

/// The outputs of the methods for a log whose true torque is known, in bounded memory.
class ComparedCourse {
  public:
    /// As ComparedLog::watch calls it. `truth_nm` has a value for each row of the block.
    void add(std::size_t method, const TraceView& block, std::span<const double> out_nm,
             std::span<const double> truth_nm);

    [[nodiscard]] bool empty() const { return methods_.empty(); }

    /// Panels: the torque of each method with the true one, and its error. Names carry the rms error of the
    /// comparison's figures.
    [[nodiscard]] Figure figure(const std::string& source, const Comparison& comparison) const;

  private:
    struct Course {
        MinMaxCourse torque, error;
    };
    std::vector<Course> methods_;
    MinMaxCourse truth_;
};

/// Magnitude, phase and group delay of the linear filter that each method is at the comparison's speed, and
/// its output for a step and a ramp. Runs the filters on signals of its own, as Bench does.
[[nodiscard]] Figure comparison_figure(const Comparison& comparison, std::span<const Contender> contenders);

// Where a model and a log disagree, before and after.

/// The residual of the torque for two models, one value a sample; `position_deg` may be empty. `after_nm` may
/// be empty: one model only.
struct Residuals {
    std::span<const double> time_s, speed_deg_s, position_deg, before_nm, after_nm;
};

/// Residual against time, and its rms over position (time, without a position) and speed, with the same
/// colours before and after.
[[nodiscard]] Figure residual_figure(const std::string& title, const std::string& sentence,
                                     const Residuals& residuals, std::optional<double> noise_floor_nm);

/// The gap from round to round down to the noise floor, each round named.
[[nodiscard]] Figure gap_figure(const std::string& title, const Diagnosis& diagnosis);

/// The gap from round to round, and the residual of the model as given and of the improved one: against time,
/// and over position and speed.
[[nodiscard]] Figure diagnosis_figure(const std::string& source, const Diagnosis& diagnosis,
                                      const TraceView& log);

// Changes in a fleet.

/// A panel for each of the first ten alerts.
[[nodiscard]] Figure trend_figure(const Trend& trend);

}  // namespace ripplenotch
