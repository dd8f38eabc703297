// SPDX-License-Identifier: MIT
#include "diagnose/report/summary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "diagnose/case/case.hpp"
#include "diagnose/case/lines.hpp"
#include "diagnose/judging/doubt.hpp"
#include "diagnose/judging/judge.hpp"
#include "diagnose/limits.hpp"
#include "diagnose/search/search.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/core/trace.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"
#include "ripplenotch/model/motion.hpp"

namespace ripplenotch {

std::string_view status_name(FindingStatus status) {
    constexpr std::string_view names[] = {"confirmed",        "ambiguous",      "tentative",     "immaterial",
                                          "shape-correction", "unidentifiable", "not-reproduced"};
    return names[static_cast<std::size_t>(status)];
}

std::string_view verdict_name(DiagnosisVerdict verdict) {
    constexpr std::string_view names[] = {"matches", "explained", "partly-explained", "unexplained",
                                          "undecided"};
    return names[static_cast<std::size_t>(verdict)];
}

std::string_view direction_name(Direction direction) {
    constexpr std::string_view names[] = {"", "positive", "negative", "both"};
    return names[static_cast<std::size_t>(direction)];
}

std::string_view region_kind_name(RegionKind kind) {
    constexpr std::string_view names[] = {"time", "tone", "order", "position", "speed"};
    return names[static_cast<std::size_t>(kind)];
}

void add_unused_rows(std::vector<UnusedRows>& listed, const Case& whole, std::string_view reason) {
    std::size_t rows = whole.size() - whole.used();
    for (const UnusedRows& before : listed) rows -= before.rows;
    if (rows > 0) listed.push_back({std::string(reason), rows});
}

std::vector<EffectOfUnusedRows> mainly_unused(std::span<const Effect* const> effects, const Case& whole,
                                              const Model& model) {
    std::vector<EffectOfUnusedRows> found;
    Motion motion = whole.motion;
    motion.known_nm.clear();
    for (const Effect* effect : effects) {
        Model alone{model.gear_ratio, {{effect, {}}}};
        for (const Parameter& parameter : effect->parameters)
            alone.terms[0].values.emplace_back(parameter.start);
        // A sensor shows what others bring, and acts by itself nowhere.
        if (side_of(alone.terms[0]) != Side::joint) continue;
        const std::vector<double> torque_nm = predict_nm(alone, motion);
        double largest = 0.0;
        for (const double each : torque_nm) largest = std::max(largest, std::abs(each));
        EffectOfUnusedRows acts{std::string(effect->name), 0, 0};
        for (std::size_t k = 0; k < torque_nm.size() && largest > 0.0; ++k) {
            if (std::abs(torque_nm[k]) < 0.5 * largest) continue;
            ++acts.rows;
            if (whole.use[k] == 0) ++acts.unused;
        }
        if (2 * acts.unused > acts.rows) found.push_back(std::move(acts));
    }
    return found;
}

namespace {

// The user's options with uncertain findings: the motion that would decide, and the option that takes a
// finding into the model all the same.

// Features of a motion that distinguish effects.
struct Seen {
    double positive = 0.0, negative = 0.0, rest = 0.0, slowly = 0.0;  ///< shares of the samples
    double travel_deg = 0.0;
};

Seen seen_in(const Motion& motion) {
    double fastest = 0.0;
    for (const double v : motion.velocity_deg_s) fastest = std::max(fastest, std::abs(v));
    Seen seen;
    const double one = 1.0 / static_cast<double>(motion.size());
    for (const double v : motion.velocity_deg_s) {
        if (std::abs(v) <= limits::recording::moving_part * fastest) {
            seen.rest += one;
            continue;
        }
        (v > 0.0 ? seen.positive : seen.negative) += one;
        if (std::abs(v) <= limits::advice::slow_part * fastest) seen.slowly += one;
    }
    const auto [low, high] = std::minmax_element(motion.position_deg.begin(), motion.position_deg.end());
    seen.travel_deg = *high - *low;
    return seen;
}

// Everything that is undecided from this log.
std::set<std::string_view> in_doubt(const Diagnosis& diagnosis) {
    std::set<std::string_view> names;
    for (const Tie& tie : diagnosis.ambiguous) names.insert(tie.effects.begin(), tie.effects.end());
    for (const Finding& finding : diagnosis.rounds)
        if (is_doubtful(finding)) names.insert(finding.term.effect->name);
    for (const Undecidable& entry : diagnosis.undecidable)
        if (diagnosis.model.has_gear_ratio() || !needs_gear_ratio(find_effect(entry.effect)))
            names.insert(entry.effect);
    return names;
}

// Missing features of this log's motion for the uncertain effects.
std::vector<std::string> missing_motion(const Diagnosis& diagnosis, const Seen& seen) {
    bool direction = false, speed = false, position = false, load = false;
    for (const std::string_view name : in_doubt(diagnosis)) {
        const Effect& effect = find_effect(name);
        direction = direction || effect.domain == Domain::speed || effect.domain == Domain::time;
        speed = speed || effect.domain == Domain::speed || effect.domain == Domain::order;
        position = position || needs_position(effect);
        load = load || effect.uses_load;
    }
    std::vector<std::string> missing;
    if (direction && std::min(seen.positive, seen.negative) < limits::advice::least_part)
        missing.emplace_back("the other direction of motion");
    if (direction && seen.rest < limits::advice::least_part)
        missing.emplace_back("rests of a second or more between moves");
    if (speed && seen.slowly < limits::advice::least_part)
        missing.push_back(fmt::format("slow motion, at {:g} % of the fastest speed or less",
                                      100.0 * limits::advice::slow_part));
    if (position && diagnosis.has_position && seen.travel_deg < limits::advice::turn_deg)
        missing.push_back(fmt::format("a travel of more than a turn (here {:.0f} deg)", seen.travel_deg));
    if (load) missing.emplace_back("the same motion with another load");
    if (!diagnosis.has_position && position) missing.emplace_back("a column with the position");
    return missing;
}

void add_ties(const Diagnosis& diagnosis, std::vector<std::string>& steps) {
    for (const Tie& tie : diagnosis.ambiguous) {
        std::string sides, accept;
        for (const std::string& side : tie.effects) {
            sides += (sides.empty() ? "" : " or ") + side;
            accept += (accept.empty() ? "--accept " : " or --accept ") + side;
        }
        steps.push_back(fmt::format("{}: {} would decide; {} selects one", sides, tie.advice, accept));
    }
}

void add_doubtful(const Diagnosis& diagnosis, std::vector<std::string>& steps) {
    std::set<std::string_view> told;
    for (const Finding& finding : diagnosis.rounds) {
        const std::string_view name = finding.term.effect->name;
        if (!is_doubtful(finding) || !told.insert(name).second) continue;
        steps.push_back(fmt::format("{} is {}: --accept {} includes it in the model anyway", name,
                                    status_name(finding.status), name));
    }
}

// A sentence each; nothing where nothing is uncertain. `smoothed` is the log's motion.
std::vector<std::string> next_steps(const Diagnosis& diagnosis, const Motion& smoothed) {
    std::vector<std::string> steps;
    if (!diagnosis.setup.empty()) {
        const std::string& option = diagnosis.setup.front().option;
        return {"correct the set-up" + (option.empty() ? "" : fmt::format(" ({})", option)) +
                " and diagnose again"};
    }
    add_ties(diagnosis, steps);
    add_doubtful(diagnosis, steps);
    if (in_doubt(diagnosis).empty()) return steps;
    const auto missing = missing_motion(diagnosis, seen_in(smoothed));
    if (missing.empty()) return steps;
    std::string words;
    for (const std::string& one : missing) words += (words.empty() ? "" : "; ") + one;
    steps.push_back("a more informative log has " + words);
    return steps;
}

// A diagnosis with what its user decides, and what there is to do next.

// The effect with its values open, except those that name a line.
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

// The findings that the name refers to in this diagnosis: uncertain findings, or a side of a tie.
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
        "--accept {}: {}; uncertain findings: {}", name,
        confirmed ? "it is confirmed, and in the model already" : "this log gives no finding of that name",
        there.empty() ? "nothing" : there);
}

// Closed share, in percent, of the squared gap above the floor.
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

// The model as given with the accepted findings, their values open.
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
    // A finding accepted by the user is not one confirmed by the log.
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
        told.next = next_steps(told, motion_along(log, options.smoothing));
    if (!told.residual_after_nm.empty())
        told.bands = band_gaps(log.torque_nm, told.beside_given_nm, told.residual_after_nm, log.sample_rate);
    return told;
}

namespace {

double residual_rms(const Case& c, const Model& stated, const std::vector<unsigned char>& use) {
    return rms_of(residual_nm(c, stated), use);
}

// Closed share of the squared gap above the floor, over samples without faults. Empty when the gap was not
// significant.
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

void name_findings(Diagnosis& diagnosis) {
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
            if (rival.margin >= tie_margin) continue;
            tie.effects.emplace_back(rival.effect);
            const Effect& other = find_effect(rival.effect);
            if (tie.advice.empty())
                tie.advice = !diagnosis.model.has_gear_ratio() && needs_gear_ratio(other)
                                 ? "the gear ratio, --gear-ratio N,"
                                 : what_would_tell(effect, other);
        }
        if (ties.insert({tie.effects.begin(), tie.effects.end()}).second) diagnosis.ambiguous.push_back(tie);
    }
}

void measure_gap(Diagnosis& diagnosis, const GapCase& whole, const GapCase* validation) {
    DiagnosisGap& gap = diagnosis.gap;
    const std::vector<unsigned char> all(whole.improved.size(), 1);
    gap.before_nm = residual_rms(whole.as_given, diagnosis.baseline, all);
    gap.after_nm = residual_rms(whole.improved, diagnosis.model, all);
    gap.closed_percent = closed_percent(whole, diagnosis, limits::values::least_gap);
    if (validation == nullptr) return;
    const std::vector<unsigned char> every(validation->improved.size(), 1);
    gap.validation_before_nm = residual_rms(validation->as_given, diagnosis.baseline, every);
    gap.validation_after_nm = residual_rms(validation->improved, diagnosis.model, every);
    gap.validation_closed_percent = closed_percent(*validation, diagnosis, limits::values::least_gap);
}

}  // namespace ripplenotch
