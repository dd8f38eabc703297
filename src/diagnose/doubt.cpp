// SPDX-License-Identifier: MIT
#include "diagnose/doubt.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>

#include "diagnose/bent_shape.hpp"
#include "diagnose/evenness.hpp"
#include "diagnose/leftover.hpp"
#include "diagnose/search.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

// Part of the gain that must remain without the finding's best fortieth of the log.
constexpr double least_elsewhere = 0.2;
// A torque so many times larger than what it explains is held in balance by another.
constexpr double most_inflation = 12.0;
// A finding smaller than this part of a larger one of the same kind may only mend its form.
constexpr double shape_part = 0.04;
// Below this, whatever its kind.
constexpr double slight_sigma = 0.25;
// Above this a large torque is a finding of its own, however little of it no other can explain.
constexpr double stands_sigma = 0.5;
// Part of a finding's torque that must be left unexplained where it acts to cast doubt on it.
constexpr double casts_doubt = 0.4;
// A real effect's size is the same wherever it acts, but for what its formula leaves out.
constexpr double most_uneven = 0.3;
constexpr double outgrown = 0.7;
constexpr const char* more_is_left = "more is left unexplained than it explains";

// Domains in which something unexplained casts doubt on an effect.
bool touches(Domain domain, const Leftover& leftover) {
    if (leftover.kind == "order" || leftover.kind == "tone") {
        return domain == Domain::order || domain == Domain::frequency;
    }
    if (leftover.kind == "position") return domain == Domain::position;
    if (leftover.kind == "speed") return domain == Domain::speed;
    return domain == Domain::time || domain == Domain::speed || domain == Domain::position;
}

std::string uneven_words(const Unevenness& uneven) {
    return fmt::format("what is there only looks like it: its size is not the same {} ({:.0f} % off)",
                       uneven.where, 100.0 * std::min(uneven.part, 9.99));
}

bool is_fast(Domain d) { return d == Domain::order || d == Domain::frequency; }

bool of_one_kind(Domain a, Domain b) { return is_fast(a) == is_fast(b); }

// A delay of part of a sample is a matter of when a sample is said to be taken.
bool within_a_sample(const Term& term, const Case& looked_at) {
    for (std::size_t p = 0; p < term.values.size(); ++p) {
        const Parameter& parameter = term.effect->parameters[p];
        if (term.effect->side != Side::sensor || parameter.unit != "s" || !term.values[p]) continue;
        if (std::abs(*term.values[p]) < 0.75 / looked_at.motion.sample_rate.value()) return true;
    }
    return false;
}

// A size that its own error covers, unless another number tells that the effect is there.
std::string_view untold_size(const Term& stated, const std::vector<FittedValue>& values, std::size_t term) {
    std::string_view untold;
    for (const FittedValue& value : values) {
        const Parameter& parameter = stated.effect->parameters[value.parameter];
        if (value.term != term || !parameter.linear) continue;
        const double off = std::abs(value.value - parameter.neutral);
        if (value.standard_error && *value.standard_error < 0.5 * off) return {};
        untold = parameter.name;
    }
    return untold;
}

// What speaks against a finding by itself; empty reason when nothing does.
struct Doubt {
    FindingStatus status = FindingStatus::confirmed;
    std::string reason;
};

Doubt doubt_of(const ModelBench& bench, const Candidate& model, std::size_t term, const Evidence& evidence) {
    const Term& stated = model.stated.terms[term];
    if (evidence.share_sigma < material_sigma(bench.looked_at()) ||
        within_a_sample(stated, bench.looked_at()))
        return {FindingStatus::immaterial,
                fmt::format("it changes the torque by {:.2g} Nm rms beside a noise of {:.2g} Nm",
                            evidence.share_nm, bench.noise().rms_nm)};
    if (evidence.own_nm > most_inflation * std::max(evidence.share_nm, 1e-12))
        return {FindingStatus::unidentifiable,
                "most of its torque is held in balance by another effect's: this log cannot tell them"};
    if (const auto size = untold_size(stated, model.values, term); !size.empty())
        return {FindingStatus::unidentifiable, fmt::format("this log does not tell its {}", size)};
    if (evidence.raw_gain <= 0.0) return {FindingStatus::tentative, "the gap is no smaller with it"};
    if (const auto bent = bent_parameter(bench, model, term); !bent.empty())
        return {
            FindingStatus::tentative,
            fmt::format("its {} ends at a bound, or as good as that: it stands in for something else", bent)};
    if (evidence.elsewhere < least_elsewhere)
        return {FindingStatus::tentative,
                "it explains one short stretch of the log and hardly anything elsewhere"};
    if (const Unevenness uneven = unevenness(bench, model.stated, term); uneven.part > most_uneven)
        return {FindingStatus::tentative, uneven_words(uneven)};
    return {};
}

}  // namespace

void doubt_alone(Finding& finding, const ModelBench& bench, const Candidate& model, std::size_t term) {
    Doubt doubt = doubt_of(bench, model, term, finding.evidence);
    finding.status = doubt.status;
    finding.reason = std::move(doubt.reason);
}

double excess_of(const ModelBench& bench, const Model& stated) {
    const double left_nm = rms(bench.cleared_residual(stated));
    return std::sqrt(std::max(left_nm * left_nm - portable::pow(bench.noise().rms_nm, 2), 0.0));
}

void doubt_for_leftovers(Finding& finding, double excess_nm, const ModelBench& bench,
                         const std::vector<Leftover>& unexplained) {
    if (excess_nm > outgrown * finding.evidence.share_nm && !unexplained.empty()) {
        finding.status = FindingStatus::tentative;
        finding.reason = more_is_left;
    }
    for (const Leftover& place : unexplained) {
        // What is left must not be small beside the finding to cast doubt on it.
        if (!touches(finding.term.effect->domain, place) ||
            place.rms_nm < casts_doubt * finding.evidence.share_nm || is_confined(place, bench.looked_at()))
            continue;
        finding.status = FindingStatus::tentative;
        finding.reason = "something unexplained is left where it acts";
    }
}

void doubt_for_size(Finding& finding, const std::vector<Finding>& findings) {
    const Evidence& evidence = finding.evidence;
    for (const Finding& other : findings) {
        const Effect& larger = *other.term.effect;
        const bool slight = evidence.share_sigma < slight_sigma;
        const bool stands =
            evidence.share_sigma > stands_sigma && evidence.own_nm > shape_part * other.evidence.own_nm;
        const double larger_nm = std::max(other.evidence.share_nm, other.evidence.own_nm);
        if (evidence.share_nm > shape_part * larger_nm || stands ||
            !(slight || of_one_kind(finding.term.effect->domain, larger.domain)))
            continue;
        finding.status = is_doubtful(other) ? FindingStatus::tentative : FindingStatus::shape_correction;
        finding.reason = fmt::format("it may only mend the form of {}, which is {}", larger.name,
                                     is_doubtful(other) ? "in doubt" : "far larger");
    }
}

bool is_trusted(const Finding& finding) {
    return finding.status == FindingStatus::confirmed || finding.status == FindingStatus::ambiguous;
}

bool is_doubtful(const Finding& finding) {
    return finding.status == FindingStatus::tentative || finding.status == FindingStatus::unidentifiable ||
           finding.status == FindingStatus::not_reproduced;
}

bool doubt_beside(const ModelBench& bench, const Candidate& kept, std::size_t own_terms,
                  std::vector<Finding>& findings) {
    const double excess_nm = excess_of(bench, kept.stated);
    bool changed = false;
    std::size_t term = own_terms;
    for (Finding& finding : findings) {
        if (is_doubtful(finding)) continue;
        const std::size_t place = term++;
        const Domain domain = finding.term.effect->domain;
        bool same = false, kin = false;
        for (const Finding& other : findings) {
            same = same || (is_doubtful(other) && other.term.effect->domain == domain);
            kin = kin || (is_doubtful(other) && is_fast(other.term.effect->domain) && is_fast(domain));
        }
        if (!is_trusted(finding)) continue;
        const Unevenness uneven = same ? unevenness(bench, kept.stated, place) : Unevenness{};
        const bool outdone = (same || kin) && excess_nm > outgrown * finding.evidence.share_nm;
        if (!outdone && uneven.part <= most_uneven) continue;
        finding.status = FindingStatus::tentative;
        finding.reason = outdone ? more_is_left : uneven_words(uneven);
        changed = true;
    }
    return changed;
}

}  // namespace ripplenotch
