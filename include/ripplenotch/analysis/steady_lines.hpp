// SPDX-License-Identifier: MIT
#pragma once
// The paper's way: the lines of each steady stretch, followed over speeds. What keeps its order is an order,
// what keeps its frequency a tone, what was seen at one speed only is unknown.

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "ripplenotch/analysis/identification.hpp"
#include "ripplenotch/analysis/spectrum.hpp"
#include "ripplenotch/analysis/steady.hpp"

namespace ripplenotch {

struct StretchLines {
    std::size_t log = 0;
    Stretch stretch;
    std::vector<SpectralPeak> peaks;
    std::vector<SpectralHump> humps;
    double floor_nm = 0.0;  ///< median over the spectrum
    double bin_hz = 0.0;
};

/// One peak of one stretch.
struct Sighting {
    std::size_t stretch = 0;  ///< index into SteadyLines::stretches
    double hz = 0.0, hz_error = 0.0;
    double speed_deg_s = 0.0;  ///< signed; 0 at rest
    double speed_share_error = 0.0;
    double amplitude_nm = 0.0, snr = 0.0;
    double rate_hz = 0.0;      ///< of the log
    double seen_hz = 0.0;      ///< where the spectrum shows it: below hz in a line of kind alias
    bool by_velocity = false;  ///< of a log without position, whose velocity may be off
    [[nodiscard]] double order_output() const;  ///< 360 f / |v|; only where the joint moves
    [[nodiscard]] double order_error() const;   ///< from the frequency alone
};

struct SteadyLine {
    LineKind kind = LineKind::unknown;
    bool by_accident = false;         ///< shares an order with a line at another speed as unrelated ones may
    std::vector<Sighting> sightings;  ///< by stretch
};

/// The velocity of the logs without position is so much too high; the speeds of the sightings are without it.
struct SteadyOffset {
    DegPerSec offset, offset_error;  ///< standard error
    double order_share_error = 0.0;  ///< relative error that all orders have in common for it
};

struct SteadyLines {
    std::vector<StretchLines> stretches;
    std::vector<SteadyLine> lines;  ///< most widely seen first
    std::size_t moving = 0, resting = 0;
    std::size_t speeds = 0;              ///< different |speed| among the moving stretches
    std::optional<SteadyOffset> offset;  ///< where ripple at three speeds or more tells it
};

/// Where a family of fixed tones explains what orders would explain too, and better, they are tones.
/// `false_alarm` is the chance that noise gives any line in any of the stretches.
[[nodiscard]] SteadyLines find_steady_lines(std::span<const TraceView> logs, const SteadyRule& rule,
                                            double false_alarm);

}  // namespace ripplenotch
