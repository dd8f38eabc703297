// SPDX-License-Identifier: MIT
#include "cli/identify/identify_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace ripplenotch {
namespace {

std::string range(double from, double to, int digits) {
    const std::string low = fmt::format("{:.{}g}", from, digits), high = fmt::format("{:.{}g}", to, digits);
    return low == high ? low : low + "-" + high;
}

std::string hz_range(const Line& line) {
    if (line.hz) return fmt::format("{:.5g}", *line.hz);
    const auto seen = seen_frequencies(line);
    return seen ? range(seen->lowest_hz, seen->highest_hz, 4) : "-";
}

/// At one speed a line is the one or the other.
std::string_view kind_text(const Line& line) {
    return line.kind == LineKind::unknown ? "order or tone" : line_kind_name(line.kind);
}

std::string line_row(const Line& line, std::size_t kind_width) {
    return fmt::format("{:<{}} {:>5} {:>13} {:>13} {:>10.3g} {:>8} {:>6.1f} {:>12}  {}", kind_text(line),
                       kind_width, line.order ? fmt::format("{:.4g}", *line.order) : "-",
                       line.order_output ? fmt::format("{:.3f}", *line.order_output) : "-", hz_range(line),
                       line.amplitude_nm,
                       line.phase_known ? fmt::format("{:.0f}", std::round(line.phase_deg) + 0.0) : "-",
                       line.snr, range(line.speed_from_deg_s, line.speed_to_deg_s, 3), line.note);
}

/// One recording a row, with the line's amplitude or the ratio as it alone tells it.
std::string disagreement_table(const Disagreement& one, const std::vector<std::string>& recordings) {
    const bool ratio = one.about == Disagreement::About::ratio;
    const bool phase = one.about == Disagreement::About::phase;
    std::string text = "\nthe recordings disagree: ";
    if (!ratio) {
        text += one.order ? fmt::format("order {:g}", *one.order)
                          : fmt::format("output order {:.5g}", *one.order_output);
    }
    text += ratio   ? "gear ratio\n"
            : phase ? ", phase in deg (the wave generator or the encoder's zero may have been turned)\n"
                    : ", Nm\n";
    for (const Disagreement::Value& value : one.values) {
        const std::string name = value.recording < recordings.size()
                                     ? recordings[value.recording]
                                     : fmt::format("recording {}", value.recording + 1);
        text +=
            fmt::format("{:>10.{}g} +/- {:<8.2g} {}\n", value.value, ratio ? 6 : 3, 2.0 * value.error, name);
    }
    return text;
}

std::string trimmed(std::string text) {
    while (!text.empty() && text.back() == ' ') text.pop_back();
    return text;
}

}  // namespace

std::string identification_report(const Identification& found, const std::vector<std::string>& recordings) {
    std::string text = found.joint.empty() ? "" : found.joint + ": ";
    text += found.verdict + "\n";
    const GearRatioFit& ratio = found.gear_ratio;
    if (ratio.value) {
        text += fmt::format("\ngear ratio {:.4f}, standard error {:.2g}, 95 % interval {:.4f} to {:.4f}\n",
                            *ratio.value, ratio.standard_error, ratio.ci95_low, ratio.ci95_high);
    }
    if (!found.lines.empty()) {
        std::size_t width = 8;
        for (const Line& line : found.lines) width = std::max(width, kind_text(line).size());
        text += "\n" +
                trimmed(fmt::format("{:<{}} {:>5} {:>13} {:>13} {:>10} {:>8} {:>6} {:>12}", "kind", width,
                                    "order", "output order", "Hz", "amplitude", "phase", "SNR", "speed")) +
                "\n";
        text += trimmed(fmt::format("{:<{}} {:>5} {:>13} {:>13} {:>10} {:>8} {:>6} {:>12}", "", width, "",
                                    "per turn", "", "Nm", "deg", "", "deg/s")) +
                "\n";
        for (const Line& line : found.lines) text += trimmed(line_row(line, width)) + "\n";
    }
    if (ratio.second_comb)
        text += fmt::format("second comb: {:.4f} turns of the wave generator against the other spline\n",
                            *ratio.second_comb);
    if (ratio.candidates.size() > (ratio.value ? 1U : 0U)) {
        text += ratio.value ? "\nrival ratios\n" : "\npossible ratios\n";
        for (std::size_t i = ratio.value ? 1 : 0; i < ratio.candidates.size(); ++i) {
            const RatioCandidate& candidate = ratio.candidates[i];
            text += fmt::format("{:>10.3f}  score {:.3f}  {}\n", candidate.value, candidate.score,
                                candidate.reason);
        }
    }
    for (const Disagreement& one : found.disagreements) text += disagreement_table(one, recordings);
    if (!found.notes.empty()) text += "\n";
    for (const std::string& note : found.notes) text += "note: " + note + "\n";
    return text;
}

}  // namespace ripplenotch
