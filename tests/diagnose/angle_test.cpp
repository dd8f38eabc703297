// SPDX-License-Identifier: MIT
// The angle of a log without position: its walk is told by the ripple, and another log is put in its place.

#include <cmath>
#include <numbers>

#include "bench_fixture.hpp"
#include "diagnose/angle/angle.hpp"
#include "ripplenotch/model/prediction.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using namespace ripplenotch::fixture;

namespace {

// A case whose position is off by this, as that of an integrated speed is.
Case off_by(const Model& truth, const std::vector<double>& off_deg, std::uint64_t seed) {
    Case c = case_of(plain_log(truth, seed));
    for (std::size_t k = 0; k < c.size(); ++k) c.motion.position_deg[k] += off_deg[k];
    c.walk_deg = 0.02;
    return c;
}

std::vector<double> wander(double size_deg) {
    std::vector<double> off;
    const double duration_s = tour().time_s.back();
    for (const double time : tour().time_s)
        off.push_back(size_deg * std::sin(2.5 * std::numbers::pi * time / duration_s));
    return off;
}

// rms by which the position is off, less its mean.
double still_off_deg(const Case& c, bool mean_counts = false) {
    double sum = 0.0, square = 0.0;
    const auto n = static_cast<double>(c.size());
    for (std::size_t k = 0; k < c.size(); ++k) {
        const double off = c.motion.position_deg[k] - tour().position_deg[k];
        sum += off / n;
        square += off * off / n;
    }
    return std::sqrt(mean_counts ? square : square - sum * sum);
}

Trace blind(const Model& truth, double start_deg, std::uint64_t seed) {
    Motion motion = tour();
    for (double& position : motion.position_deg) position += start_deg;
    Trace log = logged(truth, motion, seed);
    log.position_deg.clear();
    return log;
}

}  // namespace

TEST_CASE("the ripple tells how far an integrated position has walked") {
    const double walked_deg = 0.05;
    Case c = off_by(joint(), wander(walked_deg), 81);
    REQUIRE(still_off_deg(c) > 0.6 * walked_deg);
    straighten(c, opened(joint()));
    CHECK(still_off_deg(c) < 0.1 * walked_deg);
}

TEST_CASE("a position that was measured stays as it is") {
    Case c = case_of(plain_log(joint(), 82));
    const std::vector<double> before = c.motion.position_deg;
    take_out_walk(c, joint(), joint(), WalkOf::log);
    CHECK(c.motion.position_deg == before);
}

TEST_CASE(
    "another log is put at the place of the motor's turn, and of the output's where something tells it") {
    const Model heavy = joint_with({"gravity,amplitude_nm=2,phase_deg=30"});
    for (const double start_deg : {-1.3, 37.4}) {
        CAPTURE(start_deg);
        Case with_gravity = off_by(heavy, std::vector<double>(tour().size(), start_deg), 83);
        put_in_place(with_gravity, heavy);
        CHECK(std::abs(std::remainder(still_off_deg(with_gravity, true), 360.0)) < 0.01);
        Case alone = off_by(joint(), std::vector<double>(tour().size(), start_deg), 84);
        put_in_place(alone, joint());
        CHECK(std::abs(std::remainder(still_off_deg(alone, true), 3.6)) < 0.01);
    }
}

TEST_CASE("a way of more than a turn in both directions tells what goes with the position") {
    CHECK(tells_position(tour()));
    const std::vector<std::string> to_and_fro = {"poly6,to=150deg,duration=2.2s",
                                                 "poly6,to=-60deg,duration=3s"};
    CHECK_FALSE(tells_position(make_motion(to_and_fro, Hertz(500.0))));
    std::vector<std::string> short_way;
    for (int stroke = 0; stroke < 30; ++stroke) {
        short_way.emplace_back("poly6,to=30deg,duration=0.5s");
        short_way.emplace_back("poly6,to=0deg,duration=0.5s");
    }
    CHECK_FALSE(tells_position(make_motion(short_way, Hertz(500.0))));
}

TEST_CASE("logs of torque and velocity that begin anywhere bear each other's names out") {
    const Model truth = joint_with({"gravity,amplitude_nm=2,phase_deg=30"});
    const Trace log = blind(truth, 0.0, 85), other = blind(truth, 71.3, 86);
    const TraceView validation = other.view();
    const Diagnosis found = diagnose(opened(joint()), log.view(), &validation);
    CHECK(found.named == std::vector<std::string>{"gravity"});
    CHECK(found.undecidable.empty());
    REQUIRE(found.gap.validation_after_nm);
    CHECK(*found.gap.validation_after_nm == Approx(noise_nm).epsilon(0.25));
}
