// SPDX-License-Identifier: MIT
#include "diagnose/beside/naming/rivals.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "diagnose/beside/naming/form.hpp"
#include "diagnose/beside/naming/ringing.hpp"

namespace ripplenotch {
namespace {

// The best other name in its place, refined; one that is bent stands in for something else.
std::optional<Named> best_rival(Sums& sums, const Names& rest, std::size_t own, double price) {
    std::vector<Named> rivals;
    const Shape shape = sums.shapes()[own];
    // What a given term leaves is a function of the posture, which any wave over the position takes up.
    const bool of_posture = kind_of(*shape.term.effect) == Kind::position;
    for (std::size_t i = 0; i < sums.listed(); ++i) {
        const Shape& other = sums.shapes()[i];
        if (same_name(other, shape) || is_among(sums, rest, other) || !sums.is_told(i)) continue;
        if (of_posture && kind_of(*other.term.effect) != Kind::position) continue;
        Named rival{rest};
        rival.names.push_back(i);
        rival.left = sums.left_outside(rival.names);
        rivals.push_back(std::move(rival));
    }
    std::stable_sort(rivals.begin(), rivals.end(),
                     [](const Named& a, const Named& b) { return a.left < b.left; });
    keep_first_of_each(sums, rivals);
    std::optional<Named> best;
    for (std::size_t i = 0; i < std::min(rivals.size(), sums.lens().rules().beside.most_rivals); ++i) {
        Named rival = refined(sums, rivals[i]);
        if (sums.lens().bounds().is_bent(sums.shapes()[rival.names.back()])) continue;
        if (drives(sums, rival.names, rival.names.size() - 1)) continue;
        if (!of_posture && stands_beside(sums, rival.names, own, price)) continue;
        if (!best || rival.left < best->left) best = std::move(rival);
    }
    return best;
}

std::optional<Rivalry> against_best(Sums& sums, const Names& names, std::size_t place, double price) {
    Names rest = names;
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(place));
    const auto rival = best_rival(sums, rest, names[place], price);
    if (!rival) return std::nullopt;
    return Rivalry{sums.shapes()[rival->names.back()], gain_between(sums, rival->names, names)};
}

bool is_ahead(const Rivalry& one, const BesideRules& rules) {
    return one.ahead.gain >= rules.tie_margin && one.ahead.t >= rules.tie_t;
}

bool is_behind(const Rivalry& one, const BesideRules& rules) {
    return one.ahead.gain < -rules.tie_margin && one.ahead.t < -rules.tie_t;
}

DiagnosisRules with_longer_memory(DiagnosisRules rules) {
    rules.beside.memory_s = std::max(rules.beside.memory_s, rules.beside.tie_memory_s);
    return rules;
}

}  // namespace

struct LongerLook::Held {
    Held(const Lens& like, const Candidate& model, std::span<const GivenTerm> given,
         std::span<const Effect* const> effects)
        : rules(with_longer_memory(like.rules())), lens(like, model, given, effects, rules), sums(lens) {}
    DiagnosisRules rules;
    Lens lens;
    Sums sums;
};

LongerLook::LongerLook(const Lens& lens, const Candidate& model, std::span<const GivenTerm> given,
                       std::span<const Effect* const> effects)
    : lens_(lens), model_(model), given_(given), effects_(effects) {}
LongerLook::~LongerLook() = default;

Sums& LongerLook::sums() {
    if (!held_) held_ = std::make_unique<Held>(lens_, model_, given_, effects_);
    return held_->sums;
}

std::optional<Rivalry> rivalry_of(Sums& sums, const Names& names, std::size_t place, double price,
                                  LongerLook* longer) {
    const BesideRules& rules = sums.lens().rules().beside;
    auto here = against_best(sums, names, place, price);
    if (!here || longer == nullptr || is_ahead(*here, rules) || is_behind(*here, rules)) return here;
    Sums& there = longer->sums();
    Named same;
    for (const std::size_t name : names) same.names.push_back(there.place_of(sums.shapes()[name]));
    same.left = there.left_outside(same.names);
    same = refined(there, std::move(same));
    auto further = against_best(there, same.names, place, price);
    if (!further || is_ahead(*further, rules) || is_behind(*further, rules)) here = std::move(further);
    Names none;
    there.forget_but(none);
    return here;
}

}  // namespace ripplenotch
