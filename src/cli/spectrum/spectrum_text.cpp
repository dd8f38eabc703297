// SPDX-License-Identifier: MIT
#include "cli/spectrum/spectrum_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <initializer_list>
#include <span>

#include "cli/text_table.hpp"
#include "ripplenotch/core/how_many.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {
namespace {

std::string counted(std::size_t count, std::string_view noun) {
    return count == 0 ? fmt::format("no {}", noun) : how_many(count, noun);
}

std::string line_table(const std::vector<SpectralPeak>& peaks) {
    if (peaks.empty()) return "";
    std::vector<std::vector<std::string>> rows{{"Hz", "+/-", "amplitude, Nm", "phase, deg", "SNR"}};
    for (const SpectralPeak& peak : peaks) {
        rows.push_back({fmt::format("{:.4f}", peak.hz), fmt::format("{:.2g}", peak.hz_stderr),
                        fmt::format("{:.4g}", peak.amplitude_nm), fmt::format("{:.1f}", peak.phase_deg),
                        fmt::format("{:.1f}", peak.snr)});
    }
    return text_table(rows, "r");
}

std::string hump_table(const std::vector<SpectralHump>& humps) {
    if (humps.empty()) return "";
    std::vector<std::vector<std::string>> rows{
        {"hump, Hz", "rms in it, Nm", "highest at, Hz", "amplitude, Nm", "noise, Nm"}};
    for (const SpectralHump& hump : humps) {
        rows.push_back({fmt::format("{:.4g} to {:.4g}", hump.from_hz, hump.to_hz),
                        fmt::format("{:.3g}", hump.rms_nm), fmt::format("{:.4g}", hump.peak_hz),
                        fmt::format("{:.3g}", hump.peak_nm), fmt::format("{:.2g}", hump.floor_nm)});
    }
    return text_table(rows, "r");
}

}  // namespace

namespace {

/// "a,b,c"
void append_cells(std::string& text, std::initializer_list<double> cells) {
    const char* before = "";
    for (const double cell : cells) {
        text += before;
        append_shortest(text, cell);
        before = ",";
    }
    text += "\n";
}

/// A power falls as the square of an amplitude: its small values have finer steps than the digits of the
/// largest.
double power_cell(double largest, double value) {
    constexpr int power_digits = 15;
    return to_digits(to_digits_in_row({.value = value, .largest = largest}, power_digits));
}

double largest_of(std::span<const double> values) {
    return values.empty() ? 0.0 : *std::max_element(values.begin(), values.end());
}

}  // namespace

std::string frequency_csv(const std::vector<StretchSpectrum>& spectra) {
    const bool numbered = spectra.front().number.has_value();
    std::string text = numbered ? "stretch,speed_deg_s,frequency_hz,amplitude_nm,psd_nm2_hz,floor_nm\n"
                                : "frequency_hz,amplitude_nm,psd_nm2_hz,floor_nm\n";
    for (const StretchSpectrum& one : spectra) {
        const Spectrum& s = one.spectrum;
        const double amplitude_nm = largest_of(s.amplitude_nm), psd = largest_of(s.psd_nm2_hz);
        for (std::size_t k = 0; k < s.hz.size(); ++k) {
            if (numbered) {
                text += std::to_string(*one.number) + ",";
                append_shortest(text, one.stretch.speed.value());
                text += ",";
            }
            append_cells(text,
                         {s.hz[k], to_digits_in_row({s.amplitude_nm[k], amplitude_nm}),
                          power_cell(psd, s.psd_nm2_hz[k]), to_digits_in_row({s.floor_nm[k], amplitude_nm})});
        }
    }
    return text;
}

std::string order_csv(const Stack& stack) {
    std::string text = "order_output,amplitude_nm,floor_nm,averages\n";
    const double amplitude_nm = largest_of(stack.amplitude_nm);
    for (std::size_t k = stack.first; k < stack.ratio.size(); ++k) {
        append_cells(text, {static_cast<double>(k) * stack.spacing,
                            to_digits_in_row({stack.amplitude_nm[k], amplitude_nm}),
                            to_digits_in_row({stack.floor_nm[k], amplitude_nm}), stack.averages[k]});
    }
    return text;
}

std::string frequency_peaks(const std::vector<StretchSpectrum>& spectra) {
    std::string text;
    for (const StretchSpectrum& one : spectra) {
        const Spectrum& s = one.spectrum;
        if (!text.empty()) text += "\n";
        text += one.number ? fmt::format("Stretch {}, {:.4g} deg/s: ", *one.number, one.stretch.speed.value())
                           : "";
        const std::string humps = s.humps.empty() ? "" : " and " + counted(s.humps.size(), "hump");
        text += fmt::format("{}{} in {:.4g} s (resolution {:.3g} Hz, floor {:.2g} Nm).\n",
                            counted(s.peaks.size(), "line"), humps, one.stretch.duration.value(),
                            s.resolution.value(), median_floor(s.floor_nm));
        text += line_table(s.peaks) + hump_table(s.humps);
        if (one.stretch.smears_orders())
            text += fmt::format(
                "The speed changes ({:.3g} deg/s, give or take {:.2g}, over the angle turned), so that "
                "what turns with the\njoint is no line here: --domain order counts it by output turn.\n",
                one.stretch.turning_deg_s, one.stretch.turning_spread_deg_s);
    }
    return text;
}

std::string order_peaks(const OrderSpectrum& spectrum) {
    const MotionLines& found = spectrum.lines;
    std::string text = spectrum.doubt.empty() ? "" : fmt::format("Cannot tell: {}.\n", spectrum.doubt);
    text += fmt::format("{} in {} over {:.3g} output turns (resolution {:.3g} orders, floor {:.2g} Nm).\n",
                        found.lines.empty() ? "No line"
                                            : fmt::format("{} line{}", found.lines.size(),
                                                          found.lines.size() == 1 ? "" : "s"),
                        found.sweeps == 1 ? "1 sweep" : fmt::format("{} sweeps", found.sweeps), found.turns,
                        found.resolution_orders, median_floor(spectrum.stack.floor_nm));
    if (found.lines.empty()) return text;
    std::vector<std::vector<std::string>> rows{{"kind", "output order", "+/-", "Hz", "amplitude, Nm", "SNR"}};
    for (const MotionLine& line : found.lines) {
        const bool tone = line.kind == LineKind::tone, order = line.kind == LineKind::order;
        rows.push_back({std::string(line_kind_name(line.kind)),
                        tone ? "-" : fmt::format("{:.3f}", line.order_output),
                        fmt::format("{:.2g}", tone ? line.hz_stderr : line.order_stderr),
                        order ? "-" : fmt::format("{:.3f}", line.hz),
                        fmt::format("{:.4g}", line.amplitude_nm), fmt::format("{:.1f}", line.snr)});
    }
    return text + text_table(rows, "lr");
}

}  // namespace ripplenotch
