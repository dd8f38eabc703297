// SPDX-License-Identifier: MIT
#include "diagnose/judging/judge.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <vector>

#include "diagnose/case/case.hpp"
#include "diagnose/case/known_torque.hpp"
#include "diagnose/judging/doubt.hpp"
#include "diagnose/limits.hpp"
#include "diagnose/search/model_bench.hpp"
#include "diagnose/search/search.hpp"
#include "diagnose/search/search_starts.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/model/prediction.hpp"

namespace ripplenotch {

namespace {

// Samples at the limit are there partly because of noise; excluding only those while samples that noise kept
// below the limit remain would bias the torque low. The expected torque decides instead.
void leave_out_limited(Case& looked_at, const Model& stated, const std::vector<Fault>& faults,
                       double noise_nm) {
    for (const Fault& fault : faults) {
        const auto place = fault.term.effect->range_limit;
        if (!place) continue;
        const double most_nm = *fault.term.values[*place] - limits::values::limit_deviations * noise_nm;
        const auto expected_nm = predict_nm(stated, looked_at.motion);
        std::vector<unsigned char> inside = looked_at.use;
        for (std::size_t k = 0; k < looked_at.size(); ++k) {
            if (std::abs(expected_nm[k]) > most_nm) inside[k] = 0;
        }
        const auto used = [](const std::vector<unsigned char>& use) {
            return static_cast<std::size_t>(std::count(use.begin(), use.end(), 1));
        };
        if (used(inside) * limits::values::least_inside >= used(looked_at.use)) looked_at.use = inside;
    }
}

// The first of the findings whose size is not identifiable with the settled values: it was tested together
// with terms that have come to other values since, or are gone.
std::optional<std::size_t> untold(const Candidate& told, const ToldOf& of) {
    std::size_t term = of.own_terms;
    for (Finding& finding : of.findings) {
        if (is_doubtful(finding)) continue;
        if (is_trusted(finding) && doubt_size(finding, told, term)) return term;
        ++term;
    }
    return std::nullopt;
}

}  // namespace

Candidate final_values(Case looked_at, const NoiseFloor& noise, const Candidate& chosen, const ToldOf& of,
                       Work& work) {
    leave_out_limited(looked_at, chosen.stated, of.faults, noise.rms_nm);
    ModelBench bench(looked_at, noise, work);
    bench.settle_on(chosen.stated);
    Candidate told = bench.settled(chosen);
    while (const auto term = untold(told, of)) told = bench.settled(without_term(bench, told, *term));
    return told;
}

namespace {

// Square that a wave of `half_periods` over the log holds of a torque, a number per row.
double held_nm2(const ModelBench& bench, const std::vector<double>& torque_nm, std::size_t half_periods) {
    const auto& time_s = bench.looked_at().motion.time_s;
    const double begin_s = time_s.front(), log_s = time_s.back() - begin_s;
    double product = 0.0, square = 0.0;
    for (std::size_t r = 0; r < torque_nm.size(); ++r) {
        const double angle_rad = std::numbers::pi * static_cast<double>(half_periods) *
                                 (time_s[bench.rows()[r]] - begin_s) / log_s;
        const double wave = portable::cos(angle_rad);
        product += wave * torque_nm[r];
        square += wave * wave;
    }
    return product * product / std::max(square, 1e-300);
}

bool is_slow(const ModelBench& bench, const Model& stated, std::size_t term) {
    const auto added = bench.torque_of(stated, term);
    std::vector<double> torque_nm;
    double all_nm2 = 0.0, slow_nm2 = 0.0;
    for (const std::size_t k : bench.rows()) {
        torque_nm.push_back(added[k]);
        all_nm2 += added[k] * added[k];
    }
    for (std::size_t wave = 0; wave < limits::wandering::slow_waves; ++wave)
        slow_nm2 += held_nm2(bench, torque_nm, wave);
    return slow_nm2 > limits::wandering::slow_part * all_nm2;
}

}  // namespace

std::optional<double> above_wandering(const ModelBench& bench, const Model& stated, std::size_t term,
                                      double raw_gain_nm2) {
    if (!is_slow(bench, stated, term)) return std::nullopt;
    const auto left_nm = bench.cleared_residual(stated);
    double mean_nm2 = 0.0;
    for (std::size_t wave = 0; wave < limits::wandering::waves; ++wave)
        mean_nm2 += held_nm2(bench, left_nm, limits::wandering::slow_waves + wave) /
                    static_cast<double>(limits::wandering::waves);
    return raw_gain_nm2 / std::max(mean_nm2, 1e-300);
}

namespace {

// Part of the gain that is left when the stretch of the log that gives most of it is put aside.
double gain_elsewhere(const ModelBench& bench, const Model& with, const Model& without) {
    const auto now = bench.residual(with), before = bench.residual(without);
    const auto& time_s = bench.looked_at().motion.time_s;
    const double start_s = time_s.front(),
                 stretch_s = std::max((time_s.back() - start_s) / limits::judge::stretches,
                                      limits::judge::least_stretch_s);
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

// The gain block by block. A block is longer than the correlation of the noise, so that blocks are
// independent.
void take_blocks(const ModelBench& bench, const Model& with, const Model& without, Evidence& evidence) {
    const auto now = bench.residual(with), before = bench.residual(without);
    const double memory = 5.0 * static_cast<double>(bench.noise().color.size());
    const auto length = static_cast<std::size_t>(
        std::max({limits::residual::block_s * bench.looked_at().motion.sample_rate.value(), memory, 20.0}));
    double sum = 0.0, squares = 0.0;
    for (std::size_t r = 0; r < bench.rows().size(); ++evidence.blocks) {
        double gain = 0.0;
        for (const std::size_t end = std::min(r + length, bench.rows().size()); r < end; ++r)
            gain += before[r] * before[r] - now[r] * now[r];
        evidence.blocks_positive += gain > 0.0 ? 1 : 0;
        sum += gain;
        squares += gain * gain;
    }
    const double blocks = static_cast<double>(evidence.blocks);
    const double variance = squares - sum * sum / std::max(blocks, 1.0);
    evidence.t = variance > 0.0 && blocks > 1.0 ? sum / std::sqrt(variance * blocks / (blocks - 1.0)) : 0.0;
}

// A curve over the speed with nothing but a size, such as its square.
bool is_fixed_curve(const Effect& effect) {
    return effect.side == Side::joint && effect.domain == Domain::speed &&
           std::all_of(effect.parameters.begin(), effect.parameters.end(),
                       [](const Parameter& parameter) { return parameter.linear; });
}

// By how much the rival is behind. With unexplained residual remaining, two curves of fixed form that lie
// nearer to each other than to the measured torque cannot be distinguished: the form is neither's.
double ahead_of_left(double behind, const ModelBench& bench, const Candidate& model) {
    return std::max(behind - std::max(model.gain_left - bench.samples(), 0.0), 0.0);
}

double margin_of(const ModelBench& bench, const Candidate& model, const Candidate& other, bool is_form_alone,
                 bool something_left) {
    const double behind = other.criterion() - model.criterion();
    return !is_form_alone || !something_left || behind <= 0.0 ? behind : ahead_of_left(behind, bench, model);
}

// The torque of uncertain findings counts as residual as well.
void doubt_for_form(const ModelBench& bench, const Candidate& kept, std::vector<Finding>& findings) {
    for (Finding& finding : findings) {
        if (finding.status != FindingStatus::confirmed || !is_fixed_curve(*finding.term.effect)) continue;
        for (RivalFinding& rival : finding.alternatives) {
            if (!is_fixed_curve(find_effect(rival.effect)) || rival.margin < tie_margin) continue;
            const double margin = ahead_of_left(rival.margin, bench, kept);
            if (margin >= tie_margin) continue;
            rival.margin = margin;
            finding.status = FindingStatus::ambiguous;
        }
    }
}

void find_rivals(const ModelBench& bench, const Candidate& model, const Candidate& fewer, std::size_t term,
                 std::span<const Effect* const> effects, bool something_left, Finding& finding) {
    const std::size_t most = bench.work().ended() ? 1 : limits::judge::most_rivals;
    std::size_t tried = 0;
    const Effect* const load[] = {&find_effect("gravity"), &find_effect("inertia")};
    const bool is_scale = model.stated.terms[term].effect == &find_effect("simulation-scale");
    for (const Trial& trial : screen(bench, fewer, effects)) {
        if (trial.start.effect == model.stated.terms[term].effect) continue;
        if (trial.gain < limits::judge::rival_gain * finding.evidence.gain - limits::judge::rival_slack ||
            tried++ >= most)
            break;
        const Candidate other = with_trial(bench, fewer, trial);
        const bool is_form_alone =
            is_fixed_curve(*trial.start.effect) && is_fixed_curve(*model.stated.terms[term].effect);
        double margin = margin_of(bench, model, other, is_form_alone, something_left);
        // A payload is weight and inertia, one cause, which together may be a multiple of the simulation.
        if (is_scale && std::ranges::find(load, trial.start.effect) != std::end(load))
            margin -= other.gain_left - one_ahead(bench, other, load).gain_left;
        // At a bound it stands in for something else: a warm-up that never ends is a constant friction.
        if (std::abs(margin) < tie_margin &&
            !bent_parameter(bench, other, other.stated.terms.size() - 1).empty())
            continue;
        finding.alternatives.push_back({trial.start.effect->name, margin});
        if (margin < tie_margin) finding.status = FindingStatus::ambiguous;
    }
}

double squares(const ModelBench& bench, const Model& stated) {
    const auto left = bench.raw_residual(stated);
    double sum = 0.0;
    for (const std::size_t k : bench.rows()) sum += left[k] * left[k];
    return sum;
}

// rms over the rows that count.
double counted_rms(const ModelBench& bench, const std::vector<double>& torque_nm) {
    std::vector<double> counted_nm;
    for (const std::size_t k : bench.rows()) counted_nm.push_back(torque_nm[k]);
    return rms(counted_nm);
}

// rms of the torque of a term's size alone. The phase of a ripple that differs by direction acts without a
// size.
double sized_rms(const ModelBench& bench, const Model& stated, std::size_t term, double own_nm) {
    const std::span<const Parameter> parameters = stated.terms[term].effect->parameters;
    Model without_size = stated, size_alone = stated;
    bool has_size = false;
    for (std::size_t p = 0; p < parameters.size(); ++p) {
        has_size = has_size || parameters[p].linear;
        if (parameters[p].left_out != LeftOut::fitted) continue;
        (parameters[p].linear ? without_size : size_alone).terms[term].values[p] = parameters[p].neutral;
    }
    if (!has_size || counted_rms(bench, bench.torque_of(without_size, term)) == 0.0) return own_nm;
    return counted_rms(bench, bench.torque_of(size_alone, term));
}

Finding judged_finding(const ModelBench& bench, const Candidate& model, const Candidate& fewer,
                       std::size_t term, const std::vector<double>& torque_nm) {
    Finding finding;
    finding.term = model.stated.terms[term];
    for (const FittedValue& value : model.values) {
        if (value.term == term) finding.values.push_back(value);
    }
    Evidence& evidence = finding.evidence;
    evidence.gain = fewer.gain_left - model.gain_left;
    evidence.price = model.prices[term];
    evidence.share_sigma = bench.share(model, fewer);
    evidence.share_nm = evidence.share_sigma * bench.noise().material_nm;
    // rms over the rows that the share is computed from: the rows where a resonance is largest may be left
    // out.
    evidence.own_nm = counted_rms(bench, torque_nm);
    evidence.sized_nm = sized_rms(bench, model.stated, term, evidence.own_nm);
    evidence.raw_gain = squares(bench, fewer.stated) - squares(bench, model.stated);
    evidence.elsewhere = gain_elsewhere(bench, model.stated, fewer.stated);
    take_blocks(bench, model.stated, fewer.stated, evidence);
    finding.where = place_of(bench.looked_at(), torque_nm, finding.term);
    return finding;
}

// By itself, and against its rivals.
Finding tested_finding(const ModelBench& bench, const Candidate& model, std::size_t term,
                       std::span<const Effect* const> effects, bool something_left) {
    const Candidate fewer = without_term(bench, model, term);
    Finding finding = judged_finding(bench, model, fewer, term, bench.torque_of(model.stated, term));
    doubt_alone(finding, bench, model, term);
    if (is_trusted(finding)) find_rivals(bench, model, fewer, term, effects, something_left, finding);
    return finding;
}

}  // namespace

std::vector<Finding> judge(const ModelBench& bench, const Candidate& found, std::size_t own_terms,
                           std::span<const Effect* const> effects,
                           const std::vector<ResidualRegion>& unexplained) {
    std::vector<Finding> findings;
    const Candidate model = bench.with_errors(found);
    for (std::size_t term = own_terms; term < model.stated.terms.size(); ++term)
        findings.push_back(tested_finding(bench, model, term, effects, !unexplained.empty()));
    const double excess_nm = excess_of(bench, model.stated);
    for (Finding& finding : findings) {
        if (!is_trusted(finding)) continue;
        doubt_for_residual(finding, excess_nm, bench, unexplained);
        doubt_for_size(finding, findings);
    }
    return findings;
}

Finding judged_alone(const ModelBench& bench, const Candidate& found, std::size_t term,
                     std::span<const Effect* const> effects, const std::vector<ResidualRegion>& unexplained) {
    return tested_finding(bench, bench.with_errors(found), term, effects, !unexplained.empty());
}

std::string what_would_tell(const Effect& one, const Effect& other) {
    for (const auto& [effect, rival] : {std::pair(&one, &other), std::pair(&other, &one)}) {
        for (const LookAlike& alike : effect->look_alikes) {
            if (alike.name == rival->name) return std::string(alike.told_by);
        }
    }
    return "a log with rests, both directions, several speeds and a travel of more than a revolution";
}

Candidate believed(const ModelBench& bench, const Candidate& model, std::size_t own_terms,
                   std::vector<Finding>& findings) {
    while (true) {
        Candidate kept = model;
        for (std::size_t i = findings.size(); i-- > 0;) {
            if (is_doubtful(findings[i])) kept = without_term(bench, kept, own_terms + i);
        }
        if (doubt_beside(bench, kept, own_terms, findings)) continue;
        if (kept.stated.terms.size() < model.stated.terms.size()) doubt_for_form(bench, kept, findings);
        return kept;
    }
}

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

// The other log with the uncertain values of the known torque as fitted with this model.
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
            rms_used(other, brought) > material_sigma(other) * bench.noise().material_nm};
}

void note(Finding& finding, const Check& check) {
    finding.validation_before_nm = check.before_nm;
    finding.validation_after_nm = check.after_nm;
}

// Evaluates each uncertain finding together with the model.
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

// Each finding may correct an error of the one before: the newest are withdrawn until the whole does no worse
// than the model as given.
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
        if (kept_nm <= limits::reproduction::most_left * given_nm) return;
        newest->status = FindingStatus::not_reproduced;
        newest->reason =
            fmt::format("residual on the validation log {:.3g} Nm with it, {:.3g} Nm with the model as given",
                        kept_nm, given_nm);
        kept = without_term(bench, kept, place);
    }
}

// The finding that makes the other log worst, of the names or of what only mends a form.
struct Worst {
    Finding* finding = nullptr;
    Candidate without;
    double most = 0.0;  ///< ratio of the residual with it to the residual without it
};

void withdraw(Finding& finding) {
    finding.status = FindingStatus::not_reproduced;
    finding.reason = fmt::format("residual on the validation log {:.3g} Nm with it, {:.3g} Nm without it",
                                 *finding.validation_after_nm, *finding.validation_before_nm);
}

}  // namespace

// Unnamed correction terms are removed before names: extrapolated to the other log, a form that was corrected
// in this one may add more residual there than any name explains. They are also removed where the whole does
// worse than the model as given although every name does well.
Candidate reproduced(const ModelBench& bench, const Candidate& all, const Candidate& model,
                     const Model& given, const Case& other, std::size_t own_terms,
                     std::vector<Finding>& findings) {
    Candidate kept = model;
    const double most = limits::reproduction::most_left, most_nm = most * rms_left(bench, other, given);
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
        withdraw(*worst.finding);
        kept = std::move(worst.without);
    }
    withdraw_newest(bench, kept, given, other, own_terms, findings);
    note_doubtful(bench, all, kept, other, own_terms, findings);
    return kept;
}

}  // namespace ripplenotch
