// SPDX-License-Identifier: MIT
#include "diagnose/search/search_starts.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "diagnose/search/late_ratio.hpp"

namespace ripplenotch {
namespace {

std::vector<double> tried(const Effect& effect, std::size_t p, const Hints& hints, double samples,
                          double& cells) {
    const Parameter& parameter = effect.parameters[p];
    std::vector<double> values;
    if (parameter.tried.empty() && parameter.hint != Hint::tones) values.push_back(parameter.start);
    values.insert(values.end(), parameter.tried.begin(), parameter.tried.end());
    cells *= static_cast<double>(std::max<std::size_t>(values.size(), 1));
    if (parameter.hint == Hint::ripple_orders && hints.orders.size() > 1) {
        values.insert(values.end(), hints.orders.begin(), hints.orders.end());
        cells *= static_cast<double>(values.size());
    }
    if (parameter.hint == Hint::tones) {
        values = hints.tones_hz;
        cells *= samples / 2.0;
    }
    if (parameter.hint == Hint::delay && hints.delay_s) values.push_back(*hints.delay_s);
    if (parameter.hint == Hint::gear_ratios && !hints.ratios.ratios.empty()) {
        cells += hints.ratios.compared;
        for (const double ratio : hints.ratios.ratios)
            values.push_back(value_for_ratio(effect, p, hints.ratio, ratio));
    }
    if (parameter.hint == Hint::both_ways)
        std::erase_if(values, [&](double order) { return order < hints.least_order; });
    if (parameter.hint == Hint::change_times) {
        values = hints.changes.times_s;
        cells *= hints.changes.compared;
    }
    std::erase_if(values, [&](double value) { return !allows(parameter, value); });
    return values;
}

// Travel that is passed in both directions.
double both_ways_deg(const Case& looked_at) {
    constexpr double cell_deg = 5.0;  // by hand
    std::map<long, unsigned> passed;
    for (std::size_t k = 0; k < looked_at.size(); ++k) {
        const double v = looked_at.motion.velocity_deg_s[k];
        if (looked_at.use[k] == 0 || std::abs(v) < looked_at.moving_deg_s) continue;
        passed[std::lround(looked_at.motion.position_deg[k] / cell_deg)] |= v > 0.0 ? 1U : 2U;
    }
    return cell_deg * static_cast<double>(
                          std::ranges::count_if(passed, [](const auto& cell) { return cell.second == 3U; }));
}

}  // namespace

namespace {

// A torque that has but a size, or a size and the width of its step.
bool has_one_form(const Effect& effect) {
    for (std::size_t p = 0; p < effect.parameters.size(); ++p) {
        const Parameter& parameter = effect.parameters[p];
        const bool phase = effect.polar && effect.polar->phase == p;
        if (!parameter.linear && !phase && parameter.name != "width_deg_s" &&
            parameter.left_out != LeftOut::assumed)
            return false;
    }
    return true;
}

}  // namespace

bool is_there_already(const Term& tried, const Model& open) {
    const Effect& effect = *tried.effect;
    if (effect.side == Side::joint) {
        // A load is picked up and put down; more changes take up whatever else differs from move to move.
        constexpr std::ptrdiff_t most_changes = 2;
        if (find_parameter(effect, "time_s") &&
            std::ranges::count(open.terms, &effect, &Term::effect) >= most_changes)
            return true;
        return has_one_form(effect) && std::ranges::any_of(open.terms, [&](const Term& term) {
                   return term.effect == &effect && !term.values.front();
               });
    }
    return std::any_of(open.terms.begin(), open.terms.end(), [&](const Term& term) {
        if (term.effect != &effect) return false;
        bool fitted = false;
        for (std::size_t p = 0; p < effect.parameters.size(); ++p) {
            if (!term.values[p]) {
                fitted = true;
            } else if (effect.stated_from != p && effect.parameters[p].left_out != LeftOut::fitted &&
                       term.values[p] != tried.values[p]) {
                return false;
            }
        }
        return fitted;
    });
}

double value_for_ratio(const Effect& effect, std::size_t parameter, GearRatio stated, double wanted) {
    // The ratio is affine in the parameter.
    std::vector<double> values;
    for (const Parameter& other : effect.parameters) values.push_back(other.neutral);
    Motion scratch;
    GearRatio at_neutral = stated, at_next = stated;
    effect.change_motion(values, scratch, at_neutral);
    values[parameter] += 1.0;
    effect.change_motion(values, scratch, at_next);
    const double slope = at_next.value() - at_neutral.value();
    return effect.parameters[parameter].neutral + (wanted - at_neutral.value()) / slope;
}

RatioRange ratios_beside(const Candidate& model, double about, const DiagnosisRules& rules) {
    const RatioRange all{rules.screening.lowest_ratio * about, rules.screening.highest_ratio * about};
    RatioRange range = all;
    for (std::size_t t = 0; t < model.stated.terms.size(); ++t) {
        const Term& term = model.stated.terms[t];
        const auto place = term.effect->ripple_order;
        if (!place) continue;
        if (model.prices[t] == 0.0) return all;
        for (const double other : term.effect->parameters[*place].tried) {
            const double between = about * std::sqrt(other / *term.values[*place]);
            if (between < about) range.lowest = std::max(range.lowest, between);
            if (between > about) range.highest = std::min(range.highest, between);
        }
    }
    return range;
}

Hints hints_of(const ModelBench& bench, const Candidate& model, const std::vector<double>& left_nm) {
    const Model& stated = model.stated;
    Hints hints;
    if (bench.looked_at().expected_delay) hints.delay_s = bench.looked_at().expected_delay->value();
    hints.tones_hz = strongest_tones_hz(bench.looked_at(), left_nm, bench.rules());
    StatedRipple ripple = stated_ripple(stated);
    hints.ratio = ripple.ratio;
    hints.orders = std::move(ripple.orders);
    Model without_ripple = stated;
    std::erase_if(without_ripple.terms,
                  [](const Term& term) { return term.effect->ripple_order.has_value(); });
    hints.ratios =
        likely_ratios(seen_late(bench.looked_at(), lateness_of(stated)), bench.raw_residual(without_ripple),
                      hints.orders, ratios_beside(model, hints.ratio.value(), bench.rules()), bench.rules());
    hints.least_order =
        360.0 * bench.rules().screening.least_cycle / std::max(both_ways_deg(bench.looked_at()), 1e-9);
    hints.changes = change_times(bench.looked_at(), left_nm, bench.noise().rms_nm, bench.rules());
    return hints;
}

std::vector<Term> starts_of(const Effect& effect, const Hints& hints, double samples, double& cells) {
    std::vector<Term> starts{{&effect, {}}};
    for (std::size_t p = 0; p < effect.parameters.size(); ++p) {
        const Parameter& parameter = effect.parameters[p];
        const bool phase = effect.polar && p == effect.polar->phase;
        std::vector<double> values{parameter.linear || phase ? parameter.start : parameter.neutral};
        if (!parameter.linear && !phase) values = tried(effect, p, hints, samples, cells);
        std::vector<Term> more;
        for (const Term& start : starts) {
            for (const double value : values) {
                more.push_back(start);
                more.back().values.emplace_back(value);
            }
        }
        starts = std::move(more);
    }
    // A ripple effect of the very order that the model has already tells nothing new, but a screening
    // finds that out by itself.
    return starts;
}

}  // namespace ripplenotch
