// SPDX-License-Identifier: MIT
#include "diagnose/telling/next_steps.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "diagnose/case/undecidable.hpp"
#include "diagnose/judging/doubt.hpp"

namespace ripplenotch {
namespace {

// What of a motion tells effects apart.
struct Seen {
    double positive = 0.0, negative = 0.0, rest = 0.0, slowly = 0.0;  ///< of the samples
    double travel_deg = 0.0;
};

Seen seen_in(const Motion& motion, const DiagnosisRules& rules) {
    double fastest = 0.0;
    for (const double v : motion.velocity_deg_s) fastest = std::max(fastest, std::abs(v));
    Seen seen;
    const double one = 1.0 / static_cast<double>(motion.size());
    for (const double v : motion.velocity_deg_s) {
        if (std::abs(v) <= rules.recording.moving_part * fastest) {
            seen.rest += one;
            continue;
        }
        (v > 0.0 ? seen.positive : seen.negative) += one;
        if (std::abs(v) <= rules.advice.slow_part * fastest) seen.slowly += one;
    }
    const auto [low, high] = std::minmax_element(motion.position_deg.begin(), motion.position_deg.end());
    seen.travel_deg = *high - *low;
    return seen;
}

// Everything that this log leaves open.
std::set<std::string_view> in_doubt(const Diagnosis& diagnosis) {
    std::set<std::string_view> names;
    for (const Tie& tie : diagnosis.ambiguous) names.insert(tie.effects.begin(), tie.effects.end());
    for (const Finding& finding : diagnosis.rounds)
        if (is_doubtful(finding)) names.insert(finding.term.effect->name);
    for (const Undecidable& entry : diagnosis.undecidable) names.insert(entry.effect);
    return names;
}

// What the motion of this log lacks for the effects in doubt.
std::vector<std::string> missing_motion(const Diagnosis& diagnosis, const Seen& seen,
                                        const DiagnosisRules::AdviceRules& rules) {
    bool direction = false, speed = false, position = false, load = false;
    for (const std::string_view name : in_doubt(diagnosis)) {
        const Effect& effect = find_effect(name);
        direction = direction || effect.domain == Domain::speed || effect.domain == Domain::time;
        speed = speed || effect.domain == Domain::speed || effect.domain == Domain::order;
        position = position || needs_position(effect);
        load = load || effect.uses_load;
    }
    std::vector<std::string> missing;
    if (direction && std::min(seen.positive, seen.negative) < rules.least_part)
        missing.emplace_back("the other direction of motion");
    if (direction && seen.rest < rules.least_part)
        missing.emplace_back("rests of a second or more between moves");
    if (speed && seen.slowly < rules.least_part)
        missing.push_back(
            fmt::format("slow motion, at {:g} % of the fastest speed or less", 100.0 * rules.slow_part));
    if (position && diagnosis.has_position && seen.travel_deg < rules.turn_deg)
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
        steps.push_back(fmt::format("{}: {} would decide; {} takes a side", sides, tie.advice, accept));
    }
}

void add_doubtful(const Diagnosis& diagnosis, std::vector<std::string>& steps) {
    std::set<std::string_view> told;
    for (const Finding& finding : diagnosis.rounds) {
        const std::string_view name = finding.term.effect->name;
        if (!is_doubtful(finding) || !told.insert(name).second) continue;
        steps.push_back(fmt::format("{} is {}: --accept {} takes it into the model all the same", name,
                                    status_name(finding.status), name));
    }
}

}  // namespace

std::vector<std::string> next_steps(const Diagnosis& diagnosis, const Motion& smoothed,
                                    const DiagnosisRules& rules) {
    std::vector<std::string> steps;
    if (!diagnosis.setup.empty()) {
        const std::string& option = diagnosis.setup.front().option;
        return {"correct the set-up" + (option.empty() ? "" : fmt::format(" ({})", option)) +
                " and diagnose again"};
    }
    add_ties(diagnosis, steps);
    add_doubtful(diagnosis, steps);
    if (in_doubt(diagnosis).empty()) return steps;
    const auto missing = missing_motion(diagnosis, seen_in(smoothed, rules), rules.advice);
    if (missing.empty()) return steps;
    std::string words;
    for (const std::string& one : missing) words += (words.empty() ? "" : "; ") + one;
    steps.push_back("a log that would tell more has " + words);
    return steps;
}

}  // namespace ripplenotch
