// SPDX-License-Identifier: MIT
#include "diagnose/engine/engine.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "diagnose/engine/criterion.hpp"
#include "diagnose/engine/search.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch::engine {
namespace {

// Windows of the smoothing: the one that leaves least in the saturated regression, longer ones preferred.
constexpr std::array windows_s = {0.008, 0.012, 0.017, 0.025, 0.035, 0.05};
constexpr double first_window_s = 0.035;
constexpr double longest_preference = 0.02;
constexpr std::size_t exchange_finalists = 5;

// The log as the search sees it: smoothed, with its faults excluded.
struct Prepared {
    Baseline base;
    std::shared_ptr<const SaturatedFit> noise;
};

Prepared prepare(RecordedMotion& recorded, const KnownSide& known, std::vector<std::size_t>& spike_rows) {
    std::optional<double> inertia;
    Prepared now;
    const auto measure = [&](double window_s) {
        recorded.smooth(window_s);
        now.base = make_baseline(recorded, known, inertia);
        now.noise = std::make_shared<const SaturatedFit>(fit_saturated(recorded, now.base, {}, nullptr));
        inertia = now.noise->inertia_nm_per_deg_s2;
        return now.noise->noise_nm;
    };
    measure(first_window_s);
    double best_s = first_window_s, least = std::numeric_limits<double>::infinity();
    for (const double window_s : windows_s) {
        const double left = measure(window_s) * (1.0 + longest_preference * window_s / windows_s.back());
        if (left < least) least = left, best_s = window_s;
    }
    measure(best_s);
    now.noise = std::make_shared<const SaturatedFit>(fit_saturated(recorded, now.base, {}, now.noise.get()));
    const FarSamples far = find_spikes(recorded, *now.noise);
    for (const std::size_t slot : far.slots) {
        recorded.exclude(slot - 1, 3);
        if (far.are_spikes) spike_rows.push_back(recorded.row_of(slot));
    }
    if (!far.slots.empty()) measure(recorded.window_s());
    return now;
}

std::vector<double> per_row(const RecordedMotion& recorded, const std::vector<double>& per_slot) {
    std::vector<double> found;
    for (const std::size_t slot : recorded.clock().slot_of) found.push_back(per_slot[slot]);
    return found;
}

double sum(const std::vector<double>& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

// What speaks for one adopted term, and which others could stand in its place.
AdoptedTerm judged(const Search& search, Criterion& criterion, const SearchedTerms& terms, std::size_t place,
                   ValuedTerm valued) {
    AdoptedTerm found;
    found.term = std::move(valued.term);
    found.values = std::move(valued.values);
    SearchedTerms fewer = terms;
    fewer.erase(fewer.begin() + static_cast<std::ptrdiff_t>(place));
    const Admission admission = Search::admission(criterion, fewer, terms);
    found.reduction = admission.reduction;
    found.block_t = admission.block_t;
    found.noise_share = admission.noise_share;
    const double before = sum(criterion.plain_block_squares({}));
    found.explained_share =
        (sum(criterion.plain_block_squares(fewer)) - sum(criterion.plain_block_squares(terms))) / before;
    for (const SearchedTerms& other : search.extensions(criterion, fewer, exchange_finalists)) {
        const double margin = criterion.cost(other) - criterion.cost(terms);
        if (other.back().kind == terms[place].kind || margin > least_reduction ||
            search.is_preferred(criterion, fewer, {terms, terms[place]}, {other, other.back()}) ||
            !Search::admission(criterion, fewer, other).is_admissible)
            continue;
        found.rivals.push_back({valued_terms(criterion, other).back().term, margin});
    }
    return found;
}

Result searched(const Input& input) {
    Result result;
    RecordedMotion recorded(input.log, input.simulation);
    if (!input.is_good_row.empty()) recorded.mark_spoiled_rows(input.is_good_row);
    recorded.set_others(input.others_deg_s);
    const KnownSide known{&input.model, input.given_terms, input.simulation.has_value(),
                          input.simulation && input.simulation->is_scale_known};
    Prepared prepared = prepare(recorded, known, result.spike_rows);
    if (!(prepared.noise->noise_nm > 0.0)) raise<DataError>("the torque of this log does not change");
    if (recorded.is_position_integrated()) {
        // It spoils every column, so that it comes before the search.
        const Search search(recorded, prepared.base, prepared.noise,
                            {input.without.begin(), input.without.end()});
        Criterion criterion(recorded, prepared.base, prepared.noise);
        if (const auto bias = search.velocity_bias(criterion)) {
            const SearchedTerms alone = polished(criterion, {*bias});
            result.terms.push_back(
                judged(search, criterion, alone, 0, std::move(valued_terms(criterion, alone)[0])));
            result.rms_before_nm = criterion.rms_nm({});
            recorded.remove_velocity_bias(alone[0].values[0]);
            prepared = prepare(recorded, known, result.spike_rows);
        }
    }
    Search search(recorded, prepared.base, prepared.noise, {input.without.begin(), input.without.end()});
    const SearchResult found = search.run();
    Criterion& criterion = *found.best.criterion;
    SearchedTerms terms = polished(criterion, found.best.terms);
    std::vector<ValuedTerm> valued = valued_terms(criterion, terms);
    for (;;) {
        // The last of them says least.
        const auto absent = std::find_if(valued.rbegin(), valued.rend(), may_be_absent);
        if (absent == valued.rend()) break;
        result.nearly_adopted.push_back({absent->term, "its size may be none"});
        terms.erase(terms.begin() + (valued.rend() - absent - 1));
        terms = polished(criterion, terms);
        valued = valued_terms(criterion, terms);
    }
    SearchedTerms so_far;
    const auto add_factors = [&] {
        const Eigen::VectorXd factors = criterion.settled_factors(so_far);
        result.baseline_factors.emplace_back(
            factors.begin(), factors.begin() + static_cast<std::ptrdiff_t>(prepared.base.columns.size()));
    };
    add_factors();
    for (const bool is_silent : {false, true}) {
        for (std::size_t i = 0; i < terms.size(); ++i) {
            if (is_below_resolution(terms[i], recorded.step_s()) != is_silent) continue;
            auto& list = is_silent ? result.corrections : result.terms;
            list.push_back(judged(search, criterion, terms, i, std::move(valued[i])));
            so_far.push_back(terms[i]);
            add_factors();
        }
    }
    for (const RefusedTerm& refused : found.refused) {
        SearchedTerms with = terms;
        with.push_back(refused.term);
        result.nearly_adopted.push_back(
            {valued_terms(criterion, with).back().term, refused.admission.reason});
    }
    result.baseline = valued_columns(criterion, terms);
    result.simulated_inertia_nm_per_deg_s2 = criterion.base().simulated_inertia_nm_per_deg_s2;
    if (recorded.removed_bias_deg_s() == 0.0) result.rms_before_nm = criterion.rms_nm({});
    result.rms_after_nm = criterion.rms_nm(terms);
    result.noise_nm = criterion.noise().noise_nm;
    result.residual_after_nm = per_row(recorded, criterion.residual_nm(terms));
    for (const std::size_t slot : recorded.clock().slot_of) result.is_used.push_back(recorded.usable()[slot]);
    result.samples = criterion.blocks().sample.size();
    result.smoothing_s = recorded.window_s();
    return result;
}

}  // namespace

Result find_missing_effects(const Input& input) {
    Result result = searched(input);
    // A simulation seldom has ripple. What changes a ripple, and the motor angle that it follows, show once
    // the ripple is there: then the log is searched again with its orders known.
    Model with_ripple = input.model;
    std::vector<AdoptedTerm> ripples;
    for (const AdoptedTerm& adopted : result.terms) {
        if (!adopted.term.effect->ripple_order) continue;
        ripples.push_back(adopted);
        Term known{adopted.term.effect, std::vector<std::optional<double>>(adopted.term.values.size())};
        known.values[*known.effect->ripple_order] = adopted.term.values[*known.effect->ripple_order];
        with_ripple.terms.push_back(std::move(known));
    }
    const auto follows_ripple = [](const AdoptedTerm& adopted) {
        const Role role = term_kind(adopted.term.effect->name).role;
        return role == Role::ripple_change || role == Role::motor_angle;
    };
    const bool has_ripple = std::ranges::any_of(
        input.model.terms, [](const Term& term) { return bool(term.effect->ripple_order); });
    if (ripples.empty() || has_ripple) return result;
    Input again{input.log,          with_ripple,   input.simulation, input.given_terms,
                input.others_deg_s, input.without, input.is_good_row};
    Result second = searched(again);
    if (std::ranges::none_of(second.terms, follows_ripple)) return result;
    second.terms.insert(second.terms.begin(), ripples.begin(), ripples.end());
    second.rms_before_nm = result.rms_before_nm;
    return second;
}

}  // namespace ripplenotch::engine
