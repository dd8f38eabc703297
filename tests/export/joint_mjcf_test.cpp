// SPDX-License-Identifier: MIT
#include "ripplenotch/export/joint_mjcf.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "ripplenotch/core/error.hpp"
#include "ripplenotch/model/motion.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using namespace ripplenotch::literals;
using Catch::Contains;

namespace {

constexpr double pi = std::numbers::pi;

Model model_of(const std::vector<std::string>& specs) {
    Model model{GearRatio(100.0), {}};
    for (const std::string& spec : specs) model.terms.push_back(parse_term(spec));
    return model;
}

// The effect with something to hold in every value.
Term something(const Effect& effect) {
    Term term{&effect, {}};
    for (const Parameter& parameter : effect.parameters)
        term.values.emplace_back(parameter.start != 0.0 ? parameter.start : parameter.neutral);
    return term;
}

constexpr std::string_view tree = R"(<?xml version="1.0"?>
<!-- <mujoco> <joint name="elbow"/> -->
<mujoco><default><joint damping="3"/></default><worldbody><body>
<joint
  name='elbow' damping = "5"/><body><joint name="wrist" axis="0 1 0"></joint></body></body></worldbody>
<equality><joint name="elbow" joint1="wrist"/></equality></mujoco>
)";

}  // namespace

TEST_CASE("every effect of the catalogue is held, or the reason why not is told") {
    for (const Effect* effect : catalogue()) {
        CAPTURE(effect->name);
        Model model{GearRatio(100.0), {something(*effect)}};
        const JointMjcf mjcf = joint_mjcf(model);
        CHECK(mjcf.holds.size() + mjcf.not_held.size() == 1);
        CHECK(mjcf.held.terms.size() == mjcf.holds.size());
        const auto& told = mjcf.holds.empty() ? mjcf.not_held : mjcf.holds;
        CHECK(told.front().effect == effect->name);
        CHECK(!told.front().words.empty());
        const std::string text = write_mjcf(mjcf, "joint", {});
        CHECK_THAT(text, Contains(std::string(effect->name)));
    }
}

TEST_CASE("values are in newton-metres, radians and seconds") {
    const JointMjcf mjcf = joint_mjcf(
        model_of({"inertia,inertia_kgm2=0.5", "viscous-friction,coefficient_nm_per_deg_s=0.01",
                  "quadratic-viscous-friction,coefficient_nm_per_deg2_s2=1e-4",
                  "coulomb-friction,torque_nm=2,width_deg_s=0.9", "hysteresis,torque_nm=3,width_deg=18",
                  "ripple,order=2,amplitude_nm=0.4,phase_deg=30",
                  "output-ripple,order=3,amplitude_nm=0.2,phase_deg=-100", "gear-ratio,error_percent=10"}));
    CHECK(mjcf.inertia_kgm2 == 0.5);
    CHECK(mjcf.damping == Approx(1.8 / pi));
    CHECK(mjcf.quadratic_damping == Approx(3.24 / pi / pi));
    CHECK(mjcf.frictionloss_nm == 2.0);
    CHECK(mjcf.friction_width_rad_s == Approx(0.005 * pi));
    REQUIRE(mjcf.bristles.size() == 1);
    CHECK(mjcf.bristles[0].stiffness_nm_rad == Approx(30.0 / pi));
    REQUIRE(mjcf.waves.size() == 2);
    CHECK(mjcf.waves[0].poles == Approx(220.0));  // with the ratio of the log
    CHECK(mjcf.waves[0].phase_rad == Approx(2.0 * pi / 3.0));
    CHECK(mjcf.waves[1].poles == 3.0);
    CHECK(mjcf.waves[1].phase_rad == Approx(35.0 / 18.0 * pi));
    CHECK(mjcf.not_held.empty());
}

TEST_CASE("two weights are one, and two lines of an order have names of their own") {
    const Model model =
        model_of({"gravity,amplitude_nm=3,phase_deg=20", "gravity,amplitude_nm=2,phase_deg=130",
                  "ripple,order=1,amplitude_nm=1,phase_deg=0", "ripple,order=1,amplitude_nm=1,phase_deg=90"});
    const JointMjcf mjcf = joint_mjcf(model);
    const Motion motion = make_motion("poly6,from=-90deg,to=200deg,duration=2s", 50_Hz);
    const auto expected = predict_nm(model, motion);
    for (std::size_t k = 0; k < motion.size(); ++k) {
        const double q = motion.position_deg[k] * pi / 180.0;
        double sum = mjcf.weight_nm * std::cos(q + mjcf.weight_rad);
        for (const MjcfWave& wave : mjcf.waves)
            sum += wave.amplitude_nm * std::sin(wave.poles * q + wave.phase_rad);
        CHECK(sum == Approx(expected[k]).margin(1e-9));
    }
    CHECK(mjcf.waves[0].name != mjcf.waves[1].name);
}

TEST_CASE("ripple that a resonance of its own changes is not held without it") {
    Model model{GearRatio(100.0), {}};
    for (const char* term :
         {"ripple,order=1,amplitude_nm=0.2,phase_deg=0", "ripple,order=2,amplitude_nm=0.3,phase_deg=0",
          "resonance,frequency_hz=30,damping=0.3,direct=1,direct_phase_deg=180,order=2"})
        model.terms.push_back(parse_term(term));
    const JointMjcf mjcf = joint_mjcf(model);
    REQUIRE(mjcf.waves.size() == 1);
    CHECK(mjcf.waves[0].name == "ripple_1");
    REQUIRE(mjcf.not_held.size() == 2);
    CHECK(mjcf.not_held[0].effect == "ripple");
    CHECK(mjcf.not_held[1].effect == "resonance");
}

TEST_CASE("a friction below 0 is the simulation's, and no joint holds it") {
    for (const char* name : {"coulomb-friction", "viscous-friction", "hysteresis"}) {
        Model model = model_of({name});
        Term& term = model.terms[0];
        for (std::size_t p = 0; p < term.values.size(); ++p)
            term.values[p] = term.effect->parameters[p].start;
        term.values[0] = -0.3;
        const JointMjcf mjcf = joint_mjcf(model);
        CHECK(mjcf.held.terms.empty());
        REQUIRE(mjcf.not_held.size() == 1);
        CHECK_THAT(mjcf.not_held[0].words, Contains("below 0"));
    }
}

TEST_CASE("a second step of friction is told, and so is a bristle that does not begin at rest") {
    const JointMjcf two = joint_mjcf(model_of(
        {"coulomb-friction,torque_nm=2,width_deg_s=0.2", "coulomb-friction,torque_nm=1,width_deg_s=0.2"}));
    CHECK(two.frictionloss_nm == 2.0);
    REQUIRE(two.not_held.size() == 1);
    CHECK_THAT(two.not_held[0].words, Contains("one frictionloss"));
    const JointMjcf begun = joint_mjcf(model_of({"hysteresis,torque_nm=3,width_deg=18,initial_state=0.5"}));
    REQUIRE(begun.not_held.size() == 1);
    CHECK_THAT(begun.not_held[0].words, Contains("act of friction_1 to 0.157"));
    CHECK(begun.held.terms[0].values[2] == 0.0);
}

TEST_CASE("a file of its own keeps the inertia, however much the link weighs") {
    for (const char* weight : {"0.1", "3", "400"}) {
        const std::string text =
            write_mjcf(joint_mjcf(model_of({"inertia,inertia_kgm2=0.5",
                                            "gravity,phase_deg=0,amplitude_nm=" + std::string(weight)})),
                       "a<b", {});
        const auto number = [&](const std::string& word) {
            return std::stod(text.substr(text.find(word + "=\"") + word.size() + 2));
        };
        const double mass = number("mass"), distance = number("pos");
        CHECK(9.81 * mass * distance == Approx(std::stod(weight)));
        CHECK(number("armature") + mass * distance * distance == Approx(0.5));
        CHECK(number("armature") > 0.3);
        CHECK_THAT(text, Contains("name=\"a&lt;b\""));
    }
}

TEST_CASE("a heading cannot end the comment that it stands in") {
    const std::vector<std::string> heading = {"diagnose --> log.csv --model m.json"};
    const std::string text = write_mjcf(joint_mjcf(model_of({"inertia,inertia_kgm2=1"})), "joint", heading);
    CHECK(text.find("-->") > text.find("A torque sensor shows"));
}

TEST_CASE("of a tree one joint's friction and motors change, and nothing else") {
    const JointMjcf mjcf = joint_mjcf(model_of(
        {"coulomb-friction,torque_nm=2,width_deg_s=0.2", "ripple,order=1,amplitude_nm=1,phase_deg=0"}));
    const std::string once = write_into_mjcf(mjcf, tree, "arm.xml", "elbow", {});
    CHECK_THAT(once, Contains("<joint solreffriction") || Contains("<joint frictionloss=\"2\""));
    CHECK_THAT(once, Contains("name='elbow' damping = \"0\"/>"));
    CHECK_THAT(once, Contains("<joint name=\"wrist\" axis=\"0 1 0\"></joint>") &&
                         Contains("<joint damping=\"3\"/>"));
    CHECK_THAT(once, Contains("name=\"ripple_1_elbow\"") &&
                         Contains("<equality><joint name=\"elbow\" joint1=\"wrist\"/>"));
    CHECK(once.starts_with("<?xml version=\"1.0\"?>\n<!-- <mujoco> <joint name=\"elbow\"/> -->\n<!--\n"));
    // Once more into what was written: names stay different.
    const std::string twice = write_into_mjcf(mjcf, once, "arm.xml", "elbow", {});
    CHECK_THAT(twice, Contains("name=\"ripple_1_elbow_again\""));
    CHECK_THROWS_WITH(write_into_mjcf(mjcf, tree, "arm.xml", "knee", {}),
                      Contains("arm.xml: there is no joint with name=\"knee\""));
}
