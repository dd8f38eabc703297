// SPDX-License-Identifier: MIT
#include "analysis/lines/ratio_hypothesis.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <numeric>
#include <set>
#include <string_view>

#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

/// Component sets with the flexspline as output (Harmonic Drive SE, series CSG, CSF, SHG, HFUC: catalogue
/// pages "ratio"), and by how much likelier each is than a ratio of no catalogue. Chosen, not derived: most
/// arms that publish theirs have 100, with the circular spline as output 101; then 120 and 160; 30 is rare.
struct SoldRatio {
    double ratio, factor;
};
constexpr std::array sold{SoldRatio{30.0, 2.0},   SoldRatio{50.0, 5.0},  SoldRatio{80.0, 4.0},
                          SoldRatio{100.0, 11.0}, SoldRatio{120.0, 6.0}, SoldRatio{160.0, 5.0}};
/// With the circular spline as output each has one more, and fewer joints are built so.
constexpr double other_output = 0.5;
constexpr double listed_tolerance = 0.001;  // chosen, not derived: scales of logs are not known better

/// The likeliest entry within this error or the scale's.
std::optional<SoldRatio> catalogue_entry(double ratio, double error) {
    std::optional<SoldRatio> best;
    for (const SoldRatio& one : sold) {
        for (const SoldRatio listed : {one, {one.ratio + 1.0, other_output * one.factor}}) {
            const double reach = std::max(listed_tolerance * listed.ratio, std::min(3.0 * error, 0.5));
            if (std::abs(ratio - listed.ratio) < reach && (!best || best->factor < listed.factor))
                best = listed;
        }
    }
    return best;
}

constexpr double lowest_ratio = 0.99, highest_ratio = 321.0;  // range of joints and their gears
constexpr double outside_factor = 0.007;  // chosen, not derived: hardly any joint has another
/// Wave generators are built from this ratio on (the smallest sold is 30); below it there is one comb.
constexpr double least_two_combs = 29.0;
/// Below this a gear has few teeth, and its ratio is mostly whole.
constexpr double few_teeth = 25.0, broken_factor = 0.1;
constexpr double hint_factor = 3000.0;  // an expected ratio outweighs nearly all that lines show

constexpr int highest_n = 32, highest_of_shaft = 64;  // chosen, not derived: lines seldom reach so far
constexpr std::size_t most_proposing = 8;             // lines, the most clearly seen, that propose ratios
constexpr double same_ratio_share = 0.008;            // chosen, not derived

/// Probability of each n. The wave generator is an ellipse, so that the gear's effects repeat twice a turn of
/// the motor: n = 2 leads, and its multiples follow; n = 1 comes from eccentric parts (Tuttle and Seering,
/// IEEE Trans. Robotics and Automation 12, 1996). Most joints show 1 and 2 and little else, some many orders,
/// and some, nearly half of those with lines of both splines, even orders alone, few or many. Chosen, not
/// derived: no statistics of joints are published; 8 is among the even orders of most of ten real joints.
/// Lines at one and two times a ratio are orders 2 and 4 of its half a quarter of the time, so that they
/// alone determine no ratio unless a catalogue has one of the two.
struct OrderPrior {
    std::array<double, highest_n + 1> share{};
    double one_comb = 0.0, two_combs = 0.0;  ///< how many joints are so
};

/// `named` are the shares of n = 1 on; the remainder is shared by the multiples of `step` above them.
OrderPrior order_prior(double one_comb, double two_combs, int step, std::initializer_list<double> named) {
    OrderPrior prior{{}, one_comb, two_combs};
    std::copy(named.begin(), named.end(), prior.share.begin() + 1);
    const auto weight = [step](int n) { return n % step != 0 ? 0.0 : n <= 8 ? 1.0 : 64.0 / (n * n); };
    double left = 1.0, sum = 0.0;
    for (const double share : named) left -= share;
    const int first = static_cast<int>(named.size()) + 1;
    for (int n = first; n <= highest_n; ++n) sum += weight(n);
    for (int n = first; n <= highest_n; ++n)
        prior.share[static_cast<std::size_t>(n)] = left * weight(n) / sum;
    return prior;
}

const std::array<OrderPrior, 4>& order_priors() {
    static const std::array priors{order_prior(0.6, 0.3, 1, {0.4, 0.4, 0.06, 0.04}),
                                   order_prior(0.2, 0.25, 1, {0.2, 0.25}),
                                   order_prior(0.17, 0.2, 2, {0.0, 0.44, 0.0, 0.27, 0.0, 0.13, 0.0, 0.1}),
                                   order_prior(0.03, 0.25, 2, {0.0, 0.4})};
    return priors;
}

/// Probabilities that lines of the other spline are present: at Kg + 1 where the flexspline is the output,
/// else at Kg - 1.
constexpr double plus_share = 0.6, minus_share = 0.2, one_comb_share = 0.2;
/// Probabilities that a line under two combs is on either of them, or the sum of both. Ten real joints show
/// lines of both as close together as sweeps cannot separate; they lie about the middle with this deviation.
constexpr double on_one = 0.2, of_both = 0.6, both_deviation = 0.6;

constexpr double log_range = 7.0;  // orders from 1 to about 1000, a line by chance anywhere in the logarithm

double line_error(const OrderLine& line) {
    constexpr double scale = 2e-4;  // positions of lines are not known better, whatever noise would allow
    return std::max(
        portable::hypot(line.error, portable::hypot(scale, line.shared_error) * line.order_output), 1e-9);
}

/// Student's t with three degrees of freedom: errors of lines have heavier tails than normal ones.
double t3(double off, double error) {
    const double z = off / error, b = 1.0 + z * z / 3.0;
    return 0.36755 / (error * b * b);
}

double normal(double off, double deviation) {
    const double z = off / deviation;
    return 0.39894 / deviation * portable::exp(-0.5 * z * z);
}

/// A line by chance, or of the output side: once or a few times a turn of the joint, from its load.
double chance_density(const OrderLine& line) {
    constexpr double output_side = 0.2;   // chosen, not derived
    constexpr int highest_of_output = 4;  // chosen, not derived
    double density = (1.0 - output_side) / (log_range * line.order_output);
    for (int k = 1; k <= highest_of_output; ++k)
        density += output_side / highest_of_output * t3(line.order_output - k, line_error(line));
    return density;
}

/// That a line has nothing to do with the comb: seldom where it is clearly seen.
double chance_share(const OrderLine& line) {
    const double share = std::clamp(0.8 / std::max(line.snr, 1e-9), 0.02, 0.4);
    return line.certain ? share : 0.5;
}

std::vector<std::size_t> by_clearness(std::span<const OrderLine> lines) {
    std::vector<std::size_t> order(lines.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return lines[a].snr > lines[b].snr; });
    return order;
}

struct Match {
    double density = 0.0, best = 0.0;
    CombPosition position;
};

using Positions = std::vector<std::optional<CombPosition>>;

/// Where both combs make up one line, no other line lies: `others` are positions of lines more clearly seen.
bool possible(const CombPosition& position, const Positions& others) {
    return std::none_of(others.begin(), others.end(), [&](const auto& other) {
        return other && other->n == position.n && (other->of_both() || position.of_both());
    });
}

Match match(const OrderLine& line, const Positions& others, double ratio, int second_comb,
            const OrderPrior& prior) {
    Match found;
    const double q = line.order_output, error = line_error(line);
    const auto add = [&](double density, CombPosition position) {
        if (second_comb != 0 && !possible(position, others)) return;
        found.density += density;
        if (density > found.best) found.best = density, found.position = position;
    };
    const double nearest = std::max(1.0, q / ratio);
    if (nearest > highest_n + 2) return found;
    const int centre = static_cast<int>(std::lround(nearest));
    const int reach = 1 + static_cast<int>(nearest * std::abs(second_comb) / ratio);
    for (int n = std::max(1, centre - reach); n <= std::min(highest_n, centre + reach); ++n) {
        const double share = prior.share[static_cast<std::size_t>(n)], shift = second_comb;
        if (share == 0.0) continue;
        if (second_comb == 0) {
            add(share * t3(q - n * ratio, error), {n, 0.0, 0.0});
            continue;
        }
        for (const double own : {0.0, shift})
            add(share * on_one * t3(q - n * (ratio + own), error), {n, own, 0.0});
        add(share * of_both *
                normal(q - n * (ratio + 0.5 * shift), portable::hypot(error, n * both_deviation)),
            {n, 0.5 * shift, both_deviation});
    }
    return found;
}

/// Lines at whole multiples of a turn of the shaft that was measured: there is no gear in between.
Match match_of_shaft(const OrderLine& line, double turn) {
    Match found;
    const int n = static_cast<int>(std::lround(line.order_output / turn));
    constexpr double harmonic_sum = 4.744;  // sum of 1/n up to highest_of_shaft
    if (n < 1 || n > highest_of_shaft) return found;
    found.density = found.best = t3(line.order_output - n * turn, line_error(line)) / (n * harmonic_sum);
    found.position = {n, 0.0, 0.0};
    return found;
}

/// Evidence of all lines with this matching, the most clearly seen first; fills the positions of those that
/// it explains.
template <class Matching>
double log_evidence(std::span<const OrderLine> lines, const Matching& matching, Positions& positions) {
    double sum = 0.0;
    positions.assign(lines.size(), std::nullopt);
    for (const std::size_t i : by_clearness(lines)) {
        const Match found = matching(lines[i], positions);
        const double off = chance_share(lines[i]), chance = off * chance_density(lines[i]);
        sum += portable::log((1.0 - off) * found.density + chance);
        if ((1.0 - off) * found.best > chance) positions[i] = found.position;
    }
    return sum;
}

/// Weighted least squares of order_output / n - shift, and its standard error.
std::pair<double, double> fitted_ratio(std::span<const OrderLine> lines, const RatioHypothesis& one) {
    double top = 0.0, bottom = 0.0;
    for (std::size_t i = 0; i < lines.size(); ++i) {
        if (!one.position[i]) continue;
        const CombPosition& at = *one.position[i];
        const double error = portable::hypot(line_error(lines[i]) / at.n, at.spread);
        top += (lines[i].order_output / at.n - at.shift) / (error * error);
        bottom += 1.0 / (error * error);
    }
    return bottom > 0.0 ? std::pair(top / bottom, 1.0 / std::sqrt(bottom)) : std::pair(one.ratio, one.ratio);
}

double log_prior(double ratio, double error, int second_comb, const OrderPrior& prior, bool one_line) {
    constexpr double log_ratios = 5.77, least_share = 1e-3;  // the logarithm of 320; chosen, not derived
    double factor = 2.5 * std::max(error / ratio, least_share) / log_ratios;
    if (ratio < lowest_ratio || ratio > highest_ratio) factor *= outside_factor;
    if (ratio < few_teeth && std::abs(ratio - std::round(ratio)) > 3.0 * error + 0.002 * ratio)
        factor *= broken_factor;
    factor *= second_comb == 0 ? prior.one_comb : prior.two_combs;
    if (!one_line) factor *= second_comb > 0 ? plus_share : second_comb < 0 ? minus_share : one_comb_share;
    if (const auto listed = catalogue_entry(ratio, error)) factor *= listed->factor;
    return portable::log(factor);
}

bool leads_at(std::span<const OrderLine> lines, const RatioHypothesis& one, std::span<const int> orders) {
    const auto strongest = std::max_element(
        lines.begin(), lines.end(),
        [](const OrderLine& a, const OrderLine& b) { return a.amplitude_nm < b.amplitude_nm; });
    const auto& at = one.position[static_cast<std::size_t>(strongest - lines.begin())];
    return at && std::find(orders.begin(), orders.end(), at->n) != orders.end();
}

std::string numbers(const std::set<int>& values) { return fmt::format("{}", fmt::join(values, ", ")); }

void describe(std::span<const OrderLine> lines, const RatioQuestion& question, RatioHypothesis& one) {
    std::set<int> first, second;
    bool odd = false;
    for (const auto& at : one.position) {
        if (!at) continue;
        (at->shift != 0.0 && !at->of_both() ? second : first).insert(at->n);
        odd = odd || at->n % 2 != 0;
    }
    std::string text = first.empty() ? "" : "lines at n = " + numbers(first);
    if (!second.empty())
        text += fmt::format("{}n = {} of {:.5g}", text.empty() ? "lines at " : " and at ", numbers(second),
                            one.ratio + one.second_comb);
    if (!odd && first.size() + second.size() > 0)
        text += fmt::format("; no odd order: cannot be distinguished from {:.4g}", 2.0 * one.ratio);
    if (const auto listed = catalogue_ratio(one.value, one.error))
        text += fmt::format("; {:.0f} is a catalogue ratio", *listed);
    if (question.hint &&
        std::abs(one.value - question.hint->value()) < hint_tolerance * question.hint->value()) {
        one.hinted = true;
        text += fmt::format("; agrees with the hint {:.6g}", question.hint->value());
    }
    if (leads_at(lines, one, question.hinted_orders)) {
        one.hinted = true;
        text += "; its strongest line is at a hinted order";
    }
    if (one.hinted) one.log_evidence += portable::log(hint_factor);
    one.listed = catalogue_ratio(one.value, one.error).has_value();
    one.reason = std::move(text);
}

/// Two combs are a hypothesis where a line lies on each or is made up by both, and another line agrees.
bool explains(const RatioHypothesis& one) {
    std::size_t lines = 0;
    bool first = false, second = false;
    for (const auto& at : one.position) {
        if (!at) continue;
        ++lines;
        first = first || at->shift == 0.0 || at->of_both();
        second = second || at->shift != 0.0;
    }
    return first && (one.second_comb == 0 || (second && lines > 1));
}

/// The nearest maximum of the evidence.
RatioHypothesis nearest_maximum(std::span<const OrderLine> lines, double ratio, int second_comb,
                                const OrderPrior& prior) {
    RatioHypothesis one;
    one.ratio = ratio;
    one.second_comb = second_comb;
    double error = ratio;
    for (int round = 0; round < 3; ++round) {
        one.log_evidence = log_evidence(
            lines,
            [&](const OrderLine& line, const Positions& others) {
                return match(line, others, one.ratio, second_comb, prior);
            },
            one.position);
        if (std::none_of(one.position.begin(), one.position.end(),
                         [](const auto& at) { return at.has_value(); }))
            return one;
        if (round < 2) std::tie(one.ratio, error) = fitted_ratio(lines, one);
    }
    one.value = one.ratio;
    one.error = error;
    one.log_evidence += log_prior(one.ratio, error, second_comb, prior, lines.size() == 1);
    return one;
}

void add_gears(std::span<const OrderLine> lines, const RatioQuestion& question,
               std::vector<RatioHypothesis>& all) {
    struct Start {
        double ratio;
        int second_comb;
    };
    std::vector<Start> starts;
    if (question.hint) starts.push_back({question.hint->value(), 0});
    std::vector<std::size_t> proposing = by_clearness(lines);
    if (proposing.size() > most_proposing) proposing.resize(most_proposing);
    for (const std::size_t i : proposing) {
        for (int n = 1; n <= highest_n; ++n) {
            const double ratio = lines[i].order_output / n;
            starts.push_back({ratio, 0});
            for (const int second : {1, -1}) {
                if (ratio < least_two_combs) continue;
                starts.push_back({ratio, second});
                starts.push_back({ratio - second, second});
            }
        }
    }
    for (const OrderPrior& prior : order_priors()) {
        std::vector<RatioHypothesis> found;
        for (const Start& start : starts) {
            RatioHypothesis one = nearest_maximum(lines, start.ratio, start.second_comb, prior);
            const auto same = [&](const RatioHypothesis& other) {
                return other.second_comb == one.second_comb &&
                       std::abs(other.ratio - one.ratio) < 1e-6 * one.ratio;
            };
            if (explains(one) && std::none_of(found.begin(), found.end(), same))
                found.push_back(std::move(one));
        }
        for (RatioHypothesis& one : found) {
            describe(lines, question, one);
            all.push_back(std::move(one));
        }
    }
}

/// A possible mistake in the velocity's unit: the apparent ratio is the true one times the factor.
struct UnitMistake {
    double factor;
    std::string_view reason;
};
constexpr double rpm_per_rad_s = 9.549296585513721;  // 60 / (2 pi)
constexpr std::array unit_mistakes{UnitMistake{degrees_per_radian, "the speed is in rad/s, not deg/s"},
                                   UnitMistake{1.0 / degrees_per_radian, "the speed is in deg/s, not rad/s"},
                                   UnitMistake{6.0, "the speed is in rpm, not deg/s"},
                                   UnitMistake{1.0 / 6.0, "the speed is in deg/s, not rpm"},
                                   UnitMistake{rpm_per_rad_s, "the speed is in rad/s, not rpm"},
                                   UnitMistake{1.0 / rpm_per_rad_s, "the speed is in rpm, not rad/s"},
                                   UnitMistake{60.0, "the speed is wrong by a factor of 60"},
                                   UnitMistake{1.0 / 60.0, "the speed is wrong by a factor of 60"},
                                   UnitMistake{360.0, "the speed is in turns/s, not deg/s"},
                                   UnitMistake{1.0 / 360.0, "the speed is in deg/s, not turns/s"},
                                   UnitMistake{1000.0, "the speed is wrong by a factor of 1000"},
                                   UnitMistake{1e-3, "the speed is wrong by a factor of 1000"}};
constexpr double mistaken = 0.01;  // chosen, not derived: probability of each

/// A ratio as gears have it is no reason to reject the unit.
bool credible(double ratio) {
    constexpr double whole = 0.005;  // chosen, not derived
    return (ratio >= few_teeth && ratio <= highest_ratio) ||
           (ratio >= lowest_ratio && ratio < few_teeth &&
            std::abs(ratio - std::round(ratio)) < whole * ratio);
}

void add_fixed(std::span<const OrderLine> lines, const RatioQuestion& question, RatioHypothesis one,
               double log_share, std::vector<RatioHypothesis>& all) {
    const auto keep = [&](double log_of_prior) {
        if (!explains(one)) return;
        one.log_evidence += log_of_prior + log_share;
        if (lines.size() > 1) one.log_evidence += portable::log(one_comb_share);
        const std::string why = one.reason;
        describe(lines, question, one);
        if (!why.empty()) one.reason = why;
        all.push_back(one);
    };
    if (one.value == 1.0) {
        one.log_evidence = log_evidence(
            lines, [&](const OrderLine& line, const Positions&) { return match_of_shaft(line, one.ratio); },
            one.position);
        keep(0.0);
        return;
    }
    for (const OrderPrior& prior : order_priors()) {
        RatioHypothesis copy = one;
        one.log_evidence = log_evidence(
            lines,
            [&](const OrderLine& line, const Positions& others) {
                return match(line, others, one.ratio, 0, prior);
            },
            one.position);
        keep(portable::log(prior.one_comb));
        one = std::move(copy);
    }
}

void add_units(std::span<const OrderLine> lines, const RatioQuestion& question,
               std::vector<RatioHypothesis>& all) {
    for (const UnitMistake& unit : unit_mistakes) {
        std::vector<double> ratios;
        for (const SoldRatio& one : sold) ratios.push_back(one.ratio);
        if (question.hint && question.hint->value() != 1.0) ratios.push_back(question.hint->value());
        const double share = mistaken / (2.0 * static_cast<double>(sold.size()));
        for (const double ratio : ratios) {
            RatioHypothesis one;
            one.ratio = unit.factor * ratio;
            const bool expected = question.hint && ratio == question.hint->value();
            if (!expected && credible(one.ratio)) continue;
            one.value = ratio;
            one.as_read = false;
            one.other_unit = true;
            one.reason = fmt::format("if {}", unit.reason);
            add_fixed(lines, question, one, portable::log(share), all);
        }
    }
}

void sort_by_evidence(std::vector<RatioHypothesis>& all) {
    std::stable_sort(all.begin(), all.end(), [](const RatioHypothesis& a, const RatioHypothesis& b) {
        return a.log_evidence > b.log_evidence;
    });
}

/// Those of nearly the same value are one, with the most probable form first.
std::vector<RatioHypothesis> merged(std::vector<RatioHypothesis> all) {
    sort_by_evidence(all);
    std::vector<RatioHypothesis> apart;
    for (RatioHypothesis& one : all) {
        one.own_evidence = one.log_evidence;
        const auto same = std::find_if(apart.begin(), apart.end(), [&](const RatioHypothesis& better) {
            const bool combs = better.second_comb != 0 || one.second_comb != 0;
            const double reach = std::max(same_ratio_share * better.value, combs ? 1.05 : 0.0);
            return better.as_read == one.as_read && std::abs(better.value - one.value) < reach;
        });
        if (same == apart.end()) {
            apart.push_back(std::move(one));
        } else {
            same->log_evidence += portable::log1p(portable::exp(one.own_evidence - same->log_evidence));
            same->forms.push_back(std::move(one));
        }
    }
    sort_by_evidence(apart);
    return apart;
}

}  // namespace

std::optional<double> catalogue_ratio(double ratio, double error) {
    const auto listed = catalogue_entry(ratio, error);
    return listed ? std::optional(listed->ratio) : std::nullopt;
}

std::vector<RatioHypothesis> ratio_hypotheses(std::span<const OrderLine> lines,
                                              const RatioQuestion& question) {
    std::vector<RatioHypothesis> all;
    add_gears(lines, question, all);
    constexpr double of_shaft = 0.05;  // chosen, not derived: as probable as all gears of few teeth
    RatioHypothesis none;
    none.ratio = none.value = 1.0;
    none.reason = "whole orders of the shaft that was measured: no gear";
    add_fixed(lines, question, none, portable::log(of_shaft), all);
    add_units(lines, question, all);
    return merged(std::move(all));
}

double log_evidence_of_chance(std::span<const OrderLine> lines) {
    constexpr double prior = 0.3;  // chosen, not derived: probability that no line is of a gear or a shaft
    double sum = portable::log(prior);
    for (const OrderLine& line : lines) sum += portable::log(chance_density(line));
    return sum;
}

}  // namespace ripplenotch
