// SPDX-License-Identifier: MIT
#include "diagnose/search/search.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>

#include "diagnose/limits.hpp"
#include "diagnose/search/model_bench.hpp"
#include "diagnose/search/search_starts.hpp"

namespace ripplenotch {
namespace {

// The lines of a trial are names of their own: ripple of order 3 and of order 4 may both be there.
bool same_place(const Term& a, const Term& b) {
    if (a.effect != b.effect) return false;
    for (std::size_t p = 0; p < a.values.size(); ++p) {
        if (a.effect->parameters[p].left_out == LeftOut::refused && a.values[p] != b.values[p]) return false;
    }
    return true;
}

// Whether the newest term has the name of an earlier one.
bool has_twin(const Candidate& model) {
    const std::vector<Term>& terms = model.stated.terms;
    return std::any_of(terms.begin(), terms.end() - 1,
                       [&](const Term& term) { return same_place(term, terms.back()); });
}

bool newest_is_bent(const ModelBench& bench, const Candidate& model) {
    return !bent_parameter(bench, model, model.stated.terms.size() - 1).empty();
}

// A shape that is bent as far as it goes stands in for something else: before it is taken, whatever closes a
// fair part of what it closes has its turn.
// `tried`: the finalists, the best first.
std::optional<Candidate> best_addition(const ModelBench& bench, const Candidate& now,
                                       const std::vector<Trial>& trials, std::vector<Candidate>& tried) {
    const double worth =
        trials.empty() ? 0.0 : std::max(limits::search::within_reach * trials[0].score(), 0.0);
    for (const Trial& trial : trials) {
        if (tried.size() >= limits::search::finalists || trial.score() <= worth) break;
        if (!tried.empty() && bench.work().is_over()) break;
        tried.push_back(with_trial(bench, now, trial));
    }
    if (tried.empty()) return std::nullopt;
    std::stable_sort(tried.begin(), tried.end(),
                     [](const Candidate& a, const Candidate& b) { return a.criterion() < b.criterion(); });
    const double most = now.criterion() - tried[0].criterion();
    for (const Candidate& next : tried) {
        if (now.criterion() - next.criterion() < limits::search::instead_of_bent * most) break;
        if (!newest_is_bent(bench, next)) return next;
    }
    return tried[0];
}

// Part of the gap that closes, as the torque has it.
double raw_part(const ModelBench& bench, const Candidate& now, const Candidate& next) {
    double before = 0.0, after = 0.0;
    const auto left_before = bench.cleared_residual(now.stated),
               left_after = bench.cleared_residual(next.stated);
    for (std::size_t r = 0; r < left_before.size(); ++r) {
        before += left_before[r] * left_before[r];
        after += left_after[r] * left_after[r];
    }
    const double noise_nm = bench.noise().material_nm, gap = before - bench.samples() * noise_nm * noise_nm;
    return gap > 0.0 ? (before - after) / gap : 0.0;
}

// The same of a line, 0 of what is none. What is missing below a line's frequency colours the noise that the
// gap is weighed by, and the line weighs little then.
double line_part(const ModelBench& bench, const Candidate& now, const Candidate& next) {
    // A line has a place, its order or frequency, before its size; gravity has none.
    const auto& polar = next.stated.terms.back().effect->polar;
    return polar && polar->size > 0 ? raw_part(bench, now, next) : 0.0;
}

constexpr std::string_view no_more_than_chance = "it improves the fit no more than chance would";
constexpr std::string_view little_of_the_gap = "it closes too small a part of the gap";

// Why the newest term of `next` is not added; empty where it is worth it.
std::string_view reason_against(const ModelBench& bench, const Candidate& now, const Candidate& next) {
    const double gain = now.gain_left - next.gain_left, samples = bench.samples();
    if (next.criterion() >= now.criterion()) return no_more_than_chance;
    // A torque that is small against the noise floor may still rise above the residual where that is quiet.
    if (!bench.noise_holds_residual() && bench.share(next, now) < bench.material_sigma())
        return "its torque is too small against the noise to matter";
    const double gap = now.gain_left - samples;
    // An effect that changes the torque as a whole also fits errors of any other effect.
    if (bench.noise_holds_residual() && next.stated.terms.back().effect->side != Side::joint &&
        raw_part(bench, now, next) < limits::search::fair_part)
        return little_of_the_gap;
    if (gap <= limits::search::open_gap * samples) return {};
    return std::max(gain / gap, line_part(bench, now, next)) < limits::search::fair_part ? little_of_the_gap
                                                                                         : std::string_view();
}

// Two effects that act on the same ripple may each do little alone, and a third, which does a part of both,
// more than either. Where the best addition closes little of the gap, the finalists are compared by their
// result with one more. One that reaches the best itself is the same two in another order.
std::optional<Candidate> best_with_one_more(const ModelBench& bench, const Candidate& now,
                                            const Candidate& best, const std::vector<Candidate>& tried,
                                            std::span<const Effect* const> effects) {
    const auto adds_torque = [](const Candidate& one) {
        return one.stated.terms.back().effect->side == Side::joint;
    };
    if (adds_torque(best)) return std::nullopt;
    const double gap = now.gain_left - bench.samples();
    if (gap < limits::search::open_gap * bench.samples() ||
        best.gain_left - bench.samples() < limits::search::look_ahead_gap * gap)
        return std::nullopt;
    std::optional<Candidate> found;
    double least = one_ahead(bench, best, effects).criterion();
    for (const Candidate& other : tried) {
        // An effect that is not worth its penalty alone would not be added.
        if (other.criterion() == best.criterion() || other.criterion() >= now.criterion() ||
            adds_torque(other) || bench.work().is_over())
            continue;
        const Candidate ahead = one_ahead(bench, other, effects);
        const Term &beside = ahead.stated.terms.back(), &alone = best.stated.terms.back();
        if (ahead.criterion() >= least || (same_place(beside, alone) && side_of(beside) == side_of(alone)))
            continue;
        least = ahead.criterion();
        found = other;
    }
    return found;
}

// A delay and a gear ratio that are both present, where each is worth its penalty in addition to the other
// and the two close more than the best effect by itself.
std::optional<Candidate> late_ratio_instead(const ModelBench& bench, const Candidate& now,
                                            const std::optional<Candidate>& alone,
                                            std::span<const Effect* const> effects, std::size_t own_terms) {
    // Such a pair leaves the ripple unexplained: there is much to close.
    if (now.gain_left - bench.samples() <= limits::search::open_gap * bench.samples()) return std::nullopt;
    auto both = with_late_ratio(bench, now, own_terms, effects);
    if (!both ||
        both->criterion() >= (alone ? std::min(alone->criterion(), now.criterion()) : now.criterion()) ||
        both->stated.terms.size() > own_terms + limits::search::most_names)
        return std::nullopt;
    for (std::size_t term = both->stated.terms.size() - 2; term < both->stated.terms.size(); ++term) {
        if (!reason_against(bench, without_term(bench, *both, term), *both).empty()) return std::nullopt;
    }
    return both;
}

// Why each finalist was not added; where none was fitted, why the best of the screening was none.
std::vector<RefusedCandidate> refused_by(const ModelBench& bench, const Candidate& now,
                                         const std::vector<Trial>& trials,
                                         const std::vector<Candidate>& tried) {
    std::vector<RefusedCandidate> refused;
    for (const Candidate& next : tried) {
        // One that passes alone was left out for a better one that did not.
        if (const auto reason = reason_against(bench, now, next); !reason.empty())
            refused.push_back({next.stated.terms.back(), std::string(reason)});
    }
    if (!tried.empty() || trials.empty()) return refused;
    return {{trials[0].start, std::string(no_more_than_chance)}};
}

// `spared`: how many of the newest have just been tested.
void drop_needless(const ModelBench& bench, Candidate& now, std::size_t own_terms, std::size_t spared = 1) {
    while (now.stated.terms.size() > own_terms + spared) {
        std::optional<Candidate> best;
        for (std::size_t term = own_terms; term + spared < now.stated.terms.size(); ++term) {
            if (bench.work().is_over()) return;
            Candidate fewer = without_term(bench, now, term);
            if (!best || fewer.criterion() < best->criterion()) best = std::move(fewer);
        }
        if (!best || best->criterion() >= now.criterion()) return;
        now = std::move(*best);
    }
}

// A second term of one name that changes next to nothing is a correction term for the form of the first;
// while it is present, neither shows its own improvement.
void drop_slight_twins(const ModelBench& bench, Candidate& now, std::size_t own_terms) {
    for (std::size_t term = now.stated.terms.size(); term-- > own_terms;) {
        bool has_twin = false;
        for (std::size_t other = own_terms; other < now.stated.terms.size(); ++other)
            has_twin =
                has_twin || (other != term && same_place(now.stated.terms[other], now.stated.terms[term]));
        if (!has_twin) continue;
        Candidate fewer = without_term(bench, now, term);
        if (bench.share(now, fewer) < bench.material_sigma()) now = std::move(fewer);
    }
}

bool swap_once(const ModelBench& bench, Candidate& now, std::size_t own_terms,
               std::span<const Effect* const> effects) {
    for (std::size_t term = own_terms; term < now.stated.terms.size(); ++term) {
        if (bench.work().is_over()) return false;
        const Candidate fewer = without_term(bench, now, term);
        const double gain = fewer.gain_left - now.gain_left;
        std::size_t tried = 0;
        for (const Trial& trial : screen(bench, fewer, effects)) {
            if (same_place(trial.start, now.stated.terms[term])) continue;
            if (trial.gain < limits::search::swap_gain * gain || tried++ >= limits::search::most_swaps) break;
            const Candidate other = with_trial(bench, fewer, trial);
            if (other.criterion() < now.criterion() - limits::search::swap_margin &&
                !newest_is_bent(bench, other)) {
                now = other;
                return true;
            }
        }
    }
    return false;
}

}  // namespace

Candidate baseline(const ModelBench& bench, const Model& model) {
    return bench.fitted(model, model, std::vector<double>(model.terms.size(), 0.0), 30);
}

Candidate with_trial(const ModelBench& bench, const Candidate& model, const Trial& trial) {
    Model open = model.open, guess = model.stated;
    open.terms.push_back(trial.open);
    guess.terms.push_back(trial.start);
    std::vector<double> prices = model.prices;
    prices.push_back(trial.price);
    return bench.fitted(open, guess, std::move(prices), bench.work().ended() ? 4 : 12,
                        limits::search::finalist_settled);
}

Candidate without_term(const ModelBench& bench, const Candidate& model, std::size_t term) {
    Model open = model.open, guess = model.stated;
    std::vector<double> prices = model.prices;
    const auto at = static_cast<std::ptrdiff_t>(term);
    open.terms.erase(open.terms.begin() + at);
    guess.terms.erase(guess.terms.begin() + at);
    prices.erase(prices.begin() + at);
    // After the end only a size is wanted.
    if (bench.work().ended())
        return bench.fitted(open, guess, std::move(prices), 3, limits::search::finalist_settled);
    return bench.fitted(open, guess, std::move(prices));
}

Candidate one_ahead(const ModelBench& bench, const Candidate& candidate,
                    std::span<const Effect* const> effects) {
    Candidate best = candidate;
    const std::vector<Trial> trials = screen(bench, candidate, effects);
    for (std::size_t i = 0; i < std::min(limits::search::looked_ahead, trials.size()); ++i) {
        Candidate next = with_trial(bench, candidate, trials[i]);
        if (next.criterion() < best.criterion()) best = std::move(next);
    }
    return best;
}

namespace {

// Effects that change a ripple or a torque as a whole.
bool transforms(const Term& term) { return term.effect->side != Side::joint; }

// Two effects that change the same ripple in the place of one whose form is neither's: amplitude by speed and
// phase by direction are together nearly a resonance.
bool merge_once(const ModelBench& bench, Candidate& now, std::size_t own_terms,
                std::span<const Effect* const> effects) {
    for (std::size_t a = own_terms; a < now.stated.terms.size(); ++a) {
        for (std::size_t b = own_terms; b < a; ++b) {
            if (!transforms(now.stated.terms[a]) || !transforms(now.stated.terms[b])) continue;
            if (bench.work().is_over()) return false;
            const Candidate fewer = without_term(bench, without_term(bench, now, a), b);
            const std::vector<Trial> trials = screen(bench, fewer, effects);
            for (std::size_t i = 0; i < std::min(limits::search::finalists, trials.size()); ++i) {
                if (!transforms(trials[i].start)) continue;
                Candidate one = with_trial(bench, fewer, trials[i]);
                if (one.criterion() >= now.criterion() || newest_is_bent(bench, one)) continue;
                now = std::move(one);
                return true;
            }
        }
    }
    return false;
}

// A ripple that passes the elastic joint: alone it explains little, and what changes it nothing without it.
std::optional<Candidate> ripple_with_change(const ModelBench& bench, const Candidate& now,
                                            const std::vector<Trial>& trials,
                                            std::span<const Effect* const> effects) {
    std::vector<const Effect*> changes;
    std::ranges::copy_if(effects, std::back_inserter(changes),
                         [](const Effect* effect) { return effect->side == Side::ripple; });
    for (const Trial& trial : trials) {
        if (!trial.start.effect->ripple_order || trial.score() <= 0.0 || bench.work().is_over()) continue;
        const Candidate ripple = with_trial(bench, now, trial);
        for (const Trial& change : screen(bench, ripple, changes)) {
            if (side_of(change.start) != Side::ripple || change.score() <= 0.0) continue;
            Candidate both = with_trial(bench, ripple, change);
            if (both.criterion() < ripple.criterion() && both.criterion() < now.criterion() &&
                !newest_is_bent(bench, both))
                return both;
            break;
        }
    }
    return std::nullopt;
}

// Where the residual is part of the noise, the addition that gains most may be one that is refused for its
// kind.
std::optional<Candidate> other_addition(const ModelBench& bench, const Candidate& now,
                                        const std::vector<Trial>& trials, const std::vector<Candidate>& tried,
                                        std::span<const Effect* const> effects) {
    for (const Candidate& candidate : tried) {
        if (reason_against(bench, now, candidate).empty() && !newest_is_bent(bench, candidate))
            return candidate;
    }
    return ripple_with_change(bench, now, trials, effects);
}

// Coulomb and viscous friction together, the most that a simulation of rigid bodies lacks. Alone, each may be
// a worse first step than a curve that is nearer to the two; a curve is compared with them at three terms.
std::optional<Candidate> frictions_instead(const ModelBench& bench, const Candidate& now,
                                           const Candidate& next, std::span<const Effect* const> effects) {
    const Effect* const plain[] = {&find_effect("coulomb-friction"), &find_effect("viscous-friction")};
    const auto is_plain = [&](const Term& term) {
        return std::ranges::find(plain, term.effect) != std::end(plain);
    };
    if (std::ranges::any_of(now.stated.terms, is_plain)) return std::nullopt;
    Candidate both = now;
    for (const Effect* friction : plain) {
        const auto trials = screen(bench, both, effects);
        const auto trial =
            std::ranges::find(trials, friction, [](const Trial& one) { return one.start.effect; });
        if (trial == trials.end() || bench.work().is_over()) return std::nullopt;
        both = with_trial(bench, both, *trial);
    }
    if (both.criterion() < next.criterion()) return both;
    const Term& curve = next.stated.terms.back();
    if (!curve.effect->resists || is_plain(curve)) return std::nullopt;
    const Candidate ahead = one_ahead(bench, one_ahead(bench, next, effects), effects);
    if (one_ahead(bench, both, effects).criterion() >= ahead.criterion()) return std::nullopt;
    return both;
}

}  // namespace

Candidate search(ModelBench& bench, const Candidate& start, std::size_t own_terms,
                 std::span<const Effect* const> effects, std::vector<RefusedCandidate>& refused) {
    Candidate now = start;
    const auto add_all = [&] {
        refused.clear();
        // An addition may make an earlier one needless, and that one come back.
        for (std::size_t added = 0; added < limits::search::most_additions &&
                                    now.stated.terms.size() < own_terms + limits::search::most_names;
             ++added) {
            if (bench.work().is_over()) return;
            const std::vector<Trial> trials = screen(bench, now, effects);
            std::vector<Candidate> tried;
            auto next = best_addition(bench, now, trials, tried);
            if (auto both = late_ratio_instead(bench, now, next, effects, own_terms)) {
                next = std::move(both);
            } else if (next && now.stated.terms.size() == own_terms) {
                if (auto other = best_with_one_more(bench, now, *next, tried, effects);
                    other && reason_against(bench, now, *other).empty())
                    next = std::move(other);
            }
            if (next) {
                if (auto frictions = frictions_instead(bench, now, *next, effects))
                    next = std::move(frictions);
            }
            if (!next || !reason_against(bench, now, *next).empty())
                next = bench.noise_holds_residual() ? other_addition(bench, now, trials, tried, effects)
                                                    : std::nullopt;
            if (!next) {
                refused = refused_by(bench, now, trials, tried);
                return;
            }
            // A second one of a name mends the form of the first, which another name may have instead.
            if (has_twin(*next) && swap_once(bench, now, own_terms, effects)) {
                drop_needless(bench, now, own_terms);
                continue;
            }
            now = *next;
            // The motion's errors act through the model's own torque, which has changed.
            bench.settle_on(now.stated);
            now = bench.fitted(now.open, now.stated, now.prices);
            drop_needless(bench, now, own_terms);
        }
    };
    drop_needless(bench, now, own_terms, 0);
    add_all();
    for (std::size_t round = 0; round < limits::search::swap_rounds; ++round) {
        if (!swap_once(bench, now, own_terms, effects) && !merge_once(bench, now, own_terms, effects)) break;
        drop_needless(bench, now, own_terms);
        add_all();
    }
    drop_slight_twins(bench, now, own_terms);
    return now;
}

}  // namespace ripplenotch
