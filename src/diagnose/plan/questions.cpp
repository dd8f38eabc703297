// SPDX-License-Identifier: MIT
#include "diagnose/plan/questions.hpp"

#include <algorithm>
#include <cmath>

#include "core/rows/row_facts.hpp"
#include "diagnose/case/undecidable.hpp"
#include "diagnose/judging/doubt.hpp"
#include "ripplenotch/model/prediction.hpp"

namespace ripplenotch {
namespace {

void add_rival(std::vector<const Effect*>& rivals, const Effect& own, std::string_view name) {
    for (const Effect* const effect : catalogue()) {
        if (effect->name != name || effect == &own || effect->side == Side::converter) continue;
        if (std::find(rivals.begin(), rivals.end(), effect) == rivals.end()) rivals.push_back(effect);
    }
}

// Those that the log tells, and those that the catalogue knows.
std::vector<const Effect*> rivals_of(const Diagnosis& diagnosis, const Finding& finding) {
    const Effect& own = *finding.term.effect;
    std::vector<const Effect*> rivals;
    for (const RivalFinding& rival : finding.alternatives) add_rival(rivals, own, rival.effect);
    for (const Tie& tie : diagnosis.ambiguous)
        if (std::find(tie.effects.begin(), tie.effects.end(), own.name) != tie.effects.end())
            for (const std::string& name : tie.effects) add_rival(rivals, own, name);
    if (is_doubtful(finding))
        for (const LookAlike& alike : own.look_alikes) add_rival(rivals, own, alike.name);
    return rivals;
}

// The improved model without the finding, which is in it unless it is in doubt.
Model model_beside(const Diagnosis& diagnosis, const Finding& finding) {
    Model rest = diagnosis.model;
    if (is_doubtful(finding)) return rest;
    const auto& effect = *finding.term.effect;
    for (std::size_t t = diagnosis.baseline.terms.size(); t < rest.terms.size(); ++t) {
        const Term& term = rest.terms[t];
        bool same = term.effect == &effect;
        for (std::size_t p = 0; same && p < term.values.size(); ++p)
            same =
                effect.parameters[p].left_out != LeftOut::refused || term.values[p] == finding.term.values[p];
        if (!same) continue;
        rest.terms.erase(rest.terms.begin() + static_cast<std::ptrdiff_t>(t));
        break;
    }
    return rest;
}

bool is_of_the_joint(const Effect& effect) { return effect.side != Side::converter && !effect.chance; }

}  // namespace

std::vector<AskedTerm> asked_terms(const Diagnosis& diagnosis, const Motion& along, double variance_nm2,
                                   double enough) {
    std::vector<AskedTerm> open, found;
    for (const Finding& finding : diagnosis.rounds) {
        const bool asked = is_doubtful(finding) || finding.status == FindingStatus::ambiguous;
        const bool known = finding.status == FindingStatus::confirmed;
        if ((!asked && !known) || !is_of_the_joint(*finding.term.effect)) continue;
        AskedTerm term{finding.term, model_beside(diagnosis, finding), {}};
        term.open = asked;
        if (asked) term.rivals = rivals_of(diagnosis, finding);
        const double own_nm = rms(Prediction(term.rest, along).added(term.term));
        if (!(own_nm > 0.0)) continue;
        if (diagnosis.gap.before_nm > 0.0) term.scale = std::min(1.0, diagnosis.gap.before_nm / own_nm);
        (asked ? open : found).push_back(std::move(term));
    }
    if (open.empty()) return {};
    // The other side of a tie, as large as it would have to be.
    for (std::size_t i = 0, sides = open.size(); i < sides; ++i) {
        for (const Tie& tie : diagnosis.ambiguous) {
            if (tie.effects.empty() || tie.effects.front() != open[i].term.effect->name) continue;
            for (std::size_t k = 1; k < tie.effects.size(); ++k) {
                const Effect& rival = find_effect(tie.effects[k]);
                AskedTerm other{{}, open[i].rest, {open[i].term.effect}};
                if (is_of_the_joint(rival) && nearest_rival(open[i], rival, along, other.term))
                    open.push_back(std::move(other));
            }
        }
    }
    open.insert(open.end(), found.begin(), found.end());
    for (AskedTerm& term : open) {
        term.gain_before = separation(term, along).squares / variance_nm2;
        // What the log told well has to be told half as well, no better than what is open.
        term.needed = term.open ? enough : std::min(enough, 0.5 * term.gain_before);
    }
    std::erase_if(open, [](const AskedTerm& term) { return !(term.needed > 0.0); });
    return open;
}

}  // namespace ripplenotch
