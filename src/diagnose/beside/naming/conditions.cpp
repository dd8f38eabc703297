// SPDX-License-Identifier: MIT
#include "diagnose/beside/naming/conditions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "diagnose/beside/naming/form.hpp"
#include "diagnose/beside/naming/ringing.hpp"
#include "diagnose/search/hearing.hpp"

namespace ripplenotch {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

void doubt(BesideFinding& finding, std::string reason) {
    finding.status = FindingStatus::tentative;
    finding.reason = std::move(reason);
}

void doubt_driving(BesideFinding& finding) {
    finding.is_driving = true;
    doubt(finding, "its size is below 0: it would drive the joint, or something given holds too much of it");
}

void look_alone(const Sums& sums, const Names& names, std::size_t place, bool even_by_speed,
                BesideFinding& finding) {
    const DiagnosisRules& rules = sums.lens().rules();
    Hearing hearing(rules, finding.decisions);
    hearing.asked_price(finding.gain.gain, finding.price, false);
    hearing.asked("beside.least_t", finding.gain.t, false);
    const Effect& effect = *finding.shape.term.effect;
    const Index first = columns_at(sums, names, place).first;
    finding.same = sameness_of(sums, names, place);
    if (is_against_motion(effect) && sums.sizes(names)[first] <= 0.0)
        doubt_driving(finding);
    else if (sums.lens().bounds().is_bent(finding.shape))
        doubt(finding, "its shape ends at a bound: it stands in for something else");
    else if (hearing.asked("beside.same_sign", finding.same.same_sign,
                           finding.same.same_sign < rules.beside.same_sign))
        doubt(finding, "its sign changes from part to part of the log");
    else if (hearing.asked("beside.most_uneven", finding.same.uneven,
                           finding.same.uneven > rules.beside.most_uneven))
        doubt(finding, fmt::format("its size differs by {:.0f} % from part to part of the log",
                                   100.0 * std::min(finding.same.uneven, 9.99)));
    else if (even_by_speed && hearing.asked("evenness.most_uneven", finding.same.uneven_by_speed,
                                            finding.same.uneven_by_speed > rules.evenness.most_uneven))
        doubt(finding, fmt::format("its size differs by {:.0f} % between slow and fast, forth and back",
                                   100.0 * std::min(finding.same.uneven_by_speed, 9.99)));
}

// Beside a given term other joints' frictions are in the leftover, and may be of any form.
void look_at_form(const Sums& sums, const Names& names, std::size_t place, std::size_t effects,
                  BesideFinding& finding) {
    if (finding.status != FindingStatus::confirmed) return;
    const DiagnosisRules& rules = sums.lens().rules();
    const double part = mended_part(sums, names, place, effects);
    if (part > 0.0 &&
        Hearing(rules, finding.decisions).asked("beside.shape_part", part, part > rules.beside.shape_part))
        doubt(finding, "a friction that drives the joint mends its form: it stands in for something else");
}

void look_at_rivals(Sums& sums, const Names& names, std::size_t place, const Judgement& by,
                    BesideFinding& finding) {
    const auto rivalry = rivalry_of(sums, names, place, finding.price, by.longer);
    if (!rivalry) return;
    finding.rival = rivalry->rival;
    finding.rival_margin = rivalry->ahead.gain;
    finding.rival_t = rivalry->ahead.t;
    const BesideRules& rules = sums.lens().rules().beside;
    Hearing hearing(sums.lens().rules(), finding.decisions);
    const bool tie =
        hearing.asked("beside.tie_margin", finding.rival_margin, finding.rival_margin < rules.tie_margin) ||
        hearing.asked("beside.tie_t", finding.rival_t, finding.rival_t < rules.tie_t);
    if (!tie || finding.status != FindingStatus::confirmed) return;
    finding.status = FindingStatus::ambiguous;
    if (drives(sums, names, place))
        doubt(finding, "its size is below 0, and another name does as well: it would drive the joint");
}

// What stands for a friction that something given has too much of is not there when that is.
void look_beside_too_much(Sums& sums, const Names& names, std::size_t place, const Judgement& by,
                          BesideFinding& finding) {
    if (finding.status != FindingStatus::confirmed) return;
    Names beside = names;
    beside.erase(beside.begin() + static_cast<std::ptrdiff_t>(place));
    for (const TooMuch& friction : by.too_much) {
        beside.push_back(sums.place_of(friction.shape));
        const bool stands = stands_beside(sums, beside, names[place], finding.price);
        beside.pop_back();
        const double part = finding.gain.gain / friction.gain;
        const bool slight =
            Hearing(sums.lens().rules(), finding.decisions)
                .asked("beside.least_of_too_much", part, part < sums.lens().rules().beside.least_of_too_much);
        if (stands && !slight) continue;
        doubt(finding, fmt::format("what is given may have too much {}, which explains more",
                                   shape_name(friction.shape)));
        return;
    }
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

// A friction that drives the joint bends the curve of another that grows with the speed, or of the model's
// own. Alone it is what a simulation has too much of, of whatever form.
void look_at_driving(const Sums& sums, const Names& names, std::vector<BesideFinding>& findings) {
    const auto resists = [&](std::size_t place) {
        return kind_of(*findings[place].shape.term.effect) == Kind::speed && !drives(sums, names, place);
    };
    const auto& own = sums.lens().model().terms;
    const bool of_model = std::ranges::any_of(own, [](const Term& term) { return term.effect->resists; });
    bool is_other = false;
    for (std::size_t place = 0; place < names.size(); ++place) is_other = is_other || resists(place);
    for (std::size_t place = 0; place < names.size(); ++place) {
        BesideFinding& finding = findings[place];
        if (finding.status != FindingStatus::confirmed || !drives(sums, names, place)) continue;
        if (!is_other && !of_model) doubt_driving(finding);
        if (!is_other) continue;
        finding.status = FindingStatus::shape_correction;
        finding.reason = "its size is below 0: it mends the form of another friction";
    }
}

// Squares of the whitened log that names explain in the whole fit.
double explained_share(const Sums& sums, const Names& names) {
    if (names.empty()) return 0.0;
    VectorXd targets = sums.targets(names, 0);
    for (std::size_t fold = 1; fold < sums.folds(); ++fold) targets += sums.targets(names, fold);
    const VectorXd sizes = sums.sizes(names);
    return 2.0 * sizes.dot(targets) - sizes.dot(sums.products(names) * sizes);
}

// Of what everything that may be named would explain.
double explained_part(const Sums& sums, const Names& names) {
    Names all;
    for (std::size_t shape = 0; shape < sums.listed(); ++shape) {
        if (sums.is_told(shape)) all.push_back(shape);
    }
    return explained_share(sums, names) / std::max(explained_share(sums, all), 1e-300);
}

// Where much that could be explained is not, the names stand in for what was not tried.
void look_at_rest(const Sums& sums, const Named& now, std::vector<BesideFinding>& findings) {
    const DiagnosisRules& rules = sums.lens().rules();
    const double part = explained_part(sums, now.names);
    for (BesideFinding& finding : findings) {
        if (Hearing(rules, finding.decisions)
                .asked("beside.least_part", part, part < rules.beside.least_part))
            doubt(finding,
                  "more could be explained by names that do not hold: it may stand in for something else");
    }
}

// The name that another is clearly ahead of; none, where the best is in each place.
std::optional<std::size_t> outdone(const std::vector<BesideFinding>& findings, const BesideRules& rules) {
    for (std::size_t i = 0; i < findings.size(); ++i) {
        if (findings[i].status == FindingStatus::ambiguous && findings[i].rival &&
            findings[i].rival_margin < -rules.tie_margin && findings[i].rival_t < -rules.tie_t)
            return i;
    }
    return std::nullopt;
}

bool any_tentative(const std::vector<BesideFinding>& findings) {
    return std::any_of(findings.begin(), findings.end(), [](const BesideFinding& finding) {
        return finding.status == FindingStatus::tentative;
    });
}

// A name that was withdrawn in one shape may, in another, be the better one in the place of a name that
// stayed.
void give_way(Sums& sums, Named& now, std::vector<BesideFinding>& findings, const Judgement& by) {
    constexpr int most_ways = 3;
    for (int way = 0; way < most_ways; ++way) {
        const auto place = outdone(findings, sums.lens().rules().beside);
        if (!place) return;
        Named other = now;
        other.names[*place] = sums.place_of(*findings[*place].rival);
        other.left = sums.left_outside(other.names);
        other = refined(sums, std::move(other));
        std::vector<BesideFinding> judged = judged_beside(sums, other, by);
        if (any_tentative(judged) || outdone(judged, sums.lens().rules().beside) == place) return;
        now = std::move(other);
        findings = std::move(judged);
    }
}

}  // namespace

std::vector<BesideFinding> judged_beside(Sums& sums, const Named& now, const Judgement& by) {
    const std::vector<double> left = sums.residual_outside(now.names);
    std::vector<BesideFinding> findings;
    for (std::size_t place = 0; place < now.names.size(); ++place) {
        BesideFinding finding;
        finding.shape = sums.shapes()[now.names[place]];
        Names rest = now.names;
        rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(place));
        finding.gain = outside_gain(sums.residual_outside(rest), left, sums.lens().ground().blocks(),
                                    sums.lens().sigma());
        finding.price = price_of(sums, now.names[place], by.effects);
        finding.size_nm = swing_nm(sums, now.names, place);
        look_alone(sums, now.names, place, by.even_by_speed, finding);
        if (by.even_by_speed) look_at_form(sums, now.names, place, by.effects, finding);
        look_beside_too_much(sums, now.names, place, by, finding);
        findings.push_back(std::move(finding));
    }
    look_at_sizes(sums, findings);
    for (std::size_t place = 0; place < now.names.size(); ++place)
        look_at_rivals(sums, now.names, place, by, findings[place]);
    look_at_driving(sums, now.names, findings);
    return findings;
}

NamedBeside named_beside(Sums& sums, Judgement by) {
    Named now = search_beside(sums, {}, {}, by.effects);
    std::vector<BesideFinding> withdrawn;
    Barred barred;
    for (std::size_t turn = 0;; ++turn) {
        std::vector<BesideFinding> findings = judged_beside(sums, now, by);
        std::optional<std::size_t> weakest;
        for (std::size_t i = 0; i < findings.size(); ++i) {
            if (findings[i].status != FindingStatus::tentative) continue;
            if (!weakest || findings[i].gain.gain < findings[*weakest].gain.gain) weakest = i;
        }
        if (!weakest || turn == sums.lens().rules().beside.most_withdrawals) {
            if (!weakest) give_way(sums, now, findings, by);
            std::erase_if(withdrawn, [&](const BesideFinding& one) {
                return std::any_of(findings.begin(), findings.end(), [&](const BesideFinding& finding) {
                    return same_name(finding.shape, one.shape);
                });
            });
            if (by.even_by_speed) look_at_rest(sums, now, findings);
            findings.insert(findings.end(), withdrawn.begin(), withdrawn.end());
            return {std::move(now), std::move(findings)};
        }
        barred.push_back(findings[*weakest].shape);
        if (by.simulated && findings[*weakest].is_driving)
            by.too_much.push_back({findings[*weakest].shape, findings[*weakest].gain.gain});
        withdrawn.push_back(std::move(findings[*weakest]));
        now.names.erase(now.names.begin() + static_cast<std::ptrdiff_t>(*weakest));
        now.left = sums.left_outside(now.names);
        now = refined(sums, std::move(now));
        sums.forget_but(now.names);
        now = search_beside(sums, std::move(now), barred, by.effects);
    }
}

}  // namespace ripplenotch
