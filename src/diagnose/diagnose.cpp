// SPDX-License-Identifier: MIT
// The loop: faults, noise, baseline, search, what is left, judgement, the final fit of the whole log.

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>

#include "diagnose/faults.hpp"
#include "diagnose/judge.hpp"
#include "diagnose/leftover.hpp"
#include "diagnose/search.hpp"
#include "diagnose/values.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"

namespace ripplenotch {
namespace {

// The noise is looked at again when a model leaves less than this part of it.
constexpr double noise_was_too_large = 0.985;
constexpr int most_looks = 3;

double rms_of(const std::vector<double>& values, const std::vector<unsigned char>& use) {
    double sum = 0.0, count = 0.0;
    for (std::size_t k = 0; k < values.size(); ++k) {
        if (use[k] == 0) continue;
        sum += values[k] * values[k];
        count += 1.0;
    }
    return std::sqrt(sum / std::max(count, 1.0));
}

double residual_rms(const Case& c, const Model& stated, const std::vector<unsigned char>& use) {
    std::vector<double> left = predict_nm(stated, c.motion);
    for (std::size_t k = 0; k < left.size(); ++k) left[k] = c.torque_nm[k] - left[k];
    return rms_of(left, use);
}

// Converter effects are found in the log itself (find_faults), not by a fit.
std::vector<const Effect*> screened(const Model& model, std::span<const std::string> without) {
    for (const std::string& name : without) (void)find_effect(name);
    std::vector<const Effect*> effects;
    for (const Effect* effect : catalogue()) {
        const bool left_out = std::find(without.begin(), without.end(), effect->name) != without.end();
        // Without ripple in the model there is nothing that these could change.
        const bool ripple = std::any_of(model.terms.begin(), model.terms.end(), [](const Term& term) {
            return term.effect->ripple_order.has_value();
        });
        if (left_out || effect->side == Side::converter || (effect->side == Side::ripple && !ripple))
            continue;
        effects.push_back(effect);
    }
    return effects;
}

struct Searched {
    std::unique_ptr<Bench> bench;  ///< on which the last model was found
    NoiseFloor noise;
    Candidate first, last;
};

Searched search_case(const Case& c, const Model& model, std::span<const Effect* const> effects) {
    const std::size_t own = model.terms.size();
    // The first fit knows nothing of the noise.
    Bench rough(c, {1.0, 1.0, {}});
    Searched found;
    found.first = baseline(rough, model);
    found.last = found.first;
    for (int look = 0; look < most_looks; ++look) {
        found.noise = noise_floor(c, found.last.stated, found.last.open);
        found.bench = std::make_unique<Bench>(c, found.noise);
        Bench& bench = *found.bench;
        bench.settle_on(found.last.stated);
        const Candidate start = bench.fitted(found.last.open, found.last.stated, found.last.prices);
        if (look == 0) found.first = start;
        found.last = search(bench, start, own, effects);
        const double left = std::sqrt(found.last.gain_left / bench.samples());
        if (look > 0 && found.last.stated.terms.size() == start.stated.terms.size()) break;
        if (left > noise_was_too_large && found.last.stated.terms.size() == own) break;
    }
    return found;
}

DiagnosisVerdict verdict_of(const Diagnosis& diagnosis) {
    const bool told = !diagnosis.named.empty() || !diagnosis.ambiguous.empty();
    const bool doubtful = std::any_of(diagnosis.rounds.begin(), diagnosis.rounds.end(), is_doubtful);
    if (diagnosis.unexplained.empty() && !doubtful)
        return told ? DiagnosisVerdict::explained : DiagnosisVerdict::matches;
    return told ? DiagnosisVerdict::partly_explained : DiagnosisVerdict::unexplained;
}

void name_findings(Diagnosis& diagnosis) {
    std::set<std::set<std::string>> ties;
    for (const Finding& finding : diagnosis.rounds) {
        const Effect& effect = *finding.term.effect;
        const std::string name(effect.name);
        auto& named = diagnosis.named;
        if (finding.status == FindingStatus::confirmed &&
            std::find(named.begin(), named.end(), name) == named.end())
            named.push_back(name);
        if (finding.status != FindingStatus::ambiguous) continue;
        Tie tie{{name}, {}};
        for (const RivalFinding& rival : finding.alternatives) {
            if (rival.margin >= 12.0) continue;
            tie.effects.emplace_back(rival.effect);
            if (tie.advice.empty()) tie.advice = what_would_tell(effect, find_effect(rival.effect));
        }
        if (ties.insert({tie.effects.begin(), tie.effects.end()}).second) diagnosis.ambiguous.push_back(tie);
    }
}

// Part of the squared gap above the floor that is gone, of samples that no fault spoiled. Empty when there
// was no gap to speak of.
std::optional<double> closed_percent(const Case& c, const Diagnosis& diagnosis) {
    const double floor = std::pow(diagnosis.gap.noise_floor_nm, 2);
    const double before = std::pow(residual_rms(c, diagnosis.baseline, c.use), 2) - floor;
    const double after = std::pow(residual_rms(c, diagnosis.model, c.use), 2) - floor;
    if (before < 0.02 * floor) return std::nullopt;
    const double closed = 100.0 * (1.0 - std::max(after, 0.0) / before);
    return std::abs(closed) < 1e-3 ? 0.0 : closed;  // the same model, fitted anew
}

// Gaps are over every sample, so that they are what `simulate` says of the same model and log.
void measure_gap(Diagnosis& diagnosis, const Case& whole, const TraceView* validation, Seconds smoothing) {
    DiagnosisGap& gap = diagnosis.gap;
    const std::vector<unsigned char> all(whole.size(), 1);
    gap.before_nm = residual_rms(whole, diagnosis.baseline, all);
    gap.after_nm = residual_rms(whole, diagnosis.model, all);
    gap.closed_percent = closed_percent(whole, diagnosis);
    if (validation == nullptr) return;
    Case other = whole_case(*validation, smoothing);
    (void)find_faults(other);
    const std::vector<unsigned char> every(other.size(), 1);
    gap.validation_before_nm = residual_rms(other, diagnosis.baseline, every);
    gap.validation_after_nm = residual_rms(other, diagnosis.model, every);
    gap.validation_closed_percent = closed_percent(other, diagnosis);
}

// The gap after each addition, in the order of adoption.
void tell_rounds(Diagnosis& diagnosis, const Bench& bench, const Candidate& last, std::size_t own) {
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

bool set_aside(Case& c, const std::vector<Leftover>& left) {
    bool any = false;
    const double margin_s = 0.05;
    for (const Leftover& leftover : left) {
        if (!is_confined(leftover, c)) continue;
        for (std::size_t k = 0; k < c.size(); ++k) {
            for (const Span& span : leftover.where.time_s) {
                if (c.motion.time_s[k] < span.from - margin_s || c.motion.time_s[k] > span.to + margin_s)
                    continue;
                any = any || c.use[k] != 0;
                c.use[k] = 0;
            }
        }
    }
    return any;
}

double confined_part(const Case& c, const std::vector<Leftover>& left) {
    double total_s = 0.0;
    for (const Leftover& leftover : left) {
        for (const Span& span : leftover.where.time_s)
            total_s += leftover.kind == "time" ? span.to - span.from : 0.0;
    }
    return total_s / (c.motion.time_s.back() - c.motion.time_s.front());
}

}  // namespace

Diagnosis diagnose(const Model& model, const TraceView& log, const TraceView* validation,
                   const DiagnosisOptions& options) {
    const auto effects = screened(model, options.without);
    const std::size_t own = model.terms.size();
    Case whole = whole_case(log, options.smoothing);
    Diagnosis diagnosis;
    diagnosis.has_position = log.has_position();
    diagnosis.samples = whole.size();
    diagnosis.faults = find_faults(whole);
    Case part = excerpt(whole);
    Searched found = search_case(part, model, effects);
    {
        Bench bench(part, found.noise);
        bench.settle_on(found.first.stated);
        diagnosis.disagreement = leftovers(bench, found.first.stated);
    }
    // A disturbance of short duration bends everything that is fitted to it. It is told, set aside, and the
    // rest of the log is diagnosed without it.
    std::vector<Leftover> aside;
    for (int look = 0; look < 2; ++look) {
        const auto left = leftovers(*found.bench, found.last.stated);
        if (confined_part(part, left) > 0.15 || !set_aside(part, left)) break;
        for (const Leftover& leftover : left) {
            if (leftover.kind == "time") aside.push_back(leftover);
        }
        found = search_case(part, model, effects);
    }
    Bench& bench = *found.bench;
    diagnosis.unexplained = leftovers(bench, found.last.stated);
    diagnosis.rounds = judge(bench, found.last, own, effects, diagnosis.unexplained);
    diagnosis.baseline = found.first.stated;
    diagnosis.gap.noise_floor_nm = bench.floor_nm(found.last.stated);
    diagnosis.noise_color = found.noise.color;
    tell_rounds(diagnosis, bench, found.last, own);
    Candidate last = believed(bench, found.last, own, diagnosis.rounds);
    // What a doubtful finding would explain is not explained.
    if (last.stated.terms.size() < found.last.stated.terms.size())
        diagnosis.unexplained = leftovers(bench, last.stated);
    diagnosis.unexplained.insert(diagnosis.unexplained.begin(), aside.begin(), aside.end());
    // The excerpt chose; the whole log gives the values.
    if (part.size() < whole.size()) {
        (void)set_aside(whole, aside);
        Bench all(whole, found.noise);
        all.settle_on(last.stated);
        last = all.fitted(last.open, last.stated, last.prices, 4);
        diagnosis.baseline = all.fitted(found.first.open, found.first.stated, found.first.prices, 4).stated;
    }
    last = told_values(part.size() < whole.size() ? whole : part, found.noise, last, diagnosis.faults);
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
    name_findings(diagnosis);
    diagnosis.samples_used = part.size() < whole.size() ? whole.used() : part.used();
    measure_gap(diagnosis, whole, validation, options.smoothing);
    diagnosis.verdict = verdict_of(diagnosis);
    return diagnosis;
}

}  // namespace ripplenotch
