// SPDX-License-Identifier: MIT
#include "ripplenotch/survey/survey.hpp"

#include <algorithm>
#include <filesystem>

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

TEST_CASE("a log that is not held is described as one that is") {
    for (const char* name : {"paper_90deg_s", "paper_move_2s", "paper_rest", "dialects/comma"}) {
        const std::string path = source_folder() + "/data/" + name + ".csv";
        const LogInfo held = survey_log(path, {}), passing = survey_log(path, {}, 1000);
        CHECK(passing.rows == held.rows);
        CHECK(passing.warnings == held.warnings);
        REQUIRE(passing.joints.size() == held.joints.size());
        const JointInfo &joint = passing.joints.front(), &other = held.joints.front();
        CHECK(joint.speed_deg_s->min == other.speed_deg_s->min);
        CHECK(joint.speed_deg_s->max == other.speed_deg_s->max);
        CHECK(joint.torque_nm->min == other.torque_nm->min);
        CHECK(joint.torque_nm->max == other.torque_nm->max);
        CHECK(joint.position_deg->min == other.position_deg->min);
        CHECK(joint.position_deg->max == other.position_deg->max);
        CHECK(joint.turns == Approx(other.turns).epsilon(1e-12));
        CHECK(joint.clock_factor.has_value() == other.clock_factor.has_value());
        if (joint.clock_factor) CHECK(*joint.clock_factor == Approx(*other.clock_factor).epsilon(1e-12));
        REQUIRE(joint.stretches.size() == other.stretches.size());
        for (std::size_t i = 0; i < joint.stretches.size(); ++i) {
            CHECK(joint.stretches[i].rest == other.stretches[i].rest);
            CHECK(joint.stretches[i].speed_deg_s == Approx(other.stretches[i].speed_deg_s).margin(0.05));
            CHECK(joint.stretches[i].duration_s == Approx(other.stretches[i].duration_s).margin(0.05));
        }
    }
}
