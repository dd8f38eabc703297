// SPDX-License-Identifier: MIT
#include "diagnose/beside/conditions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "diagnose/hearing.hpp"

namespace ripplenotch {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr int most_withdrawals = 6;

// Columns of one name among those of all.
struct Columns {
    Index first = 0, count = 0;
};

Columns columns_at(const Sums& sums, const Names& names, std::size_t place) {
    Columns columns;
    for (std::size_t i = 0; i <= place; ++i) {
        columns.first += columns.count;
        columns.count = static_cast<Index>(sums.weighed(names[i]).size());
    }
    return columns;
}

// The size that each fold by itself gives the name, as a multiple of the whole fit's, the rest held.
void weigh_folds(const Sums& sums, const Names& names, std::size_t place, BesideFinding& finding) {
    const Columns own = columns_at(sums, names, place);
    const VectorXd all = sums.sizes(names), size = all.segment(own.first, own.count);
    VectorXd rest = all;
    rest.segment(own.first, own.count).setZero();
    const double variance = sums.lens().sigma() * sums.lens().sigma();
    std::vector<double> part, weight;
    double total = 0.0;
    for (std::size_t fold = 0; fold < sums.folds(); ++fold) {
        const auto products = sums.products(names, fold);
        const VectorXd open = sums.targets(names, fold) - products * rest;
        const double square = size.dot(products.block(own.first, own.first, own.count, own.count) * size);
        if (!(square > 0.0)) continue;
        part.push_back(size.dot(open.segment(own.first, own.count)) / square);
        weight.push_back(square);
        total += square;
    }
    double mean = 0.0, spread = 0.0;
    for (std::size_t i = 0; i < part.size(); ++i) mean += weight[i] / total * part[i];
    for (std::size_t i = 0; i < part.size(); ++i) {
        const double chance = variance / weight[i] * (1.0 - 1.0 / static_cast<double>(part.size()));
        spread += weight[i] / total * ((part[i] - mean) * (part[i] - mean) - chance);
        if (part[i] * mean > 0.0) finding.same_sign += weight[i] / total;
    }
    finding.evenness = mean != 0.0 ? std::sqrt(std::max(spread, 0.0)) / std::abs(mean) : 10.0;
}

// True when the name is worth its price beside another as well: then the other is not in its place.
bool stands_beside(const Sums& sums, const Names& rivals, std::size_t own, double price) {
    Names both = rivals;
    both.push_back(own);
    const OutsideGain gain = outside_gain(sums.residual_outside(rivals), sums.residual_outside(both),
                                          sums.lens().ground().blocks(), sums.lens().sigma());
    return is_worth(gain, price, sums.lens().rules().beside);
}

// The best other name in its place, refined; one that is bent stands in for something else.
std::optional<Named> best_rival(Sums& sums, const Names& rest, std::size_t own, double price) {
    std::vector<Named> rivals;
    const Shape shape = sums.shapes()[own];
    for (std::size_t i = 0; i < sums.listed(); ++i) {
        const Shape& other = sums.shapes()[i];
        if (same_name(other, shape) || is_among(sums, rest, other) || !sums.is_told(i)) continue;
        Named rival{rest};
        rival.names.push_back(i);
        rival.left = sums.left_outside(rival.names);
        rivals.push_back(std::move(rival));
    }
    std::stable_sort(rivals.begin(), rivals.end(),
                     [](const Named& a, const Named& b) { return a.left < b.left; });
    std::optional<Named> best;
    for (std::size_t i = 0; i < std::min(rivals.size(), sums.lens().rules().beside.most_rivals); ++i) {
        Named rival = refined(sums, rivals[i]);
        if (sums.lens().bounds().is_bent(sums.shapes()[rival.names.back()])) continue;
        if (stands_beside(sums, rival.names, own, price)) continue;
        if (!best || rival.left < best->left) best = std::move(rival);
    }
    return best;
}

double swing_nm(const Sums& sums, const Names& names, std::size_t place) {
    const Columns own = columns_at(sums, names, place);
    const VectorXd all = sums.sizes(names);
    const auto columns = sums.lens().torque_nm(sums.shapes()[names[place]]);
    const auto& use = sums.lens().looked_at().use;
    double sum = 0.0, square = 0.0, count = 0.0;
    for (std::size_t k = 0; k < use.size(); ++k) {
        if (use[k] == 0) continue;
        double torque = 0.0;
        for (std::size_t c = 0; c < columns.size(); ++c)
            torque += all[own.first + static_cast<Index>(c)] * columns[c][k];
        sum += torque;
        square += torque * torque;
        count += 1.0;
    }
    return std::sqrt(std::max(square / count - sum / count * (sum / count), 0.0));
}

void doubt(BesideFinding& finding, std::string reason) {
    finding.status = FindingStatus::tentative;
    finding.reason = std::move(reason);
}

void look_alone(const Sums& sums, const Names& names, std::size_t place, BesideFinding& finding) {
    const DiagnosisRules& rules = sums.lens().rules();
    Hearing hearing(rules, finding.decisions);
    hearing.asked_price(finding.gain.gain, finding.price, false);
    hearing.asked("beside.least_t", finding.gain.t, false);
    const Effect& effect = *finding.shape.term.effect;
    const Index first = columns_at(sums, names, place).first;
    weigh_folds(sums, names, place, finding);
    if (is_against_motion(effect) && sums.sizes(names)[first] <= 0.0)
        doubt(finding,
              "its size is below 0: it would drive the joint, or something given holds too much of it");
    else if (sums.lens().bounds().is_bent(finding.shape))
        doubt(finding, "its shape ends at a bound: it stands in for something else");
    else if (hearing.asked("beside.same_sign", finding.same_sign, finding.same_sign < rules.beside.same_sign))
        doubt(finding, "its size has not the same sign all over the log");
    else if (hearing.asked("beside.most_uneven", finding.evenness,
                           finding.evenness > rules.beside.most_uneven))
        doubt(finding, fmt::format("its size is not the same all over the log ({:.0f} % off)",
                                   100.0 * std::min(finding.evenness, 9.99)));
}

void look_at_rivals(Sums& sums, const Names& names, std::size_t place, const std::vector<double>& left,
                    BesideFinding& finding) {
    Names rest = names;
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(place));
    const auto rival = best_rival(sums, rest, names[place], finding.price);
    if (!rival) return;
    const BesideRules& rules = sums.lens().rules().beside;
    const OutsideGain ahead = outside_gain(sums.residual_outside(rival->names), left,
                                           sums.lens().ground().blocks(), sums.lens().sigma());
    finding.rival = sums.shapes()[rival->names.back()];
    finding.rival_margin = ahead.gain;
    finding.rival_t = ahead.t;
    Hearing hearing(sums.lens().rules(), finding.decisions);
    const bool tie = hearing.asked("beside.tie_margin", ahead.gain, ahead.gain < rules.tie_margin) ||
                     hearing.asked("beside.tie_t", ahead.t, ahead.t < rules.tie_t);
    if (tie && finding.status == FindingStatus::confirmed) finding.status = FindingStatus::ambiguous;
}

// A small one of a kind mends the form of the largest.
void look_at_sizes(const Sums& sums, std::vector<BesideFinding>& findings) {
    const DiagnosisRules& rules = sums.lens().rules();
    std::vector<FindingStatus> now;
    for (const BesideFinding& finding : findings) now.push_back(finding.status);
    for (std::size_t i = 0; i < findings.size(); ++i) {
        const Kind kind = kind_of(*findings[i].shape.term.effect);
        double largest = 0.0;
        for (std::size_t other = 0; other < findings.size(); ++other) {
            if (other != i && kind_of(*findings[other].shape.term.effect) == kind && kind != Kind::order)
                largest = std::max(largest, findings[other].size_nm);
        }
        if (now[i] != FindingStatus::confirmed || largest == 0.0) continue;
        if (!Hearing(rules, findings[i].decisions)
                 .asked("beside.shape_part", findings[i].size_nm / largest,
                        findings[i].size_nm < rules.beside.shape_part * largest))
            continue;
        findings[i].status = FindingStatus::shape_correction;
        findings[i].reason = "it mends the form of a larger finding of its kind";
    }
}

}  // namespace

std::vector<BesideFinding> judged_beside(Sums& sums, const Named& now, std::size_t effects) {
    const std::vector<double> left = sums.residual_outside(now.names);
    std::vector<BesideFinding> findings;
    for (std::size_t place = 0; place < now.names.size(); ++place) {
        BesideFinding finding;
        finding.shape = sums.shapes()[now.names[place]];
        Names rest = now.names;
        rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(place));
        finding.gain = outside_gain(sums.residual_outside(rest), left, sums.lens().ground().blocks(),
                                    sums.lens().sigma());
        finding.price = price_of(sums, now.names[place], effects);
        finding.size_nm = swing_nm(sums, now.names, place);
        look_alone(sums, now.names, place, finding);
        findings.push_back(std::move(finding));
    }
    look_at_sizes(sums, findings);
    for (std::size_t place = 0; place < now.names.size(); ++place)
        look_at_rivals(sums, now.names, place, left, findings[place]);
    return findings;
}

NamedBeside named_beside(Sums& sums, std::size_t effects) {
    Named now = search_beside(sums, {}, {}, effects);
    std::vector<BesideFinding> withdrawn;
    Barred barred;
    for (int turn = 0;; ++turn) {
        std::vector<BesideFinding> findings = judged_beside(sums, now, effects);
        std::optional<std::size_t> weakest;
        for (std::size_t i = 0; i < findings.size(); ++i) {
            if (findings[i].status != FindingStatus::tentative) continue;
            if (!weakest || findings[i].gain.gain < findings[*weakest].gain.gain) weakest = i;
        }
        if (!weakest || turn == most_withdrawals) {
            findings.insert(findings.end(), withdrawn.begin(), withdrawn.end());
            return {std::move(now), std::move(findings)};
        }
        barred.push_back(findings[*weakest].shape);
        withdrawn.push_back(std::move(findings[*weakest]));
        now.names.erase(now.names.begin() + static_cast<std::ptrdiff_t>(*weakest));
        now.left = sums.left_outside(now.names);
        now = refined(sums, std::move(now));
        sums.forget_but(now.names);
        now = search_beside(sums, std::move(now), barred, effects);
    }
}

}  // namespace ripplenotch
