// SPDX-License-Identifier: MIT
#include "ripplenotch/analysis/gear_ratio.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/matrices/least_squares.hpp"
#include "ripplenotch/analysis/line_test.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

/// Strain wave gears of robots with the flexspline as output (Harmonic Drive SE, series CSG, CSF, SHG, HFUC),
/// and the share of joints that each has: chosen, not derived, since most arms that publish theirs have 100.
struct SoldRatio {
    double ratio, share;
};
constexpr std::array sold{SoldRatio{30.0, 0.03}, SoldRatio{50.0, 0.15},  SoldRatio{80.0, 0.17},
                          SoldRatio{100.0, 0.3}, SoldRatio{120.0, 0.17}, SoldRatio{160.0, 0.18}};
constexpr double free_share = 0.12;  // of joints whose ratio is in no catalogue, from 12 to 400
constexpr double lowest_free = 12.0, highest_free = 400.0;  // the lowest order that is searched, and above
constexpr std::size_t free_ratios = 4000;                   // closer together than any line tells
constexpr double no_gear_share = 0.1;   // of logs whose lines have nothing to do with each other
constexpr double lines_off_comb = 1.0;  // expected in a log
constexpr double share_when_stated = 0.95;
constexpr double stated_reach = 0.02;  // of a stated ratio: scales of logs are right within it
constexpr std::size_t stated_steps = 200;

/// Share of joints in whose log a line of order n = 1, 2, ... was found, and in which it was the strongest;
/// n = 0: a line off the comb.
struct JointKind {
    using OfOrder = std::array<double, highest_motor_order + 1>;
    double share;
    OfOrder present, strongest;
    /// How often an order that is absent counts at most, by factors of two that it would have been found by:
    /// a smaller ripple shows ever more orders of joints that have many.
    double most_halvings;
    /// Orders of one joint are not drawn independently: their shares count with this power.
    double dependence;
};
/// Joints of many orders: 21 of four robots (Panda, xMate, UR10e, Kinova), one joint counted once, lines up
/// to n = 10. Joints of few orders, as that of the paper whose logs are in data/, and simulated ones: chosen,
/// not derived; n = 1 comes from eccentric parts, n = 2 from the ellipse (Tuttle and Seering, IEEE Trans.
/// Robotics and Automation 12, 1996). How many there are of each, and the dependence, by the likelihood of
/// what is right in 49 windows of Panda joints and 220 simulated joints (scripts/prove-identify --windows
/// --ratio).
constexpr double rare = 0.05, hardly = 0.01;
constexpr std::array joint_kinds{JointKind{0.8,
                                           {0.0, 0.43, 0.90, 0.06, 0.71, 0.06, 0.30, 0.05, 0.18, 0.06, 0.11,
                                            rare, rare, rare, rare, rare, rare},
                                           {0.05, 0.02, 0.67, 0.01, 0.15, 0.01, 0.06, 0.05, 0.01, 0.01, 0.01,
                                            hardly, hardly, hardly, hardly, hardly, hardly},
                                           1e9,
                                           0.75},
                                 JointKind{0.2,
                                           {0.0, 0.90, 0.95, 0.20, 0.12, rare, rare, rare, rare, rare, rare,
                                            rare, rare, rare, rare, rare, rare},
                                           {0.05, 0.45, 0.50, 0.03, 0.02, hardly, hardly, hardly, hardly,
                                            hardly, hardly, hardly, hardly, hardly, hardly, hardly, hardly},
                                           1.0,
                                           1.0}};
constexpr double found_snr = 4.0;           // of a line that is just found, where no bound is stated
constexpr double counts_when_absent = 0.8;  // an order may be there and too small to be found
constexpr double away_from_hint = 1e-4;     // strongest at another n than the stated ones: these count more

// Deviation of a line from its comb: a share of the width of a line, and of the scales of a log.
constexpr double place_share = 0.23, scale_share = 0.001;

double deviation_of(const OrderLine& line, double resolution) {
    return std::max(place_share * resolution, line.error) + scale_share * line.order_output;
}

double amplitude_error(const OrderLine& line) {
    return line.amplitude_nm / (line.snr * std::sqrt(line.sweeps));
}

/// Where a line lies: at n times the ratio, or at n times one turn more (or less) against the other spline.
struct Tooth {
    int n = 0;              ///< 0: off the comb
    double on_other = 0.0;  ///< probability that it is on the comb of the other spline
};

struct RatioHypothesis {
    double ratio = 0.0;
    int other_comb = 0;  ///< turns that the other spline has more, 0: one comb
    double prior = 0.0;
    double evidence = 0.0;  ///< its logarithm
    std::vector<Tooth> teeth = {};
};

class RatioPosterior {
  public:
    RatioPosterior(std::span<const OrderLine> lines, const RatioQuestion& question)
        : lines_(lines), question_(question), off_(lines_off_comb / (question.highest - question.lowest)) {
        double clearest = 0.0, sum = 0.0;
        const OrderLine& most = *std::max_element(
            lines.begin(), lines.end(),
            [](const OrderLine& a, const OrderLine& b) { return a.amplitude_nm < b.amplitude_nm; });
        for (const OrderLine& line : lines) {
            deviation_.push_back(deviation_of(line, question.resolution));
            clearest = std::max(clearest, line.snr);
            const double error = portable::hypot(amplitude_error(most), amplitude_error(line));
            const double less = (most.amplitude_nm - line.amplitude_nm) / error;
            strongest_.push_back(portable::exp(-0.5 * less * less));
            sum += strongest_.back();
        }
        for (double& probability : strongest_) probability /= sum;
        most_nm_ = most.amplitude_nm;
        usual_nm_ = most_nm_ / std::max(2.0, clearest / found_snr);
    }

    [[nodiscard]] double evidence_of_no_gear() const {
        // Who states the order of the strongest line states that there is a gear.
        if (!question_.hinted_orders.empty()) return -1e300;
        return portable::log(no_gear_share * share_of_others() * strongest_share(joint_kinds[0], 0)) +
               static_cast<double>(lines_.size()) * portable::log(off_);
    }

    [[nodiscard]] std::vector<RatioHypothesis> all() const {
        std::vector<RatioHypothesis> all;
        for (const SoldRatio& one : sold)
            add({one.ratio, 1, one.share * (1.0 - free_share) * share_of_others()}, all);
        const double step = portable::log(highest_free / lowest_free) / (free_ratios - 1.0);
        for (std::size_t i = 0; i < free_ratios; ++i)
            add({lowest_free * portable::exp(step * static_cast<double>(i)), 0,
                 free_share * share_of_others() / free_ratios},
                all);
        for (std::size_t i = 0; question_.hint && i <= stated_steps; ++i) {
            const double off = stated_reach * (2.0 * static_cast<double>(i) / stated_steps - 1.0);
            for (const int other : {0, 1, -1})
                add({question_.hint->value() * (1.0 + off), other,
                     share_when_stated / (3.0 * (stated_steps + 1.0))},
                    all);
        }
        return all;
    }

  private:
    [[nodiscard]] double share_of_others() const { return question_.hint ? 1.0 - share_when_stated : 1.0; }

    [[nodiscard]] double strongest_share(const JointKind& kind, int n) const {
        if (question_.hinted_orders.empty()) return kind.strongest.at(static_cast<std::size_t>(n));
        const auto& hinted = question_.hinted_orders;
        return std::find(hinted.begin(), hinted.end(), n) == hinted.end() ? away_from_hint : 1.0;
    }

    void add(RatioHypothesis one, std::vector<RatioHypothesis>& all) const {
        std::vector<double> density;  // of each line's place at its tooth, were an order of it always there
        for (std::size_t i = 0; i < lines_.size(); ++i) density.push_back(place(i, one));
        std::array<double, joint_kinds.size()> evidence{};
        for (std::size_t k = 0; k < joint_kinds.size(); ++k) {
            evidence.at(k) = portable::log(one.prior * joint_kinds.at(k).share) +
                             evidence_of(one, density, joint_kinds.at(k));
        }
        const double most = std::max(evidence[0], evidence[1]);
        one.evidence =
            most + portable::log(portable::exp(evidence[0] - most) + portable::exp(evidence[1] - most));
        all.push_back(std::move(one));
    }

    /// By how many factors of two the strongest line is above what would have been found of an order; below 0
    /// a stronger one may hide there.
    [[nodiscard]] double halvings_at(double order) const {
        return portable::log2(most_nm_ /
                              (question_.detectable_nm ? question_.detectable_nm(order) : usual_nm_));
    }

    [[nodiscard]] double evidence_of(const RatioHypothesis& one, std::span<const double> density,
                                     const JointKind& kind) const {
        std::array<bool, highest_motor_order + 1> seen{};
        double places = 0.0, orders = 0.0, hidden = 0.0, strongest = 0.0;
        for (std::size_t i = 0; i < lines_.size(); ++i) {
            const auto n = static_cast<std::size_t>(one.teeth[i].n);
            const double share = n > 0 ? kind.present.at(n) : 1.0;
            places += portable::log(off_ / share + density[i]);
            orders += portable::log(share);
            seen.at(n) = true;
        }
        for (std::size_t n = 1; n < seen.size(); ++n) {
            const double order = static_cast<double>(n) * one.ratio;
            if (seen.at(n) || order >= question_.highest) continue;
            const double halvings = order > question_.lowest ? halvings_at(order) : -1000.0;
            // Who states the order of the strongest line speaks of one that is seen.
            if (question_.hinted_orders.empty())
                hidden += std::max(0.0, 1.0 - portable::exp2(halvings)) * kind.strongest.at(n);
            orders += std::clamp(halvings, 0.0, kind.most_halvings) *
                      portable::log1p(-counts_when_absent * kind.present.at(n));
        }
        for (std::size_t i = 0; i < lines_.size(); ++i) {
            const int n = one.teeth[i].n;
            strongest += strongest_[i] * (strongest_share(kind, n) + (n > 0 ? hidden : 0.0));
        }
        // What is stated of the strongest line counts in full.
        const double of_strongest = question_.hinted_orders.empty() ? kind.dependence : 1.0;
        return places + kind.dependence * orders + of_strongest * portable::log(strongest);
    }

    /// Adds the tooth of a line to the hypothesis; returns the density of places about it.
    double place(std::size_t line, RatioHypothesis& one) const {
        constexpr double reach = 6.0;         // deviations, beyond which the density of a normal is nothing
        constexpr double beyond_error = 3.0;  // a line between two combs is pulled by both
        const int combs = one.other_comb == 0 ? 1 : 2;
        Tooth tooth;
        double most = 0.0;
        for (int n = 1; n <= highest_motor_order; ++n) {
            std::array<double, 2> density{};
            for (int comb = 0; comb < combs; ++comb) {
                const double order = n * (one.ratio + comb * one.other_comb);
                const double off = (lines_[line].order_output - order) / deviation_[line];
                if (std::abs(off) < reach)
                    density.at(static_cast<std::size_t>(comb)) =
                        portable::exp(-0.5 * off * off) / (std::sqrt(full_turn) * deviation_[line] * combs);
            }
            const double both = density[0] + density[1];
            if (both <= std::max(most, off_)) continue;
            most = both;
            const double to_other = lines_[line].order_output - n * (one.ratio + one.other_comb),
                         to_own = lines_[line].order_output - n * one.ratio;
            const double error =
                portable::hypot(beyond_error * lines_[line].error, scale_share * lines_[line].order_output);
            const double odds = portable::exp(
                std::clamp((to_other * to_other - to_own * to_own) / (2.0 * error * error), -500.0, 500.0));
            tooth = {n, one.other_comb == 0 ? 0.0 : 1.0 / (1.0 + odds)};
        }
        one.teeth.push_back(tooth);
        return most;
    }

    std::span<const OrderLine> lines_;
    const RatioQuestion& question_;
    double off_;
    std::vector<double> deviation_;
    std::vector<double> strongest_;  ///< probability that a line is the strongest, by its amplitude's error
    double most_nm_ = 0.0;           ///< of the strongest line
    double usual_nm_ = 0.0;          ///< that would have been found, where no bound is stated
};

/// Hypotheses that are one ratio for who reads it.
struct RatioGroup {
    double near = 0.0;  ///< the sold or the stated ratio, or the nearest whole one
    bool stated = false, sold = false;
    double probability = 0.0;
    const RatioHypothesis* best = nullptr;
};

/// What the lines make of a free ratio, which is one of a grid; 0 where it explains none of them.
double implied_ratio(std::span<const OrderLine> lines, const RatioHypothesis& one) {
    double top = 0.0, bottom = 0.0;
    for (std::size_t i = 0; i < lines.size(); ++i) {
        top += one.teeth[i].n * lines[i].order_output;
        bottom += one.teeth[i].n * one.teeth[i].n;
    }
    if (one.other_comb != 0) return one.ratio;
    return bottom > 0.0 ? top / bottom : 0.0;
}

RatioGroup group_of(double ratio, const std::optional<GearRatio>& stated) {
    constexpr double both_splines = 1.5;  // the ratio of the other spline is one more or less
    if (stated && std::abs(ratio - stated->value()) <= std::max(both_splines, stated_reach * stated->value()))
        return {.near = stated->value(), .stated = true};
    for (const SoldRatio& one : sold)
        if (std::abs(ratio - one.ratio) <= both_splines) return {.near = one.ratio, .sold = true};
    return {.near = std::round(ratio)};
}

/// Most probable first.
std::vector<RatioGroup> grouped(std::span<const OrderLine> lines, const std::vector<RatioHypothesis>& all,
                                double no_gear, const std::optional<GearRatio>& stated) {
    double most = no_gear, total = 0.0;
    for (const RatioHypothesis& one : all) most = std::max(most, one.evidence);
    std::vector<RatioGroup> groups;
    for (const RatioHypothesis& one : all) {
        const RatioGroup of = group_of(implied_ratio(lines, one), stated);
        auto group = std::find_if(groups.begin(), groups.end(), [&](const RatioGroup& other) {
            return other.near == of.near && other.stated == of.stated;
        });
        if (group == groups.end()) group = groups.insert(groups.end(), of);
        const double weight = portable::exp(one.evidence - most);
        group->probability += weight;
        total += weight;
        if (group->best == nullptr || one.evidence > group->best->evidence) group->best = &one;
    }
    total += portable::exp(no_gear - most);
    for (RatioGroup& one : groups) one.probability /= total;
    std::stable_sort(groups.begin(), groups.end(),
                     [](const RatioGroup& a, const RatioGroup& b) { return a.probability > b.probability; });
    return groups;
}

bool on_other(const Tooth& tooth) { return tooth.on_other > 0.95; }

/// True where all lines of a ratio lie on the comb of the other spline, so that this one is the ratio.
bool all_on_other(const RatioHypothesis& one) {
    return std::none_of(one.teeth.begin(), one.teeth.end(),
                        [](const Tooth& tooth) { return tooth.n > 0 && !on_other(tooth); });
}

bool any_on_other(const RatioHypothesis& one) {
    return std::any_of(one.teeth.begin(), one.teeth.end(),
                       [](const Tooth& tooth) { return tooth.n > 0 && on_other(tooth); });
}

std::string reason_of(const RatioGroup& group) {
    std::vector<int> own, other;
    for (const Tooth& tooth : group.best->teeth)
        if (tooth.n > 0) (on_other(tooth) && !all_on_other(*group.best) ? other : own).push_back(tooth.n);
    std::string text = group.stated ? "stated" : group.sold ? "in catalogues" : "in no catalogue";
    for (std::vector<int>* all : {&own, &other}) {
        std::sort(all->begin(), all->end());
        all->erase(std::unique(all->begin(), all->end()), all->end());
        if (!all->empty())
            text +=
                fmt::format("; n = {}{}", fmt::join(*all, ", "), all == &own ? "" : " of the other spline");
    }
    return text;
}

/// Of which nothing is stated, a gear needs two lines: a lone one is an order of its half about as well.
bool enough_lines(const RatioHypothesis& best, const RatioQuestion& question) {
    const auto explained =
        std::count_if(best.teeth.begin(), best.teeth.end(), [](const Tooth& tooth) { return tooth.n > 0; });
    return explained >= (question.hint || !question.hinted_orders.empty() ? 1 : 2);
}

/// The ratio implied by one line; weight 0 where it lies off the combs.
struct Estimate {
    double ratio = 0.0, variance = 1.0, weight = 0.0;
};

std::vector<Estimate> estimates_of(std::span<const OrderLine> lines, const RatioHypothesis& best) {
    std::vector<Estimate> estimates(lines.size());
    for (std::size_t i = 0; i < lines.size(); ++i) {
        const Tooth& at = best.teeth[i];
        if (at.n == 0) continue;
        const double error = std::max(lines[i].error, 1e-7 * lines[i].order_output) / at.n;
        const double between = at.on_other * (1.0 - at.on_other) * best.other_comb * best.other_comb;
        estimates[i] = {lines[i].order_output / at.n - at.on_other * best.other_comb, error * error + between,
                        1.0};
    }
    return estimates;
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
    const double own = scale / std::sqrt(bottom);
    const double reach = portable::hypot((scale > 1.0 ? student_95(freedom) : normal_95_errors) * own,
                                         normal_95_errors * shared * ratio);
    const double moved = all_on_other(best) ? best.other_comb : 0.0;
    result.value = ratio + moved;
    result.standard_error = portable::hypot(own, shared * ratio);
    result.ci95_low = *result.value - reach;
    result.ci95_high = *result.value + reach;
    if (best.other_comb != 0 && moved == 0.0 && any_on_other(best))
        result.second_comb = ratio + best.other_comb;
    return estimates;
}

/// The order of each line per turn of the motor: of a tooth, and where none is near, of a higher one.
void name_lines(std::span<const OrderLine> lines, const RatioHypothesis& best, double resolution,
                GearRatioResult& result) {
    constexpr double highest_named = 32.0, deviations = 2.0, clear_share = 0.25;
    const GearRatioFit& ratio = result.fit;
    for (std::size_t i = 0; i < lines.size(); ++i) {
        const Tooth& at = best.teeth[i];
        if (at.n > 0) {
            const bool other = ratio.second_comb && on_other(at);
            result.order_of_line[i] = other ? at.n * *ratio.second_comb / *ratio.value : at.n;
            continue;
        }
        const double reach = deviations * deviation_of(lines[i], resolution);
        for (const double comb : {*ratio.value, ratio.second_comb.value_or(*ratio.value)}) {
            const double n = std::round(lines[i].order_output / comb);
            const bool near =
                std::abs(lines[i].order_output - n * comb) < std::min(reach, clear_share * comb);
            if (n >= 1.0 && n <= highest_named && near && !result.order_of_line[i])
                result.order_of_line[i] = n * comb / *ratio.value;
        }
    }
}

/// The residual of the fit for each line, at its mean speed.
void add_residuals(std::span<const OrderLine> lines, const std::vector<Estimate>& estimates,
                   GearRatioResult& result) {
    for (std::size_t i = 0; i < lines.size(); ++i) {
        if (estimates[i].weight == 0.0) continue;
        const double order = *result.order_of_line[i];
        const double hz_of_order = std::abs(lines[i].speed_deg_s) / 360.0;
        const double hz = lines[i].order_output * hz_of_order;
        result.fit.residuals.push_back({lines[i].speed_deg_s, hz, order,
                                        hz - order * *result.fit.value * hz_of_order, estimates[i].weight});
    }
}

/// A ratio is a ratio of teeth: where the lines lie off the stated one by more than their errors allow and by
/// little, the scale of the velocity or position is the likelier cause.
void note_wrong_scale(const GearRatioFit& fit, double stated, std::vector<std::string>& notes) {
    constexpr double least_error = 0.0005, one_apart = 0.5;  // chosen, not derived
    const double share = *fit.value / stated - 1.0;
    const double uncertainty = 0.5 * (fit.ci95_high - fit.ci95_low) / stated;
    if (std::abs(share) < std::max(least_error, 1.5 * uncertainty)) return;
    const bool other_spline = std::abs(std::abs(*fit.value - stated) - 1.0) < one_apart;
    notes.push_back(fmt::format(
        "the ratio {:.6g} is {:+.2f} % from the stated {:.6g}, more than its error of {:.2f} %: {}the "
        "velocity's or position's scale reads {:.2f} % {}, or a time column is wrong by that factor",
        *fit.value, 100.0 * share, stated, 100.0 * uncertainty,
        other_spline ? "it is that of the other spline, or " : "", 100.0 * std::abs(share),
        share < 0.0 ? "high" : "low"));
}

}  // namespace

GearRatioResult fit_gear_ratio(std::span<const OrderLine> lines, const RatioQuestion& question) {
    constexpr double least_listed = 0.002;      // probability of a candidate that is listed
    constexpr std::size_t most_candidates = 8;  // chosen, not derived: a list that a person reads
    GearRatioResult result;
    result.order_of_line.resize(lines.size());
    if (lines.empty()) return result;
    const RatioPosterior posterior(lines, question);
    const std::vector<RatioHypothesis> all = posterior.all();
    const std::vector<RatioGroup> groups =
        grouped(lines, all, posterior.evidence_of_no_gear(), question.hint);
    const auto explains = [](const RatioGroup& one) {
        return std::any_of(one.best->teeth.begin(), one.best->teeth.end(),
                           [](const Tooth& tooth) { return tooth.n > 0; });
    };
    for (const RatioGroup& one : groups) {
        if (one.probability < least_listed || result.fit.candidates.size() == most_candidates) break;
        if (!explains(one)) continue;
        GearRatioFit fitted;
        fit(lines, *one.best, fitted);
        auto& all_told = result.fit.candidates;
        all_told.insert(one.stated ? all_told.begin() : all_told.end(),
                        {*fitted.value, one.probability, reason_of(one)});
    }
    auto chosen = groups.begin();
    if (question.hint) {
        chosen = std::find_if(groups.begin(), groups.end(), [](const RatioGroup& one) { return one.stated; });
        result.fit.contradicted = chosen->probability < 1.0 - share_when_stated;
    } else if (chosen->probability <= 0.5) {
        return result;
    }
    if (result.fit.contradicted) {
        RatioHypothesis stated{question.hint->value(), 0, 1.0, 0.0, std::vector<Tooth>(lines.size())};
        result.fit.value = result.fit.ci95_low = result.fit.ci95_high = question.hint->value();
        name_lines(lines, stated, question.resolution, result);
        return result;
    }
    if (!enough_lines(*chosen->best, question)) return result;
    const std::vector<Estimate> estimates = fit(lines, *chosen->best, result.fit);
    if (question.hint) note_wrong_scale(result.fit, question.hint->value(), result.notes);
    name_lines(lines, *chosen->best, question.resolution, result);
    add_residuals(lines, estimates, result);
    return result;
}

std::vector<double> undecided_ratios(const GearRatioFit& fit) {
    constexpr double least_probable = 0.1;  // chosen, not derived
    std::vector<double> ratios;
    if (fit.value) return ratios;
    for (const RatioCandidate& one : fit.candidates)
        if (one.score > least_probable) ratios.push_back(one.value);
    return ratios.size() > 1 ? ratios : std::vector<double>{};
}

}  // namespace ripplenotch
