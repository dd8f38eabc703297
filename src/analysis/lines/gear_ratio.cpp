// SPDX-License-Identifier: MIT
#include "ripplenotch/analysis/gear_ratio.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "analysis/lines/ratio_hypothesis.hpp"
#include "core/matrices/least_squares.hpp"
#include "ripplenotch/analysis/line_test.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

constexpr double least_score = 0.8;           // for a ratio to be reported: chosen, not derived
constexpr double least_listed_score = 0.005;  // for a candidate to be listed
constexpr std::size_t most_candidates = 8;    // chosen, not derived: a list that a person reads

/// The ratio implied by one line; weight 0 where it lies off the combs.
struct Estimate {
    double ratio = 0.0, variance = 1.0, weight = 0.0;
};

std::vector<Estimate> estimates_of(std::span<const OrderLine> lines, const RatioHypothesis& best) {
    // Where some lines are made up by both combs, the other comb pulls at those on one comb, too: by about a
    // tenth of the distance of the combs, rms over the lines of six joints of an arm.
    constexpr double pull_deviation = 0.12;
    const bool close_combs = std::any_of(best.position.begin(), best.position.end(),
                                         [](const auto& at) { return at && at->of_both(); });
    std::vector<Estimate> estimates(lines.size());
    for (std::size_t i = 0; i < lines.size(); ++i) {
        if (!best.position[i]) continue;
        const CombPosition& at = *best.position[i];
        const double error = portable::hypot(std::max(lines[i].error, 1e-7 * lines[i].order_output) / at.n,
                                             std::max(at.spread, close_combs ? pull_deviation : 0.0));
        estimates[i] = {lines[i].order_output / at.n - at.shift, error * error, 1.0};
    }
    return estimates;
}

/// Order per turn of the motor.
double order_of_motor(const CombPosition& at, double ratio) {
    return at.of_both() || at.shift == 0.0 ? at.n : at.n * (1.0 + at.shift / ratio);
}

/// Value, standard error and interval; returns the estimate of each line, with its weight.
std::vector<Estimate> fit(std::span<const OrderLine> lines, const RatioHypothesis& best,
                          GearRatioFit& result) {
    std::vector<Estimate> estimates = estimates_of(lines, best);
    constexpr double huber = 1.345;  // 95 % efficient where errors are normal (Huber 1964)
    double ratio = best.ratio, scale = 1.0, bottom = 0.0, freedom = -1.0, shared = 0.0;
    for (std::size_t i = 0; i < lines.size(); ++i) {
        freedom += estimates[i].weight;
        shared = std::max(shared, lines[i].shared_error);
    }
    for (int round = 0; round < 30; ++round) {
        double top = 0.0, misfit = 0.0;
        bottom = 0.0;
        for (Estimate& e : estimates) {
            if (e.weight == 0.0) continue;
            const double off = std::abs(e.ratio - ratio) / (scale * std::sqrt(e.variance));
            e.weight = round == 0 || off <= huber ? 1.0 : huber / off;
            top += e.weight * e.ratio / e.variance;
            bottom += e.weight / e.variance;
        }
        ratio = top / bottom;
        for (const Estimate& e : estimates)
            misfit += e.weight * (e.ratio - ratio) * (e.ratio - ratio) / e.variance;
        scale = excess_scatter(misfit, freedom);
    }
    result.value = ratio;
    const double own = scale / std::sqrt(bottom);
    result.standard_error = portable::hypot(own, shared * ratio);
    const double reach =
        portable::hypot((scale > 1.0 ? student_95(freedom) : 1.960) * own, 1.960 * shared * ratio);
    result.ci95_low = ratio - reach;
    result.ci95_high = ratio + reach;
    return estimates;
}

/// The same two combs with the other spline as output: the text reports it, and it is no error of the value.
bool mirrors(const RatioHypothesis& one, const RatioHypothesis& other) {
    return one.second_comb != 0 && one.second_comb == -other.second_comb &&
           std::abs(one.ratio + one.second_comb - other.ratio) < 0.5;
}

constexpr double between_combs = 1.0;    // turns of the wave generator a turn of the joint
constexpr double interval_share = 0.95;  // the probability that an interval is stated with

double share_of(const RatioHypothesis& form, const RatioHypothesis& best) {
    return portable::exp(form.own_evidence - best.log_evidence);
}

/// Two combs are reported where one has less than 0.01 of the probability.
const RatioHypothesis& reported_form(const RatioHypothesis& best) {
    if (best.second_comb == 0) return best;
    const auto one_comb = std::find_if(best.forms.begin(), best.forms.end(),
                                       [](const RatioHypothesis& form) { return form.second_comb == 0; });
    const bool rejected = one_comb == best.forms.end() || share_of(*one_comb, best) < 0.01;
    return rejected ? best : *one_comb;
}

/// The interval covers all forms of the ratio that together have 0.95 of its probability.
void widen_interval(std::span<const OrderLine> lines, const RatioHypothesis& best,
                    const RatioHypothesis& reported, GearRatioFit& result) {
    double share = share_of(reported, best);
    const auto add = [&](const RatioHypothesis& form) {
        if (share >= interval_share || &form == &reported) return;
        share += share_of(form, best);
        if (mirrors(reported, form)) return;
        GearRatioFit other;
        fit(lines, form, other);
        result.ci95_low = std::min(result.ci95_low, other.ci95_low);
        result.ci95_high = std::max(result.ci95_high, other.ci95_high);
        result.standard_error = std::max(result.standard_error, 0.25 * (result.ci95_high - result.ci95_low));
    };
    add(best);
    for (const RatioHypothesis& form : best.forms) add(form);
}

/// The residual of the fit for each line, at its mean speed.
void add_residuals(std::span<const OrderLine> lines, const RatioHypothesis& best,
                   const std::vector<Estimate>& estimates, GearRatioFit& result) {
    for (std::size_t i = 0; i < lines.size(); ++i) {
        if (!best.position[i]) continue;
        const double order = order_of_motor(*best.position[i], *result.value);
        const double hz_of_order = std::abs(lines[i].speed_deg_s) / 360.0;
        const double hz = lines[i].order_output * hz_of_order;
        result.residuals.push_back(
            {lines[i].speed_deg_s, hz, order, hz - order * *result.value * hz_of_order, estimates[i].weight});
    }
}

void check_hint(const std::vector<RatioHypothesis>& all, std::span<const OrderLine> lines, GearRatio hint,
                std::vector<std::string>& notes) {
    if (std::any_of(all.begin(), all.end(), [](const RatioHypothesis& one) { return one.hinted; })) return;
    const OrderLine& first = lines.front();
    const double n = std::max(1.0, std::round(first.order_output / hint.value()));
    const double off = 100.0 * (first.order_output / (n * hint.value()) - 1.0);
    notes.push_back(fmt::format(
        "the hint {:.6g} is not supported: output order {:.5g} is {:+.2f} % from {:.0f} times it, more than "
        "its error allows; a scale of speed or position, or a clock, that is wrong by as much would explain "
        "it",
        hint.value(), first.order_output, off, n));
}

/// A ratio is a ratio of teeth: where the lines lie off the expected one by more than their errors allow and
/// by little, the scale of the velocity or position is the likelier cause.
std::optional<RatioHypothesis> wrong_scale(const RatioHypothesis& best, const GearRatioFit& fit,
                                           GearRatio hint, std::vector<std::string>& notes) {
    constexpr double least_error = 0.0005, log_wrong_scale = -0.5;  // chosen, not derived
    const double share = *fit.value / hint.value() - 1.0;
    const double uncertainty = 0.5 * (fit.ci95_high - fit.ci95_low) / hint.value();
    if (std::abs(share) < std::max(least_error, 1.5 * uncertainty) || std::abs(share) > hint_tolerance)
        return std::nullopt;
    const std::string what = fmt::format("the velocity's or position's scale reads {:.2f} % {}",
                                         100.0 * std::abs(share), share < 0.0 ? "high" : "low");
    RatioHypothesis one = best;
    one.value = hint.value();
    one.as_read = false;
    one.log_evidence += log_wrong_scale;
    one.reason = "if " + what;
    // 100 and 101 are both sold.
    const auto listed = catalogue_ratio(best.ratio, best.error);
    const bool another_gear = listed && *listed != catalogue_ratio(hint.value(), 0.0);
    notes.push_back(fmt::format(
        "the ratio {:.6g} is {:+.2f} % from the hint {:.6g}, more than its error of {:.2f} %: {}", *fit.value,
        100.0 * share, hint.value(), 100.0 * uncertainty,
        another_gear
            ? fmt::format("either the gear is one of {:.6g}, or {}, or a time column is wrong by that factor",
                          *listed, what)
            : fmt::format("the likely cause is that {}, or that a time column is wrong by that factor; a "
                          "gear ratio that odd is unlikely",
                          what)));
    return one;
}

/// Everything that the lines could mean, as shares of one with what chance explains, most probable first.
std::vector<RatioCandidate> scored(const std::vector<RatioHypothesis>& hypotheses, double log_chance) {
    double most = log_chance, total = 0.0;
    for (const RatioHypothesis& one : hypotheses) most = std::max(most, one.log_evidence);
    std::vector<RatioCandidate> all;
    for (const RatioHypothesis& one : hypotheses)
        all.push_back({one.value, portable::exp(one.log_evidence - most), one.reason, one.other_unit});
    for (const RatioCandidate& one : all) total += one.score;
    total += portable::exp(log_chance - most);
    for (RatioCandidate& one : all) one.score /= total;
    std::stable_sort(all.begin(), all.end(),
                     [](const RatioCandidate& a, const RatioCandidate& b) { return a.score > b.score; });
    std::erase_if(all, [](const RatioCandidate& one) { return one.score < least_listed_score; });
    if (all.size() > most_candidates) all.resize(most_candidates);
    return all;
}

/// Two lines, or one and a hint: a line on its own lies at some multiple of any ratio.
bool enough_lines(std::span<const OrderLine> lines, const RatioHypothesis& best) {
    std::size_t explained = 0;
    bool certain = false;
    for (std::size_t i = 0; i < lines.size(); ++i) {
        if (!best.position[i]) continue;
        ++explained;
        certain = certain || lines[i].certain;
    }
    return best.hinted || (explained > 1 && (certain || best.listed));
}

}  // namespace

GearRatioResult fit_gear_ratio(std::span<const OrderLine> lines, const RatioQuestion& question) {
    GearRatioResult result;
    result.order_of_line.resize(lines.size());
    if (lines.empty()) return result;
    const std::optional<GearRatio> hint = question.hint;
    std::vector<RatioHypothesis> all = ratio_hypotheses(lines, question);
    if (hint) check_hint(all, lines, *hint, result.notes);
    if (!question.hinted_orders.empty() && !hint &&
        std::none_of(all.begin(), all.end(), [](const RatioHypothesis& one) { return one.hinted; }))
        result.notes.push_back("no ratio puts the strongest line at a hinted order");
    if (all.empty()) return result;
    const RatioHypothesis best = all.front();
    const double log_chance = log_evidence_of_chance(lines);
    result.fit.candidates = scored(all, log_chance);
    if (!best.as_read && best.value != 1.0)
        result.notes.push_back(
            fmt::format("a ratio of {:.4g} would be {:.4g} {}", best.ratio, best.value, best.reason));
    const bool no_gear = std::abs(best.value - 1.0) < hint_tolerance && !best.hinted;
    const bool clear = !result.fit.candidates.empty() && result.fit.candidates.front().value == best.value &&
                       result.fit.candidates.front().score >= least_score;
    if (!best.as_read || no_gear || !clear || !enough_lines(lines, best)) return result;
    const RatioHypothesis& form = reported_form(best);
    const auto estimates = fit(lines, form, result.fit);
    if (form.second_comb != 0) result.fit.second_comb = *result.fit.value + form.second_comb;
    add_residuals(lines, form, estimates, result.fit);
    widen_interval(lines, best, form, result.fit);
    result.fit.coarse = !best.hinted && result.fit.ci95_high - result.fit.ci95_low >= between_combs;
    for (std::size_t i = 0; i < lines.size(); ++i) {
        if (form.position[i]) result.order_of_line[i] = order_of_motor(*form.position[i], *result.fit.value);
    }
    if (hint && best.hinted) {
        if (auto one = wrong_scale(best, result.fit, *hint, result.notes)) all.push_back(std::move(*one));
        result.fit.candidates = scored(all, log_chance);
    }
    // The robust fit moves the value a little from where the comparison left it; one ratio, one number.
    result.fit.candidates.front().value = *result.fit.value;
    return result;
}

std::vector<double> undecided_ratios(const GearRatioFit& fit) {
    // Chosen, not derived: score of the first, and of others relative to it.
    constexpr double probable = 0.2, beside_it = 0.1;
    constexpr double same_ratio = 0.5e-4;  // the five digits that are printed
    std::vector<double> ratios;
    if (fit.value || fit.candidates.empty() || fit.candidates.front().score < probable) return ratios;
    for (const RatioCandidate& one : fit.candidates) {
        // Two reasons for one number, such as another unit of the speed, are one ratio.
        const auto is_same = [&](double ratio) {
            return std::abs(ratio - one.value) <= same_ratio * one.value;
        };
        if (one.score > beside_it * fit.candidates.front().score && std::ranges::none_of(ratios, is_same))
            ratios.push_back(one.value);
    }
    return ratios.size() > 1 ? ratios : std::vector<double>{};
}

}  // namespace ripplenotch
