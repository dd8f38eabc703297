// SPDX-License-Identifier: MIT
// A curve of friction that the catalogue does not have is not named after the nearest that it has.
#include <algorithm>
#include <cmath>

#include "bench_fixture.hpp"
#include "diagnose/judging/judge.hpp"
#include "diagnose/search/search.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using namespace ripplenotch::fixture;

namespace {

Diagnosis diagnosed_with_power(double power) {
    Trace log = logged(joint(), coarse_tour(), 61);
    const auto& velocity_deg_s = coarse_tour().velocity_deg_s;
    for (std::size_t k = 0; k < log.size(); ++k)
        log.torque_nm[k] +=
            std::copysign(0.6 * std::pow(std::abs(velocity_deg_s[k]) / 130.0, power), velocity_deg_s[k]);
    return diagnose(opened(joint()), log.view(), nullptr);
}

bool names_a_curve(const Diagnosis& found) {
    return std::any_of(found.named.begin(), found.named.end(), [](const std::string& name) {
        return name == "viscous-friction" || name == "quadratic-viscous-friction";
    });
}

const std::vector<const Effect*>& curves() {
    static const std::vector<const Effect*> effects = {&find_effect("viscous-friction"),
                                                       &find_effect("quadratic-viscous-friction")};
    return effects;
}

// Of quadratic friction in a log that holds a tone besides, which the model does not.
Finding judged_beside_a_tone(const std::vector<ResidualRegion>& unexplained, double& left) {
    const char* friction = "quadratic-viscous-friction,coefficient_nm_per_deg2_s2=2e-5";
    DiagnosisRules rules;
    rules.judge.rival_gain = 0.1;  // every rival is looked at
    TestBench on(
        case_of(plain_log(joint_with({friction, "tone,frequency_hz=37,amplitude_nm=0.06,phase_deg=10"}), 62)),
        rules);
    const Candidate model = on.fitted(joint_with({friction}));
    left = model.gain_left - on.bench.samples();
    return judge(on.bench, model, 3, curves(), unexplained).at(0);
}

std::size_t loops_left(double material_sigma) {
    DiagnosisRules rules;
    rules.judge.material_sigma = material_sigma;
    const Model truth =
        joint_with({"hysteresis,torque_nm=0.8,width_deg=2", "hysteresis,torque_nm=0.1,width_deg=12"});
    TestBench on(case_of(plain_log(truth, 63)), rules);
    std::vector<RefusedCandidate> refused;
    const Candidate last = search(on.bench, on.fitted(truth), 3, curves(), refused);
    return static_cast<std::size_t>(
        std::count_if(last.stated.terms.begin(), last.stated.terms.end(),
                      [](const Term& term) { return term.effect->name == std::string_view("hysteresis"); }));
}

}  // namespace

TEST_CASE("friction that grows with another power of the speed is none of the two that are listed") {
    for (const double power : {2.5, 3.0}) {
        const Diagnosis found = diagnosed_with_power(power);
        CAPTURE(power);
        CHECK_FALSE(names_a_curve(found));
        CHECK(found.verdict != DiagnosisVerdict::explained);
    }
    CHECK(names_a_curve(diagnosed_with_power(2.0)));
}

TEST_CASE("where something is left a curve has to be ahead of another by more than that") {
    double left = 0.0;
    const Finding alone = judged_beside_a_tone({}, left);
    const Finding beside = judged_beside_a_tone({ResidualRegion{}}, left);
    REQUIRE(left > 1000.0);
    REQUIRE(!alone.alternatives.empty());
    REQUIRE(!beside.alternatives.empty());
    CHECK(alone.alternatives[0].margin > left);
    CHECK(beside.alternatives[0].margin == Approx(alone.alternatives[0].margin - left));
}

TEST_CASE("a second term of one name that changes next to nothing goes, and a material one stays") {
    CHECK(loops_left(0.12) == 2);
    CHECK(loops_left(4.0) == 1);
}
