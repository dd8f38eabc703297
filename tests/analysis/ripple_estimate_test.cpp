// SPDX-License-Identifier: MIT
// The ripple at stated orders, of a log and by speed and direction.
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

#include "ripplenotch/analysis/ripple_estimate.hpp"
#include "ripplenotch/core/error.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;

namespace {

constexpr std::array two_orders = {Order(1.0), Order(2.0)};

struct PlantedRipple {
    double order, amplitude_nm, phase_deg;
};

struct PlantedLog {
    double ratio = 100.0, rate_hz = 1000.0, seconds = 8.0;
    std::vector<PlantedRipple> ripple = {{1.0, 0.8, 30.0}, {2.0, 0.5, -70.0}};
    double noise_nm = 0.0, memory = 0.0;  ///< of the noise from sample to sample: 0 is white
    unsigned seed = 1;
    std::function<double(double)> speed = [](double) { return 60.0; };  ///< deg/s at a time
    std::function<double(double)> trend = [](double) { return 0.0; };
};

Trace planted_trace(const PlantedLog& plant) {
    Trace trace;
    trace.sample_rate = Hertz(plant.rate_hz);
    std::mt19937 engine(plant.seed);
    std::normal_distribution<double> normal;
    double angle_deg = 0.0, noise = 0.0;
    for (std::size_t k = 0; static_cast<double>(k) < plant.seconds * plant.rate_hz; ++k) {
        const double t = static_cast<double>(k) / plant.rate_hz, v = plant.speed(t);
        if (k > 0) angle_deg += 0.5 * (v + trace.velocity_deg_s.back()) / plant.rate_hz;
        noise = plant.memory * noise + std::sqrt(1.0 - plant.memory * plant.memory) * normal(engine);
        double torque = plant.trend(t) + plant.noise_nm * noise;
        for (const PlantedRipple& one : plant.ripple)
            torque += one.amplitude_nm * std::cos((one.order * plant.ratio * angle_deg + one.phase_deg) *
                                                  std::numbers::pi / 180.0);
        trace.time_s.push_back(t);
        trace.velocity_deg_s.push_back(v);
        trace.position_deg.push_back(angle_deg);
        trace.torque_nm.push_back(torque);
    }
    return trace;
}

std::vector<RippleEstimate> estimate_of_planted(const PlantedLog& plant,
                                                std::span<const Order> at = two_orders) {
    const Trace trace = planted_trace(plant);
    const TraceView view = trace.view();
    return estimate_ripple({&view, 1}, GearRatio(plant.ratio), at);
}

double to_and_fro_deg_s(double t) { return 90.0 * std::sin(0.8 * t); }

}  // namespace

TEST_CASE("planted amplitudes and phases come back at one speed, in sweeps and over four periods of travel") {
    PlantedLog steady, sweep, short_way, slow;
    sweep.speed = to_and_fro_deg_s;
    short_way.ratio = 30.0;  // 60 deg to and fro: five periods of order 1
    short_way.seconds = 12.0;
    short_way.speed = [](double t) { return 40.0 * (std::fmod(t, 3.0) < 1.5 ? 1.0 : -1.0); };
    slow.speed = [](double) { return 1.0; };
    slow.seconds = 40.0;
    for (PlantedLog plant : {steady, sweep, short_way, slow}) {
        plant.trend = [](double t) { return 4.0 + 2.0 * std::sin(0.4 * t); };
        const auto found = estimate_of_planted(plant);
        REQUIRE(found.size() == 2);
        INFO("ratio " << plant.ratio << ", " << plant.seconds << " s");
        for (std::size_t i = 0; i < 2; ++i) {
            CHECK(found[i].present());
            CHECK(found[i].amplitude_nm == Approx(plant.ripple[i].amplitude_nm).epsilon(0.005));
            REQUIRE(found[i].phase_deg);
            CHECK(*found[i].phase_deg == Approx(plant.ripple[i].phase_deg).margin(0.5));
        }
    }
}

TEST_CASE("an order that is not there is told with the amplitude that would have been seen") {
    PlantedLog plant;
    plant.noise_nm = 0.05;
    const std::array asked = {Order(1.0), Order(2.0), Order(3.0)};
    const auto found = estimate_of_planted(plant, asked);
    CHECK_FALSE(found[2].present());
    CHECK(found[2].searched());
    CHECK(found[2].detectable_nm > found[2].amplitude_nm);
    CHECK(found[2].detectable_nm < 0.01);
    CHECK_THAT(ripple_text(found), Catch::Contains("order 3: no ripple above"));
}

TEST_CASE("false alarms are rarer than 1 %, and a ripple of the detectable amplitude is seen in 99 of 100") {
    int false_alarms = 0, missed = 0;
    constexpr int logs = 200;
    for (const double memory : {0.0, 0.9}) {
        for (unsigned seed = 0; seed < logs; ++seed) {
            PlantedLog plant;
            plant.seconds = 5.0;
            plant.rate_hz = 500.0;
            plant.speed = to_and_fro_deg_s;
            plant.noise_nm = 0.1;
            plant.memory = memory;
            plant.seed = 1000 + seed;
            plant.ripple.clear();
            const auto nothing = estimate_of_planted(plant);
            for (const RippleEstimate& one : nothing) false_alarms += one.present() ? 1 : 0;
            plant.ripple = {{1.0, nothing[0].detectable_nm, 10.0}};
            plant.seed = 5000 + seed;
            missed += estimate_of_planted(plant)[0].present() ? 0 : 1;
        }
    }
    CHECK(false_alarms <= 2 * logs / 100);
    CHECK(missed <= 2 * logs / 100);
}

TEST_CASE("nineteen of twenty planted amplitudes are within two standard errors, in coloured noise too") {
    for (const double memory : {0.0, 0.9}) {
        int inside = 0;
        constexpr int logs = 200;
        for (unsigned seed = 0; seed < logs; ++seed) {
            PlantedLog plant;
            plant.speed = to_and_fro_deg_s;
            plant.rate_hz = 500.0;
            plant.noise_nm = 0.3;
            plant.memory = memory;
            plant.seed = 100 + seed;
            const RippleEstimate one = estimate_of_planted(plant)[0];
            inside += std::abs(one.amplitude_nm - 0.8) < 1.96 * one.standard_error_nm ? 1 : 0;
        }
        INFO("memory " << memory);
        CHECK(inside >= 180);
        CHECK(inside <= 199);
    }
}

TEST_CASE("what the log does not show is said: rest, too little travel, half the sample rate, no ratio") {
    PlantedLog plant;
    plant.speed = [](double) { return 0.0; };
    CHECK_THAT(estimate_of_planted(plant)[0].insufficient, Catch::Contains("four periods"));
    plant.speed = [](double) { return 1.0; };
    plant.seconds = 2.0;  // 0.56 motor turns
    CHECK_FALSE(estimate_of_planted(plant)[0].searched());
    plant.speed = [](double) { return 120.0; };
    plant.rate_hz = 100.0;  // order 1 at 33 Hz, order 2 at 67 Hz
    plant.seconds = 8.0;
    const auto found = estimate_of_planted(plant);
    CHECK(found[0].present());
    CHECK(found[0].amplitude_nm == Approx(0.8).epsilon(0.7));
    CHECK_THAT(found[1].insufficient, Catch::Contains("half the sample rate"));
    CHECK_THROWS_AS(estimate_ripple({}, GearRatio(0.0), two_orders), UsageError);
}

TEST_CASE("an order that passes half the sample rate is measured where it is slower") {
    PlantedLog plant;
    plant.rate_hz = 100.0;
    plant.seconds = 30.0;
    plant.speed = [](double t) { return 60.0 + 59.0 * std::sin(0.3 * t); };
    const auto found = estimate_of_planted(plant);
    REQUIRE(found[1].present());
    CHECK(found[1].amplitude_nm == Approx(0.5).epsilon(0.01));
    CHECK(found[1].fastest_deg_s < 90.0);
    CHECK(found[0].fastest_deg_s > 110.0);
}

namespace {

/// Amplitude of order 2 at a signed speed and an angle of the joint; order 1 has always 0.8 Nm.
using Law = std::function<double(double speed_deg_s, double angle_deg)>;

struct LogByLaw {
    Law law = [](double, double) { return 0.5; };
    std::function<double(double)> speed;  ///< deg/s at a time
    double seconds = 60.0, noise_nm = 0.2;
    double memory = 0.0;  ///< of the noise from sample to sample: 0 is white
    unsigned seed = 1;
};

std::vector<RippleAtSpeed> found_in(const LogByLaw& plant) {
    constexpr double ratio = 100.0, rate_hz = 500.0;
    Trace trace;
    trace.sample_rate = Hertz(rate_hz);
    std::mt19937 engine(plant.seed);
    std::normal_distribution<double> normal;
    double angle_deg = 0.0, noise = 0.0;
    for (std::size_t k = 0; static_cast<double>(k) < plant.seconds * rate_hz; ++k) {
        const double t = static_cast<double>(k) / rate_hz, v = plant.speed(t);
        if (k > 0) angle_deg += 0.5 * (v + trace.velocity_deg_s.back()) / rate_hz;
        noise = plant.memory * noise + std::sqrt(1.0 - plant.memory * plant.memory) * normal(engine);
        const double motor = ratio * angle_deg * std::numbers::pi / 180.0;
        trace.time_s.push_back(t);
        trace.velocity_deg_s.push_back(v);
        trace.position_deg.push_back(angle_deg);
        trace.torque_nm.push_back(0.8 * std::cos(motor + 0.5) +
                                  plant.law(v, angle_deg) * std::cos(2.0 * motor - 1.2) +
                                  plant.noise_nm * noise + (v > 0.0 ? 3.0 : -3.0));
    }
    const TraceView view = trace.view();
    return amplitude_by_speed({&view, 1}, GearRatio(ratio), two_orders);
}

/// Back and forth, with speeds from 0 to 90 deg/s.
double sweeping_deg_s(double t) { return 90.0 * std::sin(0.8 * t); }

/// Back and forth at five speeds, each over the same 120 degrees.
double stepping_deg_s(double t) {
    constexpr std::array speeds = {30.0, 45.0, 60.0, 90.0, 120.0};
    double left = std::fmod(t, 2.0 * (4.0 + 8.0 / 3.0 + 2.0 + 4.0 / 3.0 + 1.0));
    for (const double speed : speeds) {
        if (left < 240.0 / speed) return left < 120.0 / speed ? speed : -speed;
        left -= 240.0 / speed;
    }
    return speeds.back();
}

/// What a number of seeds give of order 2.
struct Tally {
    int rows = 0, inside = 0;
};

// An interval is of the log's own amplitude in that range of speed: that of the same motion without noise.
Tally tally_of(LogByLaw plant, int seeds) {
    Tally tally;
    LogByLaw silent = plant;
    silent.noise_nm = 0.0;
    const std::vector<RippleAtSpeed> truth = found_in(silent);
    for (int seed = 0; seed < seeds; ++seed) {
        plant.seed = static_cast<unsigned>(100 + seed);
        const std::vector<RippleAtSpeed> found = found_in(plant);
        REQUIRE(found.size() == truth.size());
        for (std::size_t i = 0; i < found.size(); ++i) {
            const RippleEstimate &one = found[i].ripple, &planted = truth[i].ripple;
            if (one.order != 2.0) continue;
            ++tally.rows;
            const double off = std::abs(one.amplitude_nm - planted.amplitude_nm);
            tally.inside += off <= 1.96 * one.standard_error_nm ? 1 : 0;
        }
    }
    return tally;
}

double growing_nm(double speed_deg_s, double /*angle_deg*/) {
    return (speed_deg_s > 0.0 ? 1.2 : 1.0) * (0.3 + 0.003 * std::abs(speed_deg_s));
}

}  // namespace

TEST_CASE("a planted law of speed and direction comes back, at constant speeds and in sweeps") {
    for (const auto& motion : {sweeping_deg_s, stepping_deg_s}) {
        LogByLaw plant;
        plant.law = growing_nm;
        plant.speed = motion;
        plant.noise_nm = 0.0;
        const std::vector<RippleAtSpeed> found = found_in(plant);
        CHECK(found.size() >= 16);  // two orders, two directions, four ranges
        for (const RippleAtSpeed& at : found) {
            const double expected =
                at.ripple.order == 1.0 ? 0.8 : growing_nm(at.direction * at.speed_deg_s, 0.0);
            CHECK(at.ripple.present());
            CHECK(at.ripple.amplitude_nm == Approx(expected).epsilon(0.01));
            CHECK(at.speed_from_deg_s <= at.speed_deg_s * 1.0001);
            CHECK(at.speed_deg_s <= at.speed_to_deg_s * 1.0001);
        }
    }
}

TEST_CASE("95 % intervals cover, in white and coloured noise") {
    for (const auto& motion : {sweeping_deg_s, stepping_deg_s}) {
        for (const double memory : {0.0, 0.9}) {
            LogByLaw plant;
            plant.law = growing_nm;
            plant.speed = motion;
            plant.noise_nm = 0.5;
            plant.memory = memory;
            const Tally tally = tally_of(plant, 25);
            INFO(tally.inside << " of " << tally.rows << " intervals, memory " << memory);
            CHECK(tally.inside >= 0.90 * tally.rows);
            CHECK(tally.inside <= 0.99 * tally.rows);
        }
    }
}

TEST_CASE("one speed has a row a direction, and too little motion none") {
    LogByLaw plant;
    plant.speed = [](double t) { return std::fmod(t, 4.0) < 2.0 ? 60.0 : -60.0; };
    CHECK(found_in(plant).size() == 4);
    plant.seconds = 1.0;  // 17 motor turns
    CHECK(found_in(plant).empty());
}
