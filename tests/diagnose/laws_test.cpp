// SPDX-License-Identifier: MIT
// Laws of a diagnosis over the whole catalogue: an effect is under test on the day it is listed.
#include <algorithm>
#include <array>
#include <cmath>

#include "diagnose/answer/answer.hpp"
#include "diagnose_fixture.hpp"
#include "ripplenotch/core/error.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using namespace ripplenotch::fixture;

namespace {

double rms(const std::vector<double>& values) {
    double sum = 0.0;
    for (const double value : values) sum += value * value;
    return std::sqrt(sum / static_cast<double>(values.size()));
}

std::vector<double> difference(const Model& a, const Model& b) {
    auto left = predict_nm(a, tour());
    const auto right = predict_nm(b, tour());
    for (std::size_t k = 0; k < left.size(); ++k) left[k] -= right[k];
    return left;
}

// First guesses, with the size doubled until the effect stands well above the noise.
Term planted(const Effect& effect) {
    // Less than one and a half samples are corrected and not named.
    if (effect.name == "delay") return parse_term("delay,delay_s=0.006");
    Term term{&effect, {}};
    for (const Parameter& parameter : effect.parameters) {
        const bool nothing_yet = parameter.linear && parameter.start == parameter.neutral;
        term.values.emplace_back(nothing_yet ? parameter.neutral + noise_nm : parameter.start);
    }
    Model with = joint();
    with.terms.push_back(term);
    for (int doubling = 0; doubling < 12; ++doubling) {
        if (effect.chance || rms(difference(with, joint())) > 4.0 * noise_nm) break;
        for (std::size_t p = 0; p < effect.parameters.size(); ++p) {
            const Parameter& parameter = effect.parameters[p];
            auto& value = with.terms.back().values[p];
            const bool size =
                parameter.linear || (!effect.polar && parameter.start != parameter.neutral &&
                                     parameter.left_out == LeftOut::fitted && !parameter.logarithmic &&
                                     effect.side != Side::joint && effect.side != Side::converter);
            if (size) value = std::clamp(2.0 * *value, parameter.lower, parameter.upper);
        }
    }
    return with.terms.back();
}

struct Hidden {
    Model truth, model = {};
};

// The joint knows of inertia and ripple: of these, what is hidden is what the model is not told.
// What an effect changes: the joint has it, and the model knows it.
constexpr std::array<std::pair<std::string_view, std::string_view>, 6> changed = {{
    {"asymmetric-friction", "coulomb-friction,torque_nm=0.8,width_deg_s=0.2"},
    {"asymmetric-viscous-friction", "viscous-friction,coefficient_nm_per_deg_s=0.01"},
    {"backlash", "coulomb-friction,torque_nm=0.8,width_deg_s=0.2"},
    {"friction-warm-up", "coulomb-friction,torque_nm=0.8,width_deg_s=0.2"},
    {"payload-change", "gravity,amplitude_nm=6,phase_deg=20"},
    {"position-dependent-friction", "coulomb-friction,torque_nm=0.8,width_deg_s=0.2"},
}};

Hidden hide(const Effect& effect) {
    Hidden hidden{joint(), {}};
    for (const auto& [name, term] : changed)
        if (effect.name == name) hidden.truth.terms.push_back(parse_term(term));
    hidden.model = opened(hidden.truth);
    const auto own = std::find_if(hidden.truth.terms.begin(), hidden.truth.terms.end(),
                                  [&](const Term& term) { return term.effect == &effect; });
    if (own != hidden.truth.terms.end()) {
        hidden.model.terms.erase(hidden.model.terms.begin() + (own - hidden.truth.terms.begin()));
    } else {
        hidden.truth.terms.push_back(planted(effect));
    }
    return hidden;
}

}  // namespace

namespace {

// The ripple of a log with positions does not go with its velocity.
constexpr std::array<std::string_view, 1> not_told = {"velocity-bias"};

void check_named(const Effect& effect) {
    const Hidden hidden = hide(effect);
    const Trace log = logged(hidden.truth, tour(), 11);
    const Diagnosis found = diagnose(hidden.model, log.view(), nullptr);
    CAPTURE(effect.name, found.rounds.size());
    for (const Finding& finding : found.rounds) {
        UNSCOPED_INFO(finding.term.effect->name << " " << status_name(finding.status) << " "
                                                << finding.reason);
        CHECK(finding.reason.empty() == (finding.status == FindingStatus::confirmed));
    }
    CHECK(found.named == std::vector<std::string>{std::string(effect.name)});
}

}  // namespace

TEST_CASE("each effect of the catalogue, hidden in a log, is named, and no other is") {
    for (const Effect* effect : catalogue()) {
        // One acts on a simulation: sensing_test.cpp; one needs an arm: tests/cli/test_diagnose_coupled.py.
        if (effect->name != "simulation-scale" && !effect->other_joint &&
            std::ranges::find(not_told, effect->name) == not_told.end())
            check_named(*effect);
    }
}

TEST_CASE("the rest of the catalogue is named as well", "[!shouldfail]") {
    for (const std::string_view name : not_told) check_named(find_effect(name));
}

TEST_CASE("nothing hidden, nothing named: the model explains the log") {
    for (std::uint64_t seed = 21; seed < 25; ++seed) {
        const Diagnosis found = diagnose(opened(joint()), logged(joint(), tour(), seed).view(), nullptr);
        CAPTURE(seed);
        CHECK(found.named.empty());
        CHECK(found.verdict == DiagnosisVerdict::matches);
        CHECK(found.gap.noise_floor_nm == Approx(noise_nm).epsilon(0.1));
    }
}

TEST_CASE("the unit of the torque, the order of the model and the half of the log change no name") {
    Model truth = joint();
    truth.terms.push_back(parse_term("coulomb-friction,torque_nm=0.4,width_deg_s=0.2"));
    truth.terms.push_back(parse_term("ripple-modulation,output_order=1,depth_percent=45,phase_deg=70"));
    Trace log = logged(truth, coarse_tour(), 6);
    const auto named = [&](const Model& model, const TraceView& view) {
        auto names = diagnose(model, view, nullptr).named;
        std::sort(names.begin(), names.end());
        return names;
    };
    const std::vector<std::string> both = {"coulomb-friction", "ripple-modulation"};
    CHECK(named(opened(joint()), log.view()) == both);
    CHECK(named(opened(joint()), log.view().part(0, log.size() / 2)) == both);
    CHECK(named(opened(joint()), log.view().part(log.size() / 2, log.size() / 2)) == both);
    Model reversed = opened(joint());
    std::reverse(reversed.terms.begin(), reversed.terms.end());
    for (double& torque : log.torque_nm) torque *= 1000.0;
    CHECK(named(reversed, log.view()) == both);
}

TEST_CASE("each name closes part of the gap, and taken out again it opens its share") {
    Model truth = joint();
    truth.terms.push_back(parse_term("offset,torque_nm=0.3"));
    truth.terms.push_back(parse_term("viscous-friction,coefficient_nm_per_deg_s=0.006"));
    const Trace log = logged(truth, tour(), 7);
    const Diagnosis found = diagnose(opened(joint()), log.view(), nullptr);
    REQUIRE(found.named.size() == 2);
    double gap_nm = found.gap.before_nm;
    for (const Finding& finding : found.rounds) {
        CHECK(finding.gap_after_nm < finding.gap_before_nm);
        CHECK(finding.gap_before_nm == Approx(gap_nm).epsilon(0.02));
        gap_nm = finding.gap_after_nm;
        Model without = found.model;
        std::erase(without.terms, finding.term);
        auto left = predict_nm(without, tour());
        for (std::size_t k = 0; k < left.size(); ++k) left[k] = log.torque_nm[k] - left[k];
        const double share_nm = finding.evidence.noise_share * found.gap.noise_floor_nm;
        // The share is that of the samples used.
        const double used = static_cast<double>(found.samples_used) / static_cast<double>(found.samples);
        CHECK(rms(left) > 0.9 * std::sqrt(std::pow(found.gap.after_nm, 2) + used * std::pow(share_nm, 2)));
    }
    // The corners of the ramps, where the acceleration is not known, are in it.
    CHECK(found.gap.after_nm < 1.25 * found.gap.noise_floor_nm);
    CHECK(*found.gap.closed_percent > 99.0);
}

TEST_CASE("a log of one direction without rests cannot tell an offset from Coulomb friction, and says so") {
    const std::vector<std::string> specs = {"constant,speed=40deg/s,duration=4s",
                                            "ramp,to-speed=120deg/s,duration=0.6s",
                                            "constant,speed=120deg/s,duration=4s"};
    const Motion motion = make_motion(specs, Hertz(500.0));
    Model truth = joint();
    truth.terms.push_back(parse_term("coulomb-friction,torque_nm=0.5,width_deg_s=0.2"));
    const Diagnosis found = diagnose(opened(joint()), logged(truth, motion, 8).view(), nullptr);
    CHECK(found.named.empty());
    REQUIRE(found.ambiguous.size() == 1);
    const auto& tied = found.ambiguous[0].effects;
    CHECK(std::find(tied.begin(), tied.end(), "offset") != tied.end());
    CHECK(std::find(tied.begin(), tied.end(), "coulomb-friction") != tied.end());
    CHECK(!found.ambiguous[0].advice.empty());
}

TEST_CASE("a name that is not in the catalogue, and a log that is too short, are refused") {
    const Trace log = logged(joint(), tour(), 9);
    const std::vector<std::string> wrong = {"frictoin"};
    CHECK_THROWS_AS(diagnose(opened(joint()), log.view(), nullptr, {.without = wrong}), UsageError);
    CHECK_THROWS_AS(diagnose(opened(joint()), log.view().part(0, 100), nullptr), DataError);
}

// Which names a diagnosis gives, and which it keeps to itself: look-alikes, surrogates, what another log
// contradicts, what the log does not hold.

namespace {

using Names = std::vector<std::string>;

void tell(const Diagnosis& found) {
    for (const Finding& finding : found.rounds) {
        UNSCOPED_INFO(finding.term.effect->name << " " << status_name(finding.status) << " "
                                                << finding.reason);
    }
}

Names sorted(Names names) {
    std::sort(names.begin(), names.end());
    return names;
}

}  // namespace

TEST_CASE("with an effect taken out of the list, no look-alike takes its place", "[!shouldfail]") {
    const std::pair<std::string, std::string_view> cases[] = {
        {"offset", "offset,torque_nm=-0.43"},
        {"viscous-friction", "viscous-friction,coefficient_nm_per_deg_s=0.0063"},
        {"coulomb-friction", "coulomb-friction,torque_nm=0.84,width_deg_s=0.12"}};
    for (const auto& [name, hidden] : cases) {
        const Trace log = logged(joint_with({hidden}), coarse_tour(), 32);
        const Names without = {name};
        const Diagnosis found = diagnose(opened(joint()), log.view(), nullptr, {.without = without});
        CAPTURE(name);
        tell(found);
        CHECK(found.named.empty());
        CHECK(found.remaining);
    }
}

TEST_CASE("an offset beside gravity and a drift is a finding and no correction of theirs") {
    const Model truth = joint_with({"drift,rate_nm_s=0.04,time_constant_s=8",
                                    "gravity,amplitude_nm=3,phase_deg=69", "offset,torque_nm=0.5"});
    const Diagnosis found = diagnose(opened(joint()), logged(truth, coarse_tour(), 33).view(), nullptr);
    tell(found);
    CHECK(sorted(found.named) == Names{"drift", "gravity", "offset"});
}

TEST_CASE("a name that the validation log contradicts is withdrawn, with the figures") {
    const Model with = joint_with({"viscous-friction,coefficient_nm_per_deg_s=0.005"});
    const Trace log = logged(with, coarse_tour(), 34), same = logged(with, coarse_tour(), 35),
                other = logged(joint(), coarse_tour(), 36);
    const TraceView same_view = same.view(), other_view = other.view();
    const Diagnosis kept = diagnose(opened(joint()), log.view(), &same_view);
    tell(kept);
    CHECK(kept.named == Names{"viscous-friction"});
    CHECK(*kept.rounds[0].validation_after_nm < 0.5 * *kept.rounds[0].validation_before_nm);
    const Diagnosis withdrawn = diagnose(opened(joint()), log.view(), &other_view);
    tell(withdrawn);
    CHECK(withdrawn.named.empty());
    REQUIRE(!withdrawn.rounds.empty());
    const Finding& finding = withdrawn.rounds[0];
    CHECK(finding.status == FindingStatus::not_reproduced);
    CHECK(*finding.validation_after_nm > *finding.validation_before_nm);
    CHECK(finding.reason.find("validation log") != std::string::npos);
    // It is not in the improved model, and what it would explain is unexplained.
    CHECK(withdrawn.model.terms.size() == joint().terms.size());
    CHECK(withdrawn.verdict == DiagnosisVerdict::unexplained);
    CHECK(withdrawn.remaining);
}

TEST_CASE(
    "with a validation log that none of the names fits, the improved model does no worse there than the one "
    "given") {
    // An offset of the other sign and no friction: nothing that one teaches helps the other.
    const Trace log =
        logged(joint_with({"offset,torque_nm=0.4", "coulomb-friction,torque_nm=0.6,width_deg_s=0.3"}),
               coarse_tour(), 41);
    const Trace other = logged(joint_with({"offset,torque_nm=-0.4"}), coarse_tour(), 42);
    const TraceView other_view = other.view();
    const Diagnosis found = diagnose(opened(joint()), log.view(), &other_view);
    tell(found);
    CHECK(found.named.empty());
    REQUIRE(found.gap.validation_after_nm);
    CHECK(*found.gap.validation_after_nm <= *found.gap.validation_before_nm * (1.0 + 1e-9));
}

TEST_CASE("on a short way without position, what depends on where the joint is cannot be decided") {
    Names needing;
    for (const Effect* effect : catalogue()) {
        if (needs_position(*effect)) needing.emplace_back(effect->name);
    }
    CHECK(sorted(needing) == Names{"gravity", "output-ripple", "payload-change",
                                   "position-dependent-friction", "ripple-modulation"});
    // The joint turns back before it has made a turn.
    std::vector<std::string> specs = {"rest,duration=0.4s", "poly6,to=150deg,duration=2.2s",
                                      "rest,duration=0.4s", "poly6,to=-60deg,duration=3s",
                                      "rest,duration=0.4s"};
    Trace log =
        logged(joint_with({"gravity,amplitude_nm=2,phase_deg=30"}), make_motion(specs, Hertz(500.0)), 37);
    log.position_deg.clear();
    const Diagnosis found = diagnose(opened(joint()), log.view(), nullptr);
    tell(found);
    CHECK(std::find(found.named.begin(), found.named.end(), "gravity") == found.named.end());
    CHECK(found.remaining);
    REQUIRE(found.undecidable.size() == 5);
    // What is missing does not blow up the ripple, by which a walk of the angle could stand in for it.
    CHECK(found.gap.after_nm < 1.01 * found.gap.before_nm);
    CHECK(*found.model.terms[2].values[1] == Approx(0.45).margin(0.1));
}
