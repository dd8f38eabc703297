// SPDX-License-Identifier: MIT
// A joint of half a degree a second moves, and is judged by where and which way it does.
#include <cmath>

#include "bench_fixture.hpp"
#include "diagnose/case/case.hpp"
#include "diagnose/judging/doubt.hpp"
#include "diagnose/judging/residual_regions.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using namespace ripplenotch::fixture;

namespace {

// Up to 0.5 deg/s in both directions, 52 s at 100 Hz; its speed is measured to a thousandth of that.
Trace slow_log(const Model& truth, std::uint64_t seed) {
    static const std::vector<std::string> specs = {
        "rest,duration=2s", "poly6,to=3deg,duration=11s", "rest,duration=2s", "poly6,to=-3deg,duration=22s",
        "rest,duration=2s", "poly6,to=0deg,duration=11s", "rest,duration=2s"};
    static const Motion motion = make_motion(specs, Hertz(100.0));
    Trace log = logged(truth, motion, seed);
    log.velocity_deg_s = motion.velocity_deg_s;
    add_white_noise(log.velocity_deg_s, 0.0005, seed, NoiseChannel::velocity);
    return log;
}

}  // namespace

TEST_CASE("how slow a sample may be and still move goes with the joint, up to what fast ones have") {
    const Case slow = case_of(slow_log(joint(), 78)), fast = case_of(plain_log(joint(), 78));
    CHECK(slow.moving_deg_s == Approx(0.01 * 0.5).epsilon(0.1));
    CHECK(fast.moving_deg_s == 1.0);
}

TEST_CASE("friction of a slow joint is left over at its speeds and positions, in each direction") {
    const Model friction = joint_with({"coulomb-friction,torque_nm=0.3,width_deg_s=0.002"});
    const TestBench on(case_of(slow_log(friction, 79)));
    std::size_t at_speeds = 0, at_positions = 0;
    for (const ResidualRegion& region : residual_regions(on.bench, joint())) {
        if (region.kind == RegionKind::speed) ++at_speeds;
        if (region.kind == RegionKind::position) ++at_positions;
        if (region.kind != RegionKind::speed) continue;
        CHECK(region.rms_nm == Approx(0.3).epsilon(0.1));
        CHECK(
            (region.where.direction == Direction::positive || region.where.direction == Direction::negative));
    }
    CHECK(at_speeds == 2);
    CHECK(at_positions == 2);
}

TEST_CASE("what acts while a slow joint moves is not said to act at rest, and one way is one way") {
    const Case slow = case_of(slow_log(joint(), 80));
    std::vector<double> moving, forward;
    for (const double speed : slow.motion.velocity_deg_s) {
        moving.push_back(std::abs(speed) > 0.01 ? 0.3 : 0.0);
        forward.push_back(speed > 0.01 ? 0.3 : 0.0);
    }
    const Term term = parse_term("offset,torque_nm=1");
    CHECK(place_of(slow, moving, term).direction == Direction::both);
    CHECK(place_of(slow, forward, term).direction == Direction::positive);
    CHECK(!place_of(slow, forward, term).speed_deg_s.empty());
}

TEST_CASE("a size that differs slow and fast, forth and back is seen on a slow joint as well") {
    // Twice the friction in one direction.
    Trace log = slow_log(joint(), 81);
    for (std::size_t k = 0; k < log.size(); ++k) {
        const double speed = log.velocity_deg_s[k];
        if (std::abs(speed) > 0.01) log.torque_nm[k] += speed > 0.0 ? 0.4 : -0.2;
    }
    const TestBench on(case_of(log));
    const Unevenness uneven =
        unevenness(on.bench, joint_with({"coulomb-friction,torque_nm=0.3,width_deg_s=0.002"}), 3);
    CHECK(uneven.part > limits::evenness::most_uneven);
}
