// SPDX-License-Identifier: MIT
// Beside an arm: a delay and a lag of the sensor, which act on what is given too, and an offset of its zero.
#include <algorithm>
#include <cmath>
#include <limits>

#include "diagnose_fixture.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/model/motion.hpp"
#include "support/catch.hpp"

namespace ripplenotch {
namespace {

using fixture::model_of;
using fixture::strokes;

double other_deg(double t) {
    return 40.0 * portable::sin_degrees(360.0 * 0.13 * t + 20.0) +
           25.0 * portable::sin_degrees(360.0 * 0.31 * t);
}

// Weight along and across, and inertia: a unit of each. Another joint of the arm turns too.
std::vector<GivenTerm> arm() {
    const Motion& motion = strokes();
    GivenTerm term{"arm", {{}, {}, {}}, {0.0, 0.0, 0.0}, {100.0, 100.0, 10.0}};
    for (std::size_t k = 0; k < motion.size(); ++k) {
        const double angle_deg = motion.position_deg[k] + other_deg(motion.time_s[k]);
        term.torque_nm[0].push_back(portable::cos_degrees(angle_deg));
        term.torque_nm[1].push_back(portable::sin_degrees(angle_deg));
        term.torque_nm[2].push_back(motion.acceleration_deg_s2[k] / degrees_per_radian);
    }
    return {term};
}

std::vector<double> arms_torque(const std::vector<GivenTerm>& given, const std::vector<double>& values) {
    std::vector<double> sum(given[0].torque_nm[0].size(), 0.0);
    for (std::size_t c = 0; c < values.size(); ++c) {
        for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += values[c] * given[0].torque_nm[c][k];
    }
    return sum;
}

// The ripple that the user knows, what is hidden, and an arm of 12, 3 Nm and 0.4 kgm2, all behind the sensor.
Trace measured(std::initializer_list<const char*> hidden, std::uint64_t seed) {
    Model truth = model_of(
        {"ripple,order=1,amplitude_nm=0.3,phase_deg=40", "ripple,order=2,amplitude_nm=0.5,phase_deg=-70"});
    for (const char* term : hidden) truth.terms.push_back(parse_term(term));
    Trace log = fixture::logged(truth, strokes(), seed);
    std::vector<double> of_arm = arms_torque(arm(), {12.0, 3.0, 0.4});
    of_arm = sensed_nm(truth, strokes(), std::move(of_arm));
    for (std::size_t k = 0; k < of_arm.size(); ++k) log.torque_nm[k] += of_arm[k];
    return log;
}

Diagnosis diagnosed(const Trace& log) {
    return diagnose(model_of({"ripple,order=1", "ripple,order=2"}), log.view(), nullptr, {.given = arm()});
}

std::string told_with_values(const Diagnosis& diagnosis) {
    std::string text = std::string(verdict_name(diagnosis.verdict)) + "\n";
    for (const Finding& finding : diagnosis.rounds) {
        text += std::string(finding.term.effect->name) + " " + std::string(status_name(finding.status)) +
                " " + finding.reason;
        for (const FittedValue& value : finding.values)
            text += " " + std::to_string(value.value) +
                    (value.ci95 ? " [" + std::to_string(value.ci95->low) + ", " +
                                      std::to_string(value.ci95->high) + "]"
                                : "");
        text += "\n";
    }
    return text;
}

std::vector<std::string> named(const Diagnosis& diagnosis) {
    std::vector<std::string> names = diagnosis.named;
    std::sort(names.begin(), names.end());
    return names;
}

const Finding& finding_of(const Diagnosis& diagnosis, std::string_view effect) {
    return *std::find_if(diagnosis.rounds.begin(), diagnosis.rounds.end(),
                         [&](const Finding& finding) { return finding.term.effect->name == effect; });
}

void check_holds(const FittedValue& value, double truth) {
    REQUIRE(value.ci95);
    CHECK(value.ci95->low <= truth);
    CHECK(value.ci95->high >= truth);
}

}  // namespace

TEST_CASE("a torque taken through a model's sensors is the model's own torque with them") {
    const Model plain = model_of(
        {"ripple,order=2,amplitude_nm=0.5,phase_deg=10", "viscous-friction,coefficient_nm_per_deg_s=0.01"});
    for (const char* sensor : {"delay,delay_s=0.0037", "delay,delay_s=-0.002", "lag,time_constant_s=0.006"}) {
        Model with = plain;
        with.terms.push_back(parse_term(sensor));
        CHECK(sensed_nm(with, strokes(), predict_nm(plain, strokes())) == predict_nm(with, strokes()));
    }
}

TEST_CASE("beside an arm nothing is named where nothing is hidden") {
    const Diagnosis found = diagnosed(measured({}, 11));
    INFO(told_with_values(found));
    CHECK(found.named.empty());
    CHECK(found.verdict == DiagnosisVerdict::matches);
}

TEST_CASE("a delay acts on the arm's torque as well, and is told with its time") {
    for (const double delay_s : {0.0062, -0.0045}) {
        const std::string term = "delay,delay_s=" + std::to_string(delay_s);
        const Diagnosis found = diagnosed(measured({term.c_str()}, 12));
        INFO(told_with_values(found));
        REQUIRE(named(found) == std::vector<std::string>{"delay"});
        check_holds(finding_of(found, "delay").values[0], delay_s);
        // A tenth of a millisecond of the arm's fastest change is less than the noise.
        CHECK(finding_of(found, "delay").values[0].value == Approx(delay_s).margin(1e-4));
        CHECK(found.gap.after_nm < 1.05 * found.gap.noise_floor_nm);
    }
}

TEST_CASE("a delay does not hide friction beside it") {
    const Diagnosis found =
        diagnosed(measured({"delay,delay_s=0.005", "coulomb-friction,torque_nm=0.8,width_deg_s=0.5"}, 13));
    INFO(told_with_values(found));
    CHECK(named(found) == std::vector<std::string>{"coulomb-friction", "delay"});
    check_holds(finding_of(found, "delay").values[0], 0.005);
}

TEST_CASE("a lag is told from a delay by what it makes of the ripple") {
    const Diagnosis found = diagnosed(measured({"lag,time_constant_s=0.005"}, 14));
    INFO(told_with_values(found));
    REQUIRE(named(found) == std::vector<std::string>{"lag"});
    check_holds(finding_of(found, "lag").values[0], 0.005);
}

TEST_CASE("an offset beside an arm is a finding with its interval, and with friction it is one of two") {
    const Diagnosis alone = diagnosed(measured({"offset,torque_nm=0.4"}, 15));
    INFO(told_with_values(alone));
    REQUIRE(named(alone) == std::vector<std::string>{"offset"});
    check_holds(finding_of(alone, "offset").values[0], 0.4);
    const Diagnosis both =
        diagnosed(measured({"offset,torque_nm=-0.6", "coulomb-friction,torque_nm=0.8,width_deg_s=0.5"}, 16));
    INFO(told_with_values(both));
    CHECK(named(both) == std::vector<std::string>{"coulomb-friction", "offset"});
}

TEST_CASE("where the arm may hold a constant torque there is no offset to be told") {
    const Trace log = measured({"offset,torque_nm=0.4"}, 17);
    std::vector<GivenTerm> given = arm();
    given[0].torque_nm.emplace_back(strokes().size(), 1.0);
    given[0].mean.push_back(0.0);
    given[0].deviation.push_back(100.0);
    const Diagnosis found =
        diagnose(model_of({"ripple,order=1", "ripple,order=2"}), log.view(), nullptr, {.given = given});
    INFO(told_with_values(found));
    CHECK(found.named.empty());
    CHECK(found.gap.after_nm < 1.05 * found.gap.noise_floor_nm);
}

TEST_CASE("the residual is what the improved model, its sensor and the arm leave") {
    const Trace log = measured({"delay,delay_s=0.005", "offset,torque_nm=0.5"}, 18);
    const Diagnosis found = diagnosed(log);
    INFO(told_with_values(found));
    REQUIRE(named(found) == std::vector<std::string>{"delay", "offset"});
    std::vector<double> values;
    for (const GivenValue& value : found.given) {
        if (value.name == "arm") values.push_back(value.value);
    }
    std::vector<double> of_arm = arms_torque(arm(), values);
    of_arm = sensed_nm(found.model, strokes(), std::move(of_arm));
    Motion motion = motion_along(log.view(), default_smoothing);
    const std::vector<double> own = predict_nm(found.model, motion);
    double worst = 0.0;
    for (std::size_t k = 0; k < own.size(); ++k)
        worst = std::max(worst, std::abs(log.torque_nm[k] - own[k] - of_arm[k] - found.residual_after_nm[k]));
    // Sums of some tens of newton-metres, added up in another order.
    CHECK(worst < 1e-9);
}

}  // namespace ripplenotch

// What users have: a simulation of a whole arm beside a log of one joint, with a payload that is 3 % off, and
// friction and ripple that the simulation does not know.

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
