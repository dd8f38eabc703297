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

}  // namespace

Spectrum torque_spectrum(const TraceView& trace, const SpectrumOptions& options) {
    const std::size_t length = length_of_pieces(trace, options);
    Welch welch(length, trace.sample_rate);
    welch.add(trace.time_s, trace.torque_nm);
    if (welch.find_lines(options.false_alarm)) welch.measure(trace.time_s, trace.torque_nm);
    return welch.spectrum();
}

}  // namespace ripplenotch
