// SPDX-License-Identifier: MIT
// The ripple at stated orders, of a log and by speed and direction.
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

#include "ripplenotch/analysis/ripple_estimate.hpp"
#include "ripplenotch/analysis/ripple_meter.hpp"
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

namespace {

constexpr double ratio = 100.0;
constexpr std::array orders = {Order(1.0), Order(2.0)};

struct Plant {
    double first_nm = 1.0, second_nm = 0.3, noise_nm = 0.0, rate_hz = 1000.0;
    double position_step_deg = 0.0;  ///< resolution of the encoder; 0 is none
    std::function<double(double)> trend = [](double) { return 0.0; };
};

// Runs a speed over time through a meter with two signals: the planted torque, and the same with a tenth of
// the ripple.
RippleLevels measure(const std::function<double(double)>& speed, double seconds, const Plant& plant,
                     bool position, const std::vector<double>& gaps_s = {}) {
    RippleMeter meter(GearRatio(ratio), orders, Hertz(plant.rate_hz), 2);
    std::mt19937 engine(31);
    std::normal_distribution<double> noise(0.0, 1.0);
    double angle_deg = 0.0, last = speed(0.0);
    for (std::size_t k = 0; k < static_cast<std::size_t>(seconds * plant.rate_hz); ++k) {
        const double t = static_cast<double>(k) / plant.rate_hz, v = speed(t);
        if (k > 0) angle_deg += 0.5 * (last + v) / plant.rate_hz;
        last = v;
        const double motor = ratio * angle_deg * std::numbers::pi / 180.0;
        const double ripple =
            plant.first_nm * std::sin(motor + 0.4) + plant.second_nm * std::sin(2.0 * motor + 1.0);
        const double rest = plant.trend(t) + plant.noise_nm * noise(engine);
        const std::array torque = {rest + ripple, rest + 0.1 * ripple};
        double read = angle_deg;
        if (plant.position_step_deg > 0.0)
            read = plant.position_step_deg * std::round(read / plant.position_step_deg);
        for (const double gap : gaps_s) {
            if (k == static_cast<std::size_t>(gap * plant.rate_hz)) meter.split();
        }
        meter.add(Seconds(t), v, position ? &read : nullptr, torque);
    }
    return meter.levels();
}

double constant(double) { return 90.0; }

}  // namespace

TEST_CASE(
    "planted amplitudes come back within 1 % at constant, ramping and reversing speed, from position or "
    "velocity") {
    const std::vector<std::function<double(double)>> speeds = {
        constant, [](double) { return -35.0; }, [](double t) { return 20.0 + 25.0 * t; },
        [](double t) { return 120.0 * std::sin(0.8 * t); }, [](double t) { return -150.0 + 30.0 * t; }};
    Plant plant;
    plant.trend = [](double t) { return 8.0 + 3.0 * std::sin(1.1 * t); };
    for (std::size_t i = 0; i < speeds.size(); ++i) {
        for (const bool position : {false, true}) {
            INFO("speed " << i << ", position " << position);
            const RippleLevels levels = measure(speeds[i], 8.0, plant, position);
            REQUIRE(levels.windows > 3);
            for (std::size_t j = 0; j < 2; ++j) {
                const double scale = j == 0 ? 1.0 : 0.1;
                CHECK(levels.orders[0].amplitude_nm[j] == Approx(1.0 * scale).epsilon(0.01).margin(0.002));
                CHECK(levels.orders[1].amplitude_nm[j] == Approx(0.3 * scale).epsilon(0.01).margin(0.001));
            }
        }
    }
}

TEST_CASE("at 90 deg/s the figures are those of two sines worked out by hand") {
    Plant plant;
    plant.second_nm = 0.0;
    const RippleLevels levels = measure(constant, 10.0, plant, true);
    CHECK(levels.orders[0].mean_hz == Approx(25.0).epsilon(1e-9));
    CHECK(levels.orders[1].mean_hz == Approx(50.0).epsilon(1e-9));
    CHECK(levels.orders[0].amplitude_nm[0] == Approx(1.0).epsilon(1e-6));
    CHECK(levels.orders[1].amplitude_nm[0] == Approx(0.0).margin(1e-6));
    // Exact up to what of eight turns the trend takes for itself.
    CHECK(levels.residual_rms_nm[0] == Approx(std::sqrt(0.5)).epsilon(0.005));
    CHECK(levels.ripple_peak_to_peak_nm[0] == Approx(2.0).epsilon(0.01));
    CHECK(levels.residual_peak_to_peak_nm[0] == Approx(2.0).epsilon(0.02));
    CHECK(levels.measured_share > 0.95);
    CHECK(levels.measured_share <= 1.0);
}

TEST_CASE("noise alone gives amplitudes of the size that least squares gives noise, and no more") {
    Plant plant;
    plant.first_nm = plant.second_nm = 0.0;
    plant.noise_nm = 0.1;
    const RippleLevels levels = measure(constant, 60.0, plant, true);
    // Over N rows that count alike each coefficient has variance 2 sigma^2 / N, under a Hann window 1.5 times
    // that, the squared amplitude twice that; N is 8 turns, 320 rows.
    const double expected = 0.1 * std::sqrt(1.5 * 4.0 / 321.0);
    CHECK(levels.orders[0].amplitude_nm[0] == Approx(expected).epsilon(0.2));
    CHECK(levels.orders[1].amplitude_nm[0] == Approx(expected).epsilon(0.2));
    CHECK(levels.residual_rms_nm[0] == Approx(0.1).epsilon(0.02));
}

TEST_CASE("a trend of the third degree leaves a ten-thousandth of itself in the residual, and no ripple") {
    Plant plant;
    plant.first_nm = plant.second_nm = 0.0;
    plant.trend = [](double t) { return 100.0 - 20.0 * t + 3.0 * t * t - 0.5 * t * t * t; };
    const RippleLevels levels = measure(constant, 5.0, plant, false);
    CHECK(levels.residual_rms_nm[0] < 1e-2);
    CHECK(levels.orders[0].amplitude_nm[0] < 1e-3);
}

TEST_CASE("an encoder of 16 bits costs less than a tenth of a per cent") {
    Plant plant;
    plant.position_step_deg = 360.0 / 65536.0;
    const RippleLevels levels = measure(constant, 8.0, plant, true);
    CHECK(levels.orders[0].amplitude_nm[0] == Approx(1.0).epsilon(0.001));
    CHECK(levels.orders[1].amplitude_nm[0] == Approx(0.3).epsilon(0.001));
}

TEST_CASE("a position that wraps around is unwrapped") {
    RippleMeter meter(GearRatio(ratio), orders, Hertz(1000.0), 1);
    for (int k = 0; k < 9000; ++k) {
        const double angle_deg = 0.09 * k, motor = ratio * angle_deg * std::numbers::pi / 180.0;
        const double wrapped = std::remainder(angle_deg, 360.0), torque = std::sin(motor);
        meter.add(Seconds(k / 1000.0), 90.0, &wrapped, {&torque, 1});
    }
    CHECK(meter.levels().orders[0].amplitude_nm[0] == Approx(1.0).epsilon(1e-3));
}

TEST_CASE("slow motion is measured, but neither rest nor an order above half the sample rate") {
    const RippleLevels still = measure([](double) { return 0.0; }, 10.0, {}, true);
    CHECK(still.windows == 0);
    CHECK(still.measured_share == 0.0);
    const RippleLevels slow = measure([](double) { return 1.5; }, 20.0, {}, true);  // 8 turns take 19 s
    CHECK(slow.windows > 0);
    CHECK(slow.orders[0].amplitude_nm[0] == Approx(1.0).epsilon(0.01));
    Plant sparse;
    sparse.rate_hz = 100.0;
    const RippleLevels fast = measure([](double) { return 150.0; }, 20.0, sparse, true);  // order 2 at 83 Hz
    CHECK(fast.orders[0].windows > 0);
    CHECK(fast.orders[1].windows == 0);
    CHECK(std::isnan(fast.orders[1].amplitude_nm[0]));
}

TEST_CASE("rests before, between and after motions move no amplitude") {
    // Poly6 from rest to rest, of 180 deg in 2 s, with the torque of its acceleration, between rests of 1 s.
    const auto speed = [](double t) {
        const double s = std::fmod(t, 4.0) - 1.0;
        if (s < 0.0 || s > 2.0) return 0.0;
        return (t < 4.0 ? 180.0 : -180.0) / 2.0 * 30.0 * std::pow(s / 2.0 * (1.0 - s / 2.0), 2);
    };
    Plant plant;
    plant.trend = [&speed](double t) { return 0.05 * (speed(t + 1e-4) - speed(t - 1e-4)) / 2e-4; };
    const RippleLevels levels = measure(speed, 8.0, plant, true);
    CHECK(levels.orders[0].amplitude_nm[0] == Approx(1.0).epsilon(0.01));
    CHECK(levels.orders[1].amplitude_nm[0] == Approx(0.3).epsilon(0.01));
}

TEST_CASE("a log longer than what is held, and than what is fitted, has the amplitude of its parts") {
    Plant plant;
    plant.rate_hz = 500.0;
    plant.noise_nm = 0.2;
    const RippleLevels levels =
        measure([](double t) { return 90.0 * std::sin(0.1 * t); }, 800.0, plant, true);
    CHECK(levels.orders[0].amplitude_nm[0] == Approx(1.0).epsilon(0.01));
    CHECK(levels.orders[1].amplitude_nm[0] == Approx(0.3).epsilon(0.03));
    CHECK(levels.measured_share > 0.9);
    CHECK(levels.measured_share <= 1.0);
}

TEST_CASE("a gap starts a new window, and a run counts for the orders of which it holds four periods") {
    // 8 turns at 90 deg/s take 0.32 s; a gap every 0.2 s leaves 5 turns each.
    std::vector<double> gaps;
    for (int i = 1; i < 40; ++i) gaps.push_back(0.2 * i);
    const RippleLevels levels = measure(constant, 8.0, {}, true, gaps);
    CHECK(levels.windows == 40);
    CHECK(levels.orders[0].amplitude_nm[0] == Approx(1.0).epsilon(0.01));
    gaps.clear();
    for (int i = 1; i < 80; ++i) gaps.push_back(0.1 * i);
    const RippleLevels shorter = measure(constant, 8.0, {}, true, gaps);
    CHECK(shorter.orders[0].windows == 0);
    CHECK(shorter.orders[1].windows == 80);
}

TEST_CASE("asking for levels does not disturb the measurement") {
    RippleMeter a(GearRatio(ratio), orders, Hertz(1000.0), 1), b(GearRatio(ratio), orders, Hertz(1000.0), 1);
    for (int k = 0; k < 3000; ++k) {
        const double torque = std::sin(2.0 * std::numbers::pi * 0.025 * k);
        a.add(Seconds(k / 1000.0), 90.0, nullptr, {&torque, 1});
        b.add(Seconds(k / 1000.0), 90.0, nullptr, {&torque, 1});
        if (k % 100 == 0) static_cast<void>(a.levels());
    }
    CHECK(a.levels().orders[0].amplitude_nm == b.levels().orders[0].amplitude_nm);
    CHECK(a.levels().windows == b.levels().windows);
}

TEST_CASE("a meter refuses what it cannot measure") {
    CHECK_THROWS_AS(RippleMeter(GearRatio(0.0), orders, Hertz(1000.0), 1), UsageError);
    CHECK_THROWS_AS(RippleMeter(GearRatio(100.0), {}, Hertz(1000.0), 1), UsageError);
    CHECK_THROWS_AS(RippleMeter(GearRatio(100.0), orders, Hertz(0.0), 1), UsageError);
    CHECK_THROWS_AS(RippleMeter(GearRatio(100.0), orders, Hertz(1000.0), 0), UsageError);
    const std::array negative = {Order(-1.0)};
    CHECK_THROWS_AS(RippleMeter(GearRatio(100.0), negative, Hertz(1000.0), 1), UsageError);
}

TEST_CASE("the expected gain is that of the speeds of the windows, phase and all") {
    const auto expected = [](const std::function<double(double)>& speed, const LineGains& gains) {
        RippleMeter meter(GearRatio(ratio), orders, Hertz(1000.0), 1, gains);
        double angle_deg = 0.0;
        for (int k = 0; k < 8000; ++k) {
            const double v = speed(k / 1000.0);
            angle_deg += v / 1000.0;
            meter.add(Seconds(k / 1000.0), v, &angle_deg,
                      std::array{std::sin(ratio * angle_deg * std::numbers::pi / 180.0)});
        }
        const RippleLevels levels = meter.levels();
        REQUIRE(levels.windows > 5);
        return std::array{*levels.orders[0].expected_gain, *levels.orders[1].expected_gain};
    };
    const LineGains by_speed = [](double speed, std::span<std::complex<double>> gains) {
        gains[0] = speed / 100.0;
        gains[1] = 0.25;
    };
    const auto steady = expected([](double) { return 60.0; }, by_speed);
    CHECK(steady[0] == Approx(0.6).epsilon(1e-6));
    CHECK(steady[1] == Approx(0.25));
    // Along a ramp from 40 to 80 deg/s the gain is the root of the mean square speed, over the angle.
    const auto ramp = expected([](double t) { return 40.0 + 5.0 * t; }, by_speed);
    CHECK(ramp[0] == Approx(std::sqrt((40.0 * 40.0 + 80.0 * 80.0) / 2.0) / 100.0).epsilon(0.02));
    // A line whose sign turns in the middle of a window is one that the window's fit sees as nothing.
    int calls = 0;
    const auto turning = expected([](double) { return 60.0; },
                                  [&calls](double, std::span<std::complex<double>> gains) {
                                      gains[0] = gains[1] = calls++ % 16 < 8 ? 1.0 : -1.0;
                                  });
    CHECK(turning[0] == Approx(0.0).margin(0.01));
    RippleMeter plain(GearRatio(ratio), orders, Hertz(1000.0), 1);
    CHECK_FALSE(plain.levels().orders[0].expected_gain.has_value());
}
