// SPDX-License-Identifier: MIT
#include "ripplenotch/chart/spectrum_figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "ripplenotch/core/number.hpp"
#include "ripplenotch/figure/min_max.hpp"

namespace ripplenotch {
namespace {

// The noise and a little below it; a spectrum without noise (simulated) must not fill the page with rounding.
double lowest_shown(const std::vector<double>& amplitude_nm, const std::vector<double>& floor_nm) {
    const double highest = *std::max_element(amplitude_nm.begin(), amplitude_nm.end());
    std::vector<double> known;
    for (const double floor : floor_nm)
        if (floor > 0.0) known.push_back(floor);
    double low = 1e-5 * highest;
    if (!known.empty()) {
        std::nth_element(known.begin(), known.begin() + static_cast<std::ptrdiff_t>(known.size() / 2),
                         known.end());
        low = std::max(low, 0.25 * known[known.size() / 2]);
    }
    return std::min(low, 0.1 * highest);
}

std::vector<double> where_known(std::vector<double> floor_nm) {
    for (double& floor : floor_nm)
        if (!(floor > 0.0)) floor = not_a_number;
    return floor_nm;
}

PlotAxis amplitude_axis(const std::vector<double>& amplitude_nm, const std::vector<double>& floor_nm) {
    const double highest = *std::max_element(amplitude_nm.begin(), amplitude_nm.end());
    PlotAxis axis{"amplitude, zero to peak", "Nm", PlotScale::logarithmic};
    if (highest > 0.0) {
        axis.from = lowest_shown(amplitude_nm, floor_nm);
        axis.to = 1.5 * highest;
    }
    return axis;
}

Panel spectrum_panel(const ShownSpectrum& shown) {
    const Spectrum& spectrum = *shown.spectrum;
    Panel panel{.title = shown.name,
                .x = {"frequency", "Hz"},
                .y = amplitude_axis(spectrum.amplitude_nm, spectrum.floor_nm)};
    panel.curves.push_back(
        thinned({"torque", Ink::blue, CurveStyle::line, spectrum.hz, spectrum.amplitude_nm}));
    panel.curves.push_back(thinned(
        {"noise floor", Ink::black, CurveStyle::dashed, spectrum.hz, where_known(spectrum.floor_nm)}));
    for (std::size_t i = 0; i < std::min(spectrum.peaks.size(), most_named_lines); ++i) {
        const SpectralPeak& peak = spectrum.peaks[i];
        panel.lines.push_back({fmt::format("{:.4g} Hz, {:.3g} Nm", peak.hz, peak.amplitude_nm),
                               NamedLine::Run::at_x, peak.hz, Ink::vermilion});
    }
    return panel;
}

std::string lines_in_words(std::size_t count) {
    return count == 0   ? "No line stands out of the noise"
           : count == 1 ? "One line stands out of the noise"
                        : fmt::format("{} lines stand out of the noise", count);
}

/// "; 2 humps do, the strongest from 59 to 61 Hz with 0.6 Nm rms"
std::string humps_in_words(std::span<const ShownSpectrum> spectra) {
    std::size_t count = 0;
    const SpectralHump* strongest = nullptr;
    for (const ShownSpectrum& shown : spectra) {
        for (const SpectralHump& hump : shown.spectrum->humps) {
            ++count;
            if (strongest == nullptr || hump.rms_nm > strongest->rms_nm) strongest = &hump;
        }
    }
    if (count == 0) return "";
    return fmt::format("; {} from {:.3g} to {:.3g} Hz with {:.2g} Nm rms",
                       count == 1 ? "a hump does," : fmt::format("{} humps do, the strongest", count),
                       strongest->from_hz, strongest->to_hz, strongest->rms_nm);
}

}  // namespace

Figure spectrum_figure(const std::string& source, std::span<const ShownSpectrum> spectra) {
    Figure figure{"spectrum", fmt::format("Spectrum of the torque: {}", source), "", {}};
    std::size_t lines = 0;
    for (const ShownSpectrum& shown : spectra) {
        lines += shown.spectrum->peaks.size();
        if (figure.panels.size() < most_spectrum_panels) figure.panels.push_back(spectrum_panel(shown));
    }
    figure.sentence = lines_in_words(lines);
    if (spectra.size() > 1) figure.sentence += fmt::format(" of {} stretches", spectra.size());
    if (spectra.size() > most_spectrum_panels)
        figure.sentence += fmt::format(", of which the first {} are shown", most_spectrum_panels);
    figure.sentence += humps_in_words(spectra);
    figure.sentence += ".";
    if (std::any_of(spectra.begin(), spectra.end(), [](const ShownSpectrum& s) { return s.smears_orders; }))
        figure.sentence +=
            " The speed changes: what turns with the joint is a line by order (--domain order), not here.";
    return figure;
}

Figure order_spectrum_figure(const std::string& source, const Stack& stack, const MotionLines& lines) {
    std::vector<double> order, amplitude_nm, floor_nm;
    for (std::size_t k = stack.first; k < stack.ratio.size(); ++k) {
        order.push_back(static_cast<double>(k) * stack.spacing);
        const bool seen = stack.averages[k] > 0.0;
        amplitude_nm.push_back(seen ? stack.amplitude_nm[k] : 0.0);
        floor_nm.push_back(seen ? stack.floor_nm[k] : 0.0);
    }
    Panel panel{
        .title = "", .x = {"order", "cycles per output turn"}, .y = amplitude_axis(amplitude_nm, floor_nm)};
    panel.curves.push_back(thinned({"torque", Ink::blue, CurveStyle::line, order, amplitude_nm}));
    panel.curves.push_back(
        thinned({"noise floor", Ink::black, CurveStyle::dashed, order, where_known(std::move(floor_nm))}));
    for (const MotionLine& line : lines.lines) {
        if (line.kind == LineKind::tone || panel.lines.size() == most_named_lines) continue;
        panel.lines.push_back({fmt::format("order {:.5g}, {:.3g} Nm", line.order_output, line.amplitude_nm),
                               NamedLine::Run::at_x, line.order_output, Ink::vermilion});
    }
    return {"order-spectrum",
            fmt::format("Order spectrum of the torque: {}", source),
            fmt::format("{} over {:.3g} output turns.", lines_in_words(lines.lines.size()), lines.turns),
            {std::move(panel)}};
}

}  // namespace ripplenotch
