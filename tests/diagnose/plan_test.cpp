// SPDX-License-Identifier: MIT
#include "ripplenotch/diagnose/plan.hpp"

#include <algorithm>
#include <cmath>

#include "diagnose_fixture.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/model/noise.hpp"
#include "ripplenotch/model/motions.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using namespace ripplenotch::literals;
using Catch::Contains;

namespace {

constexpr MotionLimits limits{120.0, 400.0, -100.0, 80.0};

Trace log_of(const Model& model, const std::vector<std::string>& motions) {
    Motion motion = make_motion(motions, 250_Hz);
    std::vector<double> noise(motion.size(), 0.0);
    add_white_noise(noise, 0.05, 3, NoiseChannel::torque);
    Trace trace;
    trace.torque_nm = measure_nm(model, motion, noise);
    trace.sample_rate = motion.sample_rate;
    trace.time_s = std::move(motion.time_s);
    trace.velocity_deg_s = std::move(motion.velocity_deg_s);
    trace.position_deg = std::move(motion.position_deg);
    return trace;
}

Model joint_hiding(const std::string& hidden) {
    Model model{GearRatio(100.0), {}};
    for (const std::string& spec : {std::string("inertia,inertia_kgm2=0.4"),
                                    std::string("ripple,order=1,amplitude_nm=0.6,phase_deg=20"), hidden})
        model.terms.push_back(parse_term(spec));
    return model;
}

Model known() {
    Model model{GearRatio(100.0), {}};
    for (const char* spec : {"inertia", "ripple,order=1"}) model.terms.push_back(parse_term(spec));
    return model;
}

}  // namespace

TEST_CASE("friction that one direction cannot tell from an offset is told after the planned motion") {
    const Model truth = joint_hiding("coulomb-friction,torque_nm=0.6,width_deg_s=0.2");
    // Three speeds, one way, and never a rest.
    const Trace poor = log_of(
        truth, {"constant,speed=40deg/s,duration=3s", "ramp,from-speed=40deg/s,to-speed=90deg/s,duration=1s",
                "constant,speed=90deg/s,duration=3s", "ramp,from-speed=90deg/s,to-speed=60deg/s,duration=1s",
                "constant,speed=60deg/s,duration=3s"});
    const Diagnosis before = diagnose(known(), poor.view(), nullptr);
    REQUIRE(before.ambiguous.size() == 1);
    const PlanOptions options{.sample_rate = 250_Hz, .rules = {}};
    const auto plan = plan_motion(before, poor.view(), limits, options);
    REQUIRE(plan);
    CHECK(plan->decides);
    CHECK(plan->duration().value() <= 30.0);
    const auto open = std::count_if(plan->questions.begin(), plan->questions.end(),
                                    [](const PlanQuestion& one) { return one.open; });
    CHECK(open == 3);  // an offset, Coulomb friction, and friction of one direction
    for (const PlanQuestion& one : plan->questions) {
        CAPTURE(one.effect, one.rival);
        CHECK(one.gain >= options.rules.advice.plan_gain);
        CHECK((!one.open || one.gain_before < 12.0));
    }

    SECTION("it keeps within the limits and is still at both ends") {
        const Motion& m = plan->motion;
        for (std::size_t k = 0; k < m.size(); ++k) {
            REQUIRE(std::abs(m.velocity_deg_s[k]) <= limits.speed_deg_s);
            REQUIRE(std::abs(m.acceleration_deg_s2[k]) <= limits.acceleration_deg_s2);
            REQUIRE(m.position_deg[k] >= limits.lowest_deg);
            REQUIRE(m.position_deg[k] <= limits.highest_deg);
        }
        CHECK(m.velocity_deg_s.front() == 0.0);
        CHECK(m.velocity_deg_s.back() == 0.0);
    }
    SECTION("it is the same every time, and another seed's is another one") {
        CHECK(plan_motion(before, poor.view(), limits, options)->motions == plan->motions);
        PlanOptions other = options;
        other.seed = 2;
        CHECK(plan_motion(before, poor.view(), limits, other)->motions != plan->motions);
    }
    SECTION("the joint's log along it decides") {
        const Trace rich = log_of(truth, plan->motions);
        const Diagnosis after = diagnose(known(), rich.view(), nullptr);
        CHECK(after.named == std::vector<std::string>{"coulomb-friction"});
        CHECK(after.ambiguous.empty());
        CHECK_FALSE(plan_motion(after, rich.view(), limits, options));
    }
}

TEST_CASE("limits that are none are refused") {
    CHECK_THROWS_WITH(check(MotionLimits{0.0, 400.0, -1.0, 1.0}),
                      Contains("--limits, speed: 0 is not above 0"));
    CHECK_THROWS_WITH(check(MotionLimits{10.0, -4.0, -1.0, 1.0}), Contains("acceleration"));
    CHECK_THROWS_WITH(check(MotionLimits{10.0, 4.0, 1.0, 1.0}), Contains("range"));
}
