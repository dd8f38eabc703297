// SPDX-License-Identifier: MIT
#include "ripplenotch/chart/diagnosis_figure.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "ripplenotch/chart/residual_figure.hpp"
#include "ripplenotch/model/measured_motion.hpp"

namespace ripplenotch {
namespace {

std::vector<double> residual_of(const Model& model, const TraceView& log, Seconds smoothing) {
    std::vector<double> residual_nm = predict_nm(model, motion_along(log, smoothing));
    for (std::size_t k = 0; k < residual_nm.size(); ++k) residual_nm[k] = log.torque_nm[k] - residual_nm[k];
    return residual_nm;
}

// "coulomb-friction", "ripple (ambiguous)"
std::string round_name(const Finding& finding) {
    if (finding.status == FindingStatus::confirmed) return std::string(finding.term.effect->name);
    return fmt::format("{} ({})", finding.term.effect->name, status_name(finding.status));
}

}  // namespace

std::string diagnosis_sentence(const Diagnosis& diagnosis) {
    return fmt::format(
        "{}: {}; gap from {:.3g} to {:.3g} Nm rms, noise floor {:.3g} Nm", verdict_name(diagnosis.verdict),
        diagnosis.named.empty() ? "no effect is named" : fmt::format("{}", fmt::join(diagnosis.named, ", ")),
        diagnosis.gap.before_nm, diagnosis.gap.after_nm, diagnosis.gap.noise_floor_nm);
}

Figure gap_figure(const std::string& title, const Diagnosis& diagnosis) {
    const std::vector<Finding>& rounds = diagnosis.rounds;
    Panel panel{.title = "", .x = {"round", "", PlotScale::whole}, .y = {"rms residual", "Nm"}};
    panel.x.from = -0.5;
    panel.x.to = static_cast<double>(rounds.size()) + 0.5;
    panel.y.from = 0.0;
    Curve gap{"gap", Ink::blue, CurveStyle::line, {}, {}};
    gap.x.push_back(0.0);
    gap.y.push_back(rounds.empty() ? diagnosis.gap.before_nm : rounds.front().gap_before_nm);
    for (std::size_t i = 0; i < rounds.size(); ++i) {
        gap.x.push_back(static_cast<double>(i + 1));
        gap.y.push_back(rounds[i].gap_after_nm);
        panel.lines.push_back({fmt::format("{}: {}", i + 1, round_name(rounds[i])), NamedLine::Run::at_x,
                               static_cast<double>(i + 1), Ink::grey});
    }
    Curve points = gap;
    points.name.clear();
    points.style = CurveStyle::points;
    panel.curves = {std::move(gap), std::move(points)};
    panel.lines.push_back({"noise floor", NamedLine::Run::at_y, diagnosis.gap.noise_floor_nm, Ink::black});
    return {"gap", title, "", {std::move(panel)}};
}

Figure diagnosis_figure(const std::string& source, const Diagnosis& diagnosis, const TraceView& log,
                        Seconds smoothing) {
    const bool given = !diagnosis.residual_after_nm.empty();
    const std::vector<double> before =
        given ? diagnosis.residual_before_nm : residual_of(diagnosis.baseline, log, smoothing);
    std::vector<double> after;  // none where nothing was added: the same picture twice
    if (!diagnosis.rounds.empty())
        after = given ? diagnosis.residual_after_nm : residual_of(diagnosis.model, log, smoothing);
    Figure figure = residual_figure(
        fmt::format("Model and log: {}", source), diagnosis_sentence(diagnosis) + ".",
        {log.time_s, log.velocity_deg_s, log.position_deg, before, after}, diagnosis.gap.noise_floor_nm);
    figure.name = "diagnosis";
    Panel gap = std::move(gap_figure("", diagnosis).panels.front());
    gap.title = "The gap, round by round";
    figure.panels.insert(figure.panels.begin(), std::move(gap));
    return figure;
}

}  // namespace ripplenotch
