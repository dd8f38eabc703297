// SPDX-License-Identifier: MIT
// A shape that is as good as at a bound stands in for something else.
#include "bench_fixture.hpp"
#include "diagnose/search/search_starts.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using namespace ripplenotch::fixture;

TEST_CASE("Stribeck friction of a speed far above all speeds is Coulomb friction, and bent") {
    const std::string_view coulomb = "coulomb-friction,torque_nm=0.5,width_deg_s=0.2";
    const TestBench on(case_of(plain_log(joint_with({coulomb}), 56)));
    const Candidate stand_in =
        on.fitted(joint_with({"stribeck-friction,torque_nm=0.5,stribeck_speed_deg_s=900,width_deg_s=0.2"}));
    CHECK(bent_parameter(on.bench, stand_in, 3) == "stribeck_speed_deg_s");
}

TEST_CASE("Stribeck friction that is there is not bent") {
    const Model truth =
        joint_with({"stribeck-friction,torque_nm=0.8,stribeck_speed_deg_s=15,width_deg_s=0.2"});
    const TestBench on(case_of(plain_log(truth, 57)));
    CHECK(bent_parameter(on.bench, on.fitted(truth), 3).empty());
}
