// SPDX-License-Identifier: MIT
// A prediction that is asked for a change answers what two whole predictions would, for every effect of the
// catalogue.
#include "ripplenotch/model/prediction.hpp"

#include <vector>

#include "effects_fixture.hpp"
#include "model/catalogue.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using namespace ripplenotch::fixture;

namespace {

// Torques of 3 Nm, summed in another order.
constexpr double rounding_nm = 1e-9;

std::vector<Model> models() {
    Model sensed = base_model(), loaded = base_model(), changed = base_model();
    sensed.terms.push_back(parse_term("lag,time_constant_s=0.004"));
    loaded.terms.push_back(parse_term("load-friction,torque_nm=0.2,exponent=0.7,width_deg_s=1"));
    changed.terms.push_back(parse_term("resonance,frequency_hz=40,damping=0.2"));
    changed.terms.push_back(parse_term("coulomb-friction,torque_nm=0.4,width_deg_s=1"));
    Model elastic = base_model();
    elastic.terms.push_back(parse_term("coulomb-friction,torque_nm=0.4,width_deg_s=1"));
    elastic.terms.push_back(parse_term("resonance,frequency_hz=15,damping=0.2,whole=1"));
    return {base_model(), sensed, loaded, elastic, changed};
}

std::vector<Term> tried_terms() {
    std::vector<Term> terms;
    for (const Effect* effect : catalogue()) {
        if (effect->chance) continue;
        const std::vector<double> values = active_values(*effect);
        terms.push_back({effect, {values.begin(), values.end()}});
    }
    terms.push_back(parse_term("resonance,frequency_hz=12,damping=0.1,whole=1"));
    return terms;
}

Model appended(Model model, const Term& term) {
    model.terms.push_back(term);
    return model;
}

}  // namespace

TEST_CASE("a term that is appended to a prediction gives the torque of a whole prediction") {
    const Motion& motion = rich_motion();
    for (const Model& model : models()) {
        for (const bool kept : {false, true}) {
            Carriers carriers;
            const Prediction before(model, motion, kept ? &carriers : nullptr);
            for (const Term& term : tried_terms()) {
                const std::vector<double> expected = predict_nm(appended(model, term), motion);
                const Prediction with = before.with(term);
                INFO(term.effect->name << " beside " << model.terms.back().effect->name);
                CHECK(with.model().terms.size() == model.terms.size() + 1);
                CHECK(largest_difference(with.torque_nm(), expected) < rounding_nm);
                std::vector<double> added = before.added(term);
                for (std::size_t k = 0; k < added.size(); ++k) added[k] += before.torque_nm()[k];
                CHECK(largest_difference(added, expected) < rounding_nm);
                // Behind a prediction its motion stays as it is.
                const auto behind = before.behind(term, before.torque_nm());
                if (behind && !term.effect->whole) CHECK(largest_difference(*behind, expected) < rounding_nm);
            }
        }
    }
}

TEST_CASE("a prediction with a term appended answers changes as a whole prediction does") {
    const Motion& motion = rich_motion();
    const Model model = models().back();
    Carriers carriers;
    const Prediction before(model, motion, &carriers);
    for (const Term& term : tried_terms()) {
        if (!term.effect->linear_in_torque) continue;
        const Prediction with = before.with(term), whole(appended(model, term), motion);
        for (std::size_t place = 0; place < model.terms.size(); ++place) {
            Term other = model.terms[place];
            other.values[other.effect->ripple_order ? 1 : 0] =
                1.3 * *other.values[other.effect->ripple_order ? 1 : 0];
            INFO(term.effect->name << ", change of " << other.effect->name);
            CHECK(largest_difference(with.changed(place, other), whole.changed(place, other)) < rounding_nm);
        }
    }
}

TEST_CASE("a change of the ripple or of the gear ratio leaves the other terms alone, and only these do") {
    const Motion& motion = rich_motion();
    const Prediction plain(models()[0], motion), loaded(models()[2], motion);
    std::size_t left_alone = 0;
    for (const Term& term : tried_terms()) {
        const Effect& effect = *term.effect;
        const bool ripple_alone =
            effect.name == "gear-ratio" || (side_of(term) == Side::ripple && !effect.uses_load);
        INFO(effect.name);
        CHECK(plain.with(term).has_only_ripple_anew() == ripple_alone);
        CHECK_FALSE(loaded.with(term).has_only_ripple_anew());
        left_alone += ripple_alone ? 1 : 0;
    }
    CHECK(left_alone >= 4);
}

TEST_CASE("only a sensor's effect that nothing comes after is behind a prediction") {
    const Motion& motion = rich_motion();
    Model cut = base_model();
    cut.terms.push_back(parse_term("saturation,limit_nm=1"));
    const Prediction open(base_model(), motion), converted(cut, motion);
    for (const Term& term : tried_terms()) {
        INFO(term.effect->name);
        CHECK(open.behind(term, open.torque_nm()).has_value() == (side_of(term) == Side::sensor));
        CHECK_FALSE(converted.behind(term, converted.torque_nm()).has_value());
    }
}
