// SPDX-License-Identifier: MIT
// The loop: faults, noise, baseline, search, what is left, judgement, the final fit of the whole log.

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "diagnose/angle/angle.hpp"
#include "diagnose/case/faults.hpp"
#include "diagnose/examined.hpp"
#include "diagnose/judging/doubt.hpp"
#include "diagnose/judging/judge.hpp"
#include "diagnose/judging/leftover.hpp"
#include "diagnose/judging/reproduction.hpp"
#include "diagnose/judging/values.hpp"
#include "diagnose/known_torque.hpp"
#include "diagnose/search/search.hpp"
#include "diagnose/telling/summary.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"

namespace ripplenotch {
namespace {

struct Searched {
    std::unique_ptr<ModelBench> bench;  ///< on which the last model was found
    NoiseGround ground;
    NoiseFloor noise;
    Candidate first, last;
    std::vector<RefusedCandidate> refused;
};

// The noise beside the last model, and that model fitted with it. What the search could not explain before is
// in the noise that it began with.
void measure_noise(Searched& found, const Case& c, Work& work, const DiagnosisRules& rules) {
    found.noise = noise_floor(c, found.last.stated, found.last.open, rules, found.ground);
    auto kept = found.bench ? found.bench->kept() : std::make_shared<KeptScreenings>();
    found.bench = std::make_unique<ModelBench>(c, found.noise, work, rules, std::move(kept));
    found.bench->settle_on(found.last.stated);
    found.last = found.bench->fitted(found.last.open, found.last.stated, found.last.prices);
}

Searched search_case(const Case& c, const Model& model, std::span<const Effect* const> effects, Work& work,
                     const DiagnosisRules& rules) {
    const std::size_t own = model.terms.size();
    // The first fit knows nothing of the noise.
    ModelBench rough(c, {1.0, 1.0, {}}, work, rules);
    Searched found;
    found.first = baseline(rough, model);
    found.last = found.first;
    for (std::size_t look = 0; look < rules.noise_floor.most_looks; ++look) {
        measure_noise(found, c, work, rules);
        const Candidate start = found.last;
        if (look == 0) found.first = start;
        found.last = search(*found.bench, start, own, effects, found.refused);
        const double left = std::sqrt(found.last.gain_left / found.bench->samples());
        const bool found_more = found.last.stated.terms.size() > start.stated.terms.size();
        if (look > 0 && !found_more) break;
        if (work.is_over()) {
            if (found_more) measure_noise(found, c, work, rules);
            break;
        }
        if (left > rules.noise_floor.was_too_large && found.last.stated.terms.size() == own) break;
    }
    return found;
}

// The gap after each addition, in the order of adoption.
void tell_rounds(Diagnosis& diagnosis, const ModelBench& bench, const Candidate& last, std::size_t own) {
    Candidate now = last;
    now.open.terms.resize(own);
    now.stated.terms.resize(own);
    double before = rms_of(bench.raw_residual(diagnosis.baseline), bench.looked_at().use);
    for (std::size_t i = 0; i < diagnosis.rounds.size(); ++i) {
        Finding& finding = diagnosis.rounds[i];
        now.open.terms.push_back(last.open.terms[own + i]);
        now.stated.terms.push_back(last.stated.terms[own + i]);
        now = bench.fitted(now.open, now.stated, {}, 4);
        finding.gap_before_nm = before;
        finding.gap_after_nm = before = rms_of(bench.raw_residual(now.stated), bench.looked_at().use);
    }
}

bool set_aside(Case& c, const std::vector<Leftover>& left, const DiagnosisRules& rules) {
    bool any = false;
    const double margin_s = rules.leftover.aside_margin_s;
    for (const Leftover& leftover : left) {
        if (!is_confined(leftover, c, rules)) continue;
        for (std::size_t k = 0; k < c.size(); ++k) {
            for (const Span& span : leftover.where.time_s) {
                if (c.motion.time_s[k] < span.from - margin_s || c.motion.time_s[k] > span.to + margin_s)
                    continue;
                any = any || c.use[k] != 0;
                c.use[k] = c.valid[k] = 0;
            }
        }
    }
    return any;
}

double confined_part(const Case& c, const std::vector<Leftover>& left) {
    double total_s = 0.0;
    for (const Leftover& leftover : left) {
        for (const Span& span : leftover.where.time_s)
            total_s += leftover.kind == LeftoverKind::time ? span.to - span.from : 0.0;
    }
    return total_s / (c.motion.time_s.back() - c.motion.time_s.front());
}

// Without position an effect of the position may fit along the integral of the speed and be something else.
std::vector<Undecidable> undecidable(const ModelBench& bench, const Candidate& model,
                                     std::span<const Effect* const> tried,
                                     std::span<const std::string> without) {
    std::vector<const Effect*> others;
    for (const Effect* effect : examined(model.stated, without, true)) {
        if (std::find(tried.begin(), tried.end(), effect) == tried.end()) others.push_back(effect);
    }
    std::vector<Undecidable> told;
    for (const Effect* effect : others)
        told.push_back({effect->name, "it depends on where the joint is, and the log has no position", 0.0});
    for (const Trial& trial : screen(bench, model, others)) {
        for (Undecidable& entry : told) {
            if (entry.effect == trial.start.effect->name && trial.score() > 0.0)
                entry.would_explain_nm = bench.noise().rms_nm * std::sqrt(trial.gain / bench.samples());
        }
    }
    return told;
}

// A disturbance of short duration bends everything that is fitted to it. It is told, set aside, and the rest
// of the log is diagnosed without it.
Searched search_rest(Case& part, const Model& model, std::span<const Effect* const> effects,
                     Diagnosis& diagnosis, std::vector<Leftover>& aside, Work& work,
                     const DiagnosisRules& rules) {
    Searched found = search_case(part, model, effects, work, rules);
    {
        ModelBench bench(part, found.noise, work, rules);
        bench.settle_on(found.first.stated);
        diagnosis.disagreement = leftovers(bench, found.first.stated);
    }
    for (std::size_t look = 0; look < rules.leftover.most_asides; ++look) {
        const auto left = leftovers(*found.bench, found.last.stated);
        // What is set aside has to be searched once more from the start.
        if (confined_part(part, left) > rules.leftover.most_aside_part || work.is_over() ||
            !set_aside(part, left, rules))
            break;
        for (const Leftover& leftover : left) {
            if (leftover.kind == LeftoverKind::time) aside.push_back(leftover);
        }
        found = search_case(part, model, effects, work, rules);
    }
    return found;
}

// What was found may tell more of the angle than the model as given did; then the search goes on from there.
Searched search_straight(Case& whole, Case& part, const Model& model, std::span<const Effect* const> effects,
                         Diagnosis& diagnosis, std::vector<Leftover>& aside, Work& work,
                         const DiagnosisRules& rules, bool has_position) {
    Searched found = search_rest(part, model, effects, diagnosis, aside, work, rules);
    if (has_position || !straightened_by(whole, found.last, found.bench->floor_nm(found.last.stated), rules))
        return found;
    found.bench.reset();
    found.ground = {};
    for (std::size_t k = 0; k < part.size(); ++k)
        part.motion.position_deg[k] = whole.motion.position_deg[part.row[k]];
    measure_noise(found, part, work, rules);
    found.first = found.bench->fitted(found.first.open, found.first.stated, found.first.prices);
    found.refused.clear();
    found.last = search(*found.bench, found.last, model.terms.size(), effects, found.refused);
    return found;
}

// Where more than noise is left: the same search in a log that is whitened by what was left.
void look_again(Searched& found, const Case& c, const Model& model, std::span<const Effect* const> effects,
                Work& work, const DiagnosisRules& rules) {
    const std::size_t own = model.terms.size();
    std::vector<double> left(c.size(), 0.0);
    const auto cleared = found.bench->cleared_residual(found.last.stated);
    for (std::size_t r = 0; r < cleared.size(); ++r) left[found.bench->rows()[r]] = cleared[r];
    found.noise = noise_of_residual(c, left, found.noise, rules);
    found.bench = std::make_unique<ModelBench>(c, found.noise, work, rules);
    found.bench->settle_on(found.first.stated);
    found.first = found.bench->fitted(found.first.open, found.first.stated, found.first.prices);
    found.refused.clear();
    found.last = search(*found.bench, found.first, own, effects, found.refused);
}

// What of the findings is believed, and what is left then. `other`: the validation log, if there is one;
// it may begin at an angle that only the model tells.
Candidate judged(Diagnosis& diagnosis, const Searched& found, std::size_t own,
                 std::span<const Effect* const> effects, Case* other, bool begins_anywhere) {
    const ModelBench& bench = *found.bench;
    diagnosis.unexplained = leftovers(bench, found.last.stated);
    diagnosis.rounds = judge(bench, found.last, own, effects,
                             bench.beside_residual() ? std::vector<Leftover>() : diagnosis.unexplained);
    diagnosis.refused = found.refused;
    diagnosis.baseline = found.first.stated;
    diagnosis.evaluations =
        bench.work().spent() * Work::unit_samples / static_cast<double>(bench.looked_at().size());
    diagnosis.search_ended = bench.work().ended();
    diagnosis.gap.noise_floor_nm = bench.floor_nm(found.last.stated);
    diagnosis.noise_color = found.noise.color;
    tell_rounds(diagnosis, bench, found.last, own);
    Candidate last = believed(bench, found.last, own, diagnosis.rounds);
    if (other != nullptr && begins_anywhere) put_in_place(*other, last.stated, bench.rules().recording);
    if (other != nullptr)
        last = reproduced(bench, found.last, last, diagnosis.baseline, *other, own, diagnosis.rounds);
    // What a doubtful finding would explain is not explained.
    if (last.stated.terms.size() < found.last.stated.terms.size())
        diagnosis.unexplained = leftovers(bench, last.stated);
    return last;
}

Candidate fitted_to_whole(const Case& whole, const Searched& found, const Candidate& last,
                          Diagnosis& diagnosis, Work& work, const DiagnosisRules& rules) {
    ModelBench all(whole, found.noise, work, rules);
    all.settle_on(last.stated);
    const Candidate fitted = all.fitted(last.open, last.stated, last.prices, 4);
    diagnosis.baseline = all.fitted(found.first.open, found.first.stated, found.first.prices, 4).stated;
    return fitted;
}

// The improved model with its values, those of each finding, and the faults, which are names too.
void tell_model(Diagnosis& diagnosis, const Candidate& last, std::size_t own) {
    diagnosis.model = last.stated;
    diagnosis.values = last.values;
    std::size_t place = own;
    for (Finding& finding : diagnosis.rounds) {
        if (is_doubtful(finding)) continue;
        finding.term = last.stated.terms[place];
        finding.values.clear();
        for (const FittedValue& value : last.values) {
            if (value.term == place) finding.values.push_back(value);
        }
        ++place;
    }
    for (const Fault& fault : diagnosis.faults) {
        diagnosis.model.terms.push_back(fault.term);
        diagnosis.named.emplace_back(fault.term.effect->name);
    }
}

}  // namespace

namespace {

void check_rows(std::span<const GivenTerm> given, std::size_t rows, std::string_view log) {
    for (const GivenTerm& term : given) {
        for (const auto& column : term.torque_nm) {
            if (column.size() != rows)
                raise<UsageError>("{}: {} values for the {} rows of {}", term.name, column.size(), rows, log);
        }
    }
}

// Whether a simulation is there of which nobody states the scale.
bool is_scale_open(std::span<const GivenTerm> given) {
    return std::ranges::any_of(given, [](const GivenTerm& term) {
        return term.name == "simulated" && term.deviation[0] > stated_deviation;
    });
}

// What the known torque brings into the model: friction that a simulation has too much of is below 0, and the
// zero of the sensor is fitted beside an arm's weight, which it looks like.
Model with_known_terms(Model model, std::span<const GivenTerm> given) {
    model.beside_simulation = is_given(given, "simulated");
    const bool has_offset = std::ranges::any_of(
        model.terms, [](const Term& term) { return term.effect->name == "offset"; });
    if (is_given(given, "arm") && !has_offset) model.terms.push_back(parse_term("offset"));
    return model;
}

}  // namespace

Diagnosis diagnose(const Model& given_model, const TraceView& log, const TraceView* validation,
                   const DiagnosisOptions& options) {
    check_rows(options.given, log.size(), "the log");
    if (validation != nullptr) {
        if (options.validation_given.size() != options.given.size())
            raise<UsageError>("{} terms are given for the log and {} for the validation log",
                              options.given.size(), options.validation_given.size());
        check_rows(options.validation_given, validation->size(), "the validation log");
    }
    const Model model = with_known_terms(given_model, options.given);
    const DiagnosisRules& rules = options.rules;
    check(rules);
    for (const std::string& name : options.without) (void)find_effect(name);
    const std::size_t own = model.terms.size();
    Case whole = whole_case(log, options.smoothing, rules.recording);
    take_known_torque(whole, options.given);
    std::vector<std::string> without(options.without.begin(), options.without.end());
    if (!is_scale_open(options.given)) without.emplace_back("simulation-scale");
    const auto effects =
        examined(model, without, log.has_position() || tells_position(whole.motion, rules.recording));
    std::optional<Case> other;
    if (validation != nullptr) {
        other = whole_case(*validation, options.smoothing, rules.recording);
        take_known_torque(*other, options.validation_given);
        (void)find_faults(*other, rules.faults);
    }
    Work work(rules.search.most_evaluations);
    Diagnosis diagnosis;
    diagnosis.false_alarm = rules.screening.false_alarm;
    diagnosis.has_position = log.has_position();
    diagnosis.samples = whole.size();
    diagnosis.faults = find_faults(whole, rules.faults);
    std::vector<Leftover> spoiled = nameless(diagnosis.faults, options.without), aside;
    AngleBefore before(whole, log.has_position());
    if (!log.has_position()) straighten(whole, model, rules);
    Case part = excerpt(whole, rules.recording);
    Searched found =
        search_straight(whole, part, model, effects, diagnosis, aside, work, rules, log.has_position());
    found.ground = {};  // nobody asks for the noise again
    if (other && !(log.has_position() && validation->has_position())) before.of_other(*other);
    Candidate last = judged(diagnosis, found, own, effects, other ? &*other : nullptr, before.has_other());
    const bool doubtful = std::any_of(diagnosis.rounds.begin(), diagnosis.rounds.end(), is_doubtful);
    if (doubtful || !diagnosis.unexplained.empty()) {
        const double left_nm = rms(found.bench->cleared_residual(found.last.stated));
        if (left_nm > rules.beside.least_left * found.noise.rms_nm) {
            const ModelBench plain = *found.bench;
            look_again(found, part, model, effects, work, rules);
            last = judged(diagnosis, found, own, effects, other ? &*other : nullptr, before.has_other());
            diagnosis.unexplained = leftovers(plain, last.stated);
            diagnosis.gap.noise_floor_nm = plain.floor_nm(last.stated);
            diagnosis.residual_in_noise = true;
        }
    }
    diagnosis.angle = before.account(whole, other ? &*other : nullptr);
    if (!log.has_position())
        diagnosis.undecidable = undecidable(*found.bench, last, effects, options.without);
    measure_at_samples(spoiled, whole, last.stated);
    diagnosis.unexplained.insert(diagnosis.unexplained.begin(), spoiled.begin(), spoiled.end());
    diagnosis.unexplained.insert(diagnosis.unexplained.begin(), aside.begin(), aside.end());
    // The excerpt chose; the whole log gives the values.
    const bool is_excerpt = part.size() < whole.size();
    if (is_excerpt) (void)set_aside(whole, aside, rules);
    if (is_excerpt) last = fitted_to_whole(whole, found, last, diagnosis, work, rules);
    const Case& all = is_excerpt ? whole : part;
    last = told_values(all, found.noise, last, {diagnosis.faults, diagnosis.rounds, own}, work, rules);
    tell_model(diagnosis, last, own);
    name_findings(diagnosis, rules);
    diagnosis.samples_used = all.used();
    const KnownValues known = fit_known_values(all, last.stated, found.noise);
    diagnosis.given = reported_values(options.given, known);
    const Case improved = with_known_values(whole, known);
    const std::optional<Case> other_improved =
        other ? std::optional(with_known_values(*other, known)) : std::nullopt;
    const GapCase log_gap{whole, improved};
    const std::optional<GapCase> other_gap =
        other ? std::optional<GapCase>({*other, *other_improved}) : std::nullopt;
    measure_gap(diagnosis, log_gap, other_gap ? &*other_gap : nullptr, rules);
    if (!options.given.empty()) {
        diagnosis.residual_before_nm = residual_nm(whole, diagnosis.baseline);
        diagnosis.residual_after_nm = residual_nm(improved, diagnosis.model);
        diagnosis.beside_given_nm = residual_nm(improved, {diagnosis.model.gear_ratio, {}});
    }
    diagnosis.verdict = verdict_of(diagnosis);
    return diagnosis;
}

}  // namespace ripplenotch
