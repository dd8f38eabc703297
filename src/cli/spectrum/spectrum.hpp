// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "cli/options/joint_runs.hpp"
#include "ripplenotch/document/spectrum_json.hpp"
#include "ripplenotch/log/log.hpp"

namespace ripplenotch {

// The spectrum in pieces of a log that is not held.

/// What torque_spectrum and whole_log say of the whole log. `tell` is called once, when the log's layout and
/// warnings are known, before anything is thrown that the spectrum has to say.
[[nodiscard]] LogSpectrum streamed_spectrum(LogPasses& log, const SpectrumOptions& options,
                                            const std::function<void()>& tell);

// spectrum --track: amplitude and phase of each order against time or speed.

/// With what the command shares with the spectra, which is known when the track is made.
struct TrackRequest : LogRequest {
    bool wanted = false;  ///< --track
    std::string against = "time";
    std::vector<double> output_orders, tones_hz;
    std::optional<double> window_turns;
    std::optional<Seconds> window;
    std::optional<DegPerSec> speed_step;
};

void attach_track(Options& options, TrackRequest& request);

/// Throws UsageError where an option of the track is given without it.
void check_track(const TrackRequest& request);

[[nodiscard]] Answer run_track(const TrackRequest& request, const std::string& command_line);

}  // namespace ripplenotch
