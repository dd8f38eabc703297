// SPDX-License-Identifier: MIT
// The delay of an arm's torques behind its motion: one for all joints, and a joint that contradicts it.
#include "ripplenotch/arm/arm_setup.hpp"

#include "arm_support.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using namespace ripplenotch::test;

namespace {

// A log at 200 Hz of six joints whose torques have these delays, with friction and noise.
std::optional<ArmLag> lag_of(const std::array<double, 6>& delays_s, unsigned seed) {
    const Chain chain = chain_of_dh("six.csv",
                                    "a_m,alpha_deg,d_m,theta_deg\n0,90,0.13,0\n-0.6,0,0,0\n-0.55,0,0,0\n"
                                    "0,90,0.16,0\n0,-90,0.11,0\n0,0,0.09,0\n");
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
