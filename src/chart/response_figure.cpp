// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <cmath>
#include <utility>
#include <vector>

#include "ripplenotch/chart/spectrum_figure.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/figure/min_max.hpp"

namespace ripplenotch {

namespace {

// Ribbons of more parts would be a blur, and a large file.
constexpr std::size_t most_ribbon_bins = 4000;

/// Values with half or whole intervals; nan where they are not known.
struct Band {
    std::vector<double> value, low, high;
};

Band gain_band(const FrequencyResponse& response) {
    Band band;
    for (std::size_t k = 0; k < response.hz.size(); ++k) {
        band.value.push_back(decibels(response.gain[k]));
        band.low.push_back(decibels(response.gain_low[k]));
        band.high.push_back(decibels(response.gain_high[k]));
    }
    return band;
}

// Within a range the phase goes on where it ended.
Band phase_band(const FrequencyResponse& response) {
    Band band{response.phase_deg, {}, {}};
    for (const BinRange& range : response.ranges) {
        double before = response.phase_deg[range.first];
        for (std::size_t k = range.first; k < range.end; ++k) {
            if (!response.determined(k)) continue;
            before += std::remainder(response.phase_deg[k] - before, 360.0);
            band.value[k] = before;
        }
    }
    for (std::size_t k = 0; k < band.value.size(); ++k) {
        band.low.push_back(band.value[k] - response.phase_error_deg[k]);
        band.high.push_back(band.value[k] + response.phase_error_deg[k]);
    }
    return band;
}

Panel panel_of(const ResponseReport& report, PlotAxis axis, const Band& band) {
    const FrequencyResponse& response = report.response;
    Panel panel{.title = "", .x = {"frequency", "Hz", PlotScale::logarithmic}, .y = std::move(axis)};
    panel.x.from = response.hz[1];
    panel.x.to = response.hz.back();
    Ribbon ribbon{"", Ink::blue, {}, {}, {}};
    for (std::size_t k = 0; k <= band.value.size(); ++k) {
        const bool known = k < band.value.size() && std::isfinite(band.low[k]) && std::isfinite(band.high[k]);
        if (known) {
            ribbon.x.push_back(response.hz[k]);
            ribbon.low.push_back(band.low[k]);
            ribbon.high.push_back(band.high[k]);
        } else if (!ribbon.x.empty()) {
            if (ribbon.x.size() > 1 && response.hz.size() <= most_ribbon_bins)
                panel.ribbons.push_back(ribbon);
            ribbon.x.clear();
            ribbon.low.clear();
            ribbon.high.clear();
        }
    }
    panel.curves.push_back(thinned({"measured", Ink::blue, CurveStyle::line, response.hz, band.value}));
    // A line of one point would not be seen.
    Curve single{"", Ink::blue, CurveStyle::points, {}, {}};
    for (std::size_t k = 1; k + 1 < band.value.size(); ++k) {
        if (std::isnan(band.value[k]) || !std::isnan(band.value[k - 1]) || !std::isnan(band.value[k + 1]))
            continue;
        single.x.push_back(response.hz[k]);
        single.y.push_back(band.value[k]);
    }
    if (!single.x.empty()) panel.curves.push_back(std::move(single));
    return panel;
}

void add_predicted(const ResponseReport& report, const Band& phase, Panel& gain_panel, Panel& phase_panel) {
    if (!report.predicted) return;
    Curve gain{"predicted", Ink::vermilion, CurveStyle::dashed, {}, {}}, angle = gain;
    double before = 0.0;
    for (std::size_t k = 1; k < report.response.hz.size(); ++k) {
        const std::complex<double>& at = report.predicted->at[k];
        const double deg = portable::arg(at) * degrees_per_radian;
        // The turn of the measured phase, where there is one.
        before += std::remainder(deg - before, 360.0);
        if (std::isfinite(phase.value[k])) before += 360.0 * std::round((phase.value[k] - before) / 360.0);
        const double db = decibels(portable::hypot(at.real(), at.imag()));
        for (Curve* const curve : {&gain, &angle}) curve->x.push_back(report.response.hz[k]);
        gain.y.push_back(std::isfinite(db) ? db : not_a_number);
        angle.y.push_back(before);
    }
    gain_panel.curves.push_back(thinned(gain));
    phase_panel.curves.push_back(thinned(angle));
}

}  // namespace

Figure response_figure(const std::string& source, const ResponseReport& report) {
    const FrequencyResponse& response = report.response;
    const Band phase = phase_band(response);
    Panel gains = panel_of(report, {"gain", "dB"}, gain_band(response));
    Panel phases = panel_of(report, {"phase", "deg"}, phase);
    add_predicted(report, phase, gains, phases);
    phases.legend = false;
    Panel coherence{.title = "",
                    .x = {"frequency", "Hz", PlotScale::logarithmic},
                    .y = {"coherence"},
                    .legend = false,
                    .height = 0.6};
    coherence.x.from = gains.x.from;
    coherence.x.to = gains.x.to;
    coherence.y.from = 0.0;
    coherence.y.to = 1.0;
    coherence.curves.push_back(
        thinned({"coherence", Ink::blue, CurveStyle::line, response.hz, response.coherence}));
    coherence.lines.push_back({fmt::format("{:.2g}, 95 % limit", response.coherence_limit),
                               NamedLine::Run::at_y, response.coherence_limit});
    return {"response",
            fmt::format("Frequency response {}/{}: {}", report.out, report.in, source),
            response_verdict(report),
            {std::move(gains), std::move(phases), std::move(coherence)}};
}

}  // namespace ripplenotch
