// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <string>
#include <utility>

#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/visible_text.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"

namespace ripplenotch {

namespace {

// "1.500 +/- 0.010 Nm": the size of a finding with half of its 95 % interval.
std::string size_text(const Finding& finding) {
    const Effect& effect = *finding.term.effect;
    std::string text;
    for (std::size_t p = 0; p < effect.parameters.size(); ++p) {
        if (effect.parameters[p].left_out == LeftOut::refused)
            text += fmt::format(" {} {:.4g}", effect.parameters[p].name, *finding.term.values[p]);
    }
    // Of several factors the first whose interval does not hold 0.
    const auto rank = [&](const FittedValue& value) {
        return std::pair(effect.parameters[value.parameter].linear,
                         !value.ci95 || value.ci95->low > 0.0 || value.ci95->high < 0.0);
    };
    const FittedValue* size = nullptr;
    for (const FittedValue& value : finding.values)
        if (size == nullptr || rank(value) > rank(*size)) size = &value;
    if (size == nullptr) return text;
    const Parameter& parameter = effect.parameters[size->parameter];
    text += " " + (size->ci95 ? with_error(size->value, 0.5 * (size->ci95->high - size->ci95->low))
                              : fmt::format("{:.4g}", size->value));
    return parameter.unit.empty() ? text : fmt::format("{} {}", text, parameter.unit);
}

}  // namespace

bool simulation_exceeds(const Diagnosis& diagnosis, const Finding& finding) {
    return diagnosis.model.beside_simulation && finding.term.effect->resists &&
           finding.term.values.front().value_or(0.0) < 0.0;
}

std::string diagnosis_sentence(const Diagnosis& diagnosis) {
    if (!diagnosis.doubt.empty()) return diagnosis.doubt;
    std::string names;
    const auto add = [&](const std::string& name) { names += (names.empty() ? "" : ", ") + name; };
    for (const Finding& finding : diagnosis.rounds) {
        if (finding.status != FindingStatus::confirmed) continue;
        add(fmt::format(
            "{}{}{}", finding.term.effect->name, size_text(finding),
            simulation_exceeds(diagnosis, finding) ? " (the simulation has too much of it)" : ""));
    }
    for (const Tie& tie : diagnosis.ambiguous) add(joined(tie.effects, " or "));
    const DiagnosisGap& gap = diagnosis.gap;
    const std::string head = !names.empty()             ? "Missing: " + names
                             : !diagnosis.setup.empty() ? "No effect can be confirmed with this set-up"
                             : diagnosis.remaining      ? "No effect of the catalogue is named"
                             : diagnosis.model.has_gear_ratio()
                                 ? "Nothing is missing"
                                 : "Nothing is missing of what was examined, which ripple is not";
    std::string faults;
    for (const Fault& fault : diagnosis.faults)
        faults += fmt::format("{}{}", faults.empty() ? "; the log has " : ", ", fault.term.effect->name);
    // Of a thousand samples, which logs have, an rms is known to 2 %.
    return fmt::format("{}{}; residual {:.3g} to {:.3g} Nm rms, noise {:.3g} Nm rms.", head, faults,
                       gap.before_nm, gap.after_nm, gap.noise_floor_nm);
}

}  // namespace ripplenotch
