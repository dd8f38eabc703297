// SPDX-License-Identifier: MIT
#include "diagnose/search/late_ratio.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>

#include "diagnose/case/lines.hpp"
#include "diagnose/search/search_starts.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

const Effect* among(std::span<const Effect* const> effects, std::string_view name) {
    const auto found =
        std::ranges::find_if(effects, [&](const Effect* effect) { return effect->name == name; });
    return found == effects.end() ? nullptr : *found;
}

LateRatio best_late_ratio(const ModelBench& bench, const Effect& delay, const StatedRipple& ripple,
                          RatioRange range, const std::vector<double>& torque_nm) {
    const auto ratios_at = [&](double delay_s) {
        return LateRatio{delay_s, likely_ratios(seen_late(bench.looked_at(), Seconds(delay_s)), torque_nm,
                                                ripple.orders, range, bench.rules())};
    };
    LateRatio best = ratios_at(0.0);
    const double alone_nm2 = best.ratios.strongest_nm2;
    for (const double delay_s : delay.parameters[0].tried) {
        LateRatio late = ratios_at(delay_s);
        if (late.ratios.strongest_nm2 > best.ratios.strongest_nm2) best = std::move(late);
    }
    best.strongest_alone_nm2 = alone_nm2;
    return best;
}

}  // namespace

Seconds lateness_of(const Model& stated) {
    double late_s = 0.0;
    for (const Term& term : stated.terms) {
        if (term.effect->name == "delay") late_s += term.values[0].value_or(0.0);
    }
    return Seconds(late_s);
}

Case seen_late(const Case& looked_at, Seconds late) {
    Case seen = looked_at;
    if (late.value() == 0.0 || seen.size() < 2) return seen;
    const auto& time_s = looked_at.motion.time_s;
    const auto& position_deg = looked_at.motion.position_deg;
    // Rows that were lost or left out make a step of several periods.
    const double longest_s = 1.5 / looked_at.motion.sample_rate.value();
    std::size_t before = 0;
    for (std::size_t k = 0; k < seen.size(); ++k) {
        const double wanted_s = time_s[k] - late.value();
        while (before + 2 < seen.size() && time_s[before + 1] <= wanted_s) ++before;
        const double step_s = time_s[before + 1] - time_s[before], into_s = wanted_s - time_s[before];
        if (into_s < 0.0 || into_s > step_s || step_s > longest_s) {
            seen.use[k] = 0;
            continue;
        }
        seen.motion.position_deg[k] =
            position_deg[before] + (position_deg[before + 1] - position_deg[before]) * into_s / step_s;
    }
    return seen;
}

std::optional<Candidate> with_late_ratio(const ModelBench& bench, const Candidate& now, std::size_t own_terms,
                                         std::span<const Effect* const> effects) {
    const Effect* const delay = among(effects, "delay");
    const Effect* const gear_ratio = among(effects, "gear-ratio");
    if (delay == nullptr || gear_ratio == nullptr) return std::nullopt;
    const auto is_one = [&](const Term& term) { return term.effect == delay || term.effect == gear_ratio; };
    Model open = now.open, guess = now.stated;
    std::vector<double> prices = now.prices;
    // One of the two that was found alone may have the wrong value, for want of the other.
    std::size_t there = 0;
    for (std::size_t term = guess.terms.size(); term-- > 0;) {
        if (!is_one(guess.terms[term])) continue;
        if (term < own_terms || ++there == 2) return std::nullopt;
        const auto at = static_cast<std::ptrdiff_t>(term);
        open.terms.erase(open.terms.begin() + at);
        guess.terms.erase(guess.terms.begin() + at);
        prices.erase(prices.begin() + at);
    }
    const StatedRipple ripple = stated_ripple(guess);
    Model without_ripple = guess;
    std::erase_if(without_ripple.terms,
                  [](const Term& term) { return term.effect->ripple_order.has_value(); });
    const std::vector<double> torque_nm = bench.raw_residual(without_ripple);
    const SeenModel seen{open, torque_nm, {}};
    KeptBeside<LateRatio>& kept = bench.kept()->late_ratios;
    const LateRatio* before = kept.find(seen, bench.looked_at().use, bench.same_model_nm2());
    const LateRatio& best =
        before != nullptr
            ? *before
            : kept.keep(seen,
                        best_late_ratio(bench, *delay, ripple,
                                        ratios_beside(now, ripple.ratio.value(), bench.rules()), torque_nm));
    if (best.ratios.ratios.empty() ||
        !(best.ratios.strongest_nm2 > bench.rules().screening.late_ratio * best.strongest_alone_nm2))
        return std::nullopt;
    const double cells = best.ratios.compared * static_cast<double>(delay->parameters[0].tried.size());
    const double price =
        portable::log(bench.samples()) + portable::log(cells) +
        2.0 * portable::log(static_cast<double>(effects.size()) / bench.rules().screening.false_alarm);
    const double error = value_for_ratio(*gear_ratio, 0, ripple.ratio, best.ratios.ratios.front());
    for (const auto& [effect, value] : {std::pair(delay, best.delay_s), std::pair(gear_ratio, error)}) {
        open.terms.push_back({effect, {std::nullopt}});
        guess.terms.push_back({effect, {value}});
        prices.push_back(price);
    }
    return bench.fitted(open, guess, std::move(prices), 12, bench.rules().search.finalist_settled);
}

}  // namespace ripplenotch
