// SPDX-License-Identifier: MIT
#pragma once
#include <optional>
#include <span>
#include <string>

#include "ripplenotch/analysis/order_track.hpp"
#include "ripplenotch/figure/figure.hpp"

namespace ripplenotch {

/// How the amplitudes of a track are shown: what a cosine of amplitude 1 is, and the name of that.
struct TrackScale {
    double factor = 1.0;
    std::string label = "amplitude, zero to peak";
};

/// A line in the legend, and what gives its colour: an order of the motor, a tone, or neither.
struct TrackName {
    std::string words;
    std::optional<double> order = {};
    bool is_tone = false;
};

/// Amplitude of each line against time with twice its standard error as a ribbon, and its phase.
[[nodiscard]] Figure track_figure(const std::string& source, const OrderTracks& tracks,
                                  std::span<const TrackName> names, const TrackScale& scale);

/// The same against signed speed, the ribbon being the spread over the rows of a speed.
[[nodiscard]] Figure track_figure(const std::string& source, const SpeedTrack& tracks,
                                  std::span<const TrackName> names, const TrackScale& scale);

}  // namespace ripplenotch
