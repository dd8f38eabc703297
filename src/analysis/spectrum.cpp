// SPDX-License-Identifier: MIT
#include "ripplenotch/analysis/spectrum.hpp"

#include <algorithm>
#include <cmath>

#include "analysis/welch.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {
namespace {

constexpr std::size_t fewest_samples = 64;

std::size_t length_of_pieces(const TraceView& trace, const SpectrumOptions& options) {
    std::size_t length = trace.size();
    if (options.segment) {
        const double asked = options.segment->value() * trace.sample_rate.value();
        length = std::min(length, static_cast<std::size_t>(std::llround(asked)));
    }
    if (length < fewest_samples) {
        raise<DataError>("a spectrum needs at least {} samples, there are {}{}", fewest_samples, length,
                         options.segment ? "; use a longer --segment" : "");
    }
    return length;
}

/// Half-overlapping pieces, handed out as times and torques, with the number of samples that the piece before
/// had too.
template <class Take>
void for_each_piece(const TraceView& trace, std::size_t length, Take take) {
    const std::size_t hop = std::max<std::size_t>(1, length / 2);
    for (std::size_t first = 0; first + length <= trace.size(); first += hop) {
        take(trace.time_s.subspan(first, length), trace.torque_nm.subspan(first, length),
             first > 0 ? length - hop : 0);
    }
}

}  // namespace

Spectrum torque_spectrum(const TraceView& trace, const SpectrumOptions& options) {
    const std::size_t length = length_of_pieces(trace, options);
    Welch welch(length, trace.sample_rate);
    for_each_piece(trace, length, [&](auto... piece) { welch.add(piece...); });
    if (welch.find_lines(options.false_alarm)) {
        for_each_piece(trace, length, [&](auto... piece) { welch.measure(piece...); });
    }
    return welch.spectrum();
}

}  // namespace ripplenotch
