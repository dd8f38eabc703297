// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>

#include "diagnose/engine/search.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch::engine {
namespace {

// Halvings, roughly, of a step of the coordinate search.
constexpr double shrink = 0.55;
constexpr double straight_drift_s = 1e3;  // from here on a drift is a line, whatever its time constant

// Steps of both signs about the best value so far, each series shorter than the last.
struct StepSearch {
    Criterion& criterion;
    SearchedTerms& terms;
    std::size_t place, value;
    double best;

    template <class Moved>
    void run(int passes, double step, double shrunk, Moved moved) {
        for (int pass = 0; pass < passes; ++pass, step *= shrunk) {
            for (const double signed_step : {-step, step}) {
                SearchedTerms tried = terms;
                const auto next = moved(terms[place].values[value], signed_step);
                if (!next) continue;
                tried[place].values[value] = *next;
                const double squares = criterion.fit(tried).squares;
                if (squares >= best) continue;
                best = squares;
                terms = std::move(tried);
            }
        }
    }
};

}  // namespace

double bias_step_deg_s(const RecordedMotion& recorded, const Baseline& base) {
    const double cycles_per_deg =
        *std::max_element(base.orders.begin(), base.orders.end()) * base.ratio.value() / 360.0;
    return 0.25 / (cycles_per_deg * recorded.motion().time_s.back());
}

SearchedTerms refined(Criterion& criterion, SearchedTerms terms, std::size_t place) {
    const TermKind& kind = *terms[place].kind;
    if (!kind.is_refined) return terms;
    StepSearch search{criterion, terms, place, 0, criterion.fit(terms).squares};
    if (kind.effect->name == "gear-ratio") {
        const std::vector<double>& orders = criterion.base().orders;
        const double turns = std::max(criterion.recorded().travel_deg() / 360.0, 0.05);
        const double step = 0.2 / (*std::max_element(orders.begin(), orders.end()) * turns);
        search.run(7, step, 0.5,
                   [](double ratio, double by) { return std::optional(rounded(ratio + by, 7)); });
        return terms;
    }
    const bool is_delay = kind.effect->name == "delay";
    if (kind.effect->name == "velocity-bias") {
        const double step = bias_step_deg_s(criterion.recorded(), criterion.base());
        search.run(7, 0.5 * step, shrink,
                   [](double bias, double by) { return std::optional(rounded(bias + by, 7)); });
        return terms;
    }
    const int sweeps = kind.searched.size() > 1 ? 2 : 1;
    for (int sweep = 0; sweep < sweeps; ++sweep) {
        for (std::size_t value = 0; value < kind.searched.size(); ++value) {
            SearchedValue bounds = kind.searched[value];
            if (bounds.is_choice) continue;
            bounds.upper *= width_scale(kind, bounds, criterion.recorded());
            search.value = value;
            if (is_delay) {
                search.run(7, 0.002, shrink, [&](double delay_s, double by) -> std::optional<double> {
                    const double next = std::nearbyint((delay_s + by) * 1e6) * 1e-6;
                    if (next < bounds.lower || next > bounds.upper) return std::nullopt;
                    return next;
                });
                continue;
            }
            if (kind.effect->name == "drift" && terms[place].values[0] > straight_drift_s) continue;
            if (bounds.step > 0.0) {
                search.run(6, bounds.step, shrink, [&](double from, double by) {
                    return std::optional(rounded(std::clamp(from + by, bounds.lower, bounds.upper), 6));
                });
                continue;
            }
            search.run(5, 0.35, shrink, [&](double from, double by) {
                const double size =
                    std::clamp(std::abs(from) * portable::exp(by), bounds.lower, bounds.upper);
                return std::optional(rounded(std::copysign(size, from), 5));
            });
        }
    }
    return terms;
}

}  // namespace ripplenotch::engine
