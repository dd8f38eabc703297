// SPDX-License-Identifier: MIT
// Faults of the set-up of an arm whose truth is known.
#include "ripplenotch/arm/arm_setup.hpp"

#include "arm_support.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using namespace ripplenotch::test;

namespace {

// A log with friction of each joint at 100 Hz.
struct ArmRecord {
    Chain chain = chain_of_dh("six.csv", six_dh);
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
    std::swap(record.traces[1], record.traces[2]);
    std::swap(record.traces[1].torque_nm, record.traces[2].torque_nm);
    faults = record.faults();
    REQUIRE(faults.size() == 1);
    CHECK(faults.front().kind == SetupFaultKind::wrong_joint);
    CHECK_THAT(faults.front().statement, Catch::Contains("the torques of joints"));
}

// The delay of an arm's torques behind its motion: one for all joints, and a joint that contradicts it.

namespace {

// A log at 200 Hz of six joints whose torques have these delays, with friction and noise.
std::optional<ArmLag> lag_of(const std::array<double, 6>& delays_s, unsigned seed) {
    const Chain chain = chain_of_dh("six.csv", six_dh);
    std::mt19937_64 random(seed);
    const auto motions = fourier_motions(6, 30.0, 200.0, seed + 4, 50.0);
    const auto links = random_links(6, seed + 3);
    std::vector<std::vector<double>> torques;
    ArmLog log;
    for (std::size_t j = 0; j < 6; ++j) {
        const Motion& motion = motions[j];
        auto torque_nm = arm_torque(chain, links, motions, j);
        for (std::size_t k = 0; k < torque_nm.size(); ++k)
            torque_nm[k] += 2.0 * std::tanh(motion.velocity_deg_s[k] / 1.5);
        torques.push_back(std::move(torque_nm));
        log.joints.push_back(
            {motion.sample_rate, motion.time_s, motion.velocity_deg_s, torques[j], motion.position_deg});
    }
    log.has_torque.assign(6, true);
    std::vector<std::vector<double>> late(6);
    for (std::size_t j = 0; j < 6; ++j) {
        const AdvancedLog moved(log, -delays_s[j]);
        late[j].assign(moved.log.joints[j].torque_nm.begin(), moved.log.joints[j].torque_nm.end());
        for (double& each : late[j]) each += 0x1p-53 * static_cast<double>(random() >> 11) - 0.5;
    }
    for (std::size_t j = 0; j < 6; ++j) log.joints[j].torque_nm = late[j];
    ArmFitOptions options;
    options.smoothing = Seconds(0.08);
    return common_lag(chain, log, fit_arm(chain, log, options), options);
}

}  // namespace

TEST_CASE("the delay of all torques is one number whose interval holds it", "[arm]") {
    for (const double delay_s : {0.0, 0.0088, -0.0131}) {
        CAPTURE(delay_s);
        const auto lag = lag_of({delay_s, delay_s, delay_s, delay_s, delay_s, delay_s}, 1);
        REQUIRE(lag);
        CHECK(lag->delay_s == Approx(delay_s).margin(1e-3));
        CHECK(lag->delay_95_s.low <= delay_s);
        CHECK(lag->delay_95_s.high >= delay_s);
        CHECK(lag->is_there() == (delay_s != 0.0));
    }
}

TEST_CASE("a joint with a delay of its own contradicts that of the others", "[arm]") {
    const auto lag = lag_of({0.006, 0.006, 0.02, 0.006, 0.006, 0.006}, 2);
    REQUIRE(lag);
    CHECK(lag->delay_s == Approx(0.006).margin(1e-3));
    for (const JointLag& joint : lag->joints) CHECK(joint.contradicts == (joint.joint == 2));
    CHECK(lag->contradicted_by(2));
    CHECK(!lag->contradicted_by(1));
}
