// SPDX-License-Identifier: MIT
// Ripple that is next to nothing at rest has the amplitude of a speed at which the log tells it.
#include "diagnose/search/search_starts.hpp"

#include <algorithm>
#include <cmath>

#include "bench_fixture.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using namespace ripplenotch::fixture;

namespace {

// A model that was found: ripple is open, the change of it has a price.
Candidate candidate(const Model& stated) {
    Candidate found;
    found.stated = stated;
    found.open = opened(stated);
    found.prices.assign(stated.terms.size(), 0.0);
    found.prices.back() = 40.0;
    return found;
}

Candidate restated(Candidate model) {
    state_where_told(model, along_tour());
    return model;
}

double value(const Candidate& model, std::size_t term, std::string_view name) {
    const Term& there = model.stated.terms[term];
    return there.values[*find_parameter(*there.effect, name)].value_or(0.0);
}

double from_of(const Candidate& model) { return value(model, model.stated.terms.size() - 1, "from_deg_s"); }

double largest_change_nm(const Model& a, const Model& b) {
    const auto one = predict_nm(a, along_tour().motion), other = predict_nm(b, along_tour().motion);
    double most = 0.0;
    for (std::size_t k = 0; k < one.size(); ++k) most = std::max(most, std::abs(one[k] - other[k]));
    return most;
}

constexpr std::string_view steep = "ripple-speed-dependence,gain_percent=3000,exponent=2",
                           gentle = "ripple-speed-dependence,gain_percent=60,exponent=1";

}  // namespace

TEST_CASE("the usual speed is that of the moving rows, in two digits") {
    const double usual_deg_s = usual_speed_deg_s(along_tour());
    CHECK(usual_deg_s > 50.0);
    CHECK(usual_deg_s <= 110.0);
    CHECK(usual_deg_s == std::round(usual_deg_s));
    Case resting = along_tour();
    resting.motion.velocity_deg_s.assign(resting.size(), 0.0);
    CHECK(usual_speed_deg_s(resting) == 0.0);
}

TEST_CASE("ripple that is next to nothing at rest is stated from the usual speed, and its torque stays") {
    const Candidate before = candidate(joint_with({steep})), after = restated(before);
    const double usual_deg_s = usual_speed_deg_s(along_tour());
    CHECK(from_of(after) == usual_deg_s);
    CHECK(after.open.terms.back().values[*after.open.terms.back().effect->stated_from] == usual_deg_s);
    CHECK(!after.open.terms.back().values[0]);
    const double there = 1.0 + 30.0 * portable::pow(usual_deg_s / 100.0, 2.0);
    CHECK(value(after, 1, "amplitude_nm") == Approx(0.7 * there));
    CHECK(value(after, 3, "gain_percent") == Approx(100.0 * (1.0 - 1.0 / there)));
    CHECK(largest_change_nm(before.stated, after.stated) < 1e-10);
}

TEST_CASE("ripple that is there at rest has its amplitude there, and comes back to it") {
    CHECK(from_of(restated(candidate(joint_with({gentle})))) == 0.0);
    const Candidate from_speed =
        candidate(joint_with({"ripple-speed-dependence,gain_percent=40,exponent=1,from_deg_s=50"}));
    const Candidate after = restated(from_speed);
    CHECK(from_of(after) == 0.0);
    CHECK(largest_change_nm(from_speed.stated, after.stated) < 1e-10);
}

TEST_CASE("one order alone changes one ripple term alone") {
    const Candidate before =
        candidate(joint_with({"ripple-speed-dependence,gain_percent=3000,exponent=2,order=2"}));
    const Candidate after = restated(before);
    CHECK(from_of(after) > 0.0);
    CHECK(value(after, 1, "amplitude_nm") == 0.7);
    CHECK(value(after, 2, "amplitude_nm") > 0.7);
    CHECK(largest_change_nm(before.stated, after.stated) < 1e-10);
}

TEST_CASE("what the user stated stays as it was stated") {
    // The change of the ripple itself.
    Candidate own = candidate(joint_with({steep}));
    own.prices.back() = 0.0;
    CHECK(restated(own).stated == own.stated);
    // An amplitude of one of the ripples that it changes.
    Candidate fixed = candidate(joint_with({steep}));
    fixed.open.terms[2] = fixed.stated.terms[2];
    CHECK(restated(fixed).stated == fixed.stated);
}

TEST_CASE("ripple that is nothing at rest has a name and a gain that the log tells") {
    // An error of the gear's angle, the motor held.
    const Model truth = joint_with({"resonance,frequency_hz=45,damping=0.1,direct=1,direct_phase_deg=180"});
    const Diagnosis diagnosis = diagnose(opened(joint()), logged(truth, tour(), 81).view(), nullptr);
    const auto swells = [](const Finding& f) { return f.term.effect->name == "ripple-speed-dependence"; };
    const auto there = std::ranges::find_if(diagnosis.rounds, swells);
    REQUIRE(there != diagnosis.rounds.end());
    const Finding& found = *there;
    CHECK(found.status == FindingStatus::confirmed);
    REQUIRE(!found.values.empty());
    CHECK(found.values[0].value == Approx(100.0).margin(3.0));
    REQUIRE(found.values[0].standard_error);
    CHECK(*found.values[0].standard_error < 2.0);
    const double relative_error = *found.values[0].standard_error / std::abs(found.values[0].value);
    CHECK(relative_error < 0.02);
}
