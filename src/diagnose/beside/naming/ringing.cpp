// SPDX-License-Identifier: MIT
#include "diagnose/beside/naming/ringing.hpp"

#include <algorithm>

namespace ripplenotch {
namespace {

Names with_plain(const Sums& sums, Names names, std::size_t place) {
    const Shape plain{sums.shapes()[names[place]].term};
    const auto& shapes = sums.shapes();
    names[place] = static_cast<std::size_t>(std::find(shapes.begin(), shapes.end(), plain) - shapes.begin());
    return names;
}

}  // namespace

void keep_first_of_each(const Sums& sums, std::vector<Named>& trials) {
    std::vector<Shape> kept;
    std::erase_if(trials, [&](const Named& trial) {
        const Shape& shape = sums.shapes()[trial.names.back()];
        const auto is_kept = [&](const Shape& one) {
            return same_name(one, shape) && one.ringing.has_value() == shape.ringing.has_value();
        };
        if (std::any_of(kept.begin(), kept.end(), is_kept)) return true;
        kept.push_back(shape);
        return false;
    });
}

OutsideGain gain_of_ringing(const Sums& sums, const Names& names, std::size_t place) {
    return gain_between(sums, with_plain(sums, names, place), names);
}

bool is_worth_ringing(const Sums& sums, const Names& names, std::size_t place, std::size_t effects) {
    if (!sums.shapes()[names[place]].ringing) return true;
    // At a bound it stands in for something else: a burst of noise passed for a ripple of 4 Hz, damped
    // by 1.5.
    if (sums.lens().bounds().is_ringing_bent(sums.shapes()[names[place]])) return false;
    return is_worth(gain_of_ringing(sums, names, place), price_of_ringing(sums, names[place], effects),
                    sums.lens().rules().beside);
}

Named refined_from_others(Sums& sums, const Named& now, std::size_t place) {
    const Shape begun = sums.shapes()[now.names[place]];
    Named best = now;
    for (std::size_t shape = 0; shape < sums.listed(); ++shape) {
        const Shape& start = sums.shapes()[shape];
        if (!start.ringing || !same_name(start, begun) || start == begun) continue;
        Named other = now;
        other.names[place] = shape;
        other.left = sums.left_outside(other.names);
        other = refined(sums, std::move(other));
        if (other.left < best.left) best = std::move(other);
    }
    return best;
}

Named with_ringing(Sums& sums, Named now, std::size_t effects) {
    for (std::size_t place = 0; place < now.names.size(); ++place) {
        const Shape plain = sums.shapes()[now.names[place]];
        if (plain.ringing || !plain.term.effect->ripple_order) continue;
        Named best = now;
        for (std::size_t shape = 0; shape < sums.listed(); ++shape) {
            if (!sums.shapes()[shape].ringing || !same_name(sums.shapes()[shape], plain)) continue;
            Named trial = now;
            trial.names[place] = shape;
            trial.left = sums.left_outside(trial.names);
            if (trial.left < best.left) best = std::move(trial);
        }
        if (best.names == now.names) continue;
        Named next = refined(sums, best);
        if (!is_worth_ringing(sums, next.names, place, effects))
            next = refined_from_others(sums, best, place);
        if (is_worth_ringing(sums, next.names, place, effects)) now = std::move(next);
    }
    return now;
}

Named without_idle_ringing(Sums& sums, Named now, std::size_t effects) {
    for (std::size_t place = 0; place < now.names.size(); ++place) {
        if (is_worth_ringing(sums, now.names, place, effects)) continue;
        now.names = with_plain(sums, now.names, place);
        now.left = sums.left_outside(now.names);
        now = refined(sums, std::move(now));
    }
    return now;
}

}  // namespace ripplenotch
