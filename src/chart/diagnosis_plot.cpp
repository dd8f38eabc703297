// SPDX-License-Identifier: MIT
#include "ripplenotch/chart/diagnosis_plot.hpp"

#include <fmt/format.h>

#include "ripplenotch/chart/diagnosis_figures.hpp"
#include "ripplenotch/model/measured_motion.hpp"

namespace ripplenotch {
namespace {

std::vector<double> residual_of(const Model& model, const TraceView& log, Seconds smoothing) {
    std::vector<double> residual_nm = predict_nm(model, motion_along(log, smoothing));
    for (std::size_t k = 0; k < residual_nm.size(); ++k) residual_nm[k] = log.torque_nm[k] - residual_nm[k];
    return residual_nm;
}

std::string in_words(const Diagnosis& diagnosis) {
    std::string named;
    for (const std::string& name : diagnosis.named) named += (named.empty() ? "" : ", ") + name;
    return fmt::format("{}: {}; gap from {:.3g} to {:.3g} Nm rms, noise floor {:.3g} Nm.",
                       verdict_name(diagnosis.verdict), named.empty() ? "no effect is named" : named,
                       diagnosis.gap.before_nm, diagnosis.gap.after_nm, diagnosis.gap.noise_floor_nm);
}

}  // namespace

Figure diagnosis_figure(const std::string& source, const Diagnosis& diagnosis, const TraceView& log,
                        Seconds smoothing) {
    std::vector<GapRound> rounds;
    for (const Finding& finding : diagnosis.rounds) {
        const std::string effect(finding.term.effect->name);
        const bool sure = finding.status == FindingStatus::confirmed;
        rounds.push_back({sure ? effect : fmt::format("{} ({})", effect, status_name(finding.status)),
                          finding.gap_before_nm, finding.gap_after_nm});
    }
    const std::vector<double> before = residual_of(diagnosis.baseline, log, smoothing);
    const std::vector<double> after = residual_of(diagnosis.model, log, smoothing);
    Figure figure = residual_figure(fmt::format("Model and log: {}", source), in_words(diagnosis),
                                    {log.time_s, log.velocity_deg_s, log.position_deg, before, after},
                                    diagnosis.gap.noise_floor_nm);
    figure.name = "diagnosis";
    Figure gap = gap_figure("", "", rounds, diagnosis.gap.noise_floor_nm);
    gap.panels.front().title = "The gap, round by round";
    figure.panels.insert(figure.panels.begin(), std::move(gap.panels.front()));
    return figure;
}

}  // namespace ripplenotch
