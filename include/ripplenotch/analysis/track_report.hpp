// SPDX-License-Identifier: MIT
#pragma once
// Order tracks with their names and kind of amplitude, as columns of numbers and as text.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ripplenotch/analysis/order_track.hpp"
#include "ripplenotch/analysis/ripple_estimate.hpp"
#include "ripplenotch/core/gear_account.hpp"

namespace ripplenotch {

/// The name of a line of the tracks.
struct TrackLabel {
    enum class Kind { order, order_output, tone } kind = Kind::order;
    double value = 1.0;  ///< cycles per motor turn, per output turn, or hertz

    /// "order_1", "order_output_202", "tone_50hz"
    [[nodiscard]] std::string column() const;
    /// "order 1", "output order 202", "50 Hz"
    [[nodiscard]] std::string words() const;
};

struct TrackReport {
    std::string joint;
    std::string doubt;  ///< why these orders may be others: a sentence that the verdict begins with, or empty
    std::optional<GearAccount> gear;
    bool angle_from_position = false;    ///< else phases count from the first sample
    std::optional<double> window_turns;  ///< of the motor where there is a gear ratio, else of the output
    std::optional<Seconds> window;
    std::vector<TrackLabel> labels;
    /// The ripple of each label over the whole log; empty for tones.
    std::vector<std::optional<RippleEstimate>> ripple;
    OrderTracks tracks;
    std::optional<SpeedTrack> by_speed;  ///< when the rows go by speed
};

struct TrackColumn {
    std::string name;  ///< with its unit
    std::vector<double> values;
};

/// Rows by time or by speed as columns, six significant digits: time_s, speed_deg_s, and per line amplitude,
/// phase_deg and standard_error_nm; or speed_deg_s, rows, and per line amplitude, phase_deg and spread_nm.
/// nan where a line was not measured.
[[nodiscard]] std::vector<TrackColumn> track_columns(const TrackReport& report);

/// One line over the rows in which it was measured.
struct TrackSummary {
    std::size_t rows = 0;  ///< rows where it was measured; 0: the other values mean nothing
    double median_nm = 0.0, least_nm = 0.0, greatest_nm = 0.0;
    double least_at_deg_s = 0.0, greatest_at_deg_s = 0.0;
};
/// `line` counts from 0, as `labels` do.
[[nodiscard]] TrackSummary track_summary(const TrackReport& report, std::size_t line);

/// One sentence a line: its amplitude over the log (of a tone the median), and the least and the greatest
/// along it and where they are.
[[nodiscard]] std::string track_verdict(const TrackReport& report);

}  // namespace ripplenotch
