// SPDX-License-Identifier: MIT
#include "diagnose/beside/beside.hpp"

#include <algorithm>
#include <cmath>

#include "core/vectors/dot.hpp"
#include "diagnose/beside/other_log.hpp"
#include "diagnose/doubt.hpp"
#include "diagnose/place.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/model/prediction.hpp"

namespace ripplenotch {
namespace {

Finding finding_of(const Lens& lens, BesideFinding found) {
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

// Its torque along the log, and where that acts.
void measure(Finding& finding, const Lens& lens, const Model& beside) {
    const Case& c = lens.looked_at();
    const auto torque_nm = Prediction(beside, c.motion).added(finding.term);
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

}  // namespace

BesideOutcome find_beside(const GivenCase& log, const GivenCase* validation, const Candidate& model,
                          std::span<const Effect* const> effects, const DiagnosisRules& rules, Work& work) {
    const Lens lens(log.looked_at, model, log.given, effects, rules, work);
    Sums sums(lens);
    NamedBeside named = named_beside(sums, {catalogue().size(), log.given.empty()});
    std::vector<OtherLeft> other(named.findings.size());
    if (validation != nullptr) other = withdraw_on_other(sums, model, *validation, named.findings);
    const Believed believed = believed_of(sums, named.findings);
    BesideOutcome outcome;
    for (std::size_t i = 0; i < named.findings.size(); ++i) {
        Finding finding = finding_of(lens, named.findings[i]);
        const auto place = std::find(believed.place.begin(), believed.place.end(), i);
        const bool stays = place != believed.place.end();
        set_values(finding, stays ? believed.values[static_cast<std::size_t>(place - believed.place.begin())]
                                  : values_beside(sums, {named.findings[i].shape})[0]);
        measure(finding, lens, model.stated);
        if (other[i].without_nm > 0.0) {
            finding.validation_before_nm = other[i].without_nm;
            finding.validation_after_nm = other[i].with_nm;
        }
        if (stays) outcome.believed.push_back(finding.term);
        outcome.findings.push_back(std::move(finding));
    }
    std::stable_partition(outcome.findings.begin(), outcome.findings.end(),
                          [](const Finding& finding) { return !is_doubtful(finding); });
    std::vector<double> explained(lens.open_nm().size(), 0.0);
    const Prediction beside(model.stated, lens.looked_at().motion);
    for (const Term& term : outcome.believed) {
        const auto torque_nm = beside.added(term);
        add_scaled(1.0, torque_nm.data(), explained.data(), explained.size());
    }
    outcome.given_values = lens.plain_values(explained);
    outcome.given_values.resize(lens.columns().stated);
    if (!log.given.empty() && lens.columns().given <= 2) outcome.given_errors = errors_of_given(lens);
    return outcome;
}

}  // namespace ripplenotch
