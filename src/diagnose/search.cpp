// SPDX-License-Identifier: MIT
#include "diagnose/search.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "diagnose/bent_shape.hpp"

namespace ripplenotch {
namespace {

constexpr std::size_t most_names = 7;
constexpr int most_additions = 9;
constexpr std::size_t finalists = 4;
// Relative improvement at which a trial has shown what it is worth.
constexpr double finalist_settled = 1e-5;
// A finalist's foreseen gain, against that of the best.
constexpr double within_reach = 0.4;
// As long as more than this part of the sum of squares is unexplained, a step has to close a fair part of it:
// what closes less only feeds on something else.
constexpr double open_gap = 0.02, fair_part = 0.12;
constexpr int swap_rounds = 2;
// Part of the gain of a bent shape with which another is preferred to it.
constexpr double instead_of_bent = 0.5;

// The lines of a trial are names of their own: ripple of order 3 and of order 4 may both be there.
bool same_place(const Term& a, const Term& b) {
    if (a.effect != b.effect) return false;
    for (std::size_t p = 0; p < a.values.size(); ++p) {
        if (a.effect->parameters[p].left_out == LeftOut::refused && a.values[p] != b.values[p]) return false;
    }
    return true;
}

bool newest_is_bent(const ModelBench& bench, const Candidate& model) {
    return !bent_parameter(bench, model, model.stated.terms.size() - 1).empty();
}

// A shape that is bent as far as it goes stands in for something else: before it is taken, whatever closes a
// fair part of what it closes has its turn.
std::optional<Candidate> best_addition(const ModelBench& bench, const Candidate& now,
                                       const std::vector<Trial>& trials) {
    std::vector<Candidate> tried;
    const double worth = trials.empty() ? 0.0 : std::max(within_reach * trials[0].score(), 0.0);
    for (const Trial& trial : trials) {
        if (tried.size() >= finalists || trial.score() <= worth) break;
        if (!tried.empty() && bench.work().is_over()) break;
        tried.push_back(with_trial(bench, now, trial));
    }
    if (tried.empty()) return std::nullopt;
    std::stable_sort(tried.begin(), tried.end(),
                     [](const Candidate& a, const Candidate& b) { return a.criterion() < b.criterion(); });
    const double most = now.criterion() - tried[0].criterion();
    for (const Candidate& next : tried) {
        if (now.criterion() - next.criterion() < instead_of_bent * most) break;
        if (!newest_is_bent(bench, next)) return next;
    }
    return tried[0];
}

bool worth_it(const ModelBench& bench, const Candidate& now, const Candidate& next) {
    if (next.criterion() >= now.criterion()) return false;
    const double gain = now.gain_left - next.gain_left, samples = bench.samples();
    if (bench.share(next, now) < material_sigma(bench.looked_at())) return false;
    const double gap = now.gain_left - samples;
    return gap <= open_gap * samples || gain >= fair_part * gap;
}

// `spared`: how many of the newest were judged a moment ago.
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

bool swap_once(const ModelBench& bench, Candidate& now, std::size_t own_terms,
               std::span<const Effect* const> effects) {
    for (std::size_t term = own_terms; term < now.stated.terms.size(); ++term) {
        if (bench.work().is_over()) return false;
        const Candidate fewer = without_term(bench, now, term);
        const double gain = fewer.gain_left - now.gain_left;
        std::size_t tried = 0;
        for (const Trial& trial : screen(bench, fewer, effects)) {
            if (same_place(trial.start, now.stated.terms[term])) continue;
            if (trial.gain < 0.8 * gain || tried++ >= 2) break;
            const Candidate other = with_trial(bench, fewer, trial);
            if (other.criterion() < now.criterion() - 1.0 && !newest_is_bent(bench, other)) {
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
    return bench.fitted(open, guess, std::move(prices), bench.work().ended() ? 4 : 12, finalist_settled);
}

Candidate without_term(const ModelBench& bench, const Candidate& model, std::size_t term) {
    Model open = model.open, guess = model.stated;
    std::vector<double> prices = model.prices;
    const auto at = static_cast<std::ptrdiff_t>(term);
    open.terms.erase(open.terms.begin() + at);
    guess.terms.erase(guess.terms.begin() + at);
    prices.erase(prices.begin() + at);
    // After the end only a size is wanted.
    if (bench.work().ended()) return bench.fitted(open, guess, std::move(prices), 3, finalist_settled);
    return bench.fitted(open, guess, std::move(prices));
}

Candidate search(ModelBench& bench, const Candidate& start, std::size_t own_terms,
                 std::span<const Effect* const> effects) {
    Candidate now = start;
    const auto add_all = [&] {
        // An addition may make an earlier one needless, and that one come back.
        for (int added = 0; added < most_additions && now.stated.terms.size() < own_terms + most_names;
             ++added) {
            if (bench.work().is_over()) return;
            const auto next = best_addition(bench, now, screen(bench, now, effects));
            if (!next || !worth_it(bench, now, *next)) return;
            now = *next;
            // The motion's errors act through the model's own torque, which has changed.
            bench.settle_on(now.stated);
            now = bench.fitted(now.open, now.stated, now.prices);
            drop_needless(bench, now, own_terms);
        }
    };
    drop_needless(bench, now, own_terms, 0);
    add_all();
    for (int round = 0; round < swap_rounds; ++round) {
        if (!swap_once(bench, now, own_terms, effects)) break;
        drop_needless(bench, now, own_terms);
        add_all();
    }
    return now;
}

}  // namespace ripplenotch
