// SPDX-License-Identifier: MIT
#pragma once
// spectrum --track: amplitude and phase of each order against time or speed.

#include <optional>
#include <string>
#include <vector>

#include "cli/command.hpp"
#include "cli/options/options.hpp"
#include "cli/options/plot_request.hpp"
#include "ripplenotch/log/log.hpp"
#include "ripplenotch/verdict/gear_choice.hpp"

namespace ripplenotch {

struct TrackRequest {
    bool wanted = false;  ///< --track
    std::string against = "time";
    std::vector<double> output_orders, tones_hz;
    std::optional<double> window_turns;
    std::optional<Seconds> window;
    // What the command shares with the spectra; set when the track is made.
    CommonOptions common;
    PlotRequest plot;
    ReadOptions log;
    std::string path;
    GearOptions gear_options;
    std::optional<DegPerSec> speed_step;
};

void attach_track(Options& options, TrackRequest& request);

/// Throws UsageError where an option of the track is given without it.
void check_track(const TrackRequest& request);

ExitCode run_track(const TrackRequest& request, const std::string& command_line);

}  // namespace ripplenotch
