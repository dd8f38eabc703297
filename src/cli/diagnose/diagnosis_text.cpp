// SPDX-License-Identifier: MIT
#include "cli/diagnose/joint_diagnosis.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "cli/talk.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/visible_text.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"

namespace ripplenotch {

std::string short_number(double value) {
    const std::string text = fmt::format("{:.4g}", value);
    return text == "-0" ? "0" : text;
}

std::string value_text(const Term& term, const FittedValue& value) {
    const Parameter& parameter = term.effect->parameters[value.parameter];
    std::string text = fmt::format("{} = {}", parameter.name, short_number(value.value));
    if (value.at_bound) text += " (at its bound)";
    // An interval over all that the parameter may be says nothing, in whatever digits.
    if (value.ci95 && value.ci95->low <= parameter.lower && value.ci95->high >= parameter.upper) {
        text += " (not identifiable from this log)";
    } else if (value.ci95) {
        text += fmt::format(" [{}, {}]", short_number(value.ci95->low), short_number(value.ci95->high));
    }
    return text;
}

namespace {

// "torque_nm = 0.8, width_deg_s = 1"
std::string stated_text(const Term& term) {
    std::string text;
    for (std::size_t p = 0; p < term.values.size(); ++p)
        if (term.values[p])
            text += fmt::format("{}{} = {}", text.empty() ? "" : ", ", term.effect->parameters[p].name,
                                short_number(*term.values[p]));
    return text;
}

// A line a term that the user took into the model; nothing without one.
std::string accepted_text(const Diagnosis& diagnosis) {
    std::string text;
    for (const AcceptedFinding& one : diagnosis.accepted)
        text += fmt::format("accepted by you and not confirmed by this log ({}): {}, {}\n",
                            status_name(one.status), one.term.effect->name, stated_text(one.term));
    return text;
}

// Where in frequency the torque is, and what is left of it; nothing without given terms.
std::string band_table(const std::vector<BandGap>& bands) {
    if (bands.empty()) return {};
    TextRows rows = {{"frequency", "torque, Nm rms", "without the known terms", "and the model"}};
    for (const BandGap& band : bands) {
        const std::string name = band.from_hz == 0.0 ? fmt::format("below {:g} Hz", band.to_hz)
                                 : band.to_hz == 0.0
                                     ? fmt::format("above {:g} Hz", band.from_hz)
                                     : fmt::format("{:g} to {:g} Hz", band.from_hz, band.to_hz);
        rows.push_back({name, short_number(band.torque_nm), short_number(band.beside_given_nm),
                        short_number(band.after_nm)});
    }
    return text_table(rows, "lr");
}

std::vector<std::string> setup_sentences(const Diagnosis& diagnosis) {
    std::vector<std::string> all;
    for (const SetupFault& fault : diagnosis.setup)
        all.push_back(fmt::format("Check the set-up: {}{}.", fault.statement,
                                  fault.option.empty() ? "" : fmt::format(" ({})", fault.option)));
    if (!diagnosis.alignment) return all;
    const SimulationLag& lag = *diagnosis.alignment;
    const double half_s = 0.5 * (lag.delay_95_s.high - lag.delay_95_s.low);
    std::string text = fmt::format("Delay: the log is {} ms {} the simulation (correlation {:.4f})",
                                   with_error(1e3 * std::abs(lag.delay_s), 1e3 * half_s),
                                   lag.delay_s > 0.0 ? "behind" : "ahead of", lag.correlation);
    if (lag.clock_error) text += fmt::format("; clocks differ by {:.3g} ppm", 1e6 * *lag.clock_error);
    if (lag.position_difference_deg)
        text +=
            fmt::format("; positions then differ by {} deg rms", short_number(*lag.position_difference_deg));
    all.push_back(text + ".");
    return all;
}

std::string round_text(const Diagnosis& diagnosis, const Finding& finding, std::size_t number) {
    std::string text =
        fmt::format("round {}: {}, {}\n", number, finding.term.effect->name, status_name(finding.status));
    if (!finding.reason.empty()) text += fmt::format("  {}\n", finding.reason);
    for (const FittedValue& value : finding.values)
        text += fmt::format("  {}\n", value_text(finding.term, value));
    if (simulation_exceeds(diagnosis, finding))
        text += "  negative friction is not physical: the simulation includes too much friction already\n";
    if (finding.is_given || finding.is_in_model())
        text += fmt::format("  gap {} -> {} Nm\n", short_number(finding.gap_before_nm),
                            short_number(finding.gap_after_nm));
    if (!finding.is_given)
        text +=
            fmt::format("  alone it explains {} times the noise; t over blocks {}\n",
                        short_number(finding.evidence.noise_share), short_number(finding.evidence.block_t));
    if (finding.validation_before_nm) {
        text += fmt::format("  on the validation log {} -> {} Nm with it\n",
                            short_number(*finding.validation_before_nm),
                            short_number(*finding.validation_after_nm));
    }
    for (const RivalFinding& rival : finding.alternatives)
        text += fmt::format("  instead of it, {} ({}): behind by {}\n", rival.term.effect->name,
                            stated_text(rival.term), short_number(rival.margin));
    return text;
}

// What the improved model leaves, in a line.
std::string remaining_text(const Diagnosis& diagnosis) {
    if (!diagnosis.remaining) return {};
    const RemainingResidual& left = *diagnosis.remaining;
    const std::string part = fmt::format("{:.0f} % of it", 100.0 * std::min(left.part, 1.0));
    std::string where;
    switch (left.kind) {
        case RegionKind::throughout:
            where = "throughout the log";
            break;
        case RegionKind::tone:
            where = fmt::format("{} at {} Hz", part, short_number(left.where.from));
            break;
        default:
            where = fmt::format("{} from {} to {} {}", part, short_number(left.where.from),
                                short_number(left.where.to),
                                left.kind == RegionKind::time    ? "s"
                                : left.kind == RegionKind::speed ? "deg/s"
                                                                 : "deg");
    }
    return fmt::format("remaining: {} Nm rms where the noise is {}; {}\n", short_number(left.rms_nm),
                       short_number(diagnosis.gap.noise_floor_nm), where);
}

// What could not be determined, and which motion would.
std::string open_text(const Diagnosis& diagnosis) {
    std::string text;
    for (const Tie& tie : diagnosis.ambiguous)
        text += fmt::format("{}: this log cannot tell; {} would\n", joined(tie.effects, " or "), tie.advice);
    for (const Undecidable& entry : diagnosis.undecidable)
        text += fmt::format("not examined: {}: {}\n", entry.effect, entry.reason);
    return text;
}

std::string findings_text(const Diagnosis& diagnosis, bool explain) {
    std::string text;
    std::size_t number = 0;
    for (const Finding& finding : diagnosis.rounds) {
        ++number;
        if (finding.status == FindingStatus::correction && !explain) continue;
        text += round_text(diagnosis, finding, number);
    }
    if (!explain) return text;
    for (const RefusedCandidate& candidate : diagnosis.refused)
        text += fmt::format("not named: {}: {}\n", candidate.term.effect->name, candidate.reason);
    return text;
}

// What is left open is not rounded away.
std::string closed_text(const std::optional<double>& percent) {
    if (!percent) return {};
    int decimals = 1;
    while (decimals < 4 && *percent < 100.0 && rounded(*percent, decimals).starts_with("100")) ++decimals;
    return fmt::format(", {} % of it closed", rounded(*percent, decimals));
}

std::string gap_text(const DiagnosisGap& gap) {
    std::string text = fmt::format("gap {} -> {} Nm{}\n", short_number(gap.before_nm),
                                   short_number(gap.after_nm), closed_text(gap.closed_percent));
    if (gap.validation_before_nm)
        text +=
            fmt::format("on the validation log {} -> {} Nm{}\n", short_number(*gap.validation_before_nm),
                        short_number(*gap.validation_after_nm), closed_text(gap.validation_closed_percent));
    return text;
}

}  // namespace

std::string diagnosis_story(const CommonOptions& common, const Diagnosis& diagnosis, bool explain) {
    if (diagnosis.verdict == DiagnosisVerdict::undecided)
        return paragraph(common, diagnosis_sentence(diagnosis));
    std::string text;
    for (const std::string& sentence : setup_sentences(diagnosis)) text += paragraph(common, sentence);
    text += paragraph(common, diagnosis_sentence(diagnosis)) + gap_text(diagnosis.gap) +
            open_text(diagnosis) + remaining_text(diagnosis);
    text += fmt::format("verdict: {}\nnamed: {}\n", verdict_name(diagnosis.verdict),
                        diagnosis.named.empty() ? "nothing" : joined(diagnosis.named, ", "));
    text += fmt::format("{} samples, {} used\n", diagnosis.samples, diagnosis.samples_used);
    for (const Fault& fault : diagnosis.faults)
        text += fmt::format("fault of the log: {}, {}\n", fault.term.effect->name, fault.words);
    text += findings_text(diagnosis, explain) + accepted_text(diagnosis) + band_table(diagnosis.bands);
    for (const std::string& step : diagnosis.next) text += fmt::format("next: {}\n", step);
    return text;
}

namespace {

std::string lag_text(const ArmAccount& account) {
    if (!account.lag) return {};
    const ArmLag& lag = *account.lag;
    std::string text = fmt::format(
        "  delay of the torque behind the motion, one for all joints: {:.3g} ms, 95 % interval {:.3g} to "
        "{:.3g} ms{}\n",
        1e3 * lag.delay_s, 1e3 * lag.delay_95_s.low, 1e3 * lag.delay_95_s.high,
        account.lag_is_applied ? "; part of the model" : "; none is assumed");
    for (const JointLag& joint : lag.joints)
        if (joint.contradicts)
            text += fmt::format("  joint {} contradicts it: {:.3g} ms\n", account.joints[joint.joint].name,
                                1e3 * joint.delay_s);
    return text;
}

}  // namespace

std::string arm_text(const ArmAccount& account) {
    if (account.values_are_stated)
        return fmt::format(
            "arm: {} joints of {} matched {} (-v shows them); its values are the model's, motion smoothed "
            "over {:g} s\n",
            account.joints.size(), account.source, account.rule, account.smoothing.value());
    return fmt::format(
               "arm: {} joints of {} matched {} (-v shows them); {} of {} combinations of its masses "
               "determined by this log, {}, motion smoothed over {:g} s{}\n  {:.3g} -> {:.3g} Nm rms with "
               "friction included, 5-fold cross-validated\n",
               account.joints.size(), account.source, account.rule, account.values_told, account.values_there,
               account.all_joints_at_once ? "all joints fitted at once" : "this joint fitted alone",
               account.smoothing.value(), account.lengths_are_guessed ? ", lengths of its links guessed" : "",
               account.gap_before_nm, account.gap_nm) +
           lag_text(account) +
           (account.ripple.empty() ? "" : fmt::format("  subtracted first: {}\n", account.ripple));
}

}  // namespace ripplenotch
