// SPDX-License-Identifier: MIT
// The ripple by speed and direction: known laws, and what is claimed of intervals and of changes.

#include "ripplenotch/analysis/amplitude_by_speed.hpp"

#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <string>

#include "support/catch.hpp"

using namespace ripplenotch;

namespace {

constexpr std::array two_orders = {Order(1.0), Order(2.0)};

/// Amplitude of order 2 at a signed speed and an angle of the joint; order 1 has always 0.8 Nm.
using Law = std::function<double(double speed_deg_s, double angle_deg)>;

struct PlantedLog {
    Law law = [](double, double) { return 0.5; };
    std::function<double(double)> speed;  ///< deg/s at a time
    double seconds = 60.0, noise_nm = 0.2;
    double memory = 0.0;  ///< of the noise from sample to sample: 0 is white
    unsigned seed = 1;
};

AmplitudeBySpeed found_in(const PlantedLog& plant) {
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
    int rows = 0, inside = 0, logs = 0, by_speed = 0, by_direction = 0;
};

// An interval is of the log's own amplitude in that range of speed: that of the same motion without noise.
Tally tally_of(PlantedLog plant, int seeds) {
    Tally tally;
    PlantedLog silent = plant;
    silent.noise_nm = 0.0;
    const AmplitudeBySpeed truth = found_in(silent);
    for (int seed = 0; seed < seeds; ++seed) {
        plant.seed = static_cast<unsigned>(100 + seed);
        const AmplitudeBySpeed found = found_in(plant);
        REQUIRE(found.ripple.size() == truth.ripple.size());
        for (std::size_t i = 0; i < found.ripple.size(); ++i) {
            const RippleEstimate &one = found.ripple[i].ripple, &planted = truth.ripple[i].ripple;
            if (one.order != 2.0) continue;
            ++tally.rows;
            const double off = std::abs(one.amplitude_nm - planted.amplitude_nm);
            tally.inside += off <= 1.96 * one.standard_error_nm ? 1 : 0;
        }
        const AmplitudeChange& change = found.changes.back();
        ++tally.logs;
        tally.by_speed += change.speed_chance.value_or(1.0) <= change_false_alarm ? 1 : 0;
        tally.by_direction += change.direction_chance.value_or(1.0) <= change_false_alarm ? 1 : 0;
    }
    return tally;
}

double growing_nm(double speed_deg_s, double /*angle_deg*/) {
    return (speed_deg_s > 0.0 ? 1.2 : 1.0) * (0.3 + 0.003 * std::abs(speed_deg_s));
}

}  // namespace

TEST_CASE("a planted law of speed and direction comes back, at constant speeds and in sweeps") {
    for (const auto& motion : {sweeping_deg_s, stepping_deg_s}) {
        PlantedLog plant;
        plant.law = growing_nm;
        plant.speed = motion;
        plant.noise_nm = 0.0;
        const AmplitudeBySpeed found = found_in(plant);
        CHECK(found.ripple.size() >= 16);  // two orders, two directions, four ranges
        for (const RippleAtSpeed& at : found.ripple) {
            const double expected =
                at.ripple.order == 1.0 ? 0.8 : growing_nm(at.direction * at.speed_deg_s, 0.0);
            CHECK(at.ripple.present());
            CHECK(at.ripple.amplitude_nm == Approx(expected).epsilon(0.01));
            CHECK(at.speed_from_deg_s <= at.speed_deg_s * 1.0001);
            CHECK(at.speed_deg_s <= at.speed_to_deg_s * 1.0001);
        }
    }
}

TEST_CASE("95 % intervals cover, and a change is found with its size, in white and coloured noise") {
    for (const auto& motion : {sweeping_deg_s, stepping_deg_s}) {
        for (const double memory : {0.0, 0.9}) {
            PlantedLog plant;
            plant.law = growing_nm;
            plant.speed = motion;
            plant.noise_nm = 0.5;
            plant.memory = memory;
            const Tally tally = tally_of(plant, 25);
            INFO(tally.inside << " of " << tally.rows << " intervals, memory " << memory);
            CHECK(tally.inside >= 0.90 * tally.rows);
            CHECK(tally.inside <= 0.99 * tally.rows);
            CHECK(tally.by_speed == tally.logs);
            CHECK(tally.by_direction == tally.logs);
        }
    }
    PlantedLog plant;
    plant.law = growing_nm;
    plant.speed = stepping_deg_s;
    const auto found = found_in(plant).changes;
    CHECK_THAT(found[0].sentence,
               Catch::Contains("order 1: no change with speed or direction found: within"));
    CHECK_THAT(found[1].sentence,
               Catch::Contains("order 2 grows with speed: 0.4") &&
                   Catch::Contains(" Nm at 30 deg/s to 0.7") &&
                   Catch::Contains(" Nm at 120 deg/s (p < 1e-09); differs by direction: 0.") &&
                   Catch::Contains(" Nm forward, 0."));
}

TEST_CASE("a constant amplitude is not claimed to change") {
    for (const auto& motion : {sweeping_deg_s, stepping_deg_s}) {
        for (const double noise_nm : {0.0, 0.2, 3.0}) {
            PlantedLog plant;
            plant.speed = motion;
            plant.seconds = 30.0;
            plant.noise_nm = noise_nm;
            plant.memory = noise_nm < 1.0 ? 0.9 : 0.0;
            const Tally tally = tally_of(plant, noise_nm > 0.0 ? 50 : 1);
            INFO("noise " << noise_nm << " Nm");
            CHECK(tally.by_speed * 25 <= tally.logs);
            CHECK(tally.by_direction * 25 <= tally.logs);
        }
    }
}

TEST_CASE("a change of the size that a log without one states is found in 95 of 100") {
    PlantedLog plant;
    plant.speed = stepping_deg_s;
    plant.seconds = 30.0;
    plant.noise_nm = 0.5;
    const std::string text = found_in(plant).changes[1].sentence;
    const std::string before = "within ";
    REQUIRE(text.find(before) != std::string::npos);
    const double share = std::stod(text.substr(text.find(before) + before.size())) / 100.0;
    // The mean of the amplitudes over the speeds remains what it was; 30 to 90 deg/s in a log this short.
    plant.law = [&](double speed, double) { return 0.5 * (1.0 + share * (std::abs(speed) - 60.0) / 60.0); };
    const Tally tally = tally_of(plant, 40);
    INFO(text << "; found " << tally.by_speed);
    CHECK(tally.by_speed >= 34);
}

TEST_CASE("one speed gives no statement on speed, and too little motion gives its reason") {
    PlantedLog plant;
    plant.speed = [](double t) { return std::fmod(t, 4.0) < 2.0 ? 60.0 : -60.0; };
    auto found = found_in(plant);
    CHECK(found.ripple.size() == 4);
    CHECK_FALSE(found.changes[1].speed_chance);
    CHECK(found.changes[1].direction_chance);
    plant.seconds = 1.0;  // 17 motor turns
    found = found_in(plant);
    CHECK(found.ripple.empty());
    CHECK_THAT(found.changes[1].sentence, Catch::Contains("too little motion"));
}
