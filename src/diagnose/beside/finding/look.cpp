// SPDX-License-Identifier: MIT
#include "diagnose/beside/finding/look.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "core/vectors/dot.hpp"
#include "diagnose/beside/finding/offset.hpp"
#include "diagnose/beside/naming/ringing.hpp"
#include "diagnose/case/place.hpp"
#include "diagnose/judging/doubt.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/model/prediction.hpp"

namespace ripplenotch {
namespace {

Finding finding_beside(const Lens& lens, BesideFinding found) {
    Finding finding;
    finding.term = found.shape.term;
    finding.status = found.status;
    finding.reason = std::move(found.reason);
    finding.decisions = std::move(found.decisions);
    finding.size_uncertain = true;
    finding.evidence.gain = found.gain.gain;
    finding.evidence.price = found.price;
    finding.evidence.elsewhere = found.gain.without_best(1) / std::max(found.gain.gain, 1e-300);
    OutOfFold& outside = finding.out_of_fold.emplace();
    outside.gain = found.gain.gain;
    outside.t = found.gain.t;
    outside.blocks = lens.ground().blocks().size();
    outside.blocks_positive = found.gain.positive();
    outside.evenness = found.same.uneven;
    if (found.rival) {
        outside.rival = found.rival->term.effect->name;
        outside.rival_margin = found.rival_margin;
        finding.alternatives.push_back({outside.rival, found.rival_margin});
    }
    return finding;
}

void set_values(Finding& finding, const BesideValues& values) {
    finding.term = values.term;
    finding.values = values.values;
}

// Where its torque acts along the log, and how large that is.
void measure_torque(Finding& finding, const Lens& lens, const std::vector<double>& torque_nm) {
    const Case& c = lens.looked_at();
    finding.where = place_of(c, torque_nm, finding.term, lens.rules().place);
    double sum = 0.0, square = 0.0;
    for (std::size_t k = 0; k < c.size(); ++k) {
        sum += c.use[k] != 0 ? torque_nm[k] : 0.0;
        square += c.use[k] != 0 ? torque_nm[k] * torque_nm[k] : 0.0;
    }
    const auto samples = static_cast<double>(std::max<std::size_t>(c.used(), 1));
    finding.evidence.own_nm = std::sqrt(square / samples);
    finding.evidence.share_nm = std::sqrt(std::max(square / samples - sum / samples * (sum / samples), 0.0));
}

// Of the given values, from the whitened log with the names taken out.
std::vector<double> errors_of_given(const Lens& lens) {
    std::vector<double> errors;
    const AlwaysOn& columns = lens.columns();
    std::vector<std::vector<double>> white;
    for (std::size_t i = 0; i < columns.of_model; ++i)
        white.push_back(lens.ground().whitened(lens.ground().bridged(columns.torque_nm[i])));
    for (std::size_t i = 0; i < columns.stated; ++i) {
        std::vector<std::vector<double>> others;
        std::vector<double> deviation;
        for (std::size_t other = 0; other < white.size(); ++other) {
            if (other == i) continue;
            others.push_back(white[other]);
            deviation.push_back(columns.deviation[other]);
        }
        const auto own = Ridge(others, deviation, lens.sigma()).left(white[i]);
        // The log and what is known before it: a value that is stated has next to no error.
        const double by_log = std::sqrt(dot(own.data(), own.data(), own.size())) /
                              (lens.rules().beside.interval_factor * lens.sigma());
        errors.push_back(1.0 / portable::hypot(by_log, 1.0 / columns.deviation[i]));
    }
    return errors;
}

std::vector<double> sum_of(const std::vector<BesideValues>& believed, const Model& model,
                           const Motion& motion) {
    std::vector<double> sum(motion.size(), 0.0);
    for (const BesideValues& values : believed) {
        const auto torque_nm = torque_of(values, model, motion);
        add_scaled(1.0, torque_nm.data(), sum.data(), sum.size());
    }
    return sum;
}

NamedBeside named_in(Sums& sums, const GivenCase& log, const Candidate& model,
                     std::span<const Effect* const> effects) {
    LongerLook longer(sums.lens(), model, log.given, effects);
    return named_beside(sums,
                        {catalogue().size(), log.given.empty(), &longer, is_given(log.given, "simulated")});
}

// Sharp, told, and among the frequencies that the line has.
bool is_resonance(const Lens& lens, const Shape& shape, const BesideValues& values) {
    const BesideRules& rules = lens.rules().beside;
    for (const FittedValue& value : values.ringing_values) {
        const Parameter& parameter = values.ringing->effect->parameters[value.parameter];
        if (parameter.left_out != LeftOut::fitted) continue;
        if (!value.ci95) return false;
        if (parameter.unit == "Hz" && (value.ci95->high > rules.told_ringing * value.value ||
                                       value.value > lens.bounds().fastest_hz(order_of(shape))))
            return false;
        if (parameter.unit != "Hz" && value.ci95->high > rules.sharp_damping) return false;
    }
    return true;
}

// Of a finding that is not withdrawn.
std::size_t place_in(const Look& look, const BesideFinding& found) {
    const Names& names = look.named.now.names;
    const auto place = std::find_if(names.begin(), names.end(), [&](std::size_t name) {
        return look.sums.shapes()[name] == found.shape;
    });
    return static_cast<std::size_t>(place - names.begin());
}

// What mends the form of a ripple, as a finding: a resonance where it is sharp and its frequency is told.
Finding ringing_finding(Look& look, const BesideFinding& found, const BesideValues& values) {
    const Lens& lens = look.lens;
    const Names& names = look.named.now.names;
    const std::size_t place = place_in(look, found);
    BesideFinding own = found;
    own.gain = gain_of_ringing(look.sums, names, place);
    own.price = price_of_ringing(look.sums, names[place], catalogue().size());
    own.decisions.clear();
    own.rival.reset();
    Finding finding = finding_beside(lens, own);
    finding.term = *values.ringing;
    finding.values = values.ringing_values;
    if (found.status == FindingStatus::confirmed && is_resonance(lens, found.shape, values)) return finding;
    finding.status = FindingStatus::shape_correction;
    finding.reason = fmt::format("it mends the form of {}, whose size and phase go with the speed",
                                 shape_name(found.shape));
    return finding;
}

// The catalogue's friction by load has the load of inertia and gravity. Where it grows with the other
// frictions' torque as well, as it may in a gear, what is missing keeps its sign as long as the weight does.
double load_by_friction_nm(const Look& look, const Believed& believed) {
    double by_load = 0.0, others_nm = 0.0;
    for (std::size_t i = 0; i < believed.place.size(); ++i) {
        const Effect& effect = *believed.values[i].term.effect;
        const Kind kind = kind_of(effect);
        if (effect.uses_load)
            by_load += std::abs(believed.values[i].values.front().value);
        else if (kind == Kind::friction || kind == Kind::speed)
            others_nm += look.named.findings[believed.place[i]].size_nm;
    }
    return by_load * others_nm;
}

// Above what does not matter, more than is left beside it above white noise (it may have fed on that), and
// more than twice what a friction by load may make of other frictions.
bool matters(const OffsetBeside& offset, const Look& look, const Believed& believed,
             const std::vector<double>& explained_nm) {
    const Lens& lens = look.lens;
    const double left_nm = lens.plain_left_nm(explained_nm);
    const double excess_nm = std::sqrt(std::max(left_nm * left_nm - lens.sigma() * lens.sigma(), 0.0));
    const double least_nm = std::max(material_sigma(lens.looked_at(), lens.rules()) * left_nm,
                                     2.0 * load_by_friction_nm(look, believed));
    return std::abs(offset.values.values.front().value) >= least_nm && offset.own_nm >= excess_nm;
}

// The zero of the measured torque becomes a term: with all that plain least squares still makes of it.
void adopt_offset(BesideOutcome& outcome, Finding finding, const Look& look, const Model& beside) {
    const std::size_t place = look.lens.columns().stated - 1;
    double& value = *finding.term.values.front();
    value += std::exchange(outcome.given_values[place], 0.0);
    finding.values.front().value = value;
    measure_torque(finding, look.lens, Prediction(beside, look.lens.looked_at().motion).added(finding.term));
    finding.evidence.share_nm = finding.evidence.own_nm;
    outcome.believed.push_back(finding.term);
    outcome.findings.push_back(std::move(finding));
}

}  // namespace

Look::Look(const GivenCase& log, const GivenCase* validation, const Candidate& model,
           std::span<const Effect* const> effects, const DiagnosisRules& rules, Work& work)
    : lens(log.looked_at, model, log.given, effects, rules, work),
      sums(lens),
      named(named_in(sums, log, model, effects)),
      other(named.findings.size()) {
    if (validation != nullptr) other = withdraw_on_other(sums, model, *validation, named.findings);
    withdraw_what_may_be_nothing(sums, validation == nullptr, named.findings);
}

std::vector<double> carried_beside(Look& look, const Candidate& model) {
    const std::vector<double> explained = sum_of(believed_of(look.sums, look.named.findings).values,
                                                 model.stated, look.lens.looked_at().motion);
    return carried_nm(look.lens.columns(), look.lens.plain_values(explained));
}

BesideOutcome outcome_of(Look& look, const GivenCase& log, const Candidate& model,
                         std::span<const Effect* const> effects) {
    Believed believed = believed_of(look.sums, look.named.findings);
    const Motion& motion = look.lens.looked_at().motion;
    BesideOutcome outcome;
    std::vector<Shape> shapes;
    for (std::size_t i = 0; i < look.named.findings.size(); ++i) {
        const BesideFinding& found = look.named.findings[i];
        const auto place = std::find(believed.place.begin(), believed.place.end(), i);
        const bool stays = place != believed.place.end();
        const BesideValues values =
            stays ? believed.values[static_cast<std::size_t>(place - believed.place.begin())]
                  : values_beside(look.sums, {found.shape})[0];
        Finding finding = finding_beside(look.lens, found);
        set_values(finding, values);
        const std::vector<double> torque_nm = torque_of(values, model.stated, motion);
        measure_torque(finding, look.lens, torque_nm);
        if (look.other[i].without_nm > 0.0) {
            finding.validation_before_nm = look.other[i].without_nm;
            finding.validation_after_nm = look.other[i].with_nm;
        }
        if (stays) {
            outcome.believed.push_back(finding.term);
            shapes.push_back(found.shape);
        }
        outcome.findings.push_back(std::move(finding));
        if (!stays || !values.ringing) continue;
        Finding ringing = ringing_finding(look, found, values);
        std::vector<double> more_nm = Prediction(model.stated, motion).added(values.term);
        for (std::size_t k = 0; k < more_nm.size(); ++k) more_nm[k] = torque_nm[k] - more_nm[k];
        measure_torque(ringing, look.lens, more_nm);
        outcome.believed.push_back(ringing.term);
        outcome.findings.push_back(std::move(ringing));
    }
    std::optional<OffsetBeside> offset;
    if (is_arm_alone(log.given)) offset = offset_beside(look.lens, model, effects, shapes);
    std::vector<double> explained_nm = sum_of(believed.values, model.stated, motion);
    if (offset && !matters(*offset, look, believed, explained_nm)) offset.reset();
    if (offset) {
        believed.values.push_back(offset->values);
        explained_nm = sum_of(believed.values, model.stated, motion);
    }
    outcome.given_values = look.lens.plain_values(explained_nm);
    outcome.given_values.resize(look.lens.columns().stated);
    if (offset) {
        Finding finding = finding_beside(look.lens, offset->finding);
        set_values(finding, offset->values);
        adopt_offset(outcome, std::move(finding), look, model.stated);
    }
    std::stable_partition(outcome.findings.begin(), outcome.findings.end(),
                          [](const Finding& finding) { return !is_doubtful(finding); });
    if (!log.given.empty() && look.lens.columns().given <= 2)
        outcome.given_errors = errors_of_given(look.lens);
    return outcome;
}

bool is_arm_alone(std::span<const GivenTerm> given) {
    return is_given(given, "arm") && !is_given(given, "simulated");
}

}  // namespace ripplenotch
