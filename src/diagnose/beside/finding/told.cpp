// SPDX-License-Identifier: MIT
#include "diagnose/beside/finding/told.hpp"

#include <algorithm>
#include <iterator>
#include <limits>

#include "diagnose/beside/weighing/shapes.hpp"
#include "diagnose/judging/doubt.hpp"
#include "diagnose/judging/leftover.hpp"
#include "diagnose/telling/summary.hpp"

namespace ripplenotch {
namespace {

bool is_left_above(const Diagnosis& diagnosis, const ModelBench& bench, const Candidate& last) {
    if (diagnosis.unexplained.empty() &&
        std::none_of(diagnosis.rounds.begin(), diagnosis.rounds.end(), is_doubtful))
        return false;
    const double left_nm = rms_of(bench.raw_residual(last.stated), bench.looked_at().use);
    return left_nm > bench.rules().beside.least_left * bench.noise().rms_nm;
}

// The search before has bent a number of it to a bound that is held at its usual value here: it stands in for
// something else, and so may what was judged beside it.
bool has_bent_shape(const Diagnosis& diagnosis, const Finding& finding) {
    const std::vector<std::size_t> refined = scales_of(*finding.term.effect);
    return std::any_of(diagnosis.rounds.begin(), diagnosis.rounds.end(), [&](const Finding& round) {
        if (!is_doubtful(round) || !same_name({round.term}, {finding.term})) return false;
        return std::any_of(round.values.begin(), round.values.end(), [&](const FittedValue& value) {
            return value.at_bound &&
                   std::find(refined.begin(), refined.end(), value.parameter) == refined.end();
        });
    });
}

// What changes a ripple follows the ripple that it changes, and is of no use without it.
std::vector<Finding>::iterator end_of_unit(std::vector<Finding>::iterator first,
                                           std::vector<Finding>::iterator end) {
    const auto rings = [](const Finding& finding) { return finding.term.effect->side == Side::ripple; };
    return std::find_if_not(first + 1, end, rings);
}

void append(Candidate& now, std::vector<Finding>::const_iterator first,
            std::vector<Finding>::const_iterator end) {
    for (; first != end; ++first) now.stated.terms.push_back(first->term);
}

// Sizes of all names were fitted at once, so that one may open the gap that another closes: each round takes
// the name that leaves least. Doubtful ones stay last.
void put_in_order(std::vector<Finding>& findings, Candidate now, const ModelBench& bench) {
    const auto end = std::find_if(findings.begin(), findings.end(), is_doubtful);
    for (auto first = findings.begin(); first != end; first = end_of_unit(first, end)) {
        auto best = first;
        double least_nm = std::numeric_limits<double>::infinity();
        for (auto next = first; next != end; next = end_of_unit(next, end)) {
            Candidate with = now;
            append(with, next, end_of_unit(next, end));
            const double left_nm = rms_of(bench.raw_residual(with.stated), bench.looked_at().use);
            if (left_nm >= least_nm) continue;
            least_nm = left_nm;
            best = next;
        }
        std::rotate(first, best, end_of_unit(best, end));
        append(now, first, end_of_unit(first, end));
    }
}

}  // namespace

Candidate adopt(Diagnosis& diagnosis, BesideOutcome outcome, const Candidate& model,
                const ModelBench& bench) {
    put_in_order(outcome.findings, model, bench);
    Candidate now = model;
    double before = rms_of(bench.raw_residual(now.stated), bench.looked_at().use);
    for (auto first = outcome.findings.begin(); first != outcome.findings.end();) {
        // The gap of a ripple is told with what changes it.
        const auto end = end_of_unit(first, outcome.findings.end());
        const double opened_nm = before;
        for (auto finding = first; finding != end; ++finding) {
            if (is_doubtful(*finding)) continue;
            now.open.terms.push_back(finding->term);
            now.stated.terms.push_back(finding->term);
            now.prices.push_back(finding->evidence.price);
        }
        if (!is_doubtful(*first)) before = rms_of(bench.raw_residual(now.stated), bench.looked_at().use);
        for (auto finding = first; finding != end; ++finding) {
            finding->gap_before_nm = finding == first ? opened_nm : before;
            finding->gap_after_nm = before;
            finding->evidence.share_sigma = finding->evidence.share_nm / bench.noise().rms_nm;
            finding->evidence.raw_gain = static_cast<double>(bench.looked_at().used()) *
                                         (finding->gap_before_nm * finding->gap_before_nm - before * before);
        }
        first = end;
    }
    std::move(outcome.findings.begin(), outcome.findings.end(), std::back_inserter(diagnosis.rounds));
    return now;
}

Candidate with_findings_beside(Diagnosis& diagnosis, const ModelBench& bench, const Candidate& last,
                               const Case* other, std::span<const Effect* const> effects) {
    if (!is_left_above(diagnosis, bench, last)) return last;
    std::optional<GivenCase> validation;
    if (other != nullptr) validation.emplace(GivenCase{*other});
    // What changes ripple was tried in that search, on all of the model's; here it would feed on what is
    // left.
    std::vector<const Effect*> tried;
    std::copy_if(effects.begin(), effects.end(), std::back_inserter(tried),
                 [](const Effect* effect) { return effect->side != Side::ripple; });
    BesideOutcome outcome = find_beside({bench.looked_at()}, validation ? &*validation : nullptr, last, tried,
                                        bench.rules(), bench.work());
    // The search before has told its own doubts.
    std::erase_if(outcome.findings, is_doubtful);
    if (outcome.findings.empty()) return last;
    for (const Finding& finding : outcome.findings) {
        if (has_bent_shape(diagnosis, finding)) return last;
    }
    for (const Finding& finding : outcome.findings) {
        std::erase_if(diagnosis.rounds, [&](const Finding& round) {
            return is_doubtful(round) && same_name({round.term}, {finding.term});
        });
    }
    const Candidate now = adopt(diagnosis, std::move(outcome), last, bench);
    diagnosis.unexplained = leftovers(bench, now.stated);
    diagnosis.leftover = left_by_band(bench.looked_at(), now.stated);
    return now;
}

}  // namespace ripplenotch
