// SPDX-License-Identifier: MIT
#include "ripplenotch/survey/survey.hpp"

#include "support/catch.hpp"
#include "support/places.hpp"

using namespace ripplenotch;

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
