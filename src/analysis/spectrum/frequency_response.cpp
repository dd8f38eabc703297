// SPDX-License-Identifier: MIT
#include "ripplenotch/analysis/frequency_response.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "analysis/spectrum/fourier.hpp"
#include "analysis/spectrum/spectrum.hpp"
#include "analysis/spectrum/stack.hpp"
#include "ripplenotch/analysis/spectrum.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {

namespace {

constexpr double chance = 0.05;                 // of 95 % limits and intervals
constexpr double fewest_segments = 4.0;         // by hand: below, the limit of the coherence is above 0.6
constexpr std::size_t usual_segments = 32;      // by hand: a coherence of 0.1 is significant
constexpr double longest_usual_s = 10.0;        // by hand: a long log gets more segments, not longer ones
constexpr std::size_t hole_bins = 2;            // the main lobe of a Hann window to one side
constexpr double smallest_power_share = 1e-10;  // 100 dB: as for the lines of a spectrum, rounding is below

/// Mean spectra of both signals and their cross-spectrum.
struct CrossSpectra {
    std::vector<double> in, out;
    std::vector<std::complex<double>> cross;
    std::size_t segments = 0;
};

CrossSpectra cross_spectra(const SignalPair& signals, std::size_t length) {
    PieceMaker in_maker(length, signals.sample_rate), out_maker(length, signals.sample_rate);
    const std::size_t bins = length / 2 + 1, rows = signals.time_s.size();
    CrossSpectra sums{std::vector<double>(bins), std::vector<double>(bins),
                      std::vector<std::complex<double>>(bins)};
    std::vector<std::size_t> ends(signals.run_starts.begin(), signals.run_starts.end());
    ends.push_back(rows);
    std::size_t first = 0;
    for (const std::size_t end : ends) {
        const auto run = [&](std::span<const double> values) { return values.subspan(first, end - first); };
        std::size_t at = 0;
        in_maker.begin_again();
        out_maker.begin_again();
        // Both makers cut the same pieces: that of the output is made with each of the input's.
        in_maker.for_each(run(signals.time_s), run(signals.in), [&](const Piece&) {
            const auto x = in_maker.sums();
            out_maker.for_each(run(signals.time_s).subspan(at, length), run(signals.out).subspan(at, length),
                               [&](const Piece&) {
                                   const auto y = out_maker.sums();
                                   for (std::size_t k = 0; k < bins; ++k) {
                                       sums.in[k] += std::norm(x[k]);
                                       sums.out[k] += std::norm(y[k]);
                                       sums.cross[k] += std::conj(x[k]) * y[k];
                                   }
                               });
            out_maker.begin_again();
            at += std::max<std::size_t>(1, length / 2);
            ++sums.segments;
        });
        first = end;
    }
    return sums;
}

std::size_t segment_length(const SignalPair& signals, const ResponseOptions& response) {
    std::optional<Seconds> asked = response.segment;
    if (response.resolution) asked = Seconds(hann_cell / response.resolution->value());
    const std::size_t rows = signals.time_s.size();
    const SpectrumOptions options{.segment = asked};
    std::size_t length = piece_length(rows, signals.sample_rate, options);
    if (!asked) {
        const auto longest = static_cast<std::size_t>(longest_usual_s * signals.sample_rate.value());
        length = std::min(std::max(2 * rows / (usual_segments + 1), fewest_spectrum_samples), longest);
    }
    if (length < fewest_spectrum_samples)
        raise<DataError>(
            "a segment of a frequency response needs at least {} samples, {} were given; use a longer "
            "--segment, "
            "or a smaller --resolution",
            fewest_spectrum_samples, length);
    return length;
}

/// Power that a line may show so many bins from its highest one, over that. In the main lobe: a line on a bin
/// shows a quarter in the next, and a fifth more is noise; one between two bins shows 0.2^2 in the second
/// from it, with the margin of the side lobes.
double leaking_power(std::size_t apart) {
    if (apart == 1) return 0.3;
    if (apart == 2) return skirt_margin * skirt_margin * 0.04;
    const double amplitude = skirt_margin * leakage(static_cast<double>(apart) - 0.5);
    return amplitude * amplitude;
}

/// A maximum this much higher than both bins outside of its main lobe is a line; by hand: the ratio of two
/// averages over four segments of noise exceeds it in one of a thousand cases.
constexpr double line_over_sides = 10.0;

/// What a line shows in its main lobe is the response at its own frequency: the highest bin is nearest to it.
void hide_main_lobes(std::span<const double> power, std::vector<char>& hidden) {
    constexpr std::size_t outside = hole_bins + 1;
    for (std::size_t k = outside; k + outside < power.size(); ++k) {
        const double sides = std::max(power[k - outside], power[k + outside]);
        const bool highest = power[k] >= power[k - 1] && power[k] > power[k + 1];
        if (!highest || power[k] <= line_over_sides * sides) continue;
        for (std::size_t apart = 1; apart < outside; ++apart) hidden[k - apart] = hidden[k + apart] = 1;
    }
}

/// Bins whose power may be the leakage of a stronger bin, or of the straight line that was removed.
std::vector<char> hidden_bins(std::span<const double> power) {
    const std::size_t bins = power.size();
    std::vector<char> hidden(bins, 0);
    const double least = smallest_power_share * *std::max_element(power.begin(), power.end());
    for (std::size_t k = 0; k < bins; ++k) {
        if (k < trend_bins || k + 1 == bins || !(power[k] > least)) hidden[k] = 1;
        for (std::size_t apart = 1; apart < bins; ++apart) {
            const double leaks = leaking_power(apart) * power[k];
            if (leaks <= least) break;
            if (apart <= k && power[k - apart] < leaks) hidden[k - apart] = 1;
            if (k + apart < bins && power[k + apart] < leaks) hidden[k + apart] = 1;
        }
    }
    hide_main_lobes(power, hidden);
    return hidden;
}

/// Ranges of bins whose coherence exceeds the limit, one of them that for all bins together: single bins
/// exceed the former by chance. `over` gets 0 for the others.
std::vector<BinRange> ranges_of(std::vector<char>& over, const FrequencyResponse& response) {
    std::vector<BinRange> ranges;
    const std::size_t bins = over.size();
    for (std::size_t k = 0; k < bins; ++k) {
        if (over[k] == 0) continue;
        BinRange range{k, k + 1};
        bool certain = false;
        std::size_t at = k;
        for (; at < std::min(range.end + hole_bins + 1, bins); ++at) {
            if (over[at] == 0) continue;
            range.end = at + 1;
            certain |= response.coherence[at] > response.coherence_limit_anywhere;
        }
        k = range.end - 1;
        if (certain)
            ranges.push_back(range);
        else
            std::fill(over.begin() + static_cast<std::ptrdiff_t>(range.first),
                      over.begin() + static_cast<std::ptrdiff_t>(range.end), 0);
    }
    return ranges;
}

// Radius of the circle that holds the true response, over the gain; 1 at the limit of the coherence.
double relative_radius(double coherence, double independent) {
    const double spread = portable::pow(chance, -1.0 / (independent - 1.0)) - 1.0;
    return std::sqrt(spread * std::max(0.0, 1.0 - coherence) / coherence);
}

double coherence_limit(double allowed, double independent) {
    return 1.0 - portable::pow(allowed, 1.0 / (independent - 1.0));
}

// A phase goes on where the one before ended.
double unwrapped(double deg, double before) { return before + std::remainder(deg - before, 360.0); }

}  // namespace

std::size_t FrequencyResponse::determined_bins() const {
    return static_cast<std::size_t>(
        std::count_if(gain.begin(), gain.end(), [](double value) { return value >= 0.0; }));
}

FrequencyResponse frequency_response(const SignalPair& signals, const ResponseOptions& options) {
    const std::size_t length = segment_length(signals, options), bins = length / 2 + 1;
    const CrossSpectra sums = cross_spectra(signals, length);
    FrequencyResponse response;
    response.estimator = options.estimator;
    response.segments = sums.segments;
    response.segment = Seconds(static_cast<double>(length) / signals.sample_rate.value());
    response.independent_segments = independent_pieces(sums.segments);
    if (static_cast<double>(sums.segments) < fewest_segments)
        raise<DataError>(
            "a frequency response needs at least {:.0f} half-overlapping segments without a gap, there {} {} "
            "of {:.4g} s; use a shorter --segment, or a larger --resolution",
            fewest_segments, sums.segments == 1 ? "is" : "are", sums.segments, response.segment.value());
    const double bin_hz = signals.sample_rate.value() / static_cast<double>(length);
    const double independent = response.independent_segments;
    response.resolution = Hertz(hann_cell * bin_hz);
    response.coherence_limit = coherence_limit(chance, independent);

    const bool by_output = options.estimator == ResponseEstimator::h2;
    std::vector<char> over = hidden_bins(by_output ? sums.out : sums.in);
    response.hidden = static_cast<std::size_t>(std::count(over.begin(), over.end(), 1));
    const double cells = std::max(1.0, static_cast<double>(bins - response.hidden) / hann_cell);
    response.coherence_limit_anywhere = coherence_limit(chance / cells, independent);
    for (std::size_t k = 0; k < bins; ++k) {
        const double both = sums.in[k] * sums.out[k];
        response.hz.push_back(static_cast<double>(k) * bin_hz);
        response.coherence.push_back(both > 0.0 ? std::min(1.0, std::norm(sums.cross[k]) / both) : 0.0);
        over[k] = over[k] == 0 && response.coherence[k] > response.coherence_limit ? 1 : 0;
    }
    response.ranges = ranges_of(over, response);
    for (std::vector<double>* const values : {&response.gain, &response.gain_low, &response.gain_high,
                                              &response.phase_deg, &response.phase_error_deg})
        values->assign(bins, not_a_number);
    for (std::size_t k = 0; k < bins; ++k) {
        if (over[k] == 0) continue;
        const std::complex<double> ratio =
            by_output ? sums.out[k] / std::conj(sums.cross[k]) : sums.cross[k] / sums.in[k];
        const double radius = relative_radius(response.coherence[k], independent);
        const double gain = portable::hypot(ratio.real(), ratio.imag());
        response.gain[k] = gain;
        response.gain_low[k] = by_output ? gain / (1.0 + radius) : gain * (1.0 - radius);
        response.gain_high[k] = by_output ? gain / (1.0 - radius) : gain * (1.0 + radius);
        response.phase_deg[k] = portable::arg(ratio) * degrees_per_radian;
        response.phase_error_deg[k] = portable::asin(std::min(1.0, radius)) * degrees_per_radian;
    }
    return response;
}

std::optional<DelayEstimate> group_delay(const FrequencyResponse& response, const BinRange& range) {
    constexpr double least_error_deg = 1e-9;  // of signals without noise
    double weights = 0.0, mean_hz = 0.0, mean_deg = 0.0, before = 0.0;
    std::vector<std::pair<std::size_t, double>> phases;
    for (std::size_t k = range.first; k < range.end; ++k) {
        if (!response.determined(k)) continue;
        before = phases.empty() ? response.phase_deg[k] : unwrapped(response.phase_deg[k], before);
        phases.emplace_back(k, before);
    }
    if (phases.size() < 3) return std::nullopt;
    const auto weight = [&](std::size_t k) {
        const double error = std::max(response.phase_error_deg[k], least_error_deg);
        return 1.0 / (error * error);
    };
    for (const auto& [k, deg] : phases) {
        weights += weight(k);
        mean_hz += weight(k) * response.hz[k];
        mean_deg += weight(k) * deg;
    }
    mean_hz /= weights;
    mean_deg /= weights;
    double squares = 0.0, products = 0.0;
    for (const auto& [k, deg] : phases) {
        const double off = response.hz[k] - mean_hz;
        squares += weight(k) * off * off;
        products += weight(k) * off * (deg - mean_deg);
    }
    // Neighbouring bins are not independent: one value for each 1.5 of them.
    return DelayEstimate{Seconds(-products / squares / 360.0),
                         Seconds(std::sqrt(hann_cell / squares) / 360.0)};
}

namespace {

// Bins below are all determined.
std::optional<Seconds> phase_delay(const FrequencyResponse& response, std::size_t bin) {
    double deg = 0.0;
    for (std::size_t k = trend_bins; k <= bin; ++k) {
        if (!response.determined(k)) return std::nullopt;
        deg = k == trend_bins ? response.phase_deg[k] : unwrapped(response.phase_deg[k], deg);
    }
    return Seconds(-deg / 360.0 / response.hz[bin]);
}

}  // namespace

std::vector<ResponseRow> third_octaves(const FrequencyResponse& response) {
    constexpr double bands_a_decade = 10.0;  // a third of an octave is a tenth of a decade (IEC 61260)
    const std::size_t bins = response.hz.size();
    std::vector<ResponseRow> rows;
    const auto band_of = [&](std::size_t k) {
        return std::lround(bands_a_decade * portable::log10(response.hz[k]));
    };
    for (std::size_t k = trend_bins; k < bins;) {
        const auto band = band_of(k);
        BinRange range{k, k};
        while (range.end < bins && band_of(range.end) == band) ++range.end;
        const std::size_t next = range.end;
        const double middle = portable::pow(10.0, static_cast<double>(band) / bands_a_decade);
        ResponseRow row{k, std::nullopt, std::nullopt};
        for (std::size_t i = range.first; i < range.end; ++i) {
            const bool better = response.determined(i) && !response.determined(row.bin);
            const bool worse = !response.determined(i) && response.determined(row.bin);
            const bool nearer = std::abs(response.hz[i] - middle) < std::abs(response.hz[row.bin] - middle);
            if (better || (nearer && !worse)) row.bin = i;
        }
        if (response.determined(row.bin)) {
            // Of fewer bins the slope would be that of a resolution and less.
            range.first = std::min(range.first, row.bin - std::min(row.bin, hole_bins));
            range.end = std::max(range.end, std::min(row.bin + hole_bins + 1, bins));
            row.group_delay = group_delay(response, range);
            row.phase_delay = phase_delay(response, row.bin);
        }
        rows.push_back(row);
        k = next;
    }
    return rows;
}

double decibels(double gain) { return 20.0 * portable::log10(gain); }

Agreement agreement(const FrequencyResponse& response, const PredictedResponse& predicted) {
    Agreement found;
    const bool inverse = response.estimator == ResponseEstimator::h2;
    for (std::size_t k = 0; k < response.hz.size(); ++k) {
        if (!response.determined(k)) continue;
        const std::complex<double> measured =
            portable::polar(response.gain[k], response.phase_deg[k] / degrees_per_radian);
        const std::complex<double> ratio = inverse ? measured / predicted.at[k] : predicted.at[k] / measured;
        const double radius = relative_radius(response.coherence[k], response.independent_segments);
        const double size = portable::hypot(ratio.real(), ratio.imag());
        ++found.bins;
        if (std::norm(ratio - 1.0) <= radius * radius) {
            ++found.within;
        } else if (size > 0.0) {
            found.largest_db = std::max(found.largest_db, std::abs(decibels(size)));
            found.largest_deg =
                std::max(found.largest_deg, std::abs(portable::arg(ratio)) * degrees_per_radian);
        }
    }
    return found;
}

namespace {

constexpr std::size_t most_ranges = 3;

std::string range_text(const FrequencyResponse& response, const BinRange& range) {
    const double from = response.hz[range.first], to = response.hz[range.end - 1];
    return range.end - range.first == 1 ? fmt::format("at {:.4g} Hz", from)
                                        : fmt::format("from {:.4g} to {:.4g} Hz", from, to);
}

std::string segments_text(const FrequencyResponse& response) {
    return fmt::format("{} segments of {:.4g} s", response.segments, response.segment.value());
}

}  // namespace

std::string response_verdict(const ResponseReport& report) {
    const FrequencyResponse& response = report.response;
    const std::string name = fmt::format("Response {}/{}: ", report.out, report.in);
    if (response.ranges.empty())
        return name + fmt::format(
                          "gain not known: the coherence nowhere exceeds {:.3g}, which independent "
                          "signals reach somewhere with 5 % ({}).",
                          response.coherence_limit_anywhere, segments_text(response));
    std::vector<BinRange> widest = response.ranges;
    std::stable_sort(widest.begin(), widest.end(),
                     [](const BinRange& a, const BinRange& b) { return a.end - a.first > b.end - b.first; });
    widest.resize(std::min(widest.size(), most_ranges));
    std::sort(widest.begin(), widest.end(),
              [](const BinRange& a, const BinRange& b) { return a.first < b.first; });
    std::string text = name + "gain known ";
    for (std::size_t i = 0; i < widest.size(); ++i)
        text += (i > 0 ? ", " : "") + range_text(response, widest[i]);
    if (const std::size_t more = response.ranges.size() - widest.size(); more > 0)
        text += fmt::format(" and in {}", how_many(more, "narrower range"));
    double least = std::numeric_limits<double>::infinity(), most = 0.0;
    for (const double gain : response.gain) {
        if (!(gain >= 0.0)) continue;
        least = std::min(least, gain);
        most = std::max(most, gain);
    }
    return text + fmt::format(", {} to {} dB ({}).", rounded(decibels(least), 1), rounded(decibels(most), 1),
                              segments_text(response));
}

std::vector<std::string> response_notes(const ResponseReport& report) {
    const FrequencyResponse& response = report.response;
    std::vector<std::string> notes;
    notes.push_back(
        fmt::format("{} of {} frequencies are determined. The coherence of independent signals is below "
                    "{:.3g} with 95 %; "
                    "it is too high by {:.2g} in the mean (n = {:.1f} independent segments).",
                    response.determined_bins(), response.hz.size(), response.coherence_limit,
                    1.0 / response.independent_segments, response.independent_segments));
    if (response.hidden > trend_bins + 1)
        notes.push_back(fmt::format(
            "At {} frequencies {} has no power of its own above the leakage of stronger frequencies.",
            response.hidden - trend_bins - 1,
            response.estimator == ResponseEstimator::h1 ? report.in : report.out));
    notes.push_back(
        response.estimator == ResponseEstimator::h1
            ? fmt::format(
                  "H1 assumes noise in {} only: noise in {} lowers the gain, at most by the factor of "
                  "the coherence.",
                  report.out, report.in)
            : fmt::format("H2 assumes noise in {} only: noise in {} raises the gain, at most by the inverse "
                          "of the coherence.",
                          report.in, report.out));
    notes.push_back(fmt::format(
        "Neither H1 nor H2 holds where {} acts back on {}. The intervals are of random errors; what changes "
        "within the resolution of {:.3g} Hz is smoothed.",
        report.out, report.in, response.resolution.value()));
    // Of a Hann window shifted against itself by a small share s of its length, 1 - (2 pi^2 / 3) s^2 is left.
    constexpr double loss_of_shift = 6.58, noted_loss = 0.01;
    double longest_s = 0.0;
    for (const BinRange& range : response.ranges)
        if (const auto delay = group_delay(response, range))
            longest_s = std::max(longest_s, std::abs(delay->delay.value()));
    const double share = longest_s / response.segment.value(), loss = loss_of_shift * share * share;
    if (loss > noted_loss)
        notes.push_back(fmt::format(
            "A delay of {:.3g} ms is {:.0f} % of a segment, which lowers the gain by about {:.2g} %: use a "
            "longer --segment.",
            1e3 * longest_s, 100.0 * share, 100.0 * std::min(loss, 1.0)));
    if (report.predicted) {
        const Agreement found = agreement(response, *report.predicted);
        notes.push_back(
            fmt::format("{} predicts the response within its 95 % region at {} of {} frequencies{}.",
                        report.predicted->method, found.within, found.bins,
                        found.within == found.bins
                            ? ""
                            : fmt::format(", and differs by at most {:.2g} dB and {:.2g} deg elsewhere",
                                          found.largest_db, found.largest_deg)));
    }
    return notes;
}

}  // namespace ripplenotch
