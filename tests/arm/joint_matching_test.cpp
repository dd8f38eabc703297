// SPDX-License-Identifier: MIT
#include "ripplenotch/arm/joint_matching.hpp"

#include "ripplenotch/arm/chain.hpp"
#include "ripplenotch/core/error.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using Catch::Contains;

namespace {

using Names = std::vector<std::string>;
using Places = std::vector<std::size_t>;

Chain chain_of(const Names& names) {
    Chain chain = chain_of_axes(std::string(names.size(), 'z'));
    chain.source = "robot.urdf";
    for (std::size_t j = 0; j < names.size(); ++j) chain.joints[j].name = names[j];
    return chain;
}

JointMatch match(const Names& chain, const Names& log, const StatedJoints& stated = {}) {
    return match_joints(chain_of(chain), log, stated, "log.csv");
}

}  // namespace

TEST_CASE("joints of the same name are one, whatever their spelling", "[arm]") {
    const JointMatch found =
        match({"shoulder_pan_joint", "elbow_joint"}, {"Elbow", "gripper", "Shoulder-Pan"});
    CHECK(found.of == Places{2, 0});
    CHECK(found.rule == "by name");
    CHECK(found.option == "joints=shoulder_pan_joint:Shoulder-Pan|elbow_joint:Elbow");
    CHECK(found.warnings.empty());
    REQUIRE(found.notes.size() == 1);
    CHECK_THAT(found.notes[0], Contains("'gripper' of the log is not part of the chain"));
    CHECK(match({"panda_joint1", "panda_joint2"}, {"panda2", "panda1"}).of == Places{1, 0});
}

TEST_CASE("joints of the same number are one, counted from 0 or 1", "[arm]") {
    const JointMatch one = match({"panda_joint1", "panda_joint2"}, {"q1", "q2"});
    CHECK(one.of == Places{0, 1});
    CHECK(one.rule == "by number");
    CHECK(match({"panda_joint1", "panda_joint2"}, {"q1", "q0"}).of == Places{1, 0});
    CHECK(match({"a0", "a1"}, {"q2", "q1"}).of == Places{1, 0});
    // From 1 as long as that finds them all, though there is a 0.
    CHECK(match({"a1", "a2"}, {"q0", "q1", "q2"}).of == Places{1, 2});
}

TEST_CASE("joints without anything in common go by their order, and that is said", "[arm]") {
    const JointMatch found = match({"base", "boom"}, {"left", "right"});
    CHECK(found.of == Places{0, 1});
    CHECK(found.rule == "by order");
    REQUIRE(found.warnings.size() == 1);
    CHECK_THAT(found.warnings[0], Contains("paired in order: base:left, boom:right"));
    // Not where a third joint leaves open which two.
    CHECK_THROWS_AS(match({"base", "boom"}, {"left", "right", "hand"}), UsageError);
}

TEST_CASE("stated joints go before any rule, which finds the others", "[arm]") {
    const JointMatch found = match({"j1", "j2", "j3"}, {"1", "2", "x"}, {{"j2", "x"}, {"j3", "2"}});
    CHECK(found.of == Places{0, 2, 1});
    CHECK(match({"j1"}, {"x"}, {{"j1", "x"}}).rule == "as stated");
    CHECK_THROWS_WITH(match({"j1"}, {"x"}, {{"k", "x"}}),
                      Contains("'k' is no joint of robot.urdf; moving joints: j1"));
    CHECK_THROWS_WITH(match({"j1"}, {"elbow"}, {{"j1", "elbou"}}), Contains("did you mean elbow?"));
    CHECK_THROWS_WITH(match({"j1", "j2"}, {"x", "y"}, {{"j1", "x"}, {"j2", "x"}}),
                      Contains("has a partner already"));
}

TEST_CASE("a joint without a partner is named, with what the log has", "[arm]") {
    CHECK_THROWS_WITH(match({"panda_joint1", "panda_joint2", "panda_joint3"}, {"1", "3"}),
                      Contains("robot.urdf has the joint 'panda_joint2', and log.csv holds no position of it "
                               "(its joints: 1, 3); "
                               "name it with joints=panda_joint2:NAME, or keep it still in the model with "
                               "joints=panda_joint2:=0deg"));
    // The same number twice is no answer.
    CHECK_THROWS_AS(match({"a1", "b1", "c"}, {"1", "2"}), UsageError);
}
