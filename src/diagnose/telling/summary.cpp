// SPDX-License-Identifier: MIT
#include "diagnose/telling/summary.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "diagnose/judging/judge.hpp"
#include "diagnose/search/search.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

double residual_rms(const Case& c, const Model& stated, const std::vector<unsigned char>& use) {
    return rms_of(residual_nm(c, stated), use);
}

// Part of the squared gap above the floor that is gone, of samples that no fault spoiled. Empty when there
// was no gap to speak of.
std::optional<double> closed_percent(const GapCase& c, const Diagnosis& diagnosis, double least_gap) {
    const double floor = portable::pow(diagnosis.gap.noise_floor_nm, 2);
    const double before =
        portable::pow(residual_rms(c.as_given, diagnosis.baseline, c.as_given.use), 2) - floor;
    const double after = portable::pow(residual_rms(c.improved, diagnosis.model, c.improved.use), 2) - floor;
    if (before < least_gap * floor) return std::nullopt;
    const double closed = 100.0 * (1.0 - std::max(after, 0.0) / before);
    return std::abs(closed) < 1e-3 ? 0.0 : closed;  // the same model, fitted anew
}

}  // namespace

DiagnosisVerdict verdict_of(const Diagnosis& diagnosis) {
    const bool told = !diagnosis.named.empty() || !diagnosis.ambiguous.empty();
    const bool doubtful = std::any_of(diagnosis.rounds.begin(), diagnosis.rounds.end(), is_doubtful);
    if (diagnosis.unexplained.empty() && !doubtful)
        return told ? DiagnosisVerdict::explained : DiagnosisVerdict::matches;
    return told ? DiagnosisVerdict::partly_explained : DiagnosisVerdict::unexplained;
}

void name_findings(Diagnosis& diagnosis, const DiagnosisRules& rules) {
    std::set<std::set<std::string>> ties;
    for (const Finding& finding : diagnosis.rounds) {
        const Effect& effect = *finding.term.effect;
        const std::string name(effect.name);
        auto& named = diagnosis.named;
        if (finding.status == FindingStatus::confirmed &&
            std::find(named.begin(), named.end(), name) == named.end())
            named.push_back(name);
        if (finding.status != FindingStatus::ambiguous) continue;
        Tie tie{{name}, {}};
        for (const RivalFinding& rival : finding.alternatives) {
            if (rival.margin >= rules.judge.tie_margin) continue;
            tie.effects.emplace_back(rival.effect);
            if (tie.advice.empty()) tie.advice = what_would_tell(effect, find_effect(rival.effect));
        }
        if (ties.insert({tie.effects.begin(), tie.effects.end()}).second) diagnosis.ambiguous.push_back(tie);
    }
}

void measure_gap(Diagnosis& diagnosis, const GapCase& whole, const GapCase* validation,
                 const DiagnosisRules& rules) {
    DiagnosisGap& gap = diagnosis.gap;
    const std::vector<unsigned char> all(whole.improved.size(), 1);
    gap.before_nm = residual_rms(whole.as_given, diagnosis.baseline, all);
    gap.after_nm = residual_rms(whole.improved, diagnosis.model, all);
    gap.closed_percent = closed_percent(whole, diagnosis, rules.values.least_gap);
    if (validation == nullptr) return;
    const std::vector<unsigned char> every(validation->improved.size(), 1);
    gap.validation_before_nm = residual_rms(validation->as_given, diagnosis.baseline, every);
    gap.validation_after_nm = residual_rms(validation->improved, diagnosis.model, every);
    gap.validation_closed_percent = closed_percent(*validation, diagnosis, rules.values.least_gap);
}

}  // namespace ripplenotch
