// SPDX-License-Identifier: MIT
// A diagnosis with what its user decides, and what there is to do next.

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "diagnose/case/band_gaps.hpp"
#include "diagnose/judging/doubt.hpp"
#include "diagnose/telling/next_steps.hpp"
#include "ripplenotch/model/motion.hpp"

namespace ripplenotch {
namespace {

// The effect with its values open, but for those that say which line is meant.
Term open_term(const Term& found) {
    Term term{found.effect, std::vector<std::optional<double>>(found.values.size())};
    for (std::size_t p = 0; p < term.values.size(); ++p) {
        if (found.effect->parameters[p].left_out == LeftOut::refused) term.values[p] = found.values[p];
    }
    return term;
}

bool needs_a_line(const Effect& effect) {
    return std::any_of(effect.parameters.begin(), effect.parameters.end(),
                       [](const Parameter& parameter) { return parameter.left_out == LeftOut::refused; });
}

// What the name stands for in this diagnosis: findings in doubt, or a side of a tie.
std::vector<AcceptedFinding> accepted_of(const Diagnosis& diagnosis, const std::string& name) {
    std::vector<AcceptedFinding> accepted;
    for (const Finding& finding : diagnosis.rounds) {
        const bool doubted = is_doubtful(finding) || finding.status == FindingStatus::ambiguous;
        if (doubted && finding.term.effect->name == name)
            accepted.push_back({finding.term, finding.status, finding.reason, {}});
    }
    if (!accepted.empty()) return accepted;
    for (const Tie& tie : diagnosis.ambiguous) {
        if (std::find(tie.effects.begin(), tie.effects.end(), name) == tie.effects.end()) continue;
        const Effect& effect = find_effect(name);
        if (needs_a_line(effect)) continue;
        accepted.push_back({Term{&effect, std::vector<std::optional<double>>(effect.parameters.size())},
                            FindingStatus::ambiguous,
                            {},
                            {}});
        break;
    }
    return accepted;
}

std::string why_not(const Diagnosis& diagnosis, const std::string& name) {
    std::string there;
    for (const Tie& tie : diagnosis.ambiguous)
        for (const std::string& side : tie.effects) there += (there.empty() ? "" : ", ") + side;
    for (const Finding& finding : diagnosis.rounds)
        if (is_doubtful(finding))
            there += (there.empty() ? "" : ", ") + std::string(finding.term.effect->name);
    const auto& named = diagnosis.named;
    const bool confirmed = std::find(named.begin(), named.end(), name) != named.end();
    return fmt::format(
        "--accept {}: {}; in doubt is {}", name,
        confirmed ? "it is confirmed, and in the model already" : "this log gives no finding of that name",
        there.empty() ? "nothing" : there);
}

// Of the squared gap above the floor.
std::optional<double> closed_of_round(double before_nm, double after_nm, double floor_nm) {
    const double before = before_nm * before_nm - floor_nm * floor_nm;
    if (!(before > 0.0)) return std::nullopt;
    return 100.0 * (1.0 - std::max(after_nm * after_nm - floor_nm * floor_nm, 0.0) / before);
}

void take_gap_before(const DiagnosisGap& first, DiagnosisGap& gap) {
    gap.before_nm = first.before_nm;
    gap.closed_percent = closed_of_round(gap.before_nm, gap.after_nm, gap.noise_floor_nm);
    if (!first.validation_before_nm) return;
    gap.validation_before_nm = first.validation_before_nm;
    gap.validation_closed_percent =
        closed_of_round(*gap.validation_before_nm, *gap.validation_after_nm, gap.noise_floor_nm);
}

// The model as given with what is accepted, its values open.
Diagnosis with_accepted(const Model& model, const TraceView& log, const TraceView* validation,
                        const DiagnosisOptions& options, Diagnosis first) {
    std::vector<AcceptedFinding> accepted;
    for (const std::string& name : options.accept) {
        std::vector<AcceptedFinding> found = accepted_of(first, name);
        if (found.empty()) first.not_accepted.push_back(why_not(first, name));
        for (AcceptedFinding& one : found) accepted.push_back(std::move(one));
    }
    if (accepted.empty()) return first;
    Model larger = model;
    for (const AcceptedFinding& one : accepted) larger.terms.push_back(open_term(one.term));
    Diagnosis told = diagnose(larger, log, validation, options);
    for (std::size_t i = 0; i < accepted.size(); ++i) {
        const std::size_t place = model.terms.size() + i;
        accepted[i].term = told.model.terms.at(place);
        for (const FittedValue& value : told.values)
            if (value.term == place) accepted[i].values.push_back(value);
    }
    told.accepted = std::move(accepted);
    // What the user accepts is not what the log confirms.
    if (told.verdict == DiagnosisVerdict::matches || told.verdict == DiagnosisVerdict::explained)
        told.verdict = DiagnosisVerdict::partly_explained;
    told.baseline.terms.resize(model.terms.size());
    told.disagreement = std::move(first.disagreement);
    told.residual_before_nm = std::move(first.residual_before_nm);
    told.not_accepted = std::move(first.not_accepted);
    take_gap_before(first.gap, told.gap);
    return told;
}

}  // namespace

Diagnosis diagnose_in_full(const Model& model, const TraceView& log, const TraceView* validation,
                           const DiagnosisOptions& options) {
    Diagnosis told = diagnose(model, log, validation, options);
    if (!options.accept.empty()) told = with_accepted(model, log, validation, options, std::move(told));
    if (!told.setup.empty() || !told.ambiguous.empty() || !told.undecidable.empty() ||
        std::any_of(told.rounds.begin(), told.rounds.end(), is_doubtful))
        told.next = next_steps(told, motion_along(log, options.smoothing), options.rules);
    if (!told.residual_after_nm.empty())
        told.bands = band_gaps(log.torque_nm, told.beside_given_nm, told.residual_after_nm, log.sample_rate);
    return told;
}

}  // namespace ripplenotch
