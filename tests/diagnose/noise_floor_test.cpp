// SPDX-License-Identifier: MIT
// The noise is measured alike whatever the model misses.
#include "diagnose/case/noise_floor.hpp"

#include <cmath>

#include "bench_fixture.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using namespace ripplenotch::fixture;

namespace {

NoiseFloor floor_of(const Case& c) { return noise_floor(c, joint(), opened(joint())); }

}  // namespace

TEST_CASE("white noise is measured with its size and no memory") {
    const NoiseFloor floor = floor_of(case_of(plain_log(joint(), 67)));
    CHECK(floor.rms_nm == Approx(noise_nm).epsilon(0.05));
    CHECK(floor.white_nm == Approx(noise_nm).epsilon(0.05));
    CHECK(floor.of_sums() < 1.3);
}

TEST_CASE("what the model misses is no noise: friction, an offset, a tone") {
    const Model truth = joint_with({"coulomb-friction,torque_nm=0.8,width_deg_s=0.2", "offset,torque_nm=1",
                                    "tone,frequency_hz=30,amplitude_nm=0.3,phase_deg=0"});
    CHECK(floor_of(case_of(plain_log(truth, 68))).rms_nm == Approx(noise_nm).epsilon(0.1));
}

TEST_CASE("noise with a memory is told with it, and sums of it scatter more") {
    Case c = case_of(plain_log(joint(), 69));
    const std::vector<double> silent = predict_nm(joint(), c.motion);
    c.torque_nm = silent;
    add_noise(c.torque_nm, {.rms = noise_nm, .correlation = 0.5}, 70, NoiseChannel::torque);
    const NoiseFloor floor = floor_of(c);
    REQUIRE(!floor.color.empty());
    CHECK(floor.color[0] == Approx(0.5).margin(0.06));
    CHECK(floor.of_sums() == Approx(3.0).epsilon(0.25));  // (1 + c) / (1 - c)
    CHECK(floor.white_nm == Approx(noise_nm * std::sqrt(0.75)).epsilon(0.05));
}

TEST_CASE("what is loud in some stretches is no noise") {
    Case c = case_of(plain_log(joint(), 71));
    Noise burst(72, NoiseChannel::torque);
    for (std::size_t k = 3000; k < 4000; ++k) c.torque_nm[k] += 0.5 * burst.normal();
    CHECK(floor_of(c).rms_nm == Approx(noise_nm).epsilon(0.1));
}
