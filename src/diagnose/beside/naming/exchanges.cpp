// SPDX-License-Identifier: MIT
#include "diagnose/beside/naming/exchanges.hpp"

#include <algorithm>
#include <optional>

namespace ripplenotch {
namespace {

constexpr double factors[] = {1.5, 1.2, 1.08};

double squared(const Sums& sums) { return sums.lens().sigma() * sums.lens().sigma(); }

bool is_friction(const Shape& shape) {
    const Kind kind = kind_of(*shape.term.effect);
    return kind == Kind::friction || kind == Kind::speed;
}

// The scale moved once up or down by this factor where that helps.
bool move_once(Sums& sums, Named& now, std::size_t name, const Scale& scale, double factor) {
    const ScaleBounds& bounds = sums.lens().bounds();
    for (const double by : {factor, 1.0 / factor}) {
        const Shape shape = sums.shapes()[now.names[name]];
        const double value = value_of(shape, scale) * by;
        if (value < bounds.low(shape, scale) || value > bounds.high(shape, scale)) continue;
        Named next = now;
        next.names[name] = sums.place_of(moved(shape, scale, value));
        next.left = sums.left_outside(next.names);
        if (next.left < now.left - sums.lens().rules().beside.refine_gain * squared(sums)) {
            now = std::move(next);
            return true;
        }
    }
    return false;
}

// Every scale once, by ever smaller factors.
Named swept(Sums& sums, Named now) {
    constexpr int most_moves = 6;
    for (std::size_t name = 0; name < now.names.size(); ++name) {
        for (const Scale& scale : scales_of(sums.shapes()[now.names[name]])) {
            for (const double factor : factors) {
                for (int move = 0; move < most_moves; ++move) {
                    if (!move_once(sums, now, name, scale, factor)) break;
                }
            }
        }
    }
    return now;
}

Names without(const Names& names, std::size_t a, std::size_t b) {
    Names rest;
    for (std::size_t i = 0; i < names.size(); ++i) {
        if (i != a && i != b) rest.push_back(names[i]);
    }
    return rest;
}

Names appended(Names names, std::size_t one) {
    names.push_back(one);
    return names;
}

bool may_stand_beside(const Sums& sums, const Names& names, std::size_t shape, const Barred& barred) {
    return sums.is_told(shape) && !is_among(sums, names, sums.shapes()[shape]) &&
           !is_barred(barred, sums.shapes()[shape]);
}

// The best two that may stand in the place of two.
void take_best_pair(const Sums& sums, const Names& rest, const Barred& barred, std::optional<Named>& best) {
    Names pool;
    for (std::size_t shape = 0; shape < sums.listed(); ++shape) {
        if (is_friction(sums.shapes()[shape]) && may_stand_beside(sums, rest, shape, barred))
            pool.push_back(shape);
    }
    for (std::size_t a = 0; a < pool.size(); ++a) {
        const Names one = appended(rest, pool[a]);
        for (std::size_t b = 0; b < a; ++b) {
            if (same_name(sums.shapes()[pool[a]], sums.shapes()[pool[b]])) continue;
            Named pair{appended(one, pool[b])};
            pair.left = sums.left_outside(pair.names);
            if (!best || pair.left < best->left) best = std::move(pair);
        }
    }
}

}  // namespace

bool is_among(const Sums& sums, const Names& names, const Shape& shape) {
    return std::any_of(names.begin(), names.end(),
                       [&](std::size_t name) { return same_name(sums.shapes()[name], shape); });
}

bool is_barred(const Barred& barred, const Shape& shape) {
    return std::any_of(barred.begin(), barred.end(), [&](const Shape& one) { return same_name(one, shape); });
}

Named refined(Sums& sums, Named now) {
    // The scales of one name shift with those of another: once more, as long as the last time was worth a
    // value. Less is a step along a valley, at whose end a size is no longer told.
    constexpr int most_sweeps = 4;
    constexpr double gain_of_a_value = 2.0;
    for (int sweep = 0; sweep < most_sweeps; ++sweep) {
        const double before = now.left;
        now = swept(sums, std::move(now));
        if (before - now.left < gain_of_a_value * squared(sums)) break;
    }
    return now;
}

Named with_better_names(Sums& sums, Named now, const Barred& barred) {
    while (true) {
        Named best = now;
        for (std::size_t name = 0; name < now.names.size(); ++name) {
            const Names rest = without(now.names, name, name);
            for (std::size_t shape = 0; shape < sums.listed(); ++shape) {
                if (shape == now.names[name] || sums.shapes()[shape].ringing ||
                    !may_stand_beside(sums, rest, shape, barred))
                    continue;
                Named other{appended(rest, shape)};
                other.left = sums.left_outside(other.names);
                if (other.left < best.left) best = std::move(other);
            }
        }
        if (!(best.left < now.left - sums.lens().rules().beside.exchange_gain * squared(sums))) return now;
        now = std::move(best);
    }
}

Named with_better_pair(Sums& sums, Named now, const Barred& barred) {
    std::optional<Named> best;
    for (std::size_t a = 0; a < now.names.size(); ++a) {
        for (std::size_t b = 0; b < a; ++b) {
            if (is_friction(sums.shapes()[now.names[a]]) && is_friction(sums.shapes()[now.names[b]]))
                take_best_pair(sums, without(now.names, a, b), barred, best);
        }
    }
    if (!best) return now;
    Named other = refined(sums, std::move(*best));
    return other.left < now.left - sums.lens().rules().beside.exchange_gain * squared(sums) ? other : now;
}

}  // namespace ripplenotch
