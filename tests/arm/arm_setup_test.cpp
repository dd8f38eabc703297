// SPDX-License-Identifier: MIT
// Faults of the set-up of an arm whose truth is known.
#include "ripplenotch/arm/arm_setup.hpp"

#include "arm_support.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using namespace ripplenotch::test;

namespace {

const std::string six_links =
    "a_m,alpha_deg,d_m,theta_deg\n0,90,0.13,0\n-0.6,0,0,0\n-0.55,0,0,0\n0,90,0.16,0\n0,-90,0.11,0\n0,0,0.09,"
    "0\n";

// A log with friction of each joint at 100 Hz.
struct ArmRecord {
    Chain chain = chain_of_dh("six.csv", six_links);
    std::vector<Trace> traces;

    ArmRecord(unsigned seed, double coulomb_nm) {
        std::mt19937_64 random(seed);
        const auto motions = fourier_motions(6, 30.0, 100.0, seed + 4, 50.0);
        const auto links = random_links(6, seed + 3);
        for (std::size_t j = 0; j < chain.size(); ++j) {
            const Motion& motion = motions[j];
            Trace trace{"log.csv",          chain.joints[j].name,  motion.sample_rate,
                        motion.time_s,      motion.velocity_deg_s, arm_torque(chain, links, motions, j),
                        motion.position_deg};
            for (std::size_t k = 0; k < trace.size(); ++k)
                trace.torque_nm[k] += coulomb_nm * std::tanh(motion.velocity_deg_s[k] / 1.5) +
                                      0x1p-53 * static_cast<double>(random() >> 11) - 0.5;
            traces.push_back(std::move(trace));
        }
    }

    [[nodiscard]] std::vector<SetupFault> faults() const {
        ArmLog log;
        for (const Trace& trace : traces) log.joints.push_back(trace.view());
        log.has_torque.assign(traces.size(), true);
        ArmFitOptions options;
        options.smoothing = Seconds(0.12);
        return suspect_arm(chain, log, fit_arm(chain, log, options), options);
    }
    void reverse(std::size_t joint) {
        for (double& each : traces[joint].torque_nm) each = -each;
    }
};

}  // namespace

TEST_CASE("an arm that is right has no fault, with or without friction", "[arm]") {
    CHECK(ArmRecord(1, 0.0).faults().empty());
    CHECK(ArmRecord(2, 4.0).faults().empty());
}

TEST_CASE("gravity along another axis of the base is found, with the option that states it", "[arm]") {
    for (const Vector3& stated : {Vector3{0, 0, 9.81}, Vector3{9.81, 0, 0}}) {
        ArmRecord record(3, 2.0);
        record.chain.gravity_m_s2 = stated;
        const auto faults = record.faults();
        REQUIRE(faults.size() == 1);
        CHECK(faults.front().kind == SetupFaultKind::gravity_direction);
        CHECK(faults.front().option == "gravity=0:0:-9.81");
        CHECK(faults.front().explained_after > faults.front().explained_before);
    }
}

TEST_CASE("torques whose sign is reversed are found: of one joint, and of all by their friction", "[arm]") {
    ArmRecord record(4, 2.0);
    record.reverse(2);
    auto faults = record.faults();
    REQUIRE(faults.size() == 1);
    CHECK(faults.front().kind == SetupFaultKind::torque_sign);
    CHECK_THAT(faults.front().statement, Catch::Contains("joint " + record.chain.joints[2].name + " has"));
    for (const std::size_t joint : {0, 1, 3, 4, 5}) record.reverse(joint);
    faults = record.faults();
    REQUIRE(faults.size() == 1);
    CHECK_THAT(faults.front().statement, Catch::Contains("friction would drive the arm"));
}

TEST_CASE("a torque in mNm and exchanged joints are found", "[arm]") {
    ArmRecord record(5, 2.0);
    for (double& each : record.traces[1].torque_nm) each *= 1000.0;
    auto faults = record.faults();
    REQUIRE(faults.size() == 1);
    CHECK(faults.front().kind == SetupFaultKind::torque_unit);
    CHECK_THAT(faults.front().statement,
               Catch::Contains("joint " + record.chain.joints[1].name + " is in mNm"));
    for (double& each : record.traces[1].torque_nm) each /= 1000.0;
    std::swap(record.traces[1], record.traces[2]);
    faults = record.faults();
    REQUIRE(faults.size() == 1);
    CHECK(faults.front().kind == SetupFaultKind::wrong_joint);
}
