// SPDX-License-Identifier: MIT
// What users have: a simulation of a whole arm beside a log of one joint, with a payload that is 3 % off, and
// friction and ripple that the simulation does not know.

#include <algorithm>
#include <cmath>
#include <limits>

#include "diagnose_fixture.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "support/catch.hpp"

namespace ripplenotch {
namespace {

using fixture::strokes;

// The weight of a link that another joint turns, and what it takes to move it: no effect of this joint's own.
std::vector<double> arm_nm(double payload) {
    const Motion& motion = strokes();
    std::vector<double> torque;
    for (std::size_t k = 0; k < motion.size(); ++k) {
        const double t = motion.time_s[k];
        const double other_deg = 40.0 * portable::sin_degrees(360.0 * 0.13 * t + 20.0) +
                                 25.0 * portable::sin_degrees(360.0 * 0.31 * t);
        const double load = 30.0 + 50.0 * payload;
        torque.push_back(load * portable::cos_degrees(motion.position_deg[k] + other_deg) +
                         0.01 * load * motion.acceleration_deg_s2[k] / degrees_per_radian);
    }
    return torque;
}

Trace measured(std::uint64_t seed) {
    Model truth{GearRatio(100.0), {}};
    for (const char* term :
         {"coulomb-friction,torque_nm=0.9,width_deg_s=1", "viscous-friction,coefficient_nm_per_deg_s=0.012",
          "ripple,order=2,amplitude_nm=0.3,phase_deg=40"})
        truth.terms.push_back(parse_term(term));
    Trace log = fixture::logged(truth, strokes(), seed);
    const std::vector<double> arm = arm_nm(1.03);
    for (std::size_t k = 0; k < arm.size(); ++k) log.torque_nm[k] += arm[k];
    return log;
}

std::string told(const Diagnosis& diagnosis) {
    std::string text = std::string(verdict_name(diagnosis.verdict)) + "\n";
    for (const Finding& finding : diagnosis.rounds)
        text += std::string(finding.term.effect->name) + " " + std::string(status_name(finding.status)) +
                " " + finding.reason + "\n";
    return text;
}

constexpr double any_scale = std::numeric_limits<double>::infinity();

const Finding& found_effect(const Diagnosis& diagnosis, const char* name) {
    const auto found = std::ranges::find_if(diagnosis.rounds, [name](const Finding& finding) {
        return finding.term.effect->name == std::string_view(name);
    });
    REQUIRE(found != diagnosis.rounds.end());
    return *found;
}

void check_interval(const FittedValue& value, double truth) {
    REQUIRE(value.ci95);
    CHECK(value.ci95->low < truth);
    CHECK(value.ci95->high > truth);
    CHECK(value.value == Approx(truth).margin(0.5));
}

bool names(const Diagnosis& diagnosis, const char* name) {
    return std::find(diagnosis.named.begin(), diagnosis.named.end(), name) != diagnosis.named.end();
}

}  // namespace

TEST_CASE("measured minus simulated torque with a payload 3 % off has no name that is false") {
    Trace log = measured(1);
    const std::vector<double> simulation = arm_nm(1.0);
    for (std::size_t k = 0; k < simulation.size(); ++k) log.torque_nm[k] -= simulation[k];
    const Diagnosis found = diagnose({GearRatio(100.0), {}}, log.view(), nullptr);
    INFO(told(found));
    for (const std::string& name : found.named)
        CHECK((name == "coulomb-friction" || name == "viscous-friction" || name == "ripple"));
    CHECK(found.verdict != DiagnosisVerdict::matches);
    CHECK(found.remaining);
}

TEST_CASE("the simulation as a given term: the same names, its scale, and what the payload leaves") {
    const Trace log = measured(2), other = measured(3);
    const std::vector<GivenTerm> given = {{"simulated", {arm_nm(1.0)}, {1.0}, {any_scale}}};
    const Diagnosis found = diagnose({GearRatio(100.0), {}}, log.view(), nullptr, {.given = given});
    INFO(told(found));
    std::vector<std::string> named = found.named;
    std::sort(named.begin(), named.end());
    CHECK(named == std::vector<std::string>{"coulomb-friction", "ripple", "viscous-friction"});
    // 1.9 % are within what a simulation is known to.
    CHECK(found_effect(found, "simulation-scale").status == FindingStatus::correction);
    // A payload of 3 % is (30 + 51.5) / (30 + 50) of this arm's torque.
    check_interval(found_effect(found, "simulation-scale").values[0], 1.875);
    CHECK(found.gap.after_nm < 0.5 * found.gap.before_nm);
    const TraceView view = other.view();
    CHECK_THROWS_AS(diagnose({GearRatio(100.0), {}}, log.view(), &view, {.given = given}), UsageError);
    const Diagnosis twice =
        diagnose({GearRatio(100.0), {}}, log.view(), &view, {.given = given, .validation_given = given});
    CHECK(*twice.gap.validation_after_nm < 0.5 * *twice.gap.validation_before_nm);
}

TEST_CASE("a simulation in other units shows in its scale, stated or not") {
    Trace log = measured(4);
    std::vector<GivenTerm> given = {{"simulated", {arm_nm(1.03)}, {1.0}, {any_scale}}};
    for (double& value : given[0].torque_nm[0]) value /= 0.9;
    const Diagnosis found = diagnose({GearRatio(100.0), {}}, log.view(), nullptr, {.given = given});
    check_interval(found_effect(found, "simulation-scale").values[0], -10.0);
    given[0].deviation[0] = stated_deviation;
    // A scale that is stated is known to 2 %: ten per cent are missing.
    const Diagnosis stated = diagnose({GearRatio(100.0), {}}, log.view(), nullptr, {.given = given});
    CHECK(names(stated, "simulation-scale"));
    check_interval(found_effect(stated, "simulation-scale").values[0], -10.0);
}

}  // namespace ripplenotch
