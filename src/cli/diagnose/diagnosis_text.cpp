// SPDX-License-Identifier: MIT
#include "cli/diagnose/diagnosis_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
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

// A line a finding that the user took into the model; nothing without one.
std::string accepted_text(const Diagnosis& diagnosis) {
    std::string text;
    for (const AcceptedFinding& one : diagnosis.accepted) {
        std::string values;
        for (std::size_t p = 0; p < one.term.values.size(); ++p) {
            const Parameter& parameter = one.term.effect->parameters[p];
            if (parameter.left_out == LeftOut::refused)
                values += fmt::format(", {} = {}", parameter.name, short_number(*one.term.values[p]));
        }
        for (const FittedValue& value : one.values) values += ", " + value_text(one.term, value);
        text += fmt::format("accepted by you and not confirmed by this log ({}): {}{}\n",
                            status_name(one.status), one.term.effect->name, values);
    }
    return text;
}

// Where in frequency the torque is, and what is left of it; nothing without given terms.
std::string band_table(const std::vector<BandGap>& bands) {
    if (bands.empty()) return {};
    std::vector<std::vector<std::string>> rows = {
        {"frequency", "torque, Nm rms", "without the known terms", "and the model"}};
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

// "next: ..." a line a step.
std::string next_text(const std::vector<std::string>& steps) {
    std::string text;
    for (const std::string& step : steps) text += fmt::format("next: {}\n", step);
    return text;
}

constexpr std::size_t most_places = 4, most_of_a_kind = 3;

std::string unit_after(std::string_view unit) { return unit.empty() ? "" : fmt::format(" {}", unit); }

std::string spans_text(const std::vector<Span>& spans, std::string_view unit) {
    std::string text;
    for (std::size_t i = 0; i < std::min(spans.size(), most_places); ++i) {
        text += fmt::format("{}{} to {}", i == 0 ? "" : ", ", short_number(spans[i].from),
                            short_number(spans[i].to));
    }
    if (spans.size() > most_places) text += ", ...";
    return text + unit_after(unit);
}

std::string where_text(const Place& place) {
    std::vector<std::string> parts;
    if (!place.time_s.empty()) parts.push_back("at " + spans_text(place.time_s, "s"));
    if (!place.speed_deg_s.empty()) parts.push_back("at speeds of " + spans_text(place.speed_deg_s, "deg/s"));
    if (!place.position_deg.empty())
        parts.push_back("at positions of " + spans_text(place.position_deg, "deg"));
    for (const double hz : place.hz) parts.push_back(fmt::format("at {} Hz", short_number(hz)));
    for (const double order : place.order) parts.push_back(fmt::format("at order {}", short_number(order)));
    for (const double order : place.order_output)
        parts.push_back(fmt::format("at {} cycles per turn of the joint", short_number(order)));
    if (place.direction == Direction::both) parts.emplace_back("while it moves");
    if (place.direction == Direction::positive || place.direction == Direction::negative)
        parts.push_back(fmt::format("in {} direction", direction_name(place.direction)));
    return parts.empty() ? "throughout the log" : joined(parts, "; ");
}

// "1.500 +/- 0.010 Nm": the size of a finding with half of its 95 % interval.
std::string size_text(const Finding& finding) {
    const Effect& effect = *finding.term.effect;
    std::string text;
    for (std::size_t p = 0; p < effect.parameters.size(); ++p) {
        if (effect.parameters[p].left_out == LeftOut::refused)
            text += fmt::format(" {} {}", effect.parameters[p].name, short_number(*finding.term.values[p]));
    }
    const FittedValue* size = nullptr;
    for (const FittedValue& value : finding.values) {
        const bool larger = size == nullptr || (effect.parameters[value.parameter].linear &&
                                                !effect.parameters[size->parameter].linear);
        if (larger) size = &value;
    }
    if (size == nullptr) return text;
    const Parameter& parameter = effect.parameters[size->parameter];
    text += " " + (size->ci95 ? with_error(size->value, 0.5 * (size->ci95->high - size->ci95->low))
                              : short_number(size->value));
    return text + unit_after(parameter.unit);
}

bool is_doubtful(const Finding& finding) {
    return finding.status == FindingStatus::tentative || finding.status == FindingStatus::unidentifiable ||
           finding.status == FindingStatus::not_reproduced;
}

// A friction below 0 is what a simulation has too much of.
bool drives(const Finding& finding) {
    return finding.term.effect->resists && finding.term.values.front().value_or(0.0) < 0.0;
}

std::vector<std::string> setup_sentences(const Diagnosis& diagnosis) {
    std::vector<std::string> all;
    for (const SetupFault& fault : diagnosis.setup)
        all.push_back(fmt::format("Check the set-up: {}{}.", fault.statement,
                                  fault.option.empty() ? "" : fmt::format(" ({})", fault.option)));
    if (!diagnosis.alignment) return all;
    const SimulationLag& lag = *diagnosis.alignment;
    const double half_s = 0.5 * (lag.delay_95_s.high - lag.delay_95_s.low);
    std::string text =
        fmt::format("Delay: the log is {} ms {} the simulation (by their motions, correlation {:.4f})",
                    with_error(1e3 * std::abs(lag.delay_s), 1e3 * half_s),
                    lag.delay_s > 0.0 ? "behind" : "ahead of", lag.correlation);
    if (lag.clock_error) text += fmt::format("; clocks differ by {:.3g} ppm", 1e6 * *lag.clock_error);
    if (lag.position)
        text +=
            fmt::format("; positions then differ by {} deg rms", short_number(lag.position->rms_difference));
    all.push_back(text + ".");
    return all;
}

// The verdict in one sentence, with names, sizes and what is left.
std::string answer(const Diagnosis& diagnosis) {
    std::string names;
    const auto add = [&](const std::string& name) { names += (names.empty() ? "" : ", ") + name; };
    for (const Fault& fault : diagnosis.faults) add(std::string(fault.term.effect->name));
    for (const Finding& finding : diagnosis.rounds) {
        if (finding.status != FindingStatus::confirmed) continue;
        add(fmt::format("{}{}{}", finding.term.effect->name, size_text(finding),
                        drives(finding) ? " (the simulation has too much of it)" : ""));
    }
    for (const Tie& tie : diagnosis.ambiguous) add(joined(tie.effects, " or "));
    const DiagnosisGap& gap = diagnosis.gap;
    const std::string head = !names.empty()                   ? "Missing: " + names
                             : !diagnosis.setup.empty()       ? "No effect can be confirmed with this set-up"
                             : !diagnosis.unexplained.empty() ? "Unexplained"
                             : diagnosis.model.has_gear_ratio()
                                 ? "Nothing is missing"
                                 : "Nothing is missing of what was examined, which ripple is not";
    // Of a thousand samples, which logs have, an rms is known to 2 %.
    return fmt::format("{}; residual {:.3g} to {:.3g} Nm rms, noise {:.3g} Nm rms.", head, gap.before_nm,
                       gap.after_nm, gap.noise_floor_nm);
}

std::string round_text(const Finding& finding, std::size_t number) {
    const Term& term = finding.term;
    std::string text =
        fmt::format("round {}: {}, {}\n", number, term.effect->name, status_name(finding.status));
    if (!finding.reason.empty()) text += fmt::format("  {}\n", finding.reason);
    for (std::size_t p = 0; p < term.values.size(); ++p) {
        if (term.effect->parameters[p].left_out == LeftOut::refused)
            text +=
                fmt::format("  {} = {}\n", term.effect->parameters[p].name, short_number(*term.values[p]));
    }
    for (const FittedValue& value : finding.values) text += fmt::format("  {}\n", value_text(term, value));
    if (drives(finding))
        text += "  negative friction is not physical: the simulation includes too much friction already\n";
    text += fmt::format("  acts {}\n", where_text(finding.where));
    text += fmt::format("  gap {} -> {} Nm; alone it explains {} Nm rms; improves {} of {} blocks\n",
                        short_number(finding.gap_before_nm), short_number(finding.gap_after_nm),
                        short_number(finding.evidence.share_nm), finding.evidence.blocks_positive,
                        finding.evidence.blocks);
    if (finding.validation_before_nm) {
        text += fmt::format("  on the validation log {} -> {} Nm with it\n",
                            short_number(*finding.validation_before_nm),
                            short_number(*finding.validation_after_nm));
    }
    for (const RivalFinding& rival : finding.alternatives)
        text += fmt::format(
            "  instead of it, {} would leave {} more{}\n", rival.effect, short_number(rival.margin),
            finding.status == FindingStatus::ambiguous && rival.margin < tie_margin ? " (a tie)" : "");
    return text;
}

// What was tried and is not confirmed, in a line.
std::string doubtful_text(const Finding& finding) {
    return fmt::format("not confirmed: {}{}, {}: {}\n", finding.term.effect->name, size_text(finding),
                       status_name(finding.status), finding.reason);
}

std::string region_text(const ResidualRegion& region) {
    return fmt::format("{} Nm rms {} ({:.0f} % of the squared residual)", short_number(region.rms_nm),
                       where_text(region.where), 100.0 * std::min(region.part, 1.0));
}

// Places of one kind are told together beyond the largest: a log may disagree in dozens of stretches of time.
std::string regions_text(const std::vector<ResidualRegion>& residual_regions, std::string_view verb) {
    std::string text;
    std::map<std::string_view, std::pair<std::size_t, double>> more;  // number and part, by the kind's name
    std::map<RegionKind, std::size_t> told;
    for (const ResidualRegion& region : residual_regions) {
        if (told[region.kind]++ < most_of_a_kind) {
            text += fmt::format("{} {}\n", verb, region_text(region));
        } else {
            auto& [number, part] = more[region_kind_name(region.kind)];
            ++number;
            part += region.part;
        }
    }
    for (const auto& [kind, rest] : more)
        text += fmt::format("{} in {} further regions by {} ({:.0f} %)\n", verb, rest.first, kind,
                            100.0 * std::min(rest.second, 1.0));
    return text;
}

std::string closing(const Diagnosis& diagnosis) {
    switch (diagnosis.verdict) {
        case DiagnosisVerdict::matches:
            return diagnosis.model.has_gear_ratio()
                       ? "the model explains this log: nothing is missing"
                       : "nothing is missing of what was examined: without the gear ratio ripple was not";
        case DiagnosisVerdict::explained:
            return diagnosis.model.has_gear_ratio() ? "explained"
                                                    : "explained, without the effects of the motor's angle";
        case DiagnosisVerdict::partly_explained:
            return diagnosis.unexplained.empty() && !diagnosis.accepted.empty()
                       ? "partly explained: this log does not confirm what you accepted"
                       : "partly explained: unexplained residual remains";
        case DiagnosisVerdict::unexplained:
            return diagnosis.setup.empty() ? "unexplained: no effect of the catalogue explains the residual"
                                           : "unexplained: correct the set-up first";
        case DiagnosisVerdict::undecided:
            return "cannot tell";
    }
    return {};
}

std::string findings_text(const Diagnosis& diagnosis, bool explain) {
    std::string text;
    for (std::size_t i = 0; i < diagnosis.rounds.size(); ++i) {
        const Finding& finding = diagnosis.rounds[i];
        text += explain || !is_doubtful(finding) ? round_text(finding, i + 1) : doubtful_text(finding);
    }
    if (!explain) return text;
    for (const RefusedCandidate& candidate : diagnosis.refused)
        text += fmt::format("not named: {}: {}\n", candidate.term.effect->name, candidate.reason);
    return text;
}

std::string gap_text(const DiagnosisGap& gap) {
    std::string text =
        fmt::format("gap {} -> {} Nm", short_number(gap.before_nm), short_number(gap.after_nm));
    if (gap.closed_percent) text += fmt::format(", {} % of it closed", rounded(*gap.closed_percent, 1));
    text += "\n";
    if (gap.validation_before_nm) {
        text += fmt::format("on the validation log {} -> {} Nm", short_number(*gap.validation_before_nm),
                            short_number(*gap.validation_after_nm));
        if (gap.validation_closed_percent)
            text += fmt::format(", {} % of it closed", rounded(*gap.validation_closed_percent, 1));
        text += "\n";
    }
    return text;
}

std::string angle_text(const Diagnosis& diagnosis) {
    if (!diagnosis.angle) return "";
    std::string text;
    constexpr double rounding_deg = 1e-9;
    if (!diagnosis.has_position && diagnosis.angle->walk_deg > rounding_deg)
        text += fmt::format(
            "the angle is the integrated velocity, corrected by {} deg rms with the phase of the ripple; "
            "phases are this log's own\n",
            short_number(diagnosis.angle->walk_deg));
    if (const auto& start = diagnosis.angle->validation_start_deg)
        text += fmt::format("the validation log begins at {} deg of it, where it fits the model best\n",
                            short_number(*start));
    return text;
}

}  // namespace

std::string diagnosis_story(const CommonOptions& common, const Diagnosis& diagnosis, bool explain) {
    if (diagnosis.verdict == DiagnosisVerdict::undecided) return paragraph(common, diagnosis.doubt);
    const DiagnosisGap& gap = diagnosis.gap;
    std::string text;
    for (const std::string& sentence : setup_sentences(diagnosis)) text += paragraph(common, sentence);
    text += paragraph(common, answer(diagnosis));
    text += fmt::format("verdict: {}\n", closing(diagnosis));
    text += fmt::format("named: {}\n", diagnosis.named.empty() ? "nothing" : joined(diagnosis.named, ", "));
    text += fmt::format("{} samples, {} used; noise floor {} Nm rms\n", diagnosis.samples,
                        diagnosis.samples_used, short_number(gap.noise_floor_nm));
    for (const UnusedRows& rows : diagnosis.unused)
        text += fmt::format("  {} samples not used: {}\n", rows.rows, rows.reason);
    for (const EffectOfUnusedRows& one : diagnosis.acts_where_unused)
        text += fmt::format("  {} acts in {} samples, of which {} are not used: it may be missed\n",
                            one.effect, one.rows, one.unused);
    text += fmt::format("gap of the model as given: {} Nm rms\n", short_number(gap.before_nm));
    for (std::size_t i = 0; i < std::min<std::size_t>(diagnosis.disagreement.size(), 3); ++i)
        text += fmt::format("  residual {}\n", region_text(diagnosis.disagreement[i]));
    text += angle_text(diagnosis);
    for (const Fault& fault : diagnosis.faults)
        text += fmt::format("fault of the log: {}, {}\n", fault.term.effect->name, fault.words);
    text += findings_text(diagnosis, explain);
    for (const Tie& tie : diagnosis.ambiguous)
        text += fmt::format("{}: this log cannot tell; {} would\n", joined(tie.effects, " or "), tie.advice);
    text += regions_text(diagnosis.unexplained, "unexplained:");
    for (const Undecidable& entry : diagnosis.undecidable) {
        text += fmt::format("not examined: {}: {}", entry.effect, entry.reason);
        if (entry.would_explain_nm > 0.0)
            text += fmt::format("; along the integral of the speed it would explain {} Nm rms",
                                short_number(entry.would_explain_nm));
        text += "\n";
    }
    text += accepted_text(diagnosis);
    text += gap_text(gap);
    if (diagnosis.search_ended)
        text += fmt::format(
            "the search was ended after {:.0f} evaluations of the model; the residual is unexplained\n",
            diagnosis.evaluations);
    return text + band_table(diagnosis.bands) + next_text(diagnosis.next);
}

namespace {

std::string lag_text(const ArmAccount& account) {
    if (!account.lag) return {};
    const ArmLag& lag = *account.lag;
    std::string text = fmt::format(
        "  delay of the torque behind the motion, one for all joints: {:.3g} ms, 95 % interval {:.3g} to "
        "{:.3g} "
        "ms{}\n",
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
            "over "
            "{:g} s\n",
            account.joints.size(), account.source, account.rule, account.smoothing.value());
    return fmt::format(
               "arm: {} joints of {} matched {} (-v shows them); {} of {} combinations of its masses "
               "determined by this log, {}, motion smoothed over {:g} s{}\n  {:.3g} -> {:.3g} Nm rms with "
               "friction included, 5-fold cross-validated\n",
               account.joints.size(), account.source, account.rule, account.values_told, account.values_there,
               account.all_joints_at_once ? "all joints fitted at once" : "this joint fitted alone",
               account.smoothing.value(), account.lengths_are_guessed ? ", lengths of its links guessed" : "",
               account.gap_before_nm, account.gap_nm) +
           lag_text(account);
}

}  // namespace ripplenotch
