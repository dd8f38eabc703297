// SPDX-License-Identifier: MIT
#include "diagnose/given_diagnosis.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "core/vectors/dot.hpp"
#include "diagnose/beside/finding/sensing.hpp"
#include "diagnose/beside/finding/sizes.hpp"
#include "diagnose/beside/finding/told.hpp"
#include "diagnose/beside/weighing/always_on.hpp"
#include "diagnose/case/faults.hpp"
#include "diagnose/examined.hpp"
#include "diagnose/judging/doubt.hpp"
#include "diagnose/judging/leftover.hpp"
#include "diagnose/search/search.hpp"
#include "diagnose/telling/summary.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {
namespace {

void check_rows(std::span<const GivenTerm> given, std::size_t rows, std::string_view log) {
    for (const GivenTerm& term : given) {
        for (const auto& column : term.torque_nm) {
            if (column.size() != rows)
                raise<UsageError>("{}: {} values for the {} rows of {}", term.name, column.size(), rows, log);
        }
    }
}

// A log with what is given of it: as it stands, and with the values that were fitted.
struct GivenLog {
    Case c;
    std::span<const GivenTerm> given;

    [[nodiscard]] GivenCase view() const { return {c, given}; }

    /// Its torque less what is given. What the gear carries of it goes into the motion.
    [[nodiscard]] Case less(const Model& model, const std::vector<double>& values,
                            const DiagnosisRules& rules) const {
        const AlwaysOn columns = given_columns(c, model, given, rules);
        Case rest = c;
        const auto brought = brought_nm(columns, values, 0, columns.stated);
        add_scaled(-1.0, brought.data(), rest.torque_nm.data(), rest.torque_nm.size());
        rest.motion.known_nm = carried_nm(columns, values);
        return rest;
    }
};

std::vector<double> as_given(const Model& model, const GivenLog& log, const DiagnosisRules& rules) {
    return given_columns(log.c, model, log.given, rules).mean;
}

void tell_given(Diagnosis& diagnosis, const Model& model, std::span<const GivenTerm> given,
                const BesideOutcome& outcome) {
    const std::vector<std::string> names = given_names(model, given);
    for (std::size_t i = 0; i < names.size(); ++i) {
        GivenValue value{names[i], outcome.given_values[i], std::nullopt};
        // A value that is stated has none.
        if (i < outcome.given_errors.size() && outcome.given_errors[i] > stated_deviation) {
            const double half = normal_95_errors * outcome.given_errors[i];
            value.ci95 = Interval{value.value - half, value.value + half};
        }
        diagnosis.given.push_back(std::move(value));
    }
}

std::vector<double> left_of(const Case& c, const Model& model) {
    std::vector<double> left_nm = c.torque_nm;
    const auto predicted = predict_nm(model, c.motion);
    add_scaled(-1.0, predicted.data(), left_nm.data(), left_nm.size());
    return left_nm;
}

// Values of findings beside a leftover are their own; the places are those in the improved model.
void tell_places(Diagnosis& diagnosis, std::size_t own) {
    std::size_t place = own;
    for (Finding& finding : diagnosis.rounds) {
        if (is_doubtful(finding)) continue;
        for (FittedValue& value : finding.values) value.term = place;
        diagnosis.values.insert(diagnosis.values.end(), finding.values.begin(), finding.values.end());
        ++place;
    }
}

// Beside a leftover the sandwich's errors are too small by themselves.
void widen_values(FittedValue& value, double times) {
    if (!value.ci95) return;
    const double middle = 0.5 * (value.ci95->low + value.ci95->high);
    value.ci95->low = middle + times * (value.ci95->low - middle);
    value.ci95->high = middle + times * (value.ci95->high - middle);
}

// Of the same value, an interval that holds both.
void span_fits(std::vector<FittedValue>& values, std::span<const FittedValue> others) {
    for (FittedValue& value : values) {
        const auto other = std::ranges::find_if(others, [&](const FittedValue& one) {
            return one.term == value.term && one.parameter == value.parameter;
        });
        if (other == others.end() || !value.ci95) continue;
        if (!other->ci95) value.ci95.reset();
        if (!other->ci95) continue;
        value.ci95->low = std::min(value.ci95->low, other->ci95->low);
        value.ci95->high = std::max(value.ci95->high, other->ci95->high);
    }
}

// The scale of a simulation acts on its own friction too: what of that is too much is as uncertain.
bool is_scale_told(std::span<const GivenValue> given) {
    constexpr double told = 0.05;  // by hand, of it: a scale that is off by less is no finding
    const auto scale = std::ranges::find(given, "simulated", &GivenValue::name);
    return scale == given.end() || !scale->ci95 ||
           scale->ci95->high - scale->ci95->low <= 2.0 * told * std::abs(scale->value);
}

// A shape that ends at a bound stands in for something else.
bool is_bent(std::span<const FittedValue> values, std::size_t term) {
    return std::ranges::any_of(
        values, [term](const FittedValue& value) { return value.term == term && value.at_bound; });
}

Model beside(Model model, std::span<const GivenTerm> given) {
    model.beside_simulation = is_given(given, "simulated");
    return model;
}

class GivenDiagnosis {
  public:
    GivenDiagnosis(const Model& model, const TraceView& log, const TraceView* validation,
                   const DiagnosisOptions& options)
        : model_(beside(model, options.given)),
          options_(options),
          rules_(options.rules),
          work_(rules_.search.most_evaluations),
          effects_(examined(model, options.without, log.has_position(), true)),
          whole_{whole_case(log, options.smoothing, rules_.recording), options.given} {
        if (validation == nullptr) return;
        other_.emplace(
            GivenLog{whole_case(*validation, options.smoothing, rules_.recording), options.validation_given});
        (void)find_faults(other_->c, rules_.faults);
    }

    [[nodiscard]] Diagnosis run(bool has_position) {
        told_.false_alarm = rules_.screening.false_alarm;
        told_.has_position = has_position;
        told_.samples = whole_.c.size();
        told_.faults = find_faults(whole_.c, rules_.faults);
        std::vector<Leftover> spoiled = nameless(told_.faults, options_.without);
        const GivenLog part{excerpt(whole_.c, rules_.recording), whole_.given};
        const Candidate first =
            fitted_own(part.less(model_, as_given(model_, part, rules_), rules_), model_, model_);
        told_.baseline = first.stated;
        sensed_ = first.stated;
        std::optional<GivenCase> validation;
        if (other_) validation.emplace(other_->view());
        const BesideOutcome outcome =
            find_beside(part.view(), validation ? &*validation : nullptr, first, effects_, rules_, work_);
        tell_given(told_, model_, whole_.given, outcome);
        Candidate own = first;
        if (outcome.sensor) {
            own = with_sensor(first, outcome.sensor->term);
            sensed_ = own.stated;
            adopt_sensor(*outcome.sensor, part, first.stated, outcome.given_values);
        }
        const Candidate last = looked_at_rest(part.less(sensed_, outcome.given_values, rules_), own, outcome);
        measure_at_samples(spoiled, whole_.less(sensed_, outcome.given_values, rules_), last.stated);
        told_.unexplained.insert(told_.unexplained.begin(), spoiled.begin(), spoiled.end());
        finish(last, outcome.given_values);
        return std::move(told_);
    }

  private:
    [[nodiscard]] Candidate fitted_own(const Case& c, const Model& open, const Model& guess) {
        const ModelBench rough(c, {1.0, 1.0, {}}, work_, rules_);
        return rough.fitted(open, guess, std::vector<double>(open.terms.size(), 0.0), 30);
    }

    // What is left with and without it, the given values as they are in the end.
    void adopt_sensor(Finding sensor, const GivenLog& part, const Model& without,
                      const std::vector<double>& values) {
        const Case before = part.less(without, values, rules_), after = part.less(sensed_, values, rules_);
        sensor.gap_before_nm = rms_of(left_of(before, without), before.use);
        sensor.gap_after_nm = rms_of(left_of(after, sensed_), after.use);
        sensor.evidence.share_sigma = sensor.evidence.share_nm / std::max(sensor.gap_after_nm, 1e-300);
        sensor.evidence.raw_gain =
            static_cast<double>(before.used()) *
            (sensor.gap_before_nm * sensor.gap_before_nm - sensor.gap_after_nm * sensor.gap_after_nm);
        told_.rounds.push_back(std::move(sensor));
    }

    // What is left of the log beside what was found.
    [[nodiscard]] Candidate looked_at_rest(const Case& rest, const Candidate& first,
                                           const BesideOutcome& outcome) {
        Candidate named = first;
        for (const Term& term : outcome.believed) {
            named.open.terms.push_back(term);
            named.stated.terms.push_back(term);
        }
        named = fitted_own(rest, named.open, named.stated);
        const NoiseFloor noise = noise_floor(rest, named.stated, named.open, rules_);
        ModelBench bench(rest, noise, work_, rules_);
        bench.settle_on(named.stated);
        Candidate own = first;
        own.stated.terms.assign(
            named.stated.terms.begin(),
            named.stated.terms.begin() + static_cast<std::ptrdiff_t>(first.stated.terms.size()));
        const Candidate last = adopt(told_, outcome, own, bench);
        told_.unexplained = leftovers(bench, last.stated);
        told_.disagreement = told_.unexplained;
        told_.gap.noise_floor_nm = bench.floor_nm(last.stated);
        told_.noise_color = noise.color;
        told_.leftover = left_by_band(rest, last.stated);
        const Candidate with_errors = bench.settled(last);
        told_.values = with_errors.values;
        span_fits(told_.values, fitted_beside_frictions(last, bench));
        for (FittedValue& value : told_.values) {
            widen_values(value, rules_.beside.interval_factor);
            const bool of_friction = value.term < model_.terms.size() &&
                                     model_.terms[value.term].effect->resists && value.parameter == 0;
            if (of_friction && (!is_scale_told(told_.given) || is_bent(told_.values, value.term)))
                value.ci95.reset();
        }
        return with_errors;
    }

    // A friction of the model and one that was found share what both could be: the model's own values once
    // more, with the found ones open.
    [[nodiscard]] std::vector<FittedValue> fitted_beside_frictions(const Candidate& last,
                                                                   const ModelBench& bench) const {
        const auto own_end = static_cast<std::ptrdiff_t>(model_.terms.size());
        const auto resists = [](const Term& term) { return term.effect->resists; };
        Candidate open = last;
        const auto found = open.open.terms.begin() + own_end;
        if (!std::any_of(open.open.terms.begin(), found, resists) ||
            !std::any_of(found, open.open.terms.end(), resists))
            return {};
        for (auto term = found; term != open.open.terms.end(); ++term)
            if (resists(*term)) term->values.assign(term->values.size(), std::nullopt);
        return bench.settled(open).values;
    }

    void finish(const Candidate& last, const std::vector<double>& values) {
        told_.model = last.stated;
        tell_places(told_, model_.terms.size());
        name_findings(told_, rules_);
        for (const Fault& fault : told_.faults) {
            told_.model.terms.push_back(fault.term);
            told_.named.emplace_back(fault.term.effect->name);
        }
        told_.samples_used = whole_.c.used();
        const Case before = whole_.less(told_.baseline, as_given(model_, whole_, rules_), rules_);
        const Case after = whole_.less(sensed_, values, rules_);
        told_.residual_before_nm = left_of(before, told_.baseline);
        told_.residual_after_nm = left_of(after, told_.model);
        told_.beside_given_nm = after.torque_nm;
        const GapCase log{before, after};
        if (other_) {
            const Case other_before = other_->less(told_.baseline, as_given(model_, *other_, rules_), rules_);
            const Case other_after = other_->less(sensed_, values, rules_);
            const GapCase other{other_before, other_after};
            measure_gap(told_, log, &other, rules_);
        } else {
            measure_gap(told_, log, nullptr, rules_);
        }
        told_.verdict = verdict_of(told_);
        told_.evaluations = work_.spent() * Work::unit_samples / static_cast<double>(whole_.c.size());
    }

    Model model_;
    const DiagnosisOptions& options_;
    const DiagnosisRules& rules_;
    Work work_;
    std::vector<const Effect*> effects_;
    GivenLog whole_;
    std::optional<GivenLog> other_;
    Model
        sensed_;  ///< the user's effects, fitted, and what was found of the sensor: it acts on what is given
    Diagnosis told_;
};

}  // namespace

Diagnosis diagnose_given(const Model& model, const TraceView& log, const TraceView* validation,
                         const DiagnosisOptions& options) {
    check_rows(options.given, log.size(), "the log");
    if (validation != nullptr) {
        if (options.validation_given.size() != options.given.size())
            raise<UsageError>("{} terms are given for the log and {} for the validation log",
                              options.given.size(), options.validation_given.size());
        check_rows(options.validation_given, validation->size(), "the validation log");
    }
    return GivenDiagnosis(model, log, validation, options).run(log.has_position());
}

}  // namespace ripplenotch
