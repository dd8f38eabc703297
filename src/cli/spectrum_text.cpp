// SPDX-License-Identifier: MIT
#include "cli/spectrum_text.hpp"

#include <fmt/format.h>

#include <array>

#include "cli/text_table.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {

std::string frequency_csv(const std::vector<StretchSpectrum>& spectra) {
    const bool numbered = spectra.front().number.has_value();
    std::string text = numbered ? "stretch,speed_deg_s,frequency_hz,amplitude_nm,psd_nm2_hz,floor_nm\n"
                                : "frequency_hz,amplitude_nm,psd_nm2_hz,floor_nm\n";
    for (const StretchSpectrum& one : spectra) {
        for (std::size_t k = 0; k < one.spectrum.hz.size(); ++k) {
            if (numbered) {
                text += std::to_string(*one.number) + ",";
                append_shortest(text, one.stretch.speed.value());
                text += ",";
            }
            const std::array cells{one.spectrum.hz[k], one.spectrum.amplitude_nm[k],
                                   one.spectrum.psd_nm2_hz[k], one.spectrum.floor_nm[k]};
            for (std::size_t c = 0; c < cells.size(); ++c) {
                if (c > 0) text += ",";
                append_shortest(text, cells[c]);
            }
            text += "\n";
        }
    }
    return text;
}

std::string order_csv(const Stack& stack) {
    std::string text = "order_output,amplitude_nm,floor_nm,averages\n";
    for (std::size_t k = stack.first; k < stack.ratio.size(); ++k) {
        const std::array cells{static_cast<double>(k) * stack.spacing, stack.amplitude_nm[k],
                               stack.floor_nm[k], stack.averages[k]};
        for (std::size_t c = 0; c < cells.size(); ++c) {
            if (c > 0) text += ",";
            append_shortest(text, cells[c]);
        }
        text += "\n";
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
        text += fmt::format("{} in {:.4g} s (resolution {:.3g} Hz, floor {:.2g} Nm).\n",
                            s.peaks.empty()
                                ? "no line"
                                : fmt::format("{} line{}", s.peaks.size(), s.peaks.size() == 1 ? "" : "s"),
                            one.stretch.duration.value(), s.resolution.value(), median_floor(s.floor_nm));
        if (s.peaks.empty()) continue;
        std::vector<std::vector<std::string>> rows{{"Hz", "+/-", "amplitude, Nm", "phase, deg", "SNR"}};
        for (const SpectralPeak& peak : s.peaks) {
            rows.push_back({fmt::format("{:.4f}", peak.hz), fmt::format("{:.2g}", peak.hz_stderr),
                            fmt::format("{:.4g}", peak.amplitude_nm), fmt::format("{:.1f}", peak.phase_deg),
                            fmt::format("{:.1f}", peak.snr)});
        }
        text += text_table(rows, "r");
    }
    return text;
}

std::string order_peaks(const OrderSpectrum& spectrum) {
    const MotionLines& found = spectrum.lines;
    std::string text =
        fmt::format("{} in {} over {:.3g} output turns (resolution {:.3g} orders, floor {:.2g} Nm).\n",
                    found.lines.empty()
                        ? "No line"
                        : fmt::format("{} line{}", found.lines.size(), found.lines.size() == 1 ? "" : "s"),
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
