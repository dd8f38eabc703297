// SPDX-License-Identifier: MIT
// A drive that turns with the joint.
#include "model/spring/mass_on_spring.hpp"

#include <cmath>
#include <numbers>

#include "support/catch.hpp"

using namespace ripplenotch;

namespace {

constexpr double cycles_per_deg = 200.0 / 360.0;

Motion motion_at(std::vector<double> time_s) {
    const std::size_t samples = time_s.size();
    Motion motion{Hertz(1000.0), std::move(time_s), std::vector<double>(samples),
                  std::vector<double>(samples), std::vector<double>(samples)};
    for (std::size_t k = 0; k < samples; ++k) motion.velocity_deg_s[k] = 40.0 + 300.0 * motion.time_s[k];
    return motion;
}

}  // namespace

TEST_CASE("a drive turns back by what the mean speed of a step says, and knows the step's length") {
    std::vector<double> time_s;
    for (int k = 0; k < 300; ++k) time_s.push_back(1e-3 * (k / 3) + 1e-4 * (k % 3) + (k > 200 ? 0.5 : 0.0));
    const Motion motion = motion_at(time_s);
    const auto drive = turning_drive(motion, cycles_per_deg);
    CHECK(drive->hz[0] == cycles_per_deg * motion.velocity_deg_s[0]);
    // 0.1 ms, 0.8 ms, 0.5 s beside the usual 1 ms, though each is written with other last bits.
    CHECK(drive->steps_s.size() == 4);
    for (std::size_t k = 1; k < motion.size(); ++k) {
        const double step_s = time_s[k] - time_s[k - 1];
        const double hz = cycles_per_deg * 0.5 * (motion.velocity_deg_s[k - 1] + motion.velocity_deg_s[k]);
        CHECK(drive->hz[k] == Approx(hz).epsilon(1e-15));
        CHECK(std::abs(drive->steps_s[drive->step[k]] - step_s) <= 1e-12);
        CHECK(std::abs(drive->cosine[k] - std::cos(2.0 * std::numbers::pi * hz * step_s)) < 1e-11);
        CHECK(std::abs(drive->sine[k] + std::sin(2.0 * std::numbers::pi * hz * step_s)) < 1e-11);
    }
}

TEST_CASE("stamps that stand still or go back are a usual step, and a gap of any length is a step") {
    const auto drive = turning_drive(motion_at({0.0, 0.001, 0.001, 0.0005, 1e300}), cycles_per_deg);
    CHECK(drive->step == std::vector<std::size_t>{0, 0, 0, 0, 1});
    CHECK(drive->steps_s[1] == 1e300);
}

TEST_CASE("a drive that was asked for is kept, and another motion or another order gets its own") {
    const Motion motion = motion_at({0.0, 0.001, 0.002});
    Motion faster = motion;
    faster.velocity_deg_s[1] += 1.0;
    const auto first = turning_drive(motion, cycles_per_deg);
    CHECK(turning_drive(Motion(motion), cycles_per_deg) == first);
    CHECK(turning_drive(motion, 2.0 * cycles_per_deg)->hz[0] == 2.0 * first->hz[0]);
    CHECK(turning_drive(faster, cycles_per_deg)->hz[1] > first->hz[1]);
    CHECK(turning_drive(motion, cycles_per_deg)->hz == first->hz);
}
