// SPDX-License-Identifier: MIT
#include "ripplenotch/analysis/spectrum.hpp"

#include <algorithm>
#include <cmath>

#include "analysis/spectrum/welch.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {
std::size_t piece_length(std::size_t samples, Hertz rate, const SpectrumOptions& options) {
    std::size_t length = samples;
    if (options.segment) {
        const double asked = options.segment->value() * rate.value();
        length = std::min(length, static_cast<std::size_t>(std::llround(asked)));
    }
    return length;
}

void require_piece_length(std::size_t length, const SpectrumOptions& options) {
    if (length < fewest_spectrum_samples) {
        raise<DataError>("a spectrum needs at least {} samples, there are {}{}", fewest_spectrum_samples,
                         length, options.segment ? "; use a longer --segment" : "");
    }
}

Spectrum torque_spectrum(const TraceView& trace, const SpectrumOptions& options) {
    const std::size_t length = piece_length(trace.size(), trace.sample_rate, options);
    require_piece_length(length, options);
    Welch welch(length, trace.sample_rate);
    welch.add(trace.time_s, trace.torque_nm);
    if (welch.find_lines(options.false_alarm)) welch.measure(trace.time_s, trace.torque_nm);
    return welch.spectrum();
}

}  // namespace ripplenotch
