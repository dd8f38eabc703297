// SPDX-License-Identifier: MIT
#pragma once
// The noise of a log: what is left by a regression on everything that smooth laws of position, speed and time
// and lines of the angle can explain. It is the unit of the criterion. The regression also yields the load.

#include <optional>
#include <vector>

#include "diagnose/engine/baseline.hpp"
#include "diagnose/engine/recorded_motion.hpp"
#include "diagnose/engine/terms.hpp"

namespace ripplenotch::engine {

/// All vectors have an entry per slot.
struct SaturatedFit {
    double noise_nm = 0.0;            ///< rms of the residual of the samples used
    std::vector<double> residual_nm;  ///< all samples
    std::vector<double> ripple_nm;    ///< torque of the model's ripple
    std::vector<double> load_nm;      ///< magnitude of what the gear carries: without friction
    std::vector<double> sensed_nm;    ///< magnitude of what the sensor sees, without ripple
    double inertia_nm_per_deg_s2 = 0.0;
    std::vector<double> whitening;  ///< filter that makes the noise white, 1 first
    double innovation_nm = 0.0;     ///< rms of the whitened residual
};

/// Fits the saturated regression together with the terms adopted so far.
[[nodiscard]] SaturatedFit fit_saturated(const RecordedMotion& recorded, const Baseline& base,
                                         const SearchedTerms& terms, const SaturatedFit* before);

/// Samples far from what all smooth laws predict and from their neighbours.
struct FarSamples {
    std::vector<std::size_t> slots;
    bool are_spikes = false;  ///< enough of them stand alone while the joint moves in one direction
};
[[nodiscard]] FarSamples find_spikes(const RecordedMotion& recorded, const SaturatedFit& fit);

/// Power of lines in a residual against the angle of the joint.
struct AngleSpectrum {
    std::vector<double> cycles_per_turn, power;
    double turns = 0.0;  ///< the travel
};
/// Between two frequencies in cycles per output revolution; `spacing` in cycles over the travel. Empty where
/// the travel is too short.
[[nodiscard]] AngleSpectrum angle_spectrum(const RecordedMotion& recorded,
                                           const std::vector<double>& residual, double lowest, double highest,
                                           double spacing = 0.25);

/// Frequency in Hz of a fixed tone that rises above a residual's spectrum.
[[nodiscard]] std::optional<double> find_tone(const RecordedMotion& recorded,
                                              const std::vector<double>& residual);

/// Rounds to so many significant digits, so that values of a search that are equal to it are the same.
[[nodiscard]] double rounded(double value, int digits);

/// x(k) + filter[1] x(k - 1) + ... from zeros before the first sample.
void filter_in_place(std::vector<double>& values, std::span<const double> filter);

}  // namespace ripplenotch::engine
