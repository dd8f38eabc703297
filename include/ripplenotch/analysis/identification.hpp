// SPDX-License-Identifier: MIT
#pragma once
// What identify finds out about a joint: ripple lines, the gear ratio, and a sentence that says it. "Nothing
// found" and "cannot tell" are values of these types, not errors.

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ripplenotch/core/trace.hpp"
#include "ripplenotch/core/units.hpp"

namespace ripplenotch {

enum class LineKind { order, tone, alias, unknown };
[[nodiscard]] std::string_view line_kind_name(LineKind kind);

/// Amplitude (zero to peak) of a line in one steady stretch or speed range.
struct AmplitudeAtSpeed {
    double speed_deg_s = 0.0;  ///< signed mean
    double hz = 0.0;           ///< measured frequency
    double amplitude_nm = 0.0;
    double snr = 0.0;
};

struct Line {
    LineKind kind = LineKind::unknown;
    std::optional<double> order;         ///< cycles per motor revolution; only with a gear ratio
    std::optional<double> order_output;  ///< cycles per output revolution; for kind order and alias
    std::optional<double> order_output_stderr;
    std::optional<double> order_output_seen;  ///< for kind alias: where the folded line is seen
    std::vector<double> could_be;  ///< other output orders that explain the line about as well, by folding
    std::optional<double> hz;      ///< for kind tone, and the seen frequency of a single-speed line
    double amplitude_nm = 0.0;     ///< zero to peak, mean over the stretches that show it
    double phase_deg = 0.0;  ///< of cos(order * motor angle + phase), angle from position where there is one
    bool phase_known = false;
    double snr = 0.0;  ///< amplitude over the local noise amplitude
    double speed_from_deg_s = 0.0, speed_to_deg_s = 0.0;
    std::vector<AmplitudeAtSpeed> by_speed;
    std::string note;  ///< e.g. "mains", "seen at one speed only"
};

struct RatioCandidate {
    double value = 0.0;
    double score = 0.0;  ///< 0..1, sums to at most 1 over the candidates
    std::string reason;
};

/// Gear ratio from f = n Kg |v| / 360.
struct GearRatioFit {
    std::optional<double> value;  ///< empty when nothing supports one
    double standard_error = 0.0;
    double ci95_low = 0.0, ci95_high = 0.0;
    std::vector<RatioCandidate> candidates;  ///< likeliest first
    /// One entry per line observation used: its speed, frequency and what the fit leaves, in hertz.
    struct Residual {
        double speed_deg_s = 0.0, hz = 0.0, order = 0.0, residual_hz = 0.0, weight = 1.0;
    };
    std::vector<Residual> residuals;
};

struct Identification {
    std::string joint;
    Hertz sample_rate;
    std::string evidence;     ///< "steady stretches" or "order spectrum" or both
    std::vector<Line> lines;  ///< strongest first
    GearRatioFit gear_ratio;
    std::string verdict;             ///< one sentence with numbers
    std::vector<std::string> notes;  ///< what was looked at and why it was not enough, one sentence each
    bool conclusive = false;         ///< lines found and a ratio, or surely nothing
};

struct IdentifyOptions {
    enum class Evidence { automatic, steady, order };
    Evidence evidence = Evidence::automatic;
    std::optional<GearRatio> hint;     ///< checked, not believed
    std::vector<int> hinted_orders;    ///< n at which the strongest line is believed to stand
    double false_alarm = 0.01;         ///< chance that a log of noise gives any line
    double steady_band_percent = 5.0;  ///< speed stays within this share of its mean ...
    double steady_band_deg_s = 1.0;    ///< ... or within this, whichever is wider
    Seconds steady_for{1.0};           ///< for at least this long
};

inline constexpr std::size_t fewest_identify_samples = 64;

/// Lines and gear ratio of one joint from one or many of its logs. Throws DataError only for logs that are
/// unusable as such (fewer than 64 samples).
[[nodiscard]] Identification identify(std::span<const TraceView> logs, const IdentifyOptions& options);

}  // namespace ripplenotch
