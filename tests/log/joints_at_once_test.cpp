// SPDX-License-Identifier: MIT
// All joints of a log in one pass are what they are one by one.
#include <fstream>

#include "log_support.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using namespace ripplenotch::test;
using Catch::Contains;

namespace {

// Joints 1 and 2, whose second position wraps and whose third column of both is in another unit; joint 3 has
// no torque.
std::string rows() {
    std::string text = "time_s,q1_rad,dq1_rad_s,tau1_Nm,q2_deg,dq2_deg_s,tau2_Nm,q3_deg,dq3_deg_s\n";
    for (int k = 0; k < 3000; ++k) {
        const double t = 0.01 * k + (k > 2000 ? 1.0 : 0.0);
        const double turned = 100.0 * t, wrapped = turned - 360.0 * static_cast<int>(turned / 360.0);
        for (const double value :
             {t, 0.5 * t, 0.5, 3.0 + 0.1 * (k % 7), wrapped, 100.0, 4.0 + 0.1 * (k % 5), -10.0 * t})
            text += std::to_string(value) + ",";
        text += "-10\n";
    }
    return text;
}

}  // namespace

TEST_CASE("joints read at once are the joints read one by one", "[log]") {
    const TemporaryPath path;
    std::ofstream(path.string()) << rows();
    const auto one = read_joints_in_part(path.string(), {}), all = read_joints_at_once(path.string(), {});
    REQUIRE(one.size() == 2);
    REQUIRE(all.size() == 2);
    for (std::size_t j = 0; j < 2; ++j) {
        CHECK(all[j].trace.joint == one[j].trace.joint);
        CHECK(all[j].trace.time_s == one[j].trace.time_s);
        CHECK(all[j].trace.position_deg == one[j].trace.position_deg);
        CHECK(all[j].trace.velocity_deg_s == one[j].trace.velocity_deg_s);
        CHECK(all[j].trace.torque_nm == one[j].trace.torque_nm);
        CHECK(all[j].trace.run_starts == one[j].trace.run_starts);
        CHECK(all[j].trace.sample_rate == one[j].trace.sample_rate);
        CHECK(all[j].layout.chosen.torque == one[j].layout.chosen.torque);
        CHECK(all[j].recording.angle.verdict == one[j].recording.angle.verdict);
        CHECK(all[j].position_range_deg == one[j].position_range_deg);
    }
    CHECK(all[0].trace.run_starts.size() == 1);
}

TEST_CASE("a joint without a torque is read where its motion is enough", "[log]") {
    const TemporaryPath path;
    std::ofstream(path.string()) << rows();
    ReadOptions options;
    options.torque_of_each = false;
    const auto all = read_joints_at_once(path.string(), options);
    REQUIRE(all.size() == 3);
    CHECK_FALSE(all[2].layout.chosen.torque);
    CHECK(all[2].trace.size() == all[0].trace.size());
    CHECK(all[2].trace.position_deg[100] == Approx(-10.0));
    CHECK(std::isnan(all[2].trace.torque_nm.front()));
}

TEST_CASE("of a long log all joints are looked at in the same pieces as one by one", "[log]") {
    const TemporaryPath path;
    std::ofstream(path.string()) << rows();
    ReadOptions options;
    options.torque_of_each = false;
    const auto all = read_joints_at_once_in_part(path.string(), options, 480);
    REQUIRE(all.size() == 3);
    for (const Log& joint : all) {
        REQUIRE(joint.recording.looked_at);
        CHECK(joint.trace.size() == 480);
        CHECK(joint.trace.time_s == all[0].trace.time_s);
        CHECK(joint.layout.others.empty());
    }
    for (const Log& joint : {all[0], all[1]}) {
        ReadOptions alone;
        alone.joint = joint.trace.joint;
        const Log one = read_log_in_part(path.string(), alone, 480);
        CHECK(joint.layout.chosen.torque == one.layout.chosen.torque);
        CHECK(joint.trace.time_s == one.trace.time_s);
        CHECK(joint.trace.position_deg == one.trace.position_deg);
        CHECK(joint.trace.torque_nm == one.trace.torque_nm);
        CHECK(joint.trace.run_starts == one.trace.run_starts);
        CHECK(joint.recording.angle.verdict == one.recording.angle.verdict);
    }
    CHECK_FALSE(all[2].layout.chosen.torque);
    const auto held = read_joints_at_once_in_part(path.string(), options, 3000);
    CHECK(held[0].trace.size() == 3000);
    CHECK_FALSE(held[0].recording.looked_at);
}
