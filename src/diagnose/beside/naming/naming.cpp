// SPDX-License-Identifier: MIT
#include "diagnose/beside/naming/naming.hpp"

#include "diagnose/beside/naming/ringing.hpp"

#include <algorithm>
#include <optional>
#include <utility>

namespace ripplenotch {
namespace {

// The best of what may be added, the best first.
std::vector<Named> finalists(const Sums& sums, const Named& now, const Barred& barred) {
    std::vector<Named> trials;
    for (std::size_t shape = 0; shape < sums.listed(); ++shape) {
        const Shape& tried = sums.shapes()[shape];
        if (!sums.is_told(shape) || is_among(sums, now.names, tried) || is_barred(barred, tried)) continue;
        Named trial = now;
        trial.names.push_back(shape);
        trial.left = sums.left_outside(trial.names);
        if (trial.left < now.left) trials.push_back(std::move(trial));
    }
    std::stable_sort(trials.begin(), trials.end(),
                     [](const Named& a, const Named& b) { return a.left < b.left; });
    keep_first_of_each(sums, trials);
    trials.resize(std::min(trials.size(), sums.lens().rules().beside.finalists));
    return trials;
}

// Whether the last name is worth its price beside those before it.
bool is_worth_adding(const Sums& sums, const Named& now, const Named& next, std::size_t effects) {
    const OutsideGain gain = gain_between(sums, now.names, next.names);
    return is_worth(gain, price_of(sums, next.names.back(), effects), sums.lens().rules().beside) &&
           is_worth_ringing(sums, next.names, next.names.size() - 1, effects);
}

std::optional<Named> one_more(Sums& sums, const Named& now, const Barred& barred, std::size_t effects) {
    for (const Named& trial : finalists(sums, now, barred)) {
        Named next = refined(sums, trial);
        if (is_worth_adding(sums, now, next, effects)) return next;
        if (!sums.shapes()[trial.names.back()].ringing) continue;
        next = refined_from_others(sums, trial, trial.names.size() - 1);
        if (is_worth_adding(sums, now, next, effects)) return next;
    }
    return std::nullopt;
}

// What is worth least, of those that are no longer worth their price.
std::optional<std::size_t> needless(const Sums& sums, const Named& now, std::size_t effects) {
    std::optional<std::size_t> worst;
    double least = 0.0;
    for (std::size_t name = 0; name < now.names.size(); ++name) {
        Names rest = now.names;
        rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(name));
        const OutsideGain gain = gain_between(sums, rest, now.names);
        const double price = price_of(sums, now.names[name], effects);
        if (is_worth(gain, price, sums.lens().rules().beside)) continue;
        if (worst && gain.gain - price >= least) continue;
        worst = name;
        least = gain.gain - price;
    }
    return worst;
}

}  // namespace

Named search_beside(Sums& sums, Named now, const Barred& barred, std::size_t effects) {
    now.left = sums.left_outside(now.names);
    while (now.names.size() < sums.lens().rules().beside.most_names) {
        auto next = one_more(sums, now, barred, effects);
        if (next) {
            next = with_better_names(sums, std::move(*next), barred);
            next = with_better_pair(sums, std::move(*next), barred);
            now = with_ringing(sums, refined(sums, std::move(*next)), effects);
        }
        sums.forget_but(now.names);
        if (!next) break;
    }
    // A ripple that does not ring after all has to be worth its own price.
    now = without_idle_ringing(sums, std::move(now), effects);
    while (const auto name = needless(sums, now, effects)) {
        now.names.erase(now.names.begin() + static_cast<std::ptrdiff_t>(*name));
        now.left = sums.left_outside(now.names);
        now = refined(sums, std::move(now));
    }
    sums.forget_but(now.names);
    return now;
}

}  // namespace ripplenotch
