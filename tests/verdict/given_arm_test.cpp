// SPDX-License-Identifier: MIT
// --arm as it is typed, and a log of an arm from file to term.
#include "ripplenotch/verdict/given_terms.hpp"

#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "arm/arm_support.hpp"
#include "ripplenotch/core/error.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using namespace ripplenotch::test;
using Catch::Contains;
using Catch::Matchers::WithinAbs;

namespace {

class File {
  public:
    File(const std::string& name, const std::string& text)
        : path((std::filesystem::temp_directory_path() /
                ("ripplenotch-arm-" + std::to_string(::getpid()) + "-" + name))
                   .string()) {
        std::ofstream(path) << text;
    }
    ~File() {
        std::error_code ignored;
        std::filesystem::remove(path, ignored);
    }
    File(const File&) = delete;
    File& operator=(const File&) = delete;
    const std::string path;
};

const std::string three_dh =
    "joint,a_m,alpha_deg,d_m,theta_deg\nbase,0,90,0.3,0\nupper,0.4,0,0,0\nfore,0.3,0,0,0\n";

// Three joints; the torque of the third is not logged.
std::string log_of(const Chain& chain, const std::vector<double>& links) {
    const auto motions = fourier_motions(3, 15.0, 100.0, 9, 60.0);
    std::string text = "time_s";
    for (const std::string joint : {"1", "2", "3"}) {
        text += ",q_" + joint + "_deg,qd_" + joint + "_deg_s";
        if (joint != "3") text += ",tau_" + joint + "_Nm";
    }
    std::vector<std::vector<double>> torque_nm;
    for (std::size_t j = 0; j < 3; ++j) torque_nm.push_back(arm_torque(chain, links, motions, j));
    for (std::size_t k = 0; k < motions[0].size(); ++k) {
        text += "\n" + std::to_string(motions[0].time_s[k]);
        for (std::size_t j = 0; j < 3; ++j) {
            text += "," + std::to_string(motions[j].position_deg[k]) + "," +
                    std::to_string(motions[j].velocity_deg_s[k]);
            if (j != 2) text += "," + std::to_string(torque_nm[j][k]);
        }
    }
    return text + "\n";
}

}  // namespace

TEST_CASE("an arm is named by where its chain comes from", "[arm]") {
    const File table("dh.csv", three_dh);
    const ArmSource option =
        read_arm_source("dh,file=" + table.path + ",gravity=0:0:9.81,joints=base:q1|fore:=90deg");
    CHECK(option.chain.size() == 2);
    CHECK(option.chain.gravity_m_s2 == Vector3{0, 0, 9.81});
    REQUIRE(option.stated.size() == 1);
    CHECK(option.stated[0] == std::pair<std::string, std::string>{"base", "q1"});
    CHECK(read_arm_source("axes,word=zyY,length=0.5m").chain.joints[1].origin_m[2] == 0.5);
    CHECK_THROWS_WITH(read_arm_source("robot.urdf"),
                      Contains("'robot.urdf' is none of urdf, mjcf, mdh, dh, axes"));
    CHECK_THROWS_WITH(read_arm_source("urdf"), Contains("file"));
    CHECK_THROWS_WITH(read_arm_source("axes,word=zy,tip=tool"), Contains("tip"));
    CHECK_THROWS_WITH(read_arm_source("axes,word=zy,gravity=0:0"), Contains("2 numbers, expected 3"));
    CHECK_THROWS_WITH(read_arm_source("axes,word=zy,joints=j1"), Contains("'j1' is neither"));
    CHECK_THROWS_WITH(read_arm_source("axes,word=zy,joints=j7:=0deg"),
                      Contains("'j7' is no joint of axes zy"));
    CHECK_THROWS_AS(read_arm_source("urdf,file=/nowhere/robot.urdf"), FileError);
}

TEST_CASE("a log of an arm becomes a term for one joint and an account of it", "[arm]") {
    const File table("dh.csv", three_dh);
    const Chain chain = chain_of_dh("dh.csv", three_dh);
    const File log("log.csv", log_of(chain, random_links(3, 10)));
    ArmSource option = read_arm_source("dh,file=" + table.path);
    for (std::size_t j = 0; j < 3; ++j) option.chain.joints[j].name = "joint_" + std::to_string(j + 1);
    GivenArm arm(option, log.path, {});
    CHECK(arm.reading().match.rule == "by name");
    CHECK(arm.reading().view().has_torque == std::vector<bool>{true, true, false});
    const std::size_t joint = arm.find("2");
    CHECK(joint == 1);
    const GivenTerm term = arm.term(joint, arm.reading());
    CHECK(term.torque_nm.size() >= 20);
    CHECK(term.torque_nm.front().size() == 1500);
    const ArmAccount account = arm.account(joint);
    CHECK(account.all_joints_at_once);
    CHECK(account.joints.size() == 3);
    CHECK(account.gap_nm < 0.02 * account.gap_before_nm);
    CHECK(account.rule == "by name");
    CHECK_THROWS_WITH(arm.find("7"), Contains("'7' is no joint of"));
    // The same values for another log: the same columns.
    CHECK(arm.term(joint, arm.other(log.path, {})).mean == term.mean);
}

TEST_CASE("an arm of which only directions are known is fitted joint by joint", "[arm]") {
    const Chain chain = chain_of_dh("dh.csv", three_dh);
    const File log("log.csv", log_of(chain, random_links(3, 10)));
    GivenArm arm(read_arm_source("axes,word=zYY"), log.path, {});
    CHECK_FALSE(arm.account(1).all_joints_at_once);
    CHECK(arm.account(1).gap_nm < 0.2 * arm.account(1).gap_before_nm);
}

TEST_CASE("a joint without position, or that the log does not hold, is told", "[arm][broken]") {
    const File log("log.csv",
                   "time_s,q_1_deg,qd_1_deg_s,tau_1_Nm,qd_2_deg_s,tau_2_Nm\n0,0,0,0,0,0\n0.01,1,1,1,1,1\n"
                   "0.02,2,2,2,2,2\n");
    CHECK_THROWS_WITH(GivenArm(read_arm_source("axes,word=zy"), log.path, {}),
                      Contains("has the velocity of '2' and not its position"));
    CHECK_THROWS_WITH(GivenArm(read_arm_source("axes,word=zyy"), log.path, {}),
                      Contains("has the joint 'j3'") && Contains("its joints: 1, 2"));
}
