// SPDX-License-Identifier: MIT
#pragma once
// Frequency response from one signal of a log to another, with coherence and 95 % confidence bands: Welch's
// method, with the pieces of the spectrum. Source: J. S. Bendat, A. G. Piersol, Random Data, 4th ed., ch. 9;
// bands: G. M. Jenkins, D. G. Watts, Spectral Analysis and Its Applications, 1968, ch. 10.

#include <complex>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ripplenotch/core/quantity.hpp"

namespace ripplenotch {

/// H1 = Sxy / Sxx: unbiased by noise of the output. H2 = Syy / Syx: unbiased by noise of the input.
enum class ResponseEstimator { h1, h2 };

/// Two signals row by row, at the same times.
struct SignalPair {
    Hertz sample_rate;
    std::span<const double> time_s, in, out;
    std::span<const std::size_t> run_starts = {};  ///< as TraceView; no segment reaches across
};

struct ResponseOptions {
    std::optional<Seconds> segment = {};   ///< left out: about 32 half-overlapping ones, of 10 s at most
    std::optional<Hertz> resolution = {};  ///< instead: 1.5 over the segment
    ResponseEstimator estimator = ResponseEstimator::h1;
};

/// Consecutive bins, end not included.
struct BinRange {
    std::size_t first = 0, end = 0;
};

/// Bins from 0 Hz to half the sample rate, all vectors have the same length. Values of a bin that is not
/// determined are nan, but for its coherence.
struct FrequencyResponse {
    ResponseEstimator estimator = ResponseEstimator::h1;
    std::vector<double> hz, coherence;  ///< magnitude-squared; 0 where a signal has no power
    std::vector<double> gain, gain_low, gain_high;
    std::vector<double> phase_deg;        ///< -180 to 180; a delay is negative
    std::vector<double> phase_error_deg;  ///< half of the 95 % interval
    std::vector<BinRange> ranges;         ///< where it is determined, in between single bins may be missing
    std::size_t hidden = 0;               ///< bins whose input is leakage of stronger ones, or of the trend
    Hertz resolution;                     ///< 1.5 bins, the noise bandwidth of a Hann window
    Seconds segment;
    std::size_t segments = 0;
    double independent_segments = 0.0;  ///< n of the formulas; its inverse is the mean coherence of noise
    double coherence_limit = 0.0;  ///< 1 - 0.05^(1/(n - 1)): independent signals exceed it in 5 % of bins
    double coherence_limit_anywhere = 0.0;  ///< what they exceed in any bin at all with 5 %

    [[nodiscard]] bool determined(std::size_t bin) const { return gain[bin] >= 0.0; }
    [[nodiscard]] std::size_t determined_bins() const;
};

/// A bin is determined where its coherence exceeds the limit, in a range in which one bin exceeds the limit
/// for all bins together, and where leakage of the window does not hide its input. The bands are those of the
/// circle that holds the true response with 95 %:
///     |H - H1|^2 <= r^2 |H1|^2,    r^2 = (0.05^(-1/(n-1)) - 1) (1 - coherence) / coherence
/// which includes 0 exactly where the coherence does not exceed the limit. Of H2 the inverse has this circle.
/// Throws DataError for fewer than 64 samples a segment, or fewer than four segments.
[[nodiscard]] FrequencyResponse frequency_response(const SignalPair& signals, const ResponseOptions& options);

/// Delays with half of their 95 % intervals.
struct DelayEstimate {
    Seconds delay, error;
};
/// The slope of the phase over the determined bins of a range, weighted by their intervals; empty for fewer
/// than three.
[[nodiscard]] std::optional<DelayEstimate> group_delay(const FrequencyResponse& response,
                                                       const BinRange& range);

/// The response that a filter is known to have, at the same bins.
struct PredictedResponse {
    std::string method, note;
    std::vector<std::complex<double>> at;
};

struct ResponseReport {
    std::string joint, out, in;
    std::string unit;  ///< of the gain; empty for a plain number
    FrequencyResponse response;
    std::optional<PredictedResponse> predicted;
};

/// One bin for each third of an octave: of its determined ones the nearest to the middle.
struct ResponseRow {
    std::size_t bin = 0;
    std::optional<DelayEstimate> group_delay;
    /// From the phase, where all bins below are determined, so that it is known how often it has wrapped.
    std::optional<Seconds> phase_delay;
};
[[nodiscard]] std::vector<ResponseRow> third_octaves(const FrequencyResponse& response);

[[nodiscard]] double decibels(double gain);

/// Of the determined bins, those whose circle holds the prediction, and the largest distances of the others.
struct Agreement {
    std::size_t bins = 0, within = 0;
    double largest_db = 0.0, largest_deg = 0.0;
};
[[nodiscard]] Agreement agreement(const FrequencyResponse& response, const PredictedResponse& predicted);

/// "gain of a / b known from 0.5 to 80 Hz ...": one sentence.
[[nodiscard]] std::string response_verdict(const ResponseReport& report);
/// What the verdict rests on, and what would make it wrong: one sentence each.
[[nodiscard]] std::vector<std::string> response_notes(const ResponseReport& report);

}  // namespace ripplenotch
