// SPDX-License-Identifier: MIT
#include "ripplenotch/survey/survey.hpp"

#include <algorithm>

#include "support/catch.hpp"
#include "support/places.hpp"

using namespace ripplenotch;
using Catch::Contains;

TEST_CASE("a survey tells a log's clock, its motion and what it is good for") {
    const LogInfo info = survey_log(source_folder() + "/data/paper_90deg_s.csv", {});
    CHECK(info.rows == 4000);
    CHECK(info.clock.nominal_rate == Hertz(1000.0));
    CHECK(info.duration_s.value() == Approx(3.999));
    REQUIRE(info.joints.size() == 1);
    const JointInfo& joint = info.joints.front();
    CHECK(joint.speed_deg_s->max == Approx(90.0));
    CHECK(joint.turns == Approx(1.0).margin(0.01));
    REQUIRE(joint.stretches.size() == 1);
    CHECK(joint.stretches.front().speed_deg_s == Approx(90.0));
    CHECK_FALSE(joint.stretches.front().rest);
    REQUIRE(info.uses.size() == 4);
    CHECK(std::all_of(info.uses.begin(), info.uses.end(), [](const Use& use) { return use.possible; }));
    CHECK(info.warnings.empty());
}

TEST_CASE("a log at rest is described, and is good for no gear ratio") {
    const LogInfo info = survey_log(source_folder() + "/data/paper_rest.csv", {});
    REQUIRE(info.joints.size() == 1);
    CHECK(info.joints.front().stretches.front().rest);
    const auto identify = std::find_if(info.uses.begin(), info.uses.end(),
                                       [](const Use& use) { return use.name == "identify"; });
    REQUIRE(identify != info.uses.end());
    CHECK_FALSE(identify->possible);
    CHECK_THAT(identify->reason, Contains("too little"));
}
