// SPDX-License-Identifier: MIT
// What most joints have today, and the rival in the paper.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "filter/method.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/design/notch.hpp"

namespace ripplenotch {
namespace {

constexpr std::array keys = {
    Key{.name = "cutoff",
        .dimension = Dimension::frequency,
        .required = true,
        .above = 0.0,
        .help = "-3 dB frequency, e.g. 13Hz or 13rad/s"},
    Key{.name = "order",
        .default_text = "1",
        .above = 0.0,
        .at_most = 20.0,
        .whole = true,
        .help = "1 (one real pole) to 20"},
};

LowPassSpec low_pass(const Settings& settings) {
    return {.cutoff = Hertz(settings.number("cutoff")), .order = static_cast<int>(settings.number("order"))};
}

Cascade cascade(const Settings& settings, Hertz sample_rate) {
    return design_low_pass(low_pass(settings), sample_rate);
}

SteadyDesign steady(const Settings& settings) { return low_pass(settings); }

std::unique_ptr<CausalFilter> start(const Settings& settings, Hertz sample_rate, const CandidateTable*) {
    return std::make_unique<CascadeFilter>(cascade(settings, sample_rate));
}

// Of the lowest line at the median speed.
constexpr std::array shares_of_line = {0.5, 0.25, 0.1};

Trials trials(const TrialConditions& log) {
    Trials found;
    for (const double share : shares_of_line)
        found.all.push_back(
            {fmt::format(",cutoff={:.3g}Hz,order=1",
                         std::min(share * log.line(0, log.median).value(), 0.2 * log.update_rate.value()))});
    return found;
}

double multiplications(const Settings& settings, const CandidateTable*) {
    return section_multiplications * std::ceil(settings.number("order") / 2.0);
}

FrozenFilter frozen(const Settings& settings, Hertz sample_rate, const CandidateTable*, DegPerSec) {
    return {cascade(settings, sample_rate), fmt::format("low-pass of order {}, {} Hz", settings.text("order"),
                                                        shortest(settings.number("cutoff")))};
}

}  // namespace

const Method filter_methods::lowpass = {
    .name = "lowpass",
    .summary = "Butterworth low-pass of any order, cut-off in Hz or rad/s",
    .source = "S. Butterworth 1930; bilinear transform prewarped at the cut-off",
    .noun = "a low-pass",
    .part = MethodPart::rival,
    .keys = keys,
    .start = start,
    .frozen = frozen,
    .steady = steady,
    .trials = trials,
    .multiplications = multiplications,
};

}  // namespace ripplenotch
