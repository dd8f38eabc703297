// SPDX-License-Identifier: MIT
// Notches that stay where they are: right for a joint that moves at one speed, and for lines that do not
// follow speed.
#include <fmt/format.h>

#include <array>

#include "filter/method.hpp"
#include "ripplenotch/design/notch.hpp"

namespace ripplenotch {
namespace {

constexpr std::array keys = {
    Key{.name = "centers",
        .kind = KeyKind::list,
        .dimension = Dimension::frequency,
        .required = true,
        .above = 0.0,
        .help = "centre frequencies, e.g. 25Hz:50Hz"},
    Key{.name = "q",
        .default_text = "0.25",
        .above = 0.0,
        .help = "centre over -3 dB bandwidth; 0.25 is the paper's twin-T"},
    Key{.name = "depth",
        .dimension = Dimension::decibel,
        .above = 0.0,
        .help = "attenuation at the centre, e.g. 20dB; a full null when not given"},
    Key{.name = "width",
        .default_text = "analog",
        .choices = "analog digital",
        .help = "whether Q is that of the analogue prototype (the paper) or of the sampled filter (SciPy's "
                "iirnotch)"},
};

std::vector<NotchSpec> notches(const Settings& settings) {
    NotchSpec spec;
    spec.q = settings.number("q");
    if (settings.has("depth")) spec.depth_db = settings.number("depth");
    spec.width = settings.text("width") == "digital" ? WidthRule::digital : WidthRule::analog;
    std::vector<NotchSpec> notches;
    for (const double center_hz : settings.list("centers")) {
        spec.center = Hertz(center_hz);
        notches.push_back(spec);
    }
    return notches;
}

Cascade cascade(const Settings& settings, Hertz sample_rate) {
    Cascade sections;
    for (const NotchSpec& notch : notches(settings)) sections.push_back(design_notch(notch, sample_rate));
    return sections;
}

SteadyDesign steady(const Settings& settings) { return notches(settings); }

std::unique_ptr<CausalFilter> start(const Settings& settings, Hertz sample_rate, const CandidateTable*) {
    return std::make_unique<CascadeFilter>(cascade(settings, sample_rate));
}

constexpr double same_speed = 1.1;       // of the median speed: notches that stand still are for one speed
constexpr double highest_center = 0.45;  // of the rate at which the torque is updated

Trials trials(const TrialConditions& log) {
    const std::size_t orders = log.gear.orders.size();
    if (log.fastest > same_speed * log.median ||
        !(log.line(orders - 1, log.fastest) < highest_center * log.update_rate))
        return {{}, "the speed changes, and with it the frequency of the ripple"};
    std::string centers;
    for (std::size_t i = 0; i < orders; ++i)
        centers += fmt::format("{}{:.3g}Hz", i == 0 ? "" : ":", log.line(i, log.median).value());
    return {{{fmt::format(",centers={},q=0.25", centers)}, {fmt::format(",centers={},q=1", centers)}}};
}

double multiplications(const Settings& settings, const CandidateTable*) {
    return section_multiplications * static_cast<double>(settings.list("centers").size());
}

FrozenFilter frozen(const Settings& settings, Hertz sample_rate, const CandidateTable*, DegPerSec) {
    return {cascade(settings, sample_rate), "notches at " + settings.text("centers")};
}

}  // namespace

const Method filter_methods::fixed = {
    .name = "fixed",
    .summary = "notches at stated frequencies, whatever the speed",
    .source = "Kim, Kim, Song 2011, eq. 2 (q=0.25)",
    .noun = "fixed notches",
    .keys = keys,
    .start = start,
    .frozen = frozen,
    .steady = steady,
    .trials = trials,
    .multiplications = multiplications,
};

}  // namespace ripplenotch
