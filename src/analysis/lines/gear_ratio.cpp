// SPDX-License-Identifier: MIT
#include "ripplenotch/analysis/gear_ratio.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "analysis/lines/comb.hpp"
#include "analysis/lines/excess_scatter.hpp"
#include "analysis/lines/ratio_rivals.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

constexpr double least_score = 0.7;           // for a ratio to be given
constexpr double least_listed_score = 0.005;  // for a candidate to be listed
constexpr std::size_t most_candidates = 8;    // by hand: a list that a person reads

/// Two-sided 95 % quantile of Student's t.
double student_95(double freedom) {
    constexpr std::array table{12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228};
    if (freedom <= 10.0) return table[static_cast<std::size_t>(std::max(freedom, 1.0)) - 1];
    return 1.960 + 2.4 / freedom + 3.5 / (freedom * freedom);
}

/// What one source (a stretch of one speed, or a line over a whole motion) says about the ratio.
struct Estimate {
    double ratio = 0.0, variance = 0.0, weight = 1.0;
};

std::map<std::size_t, Estimate> by_source(std::span<const OrderLine> lines, const Comb& comb) {
    std::map<std::size_t, Estimate> estimates;
    std::map<std::size_t, double> bottom, speed_error;
    for (std::size_t i = 0; i < lines.size(); ++i) {
        if (!comb.n[i]) continue;
        for (const OrderObservation& seen : lines[i].observations) {
            const double ratio = seen.order_output / *comb.n[i];
            const double error = std::max(seen.error, 1e-7 * seen.order_output) / *comb.n[i];
            estimates[seen.source].ratio += ratio / (error * error);
            bottom[seen.source] += 1.0 / (error * error);
            speed_error[seen.source] = std::max(speed_error[seen.source], seen.speed_share_error);
        }
    }
    for (auto& [source, estimate] : estimates) {
        estimate.ratio /= bottom[source];
        const double shared = estimate.ratio * speed_error[source];
        estimate.variance = 1.0 / bottom[source] + shared * shared;
    }
    return estimates;
}

void fit(std::span<const OrderLine> lines, const Comb& comb, double shared_error, GearRatioFit& result) {
    auto estimates = by_source(lines, comb);
    constexpr double huber = 1.345;  // 95 % efficient where errors are normal (Huber 1964)
    double ratio = comb.ratio, scale = 1.0, bottom = 0.0;
    const auto freedom = static_cast<double>(estimates.size()) - 1.0;
    for (int round = 0; round < 30; ++round) {
        double top = 0.0, misfit = 0.0;
        bottom = 0.0;
        for (auto& [source, e] : estimates) {
            const double off = std::abs(e.ratio - ratio) / (scale * std::sqrt(e.variance));
            e.weight = round == 0 || off <= huber ? 1.0 : huber / off;
            top += e.weight * e.ratio / e.variance;
            bottom += e.weight / e.variance;
        }
        ratio = top / bottom;
        for (const auto& [source, e] : estimates)
            misfit += e.weight * (e.ratio - ratio) * (e.ratio - ratio) / e.variance;
        scale = excess_scatter(misfit, freedom);
    }
    result.value = ratio;
    const double own = scale / std::sqrt(bottom), shared = shared_error * ratio;
    result.standard_error = portable::hypot(own, shared);
    const double reach = portable::hypot((scale > 1.0 ? student_95(freedom) : 1.960) * own, 1.960 * shared);
    result.ci95_low = ratio - reach;
    result.ci95_high = ratio + reach;
    for (std::size_t i = 0; i < lines.size(); ++i) {
        if (!comb.n[i]) continue;
        for (const OrderObservation& seen : lines[i].observations) {
            const double expected = *comb.n[i] * ratio * std::abs(seen.speed_deg_s) / 360.0;
            result.residuals.push_back({seen.speed_deg_s, seen.hz, static_cast<double>(*comb.n[i]),
                                        seen.hz - expected, estimates[seen.source].weight});
        }
    }
}

void check_hint(const std::vector<Comb>& combs, std::span<const OrderLine> lines, GearRatio hint,
                std::vector<std::string>& notes) {
    if (std::any_of(combs.begin(), combs.end(), [](const Comb& comb) { return comb.hinted; })) return;
    const OrderLine& first = lines.front();
    const double n = std::max(1.0, std::round(first.order_output / hint.value()));
    const double off = 100.0 * (first.order_output / (n * hint.value()) - 1.0);
    notes.push_back(fmt::format(
        "the hint {:.6g} is not supported: output order {:.5g} is {:+.2f} % from {:.0f} times it, more than "
        "its error allows; a speed or position scale wrong by that much would explain it",
        hint.value(), first.order_output, off, n));
}

/// Everything that the lines could mean, as shares of one, likeliest first.
std::vector<RatioCandidate> scored(std::span<const Comb> combs, std::span<const RatioRival> rivals) {
    double most = combs.front().nats, total = 0.0;
    for (const RatioRival& rival : rivals) most = std::max(most, rival.nats);
    std::vector<RatioCandidate> all;
    for (const Comb& comb : combs) all.push_back({comb.ratio, portable::exp(comb.nats - most), comb.reason});
    for (const RatioRival& rival : rivals)
        all.push_back({rival.ratio, portable::exp(rival.nats - most), rival.reason});
    for (const RatioCandidate& one : all) total += one.score;
    for (RatioCandidate& one : all) one.score /= total;
    std::stable_sort(all.begin(), all.end(),
                     [](const RatioCandidate& a, const RatioCandidate& b) { return a.score > b.score; });
    std::erase_if(all, [](const RatioCandidate& one) { return one.score < least_listed_score; });
    if (all.size() > most_candidates) all.resize(most_candidates);
    return all;
}

}  // namespace

GearRatioResult fit_gear_ratio(std::span<const OrderLine> lines, const RatioQuestion& question) {
    GearRatioResult result;
    result.order_of_line.resize(lines.size());
    if (lines.empty()) return result;
    const std::optional<GearRatio> hint = question.hint;
    const std::vector<Comb> combs = all_combs(lines, hint, question.hinted_orders);
    if (combs.empty()) return result;
    const Comb& best = combs.front();
    std::vector<RatioRival> rivals = unit_rivals(best, hint);
    const auto add = [&](const std::optional<RatioRival>& rival) {
        if (rival) rivals.push_back(*rival);
    };
    for (RatioRival& rival : fold_rivals(lines, hint, question.hinted_orders))
        rivals.push_back(std::move(rival));
    if (hint && question.clock_in_doubt && rivals.empty()) add(clock_rival(best, *hint));
    if (hint) check_hint(combs, lines, *hint, result.notes);
    if (!question.hinted_orders.empty() && !hint &&
        std::none_of(combs.begin(), combs.end(), [](const Comb& comb) { return comb.hinted; })) {
        result.notes.push_back("no comb puts the strongest line at a hinted order");
    }
    const bool certain = std::any_of(lines.begin(), lines.end(), [&](const OrderLine& line) {
        return line.certain && best.n[static_cast<std::size_t>(&line - lines.data())];
    });
    result.fit.candidates = scored(combs, rivals);
    const RatioCandidate& likeliest = result.fit.candidates.front();
    if (likeliest.value == best.ratio && likeliest.score >= least_score &&
        (certain || best.hinted || best.listed)) {
        result.order_of_line = best.n;
        fit(lines, best, question.shared_error, result.fit);
        if (hint && best.hinted && certain) add(scale_rival(best, result.fit, *hint));
        result.fit.candidates = scored(combs, rivals);
        // The robust fit moves the value a little from where the comparison of combs left it; one ratio, one
        // number.
        if (result.fit.value) result.fit.candidates.front().value = *result.fit.value;
    }
    for (RatioRival& rival : rivals) {
        if (!rival.note.empty()) result.notes.push_back(std::move(rival.note));
    }
    return result;
}

}  // namespace ripplenotch
