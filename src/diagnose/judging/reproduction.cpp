// SPDX-License-Identifier: MIT
#include "diagnose/judging/reproduction.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "diagnose/case/known_torque.hpp"
#include "diagnose/judging/judge.hpp"
#include "diagnose/search/model_bench.hpp"
#include "diagnose/search/search.hpp"
#include "ripplenotch/model/prediction.hpp"

namespace ripplenotch {
namespace {

double rms_used(const Case& other, const std::vector<double>& values) {
    double sum = 0.0;
    for (std::size_t k = 0; k < values.size(); ++k) sum += other.use[k] != 0 ? values[k] * values[k] : 0.0;
    return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(other.used(), 1)));
}

// A tone goes on between two logs that begin at any time: its phase is the log's own.
Model with_own_phase(const Case& other, const Model& stated, std::size_t term) {
    const Effect& effect = *stated.terms[term].effect;
    if (effect.domain != Domain::frequency || effect.side != Side::joint || !effect.polar) return stated;
    Model open = stated;
    open.terms[term].values[effect.polar->size].reset();
    open.terms[term].values[effect.polar->phase].reset();
    return fit(open, other.motion, other.torque_nm, {.first_guess = &stated, .use = other.use}).model;
}

// The other log with what is uncertain of the known torque as this model leaves it to be.
Case beside(const ModelBench& bench, const Case& other, const Model& stated) {
    if (other.uncertain.empty()) return other;
    return with_known_values(other, fit_known_values(bench.looked_at(), stated, bench.noise()));
}

struct Check {
    double before_nm = 0.0, after_nm = 0.0;
    bool acts = false;  ///< on the other log it brings a torque that would be seen
};

Check checked(const ModelBench& bench, const Case& other, const Candidate& with, const Candidate& without,
              std::size_t term) {
    const Case other_with = beside(bench, other, with.stated);
    const Model own = with_own_phase(other_with, with.stated, term);
    const auto after = residual_nm(other_with, own);
    const auto before = residual_nm(beside(bench, other, without.stated), without.stated);
    std::vector<double> brought = before;
    for (std::size_t k = 0; k < brought.size(); ++k) brought[k] -= after[k];
    return {rms_used(other, before), rms_used(other, after),
            rms_used(other, brought) > material_sigma(other, bench.rules()) * bench.noise().material_nm};
}

void note(Finding& finding, const Check& check) {
    finding.validation_before_nm = check.before_nm;
    finding.validation_after_nm = check.after_nm;
}

// What a finding that is in doubt would do beside the model.
void note_doubtful(const ModelBench& bench, const Candidate& all, const Candidate& model, const Case& other,
                   std::size_t own_terms, std::vector<Finding>& findings) {
    for (std::size_t i = 0; i < findings.size(); ++i) {
        if (!is_doubtful(findings[i]) || findings[i].status == FindingStatus::not_reproduced) continue;
        Candidate with = model;
        with.open.terms.push_back(all.open.terms[own_terms + i]);
        with.stated.terms.push_back(all.stated.terms[own_terms + i]);
        with = bench.fitted(with.open, with.stated, {}, 4);
        note(findings[i], checked(bench, other, with, model, with.stated.terms.size() - 1));
    }
}

double rms_left(const ModelBench& bench, const Case& log, Model stated) {
    const Case other = beside(bench, log, stated);
    for (std::size_t term = 0; term < stated.terms.size(); ++term)
        stated = with_own_phase(other, stated, term);
    return rms_used(other, residual_nm(other, stated));
}

// Each finding may mend what the one before has spoiled: the newest go until the whole does no worse than
// the model as given.
void withdraw_newest(const ModelBench& bench, Candidate& kept, const Model& given, const Case& other,
                     std::size_t own_terms, std::vector<Finding>& findings) {
    const double given_nm = rms_left(bench, other, given);
    while (true) {
        std::size_t term = own_terms, place = 0;
        Finding* newest = nullptr;
        for (Finding& finding : findings) {
            if (is_doubtful(finding)) continue;
            if (is_trusted(finding)) {
                newest = &finding;
                place = term;
            }
            ++term;
        }
        if (newest == nullptr) return;
        const double kept_nm = rms_left(bench, other, kept.stated);
        if (kept_nm <= bench.rules().reproduction.most_left * given_nm) return;
        newest->status = FindingStatus::not_reproduced;
        Hearing(bench.rules(), newest->decisions).asked("reproduction.most_left", kept_nm / given_nm, true);
        newest->reason = fmt::format(
            "the improved model leaves {:.3g} Nm of the validation log with it, the model as given {:.3g} Nm",
            kept_nm, given_nm);
        kept = without_term(bench, kept, place);
    }
}

// The finding that makes the other log worst, of the names or of what only mends a form.
struct Worst {
    Finding* finding = nullptr;
    Candidate without;
    double most = 0.0;  ///< what it leaves, of what is left without it
};

void withdraw(Finding& finding, double left_part, const DiagnosisRules& rules) {
    finding.status = FindingStatus::not_reproduced;
    Hearing(rules, finding.decisions).asked("reproduction.most_left", left_part, true);
    finding.reason =
        fmt::format("it leaves {:.3g} Nm of the validation log, where {:.3g} Nm are left without it",
                    *finding.validation_after_nm, *finding.validation_before_nm);
}

}  // namespace

// What has no name goes before a name does: extrapolated to the other log, a form that was mended in this one
// may leave more there than any name explains. It goes, too, where the whole does worse than the model as
// given though every name does well.
Candidate reproduced(const ModelBench& bench, const Candidate& all, const Candidate& model,
                     const Model& given, const Case& other, std::size_t own_terms,
                     std::vector<Finding>& findings) {
    Candidate kept = model;
    const double most = bench.rules().reproduction.most_left, most_nm = most * rms_left(bench, other, given);
    while (true) {
        Worst named, nameless;
        named.most = nameless.most = most;
        std::size_t term = own_terms;
        for (Finding& finding : findings) {
            if (is_doubtful(finding)) continue;
            const std::size_t place = term++;
            Candidate fewer = without_term(bench, kept, place);
            const Check check = checked(bench, other, kept, fewer, place);
            note(finding, check);
            const double worse = check.after_nm / check.before_nm;
            Worst& worst = is_trusted(finding) ? named : nameless;
            if (check.acts && worse > worst.most) worst = {&finding, std::move(fewer), worse};
        }
        const bool spoilt = nameless.finding != nullptr && rms_left(bench, other, kept.stated) > most_nm;
        if (named.finding == nullptr && !spoilt) break;
        Worst& worst = nameless.finding != nullptr ? nameless : named;
        withdraw(*worst.finding, worst.most, bench.rules());
        kept = std::move(worst.without);
    }
    withdraw_newest(bench, kept, given, other, own_terms, findings);
    note_doubtful(bench, all, kept, other, own_terms, findings);
    return kept;
}

}  // namespace ripplenotch
