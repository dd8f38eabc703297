// SPDX-License-Identifier: MIT
#include "diagnose/judge.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "diagnose/leftover.hpp"
#include "diagnose/search.hpp"
#include "ripplenotch/model/prediction.hpp"

namespace ripplenotch {
namespace {

// A rival that explains the log as well but for this gain is not told from a finding.
constexpr double tie_margin = 12.0;
// Part of the gain that must remain without the finding's best fortieth of the log.
constexpr double least_elsewhere = 0.2;
constexpr double stretches = 40.0;
// A torque so many times larger than what it explains is held in balance by another.
constexpr double most_inflation = 12.0;
// A finding smaller than this part of a larger one of the same kind may only mend its form.
constexpr double shape_part = 0.04;
// Below this, whatever its kind.
constexpr double slight_sigma = 0.25;
// Part of a finding's torque that must be left unexplained where it acts to cast doubt on it.
constexpr double casts_doubt = 0.4;
constexpr double outgrown = 0.7;

double rms(const std::vector<double>& values) {
    double sum = 0.0;
    for (const double value : values) sum += value * value;
    return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(values.size(), 1)));
}

// Part of the gain that is left when the stretch of the log that gives most of it is put aside.
double gain_elsewhere(const Bench& bench, const Model& with, const Model& without) {
    const auto now = bench.residual(with), before = bench.residual(without);
    const auto& time_s = bench.looked_at().motion.time_s;
    const double start_s = time_s.front(), stretch_s = std::max((time_s.back() - start_s) / stretches, 0.25);
    std::map<long, double> gains;
    double total = 0.0, most = 0.0;
    for (std::size_t r = 0; r < now.size(); ++r) {
        const double gain = before[r] * before[r] - now[r] * now[r];
        gains[static_cast<long>((time_s[bench.rows()[r]] - start_s) / stretch_s)] += gain;
        total += gain;
    }
    for (const auto& [stretch, gain] : gains) most = std::max(most, gain);
    return total > 0.0 ? (total - most) / total : 0.0;
}

// Domains in which something unexplained casts doubt on an effect.
bool touches(Domain domain, const Leftover& leftover) {
    if (leftover.kind == "order" || leftover.kind == "tone") {
        return domain == Domain::order || domain == Domain::frequency;
    }
    if (leftover.kind == "position") return domain == Domain::position;
    if (leftover.kind == "speed") return domain == Domain::speed;
    return domain == Domain::time || domain == Domain::speed || domain == Domain::position;
}

bool of_one_kind(Domain a, Domain b) {
    const auto fast = [](Domain d) { return d == Domain::order || d == Domain::frequency; };
    return fast(a) == fast(b);
}

// A delay of part of a sample is a matter of when a sample is said to be taken.
bool within_a_sample(const Term& term, const Case& looked_at) {
    for (std::size_t p = 0; p < term.values.size(); ++p) {
        const Parameter& parameter = term.effect->parameters[p];
        if (term.effect->side != Side::sensor || parameter.unit != "s" || !term.values[p]) continue;
        if (std::abs(*term.values[p]) < 0.75 / looked_at.motion.sample_rate.value()) return true;
    }
    return false;
}

// A shape that is bent as far as it goes is not the effect's own. At a bound that is neutral it has no shape
// at all, which is all right: a drift whose time constant has no end is a straight line.
std::string_view name_at_bound(const Term& term, const std::vector<FittedValue>& values) {
    for (const FittedValue& value : values) {
        const Parameter& parameter = term.effect->parameters[value.parameter];
        // A logarithm and back is off by rounding.
        const double from_neutral = std::abs(value.value - parameter.neutral);
        if (value.at_bound && !parameter.linear &&
            from_neutral > 1e-6 * std::max(1.0, std::abs(parameter.neutral)))
            return parameter.name;
    }
    return {};
}

Place place_of(const Case& c, const std::vector<double>& torque_nm, const Term& term) {
    // Bins in which the rms of what the term adds is at least half of the largest.
    Place place;
    const auto bins_of = [&](const std::vector<double>& quantity, double floor) {
        const auto [low, high] = std::minmax_element(quantity.begin(), quantity.end());
        constexpr std::size_t bins = 20;
        std::vector<double> power(bins, 0.0), count(bins, 0.0);
        std::vector<Span> spans;
        if (!(*high - *low > floor)) return spans;
        for (std::size_t k = 0; k < c.size(); ++k) {
            const auto b =
                std::min(static_cast<std::size_t>((quantity[k] - *low) / (*high - *low) * bins), bins - 1);
            power[b] += torque_nm[k] * torque_nm[k];
            count[b] += 1.0;
        }
        double most = 0.0;
        for (std::size_t b = 0; b < bins; ++b) {
            power[b] = count[b] > 20.0 ? power[b] / count[b] : 0.0;
            most = std::max(most, power[b]);
        }
        const double width = (*high - *low) / bins;
        std::size_t taken = 0;
        for (std::size_t b = 0; b < bins; ++b) {
            if (power[b] < 0.25 * most || most == 0.0) continue;
            ++taken;
            const double from = *low + static_cast<double>(b) * width;
            if (b > 0 && power[b - 1] >= 0.25 * most)
                spans.back().to = from + width;
            else
                spans.push_back({from, from + width});
        }
        if (taken > bins * 3 / 4) spans.clear();  // nowhere in particular
        return spans;
    };
    place.time_s = bins_of(c.motion.time_s, 0.0);
    place.speed_deg_s = bins_of(c.motion.velocity_deg_s, 1.0);
    place.position_deg = bins_of(c.motion.position_deg, 5.0);
    double moving[2] = {0.0, 0.0}, count[2] = {0.0, 0.0}, rest = 0.0, rests = 0.0;
    for (std::size_t k = 0; k < c.size(); ++k) {
        const double v = c.motion.velocity_deg_s[k], power = torque_nm[k] * torque_nm[k];
        if (std::abs(v) < 1.0) {
            rest += power;
            rests += 1.0;
        } else {
            moving[v > 0.0] += power;
            count[v > 0.0] += 1.0;
        }
    }
    const double up = count[1] > 0.0 ? moving[1] / count[1] : 0.0,
                 down = count[0] > 0.0 ? moving[0] / count[0] : 0.0;
    const double still = rests > 0.0 ? rest / rests : 0.0;
    if (still < 0.25 * std::max(up, down))
        place.direction = up > 4.0 * down ? "positive" : down > 4.0 * up ? "negative" : "both";
    for (std::size_t p = 0; p < term.values.size(); ++p) {
        if (!term.values[p]) continue;
        if (term.effect->ripple_order == p && *term.values[p] > 0.0) place.order.push_back(*term.values[p]);
        if (term.effect->parameters[p].name == "frequency_hz") place.hz.push_back(*term.values[p]);
    }
    return place;
}

void find_rivals(const Bench& bench, const Candidate& model, const Candidate& fewer, std::size_t term,
                 std::span<const Effect* const> effects, Finding& finding) {
    std::size_t tried = 0;
    for (const Trial& trial : screen(bench, fewer, effects)) {
        if (trial.start.effect == model.stated.terms[term].effect) continue;
        if (trial.gain < 0.85 * finding.evidence.gain - 100.0 || tried++ >= 3) break;
        const Candidate other = with_trial(bench, fewer, trial);
        const double margin = other.criterion() - model.criterion();
        finding.alternatives.push_back({trial.start.effect->name, margin});
        if (margin < tie_margin) finding.status = FindingStatus::ambiguous;
    }
}

}  // namespace

std::string what_would_tell(const Effect& one, const Effect& other) {
    for (const auto& [effect, rival] : {std::pair(&one, &other), std::pair(&other, &one)}) {
        for (const LookAlike& alike : effect->look_alikes) {
            if (alike.name == rival->name) return std::string(alike.told_by);
        }
    }
    return "a log with rests, both directions, several speeds and a travel of more than a revolution";
}

std::vector<Finding> judge(const Bench& bench, const Candidate& model, std::size_t own_terms,
                           std::span<const Effect* const> effects, const std::vector<Leftover>& unexplained) {
    std::vector<Finding> findings;
    for (std::size_t term = own_terms; term < model.stated.terms.size(); ++term) {
        const Term& stated = model.stated.terms[term];
        Finding finding;
        finding.term = stated;
        for (const FittedValue& value : model.values) {
            if (value.term == term) finding.values.push_back(value);
        }
        const Candidate fewer = without_term(bench, model, term);
        Evidence& evidence = finding.evidence;
        evidence.gain = fewer.gain_left - model.gain_left;
        evidence.price = model.prices[term];
        evidence.share_sigma = bench.share(model, fewer);
        evidence.share_nm = evidence.share_sigma * bench.noise().rms_nm;
        evidence.elsewhere = gain_elsewhere(bench, model.stated, fewer.stated);
        Model removed = model.stated;
        removed.terms.erase(removed.terms.begin() + static_cast<std::ptrdiff_t>(term));
        const auto torque_nm = Prediction(removed, bench.looked_at().motion).added(stated);
        finding.where = place_of(bench.looked_at(), torque_nm, stated);
        if (evidence.share_sigma < material_sigma(bench.looked_at()) ||
            within_a_sample(stated, bench.looked_at())) {
            finding.status = FindingStatus::immaterial;
            finding.reason = fmt::format("it changes the torque by {:.2g} Nm rms beside a noise of {:.2g} Nm",
                                         evidence.share_nm, bench.noise().rms_nm);
        } else if (rms(torque_nm) > most_inflation * std::max(evidence.share_nm, 1e-12)) {
            finding.status = FindingStatus::unidentifiable;
            finding.reason =
                "most of its torque is held in balance by another effect's: this log cannot tell them";
        } else if (const auto bound = name_at_bound(stated, finding.values); !bound.empty()) {
            finding.status = FindingStatus::tentative;
            finding.reason = fmt::format("its {} ends at a bound: it stands in for something else", bound);
        } else if (evidence.elsewhere < least_elsewhere) {
            finding.status = FindingStatus::tentative;
            finding.reason = "it explains one short stretch of the log and hardly anything elsewhere";
        } else {
            find_rivals(bench, model, fewer, term, effects, finding);
        }
        findings.push_back(std::move(finding));
    }
    // Where more is left over than a finding explains, it may have fed on that.
    const auto left = bench.cleared_residual(model.stated);
    const double excess_nm =
        std::sqrt(std::max(rms(left) * rms(left) - std::pow(bench.noise().rms_nm, 2), 0.0));
    for (Finding& finding : findings) {
        const Effect& effect = *finding.term.effect;
        if (finding.status != FindingStatus::confirmed && finding.status != FindingStatus::ambiguous)
            continue;
        if (excess_nm > outgrown * finding.evidence.share_nm && !unexplained.empty()) {
            finding.status = FindingStatus::tentative;
            finding.reason = "more is left unexplained than it explains";
        }
        for (const Leftover& place : unexplained) {
            // What is left must not be small beside the finding to cast doubt on it.
            if (!touches(effect.domain, place) || place.rms_nm < casts_doubt * finding.evidence.share_nm)
                continue;
            if (is_confined(place, bench.looked_at())) continue;
            finding.status = FindingStatus::tentative;
            finding.reason = "something unexplained is left where it acts";
        }
        for (const Finding& other : findings) {
            const Effect& larger = *other.term.effect;
            const double part = finding.evidence.share_sigma / other.evidence.share_sigma;
            const bool slight = finding.evidence.share_sigma < slight_sigma;
            if (part > shape_part || !(slight || of_one_kind(effect.domain, larger.domain))) continue;
            finding.status = FindingStatus::shape_correction;
            finding.reason = fmt::format("it may only mend the form of {}, which is far larger", larger.name);
        }
    }
    return findings;
}

}  // namespace ripplenotch
