// SPDX-License-Identifier: MIT
// Each effect against figures worked by hand, or against an independent formula in the C library's functions.
#include <fmt/format.h>

#include <complex>
#include <numbers>

#include "effects_fixture.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using namespace ripplenotch::fixture;
using std::numbers::pi;

namespace {

Motion move(std::vector<std::string> specs, double rate_hz = 1000.0) {
    return make_motion(specs, Hertz(rate_hz));
}

// Constant speed, first sample: the torque at that speed.
double at_speed(std::initializer_list<std::string_view> terms, double speed_deg_s) {
    return predict_nm(model_of(terms), move({fmt::format("constant,duration=1s,speed={}", speed_deg_s)}, 1.0))
        .front();
}

}  // namespace

TEST_CASE(
    "drift begins with its slope and ends at slope times time constant, and at the bound it is a line") {
    const Motion m = move({"rest,duration=100s"}, 10.0);
    const auto torque = predict_nm(model_of({"drift,rate_nm_s=0.05,time_constant_s=4"}), m);
    CHECK(torque[0] == 0.0);
    CHECK(torque[1] / 0.1 == Approx(0.05).epsilon(0.02));
    CHECK(torque[40] == Approx(0.2 * (1.0 - std::exp(-1.0))));
    CHECK(torque.back() == Approx(0.2));
    CHECK(predict_nm(model_of({"drift,rate_nm_s=-0.05,time_constant_s=1e6"}), m)[400] ==
          Approx(-2.0).epsilon(1e-4));
}

TEST_CASE("friction: quadratic quadruples at double speed, Stribeck fades beyond its speed") {
    constexpr std::string_view quadratic = "quadratic-viscous-friction,coefficient_nm_per_deg2_s2=2e-5";
    CHECK(at_speed({quadratic}, 100.0) == Approx(0.2));
    CHECK(at_speed({quadratic}, -200.0) == Approx(-0.8));
    constexpr std::string_view stribeck = "stribeck-friction,torque_nm=0.8,stribeck_speed_deg_s=10";
    CHECK(at_speed({stribeck}, 0.0) == 0.0);
    CHECK(at_speed({stribeck}, 2.0) == Approx(0.8 * std::exp(-0.04)));
    CHECK(at_speed({stribeck}, -10.0) == Approx(-0.8 / std::numbers::e));
    CHECK(std::abs(at_speed({stribeck}, 60.0)) < 1e-15);
}

TEST_CASE("load friction follows the torque of inertia and gravity, whatever else the model holds") {
    // 2 kg m2 at 1 rad/s2: a load of 2 Nm, from either end; the friction has the sign of the speed.
    constexpr std::string_view friction = "load-friction,torque_nm=0.1,exponent=2";
    const Motion slowing = move({"ramp,from-speed=10rad/s,to-speed=9rad/s,duration=1s"}, 10.0);
    for (const auto extra : {"offset,torque_nm=0", "offset,torque_nm=7"}) {
        const auto with_friction = predict_nm(model_of({"inertia,inertia_kgm2=2", friction, extra}), slowing);
        const auto without = predict_nm(model_of({"inertia,inertia_kgm2=2", extra}), slowing);
        for (std::size_t k = 0; k < slowing.size(); ++k)
            CHECK(with_friction[k] - without[k] == Approx(0.1 * 4.0));
    }
    CHECK(at_speed({"gravity,amplitude_nm=3,phase_deg=180", "load-friction,torque_nm=0.1,exponent=1"},
                   -50.0) == Approx(-3.0 - 0.3));
}

TEST_CASE("hysteresis turns over 63 % of the way within its width, and stays at rest") {
    const Motion m = move(
        {"constant,speed=10deg/s,duration=10s", "rest,duration=1s", "constant,speed=-10deg/s,duration=10s"},
        100.0);
    const auto torque = predict_nm(model_of({"hysteresis,torque_nm=0.6,width_deg=2"}), m);
    CHECK(torque[0] == 0.0);
    CHECK(torque[20] == Approx(0.6 * (1.0 - std::exp(-1.0))));  // 2 deg on
    CHECK(torque[999] == Approx(0.6).epsilon(1e-10));
    CHECK(torque[1050] == Approx(0.6).epsilon(1e-10));
    CHECK(torque[1120] == Approx(0.6 * (-1.0 + 2.0 * std::exp(-1.0))).epsilon(0.02));  // 2 deg back
    CHECK(torque.back() == Approx(-0.6));
    // A log that begins wound up stays so until the joint turns.
    const auto wound = predict_nm(model_of({"hysteresis,torque_nm=0.6,width_deg=2,initial_state=-0.5"}),
                                  move({"rest,duration=1s", "constant,speed=10deg/s,duration=1s"}, 100.0));
    CHECK(wound[99] == Approx(-0.3));
    CHECK(wound[120] == Approx(0.6 * (1.0 - 1.5 * std::exp(-1.0))).epsilon(0.02));
}

TEST_CASE("hysteresis does not creep with the noise of a joint at rest") {
    Motion m = move({"constant,speed=10deg/s,duration=0.1s", "rest,duration=60s"});
    std::mt19937_64 engine(3);
    std::normal_distribution<double> noise(0.0, 0.1);
    for (std::size_t k = 100; k < m.size(); ++k) {
        m.velocity_deg_s[k] = noise(engine);
        m.position_deg[k] = m.position_deg[k - 1] + 1e-3 * m.velocity_deg_s[k];
    }
    const auto torque = predict_nm(model_of({"hysteresis,torque_nm=1,width_deg=1"}), m);
    // The position itself wanders by about 0.1 deg * sqrt(1e-3 s * 60 s) = 0.024 deg.
    for (std::size_t k = 100; k < m.size(); ++k) REQUIRE(torque[k] == Approx(torque[100]).margin(0.1));
}

TEST_CASE("ringing starts with the start, turns round with the stop, and repeats in the other direction") {
    const Motion m = move({"rest,duration=1s", "constant,speed=20deg/s,duration=1s", "rest,duration=1s",
                           "constant,speed=-20deg/s,duration=1s"});
    const auto torque = predict_nm(
        model_of({"start-stop-ringing,amplitude_nm=0.5,phase_deg=30,frequency_hz=8,decay_s=0.1"}), m);
    const auto ring = [](double t) {
        return t < 0.0 ? 0.0 : 0.5 * std::exp(-t / 0.1) * std::cos(16.0 * pi * t + pi / 6.0);
    };
    for (std::size_t k = 0; k < m.size(); ++k) {
        const double t = m.time_s[k];
        REQUIRE(torque[k] == Approx(ring(t - 1.0) - ring(t - 2.0) - ring(t - 3.0)).margin(1e-12));
    }
}

TEST_CASE("ripple that depends on speed, load, direction: gains worked by hand") {
    // At position 0 with phase 0 the ripple is at its peak, so that its torque there is its size.
    constexpr std::string_view one = "ripple,order=1,amplitude_nm=2,phase_deg=0",
                               two = "ripple,order=2,amplitude_nm=1,phase_deg=0";
    CHECK(at_speed({one, "ripple-speed-dependence,gain_percent=40,exponent=1"}, -50.0) == Approx(2.4));
    CHECK(at_speed({one, "ripple-speed-dependence,gain_percent=40,exponent=2"}, 200.0) == Approx(5.2));
    CHECK(at_speed({one, two, "ripple-speed-dependence,gain_percent=40,exponent=1"}, 100.0) == Approx(4.2));
    CHECK(at_speed({one, two, "ripple-speed-dependence,gain_percent=40,exponent=1,order=2"}, 100.0) ==
          Approx(3.4));
    CHECK(at_speed({one, "ripple-speed-dependence,gain_percent=40,exponent=2,from_deg_s=50"}, 50.0) ==
          Approx(2.0));
    CHECK(at_speed({one, "ripple-speed-dependence,gain_percent=40,exponent=2,from_deg_s=50"}, 0.0) ==
          Approx(1.2));
    CHECK(at_speed({one, "ripple-speed-dependence,gain_percent=100,exponent=2,from_deg_s=50"}, -100.0) ==
          Approx(8.0));
    CHECK(at_speed(
              {one, "gravity,amplitude_nm=3,phase_deg=180", "ripple-load-dependence,gain_percent_per_nm=10"},
              0.0) == Approx(2.0 * 1.3 - 3.0));
    CHECK(at_speed({one, "ripple-direction-dependence,gain_percent=25,phase_deg=0"}, 50.0) == Approx(2.5));
    CHECK(at_speed({one, "ripple-direction-dependence,gain_percent=25,phase_deg=0"}, -50.0) == Approx(1.5));
    CHECK(at_speed({one, "ripple-direction-dependence,gain_percent=0,phase_deg=60"}, -50.0) == Approx(1.0));
}

TEST_CASE("a change of the ripple stated from another speed is the same torque with another amplitude") {
    for (const Effect* effect : catalogue()) {
        if (!effect->restate) continue;
        CAPTURE(effect->name);
        std::mt19937_64 engine(12);
        for (const auto& [from, to] : {std::pair(0.0, 60.0), {60.0, 0.0}, {60.0, 25.0}}) {
            auto values = random_values(*effect, engine);
            values[*effect->stated_from] = from;
            const auto before = predict_nm(with(base_model(), *effect, values), rich_motion());
            const double amplitude = effect->restate(to, values);
            CHECK(values[*effect->stated_from] == to);
            Model after = with(base_model(), *effect, values);
            for (Term& term : after.terms) {
                if (term.effect->ripple_order) *term.values[term.effect->polar->size] *= amplitude;
            }
            CHECK(largest_difference(predict_nm(after, rich_motion()), before) < 1e-11);
        }
    }
}

TEST_CASE("modulation splits a line into three") {
    const Motion m = move({"constant,speed=36deg/s,duration=10s"});
    const auto torque =
        predict_nm(model_of({"ripple,order=1,amplitude_nm=2,phase_deg=10",
                             "ripple-modulation,output_order=3,depth_percent=50,phase_deg=20"}),
                   m);
    for (std::size_t k = 0; k < m.size(); ++k) {
        const double q = m.position_deg[k] * pi / 180.0, p = pi / 18.0;
        const double lines = 2.0 * std::cos(100.0 * q + p) + 0.5 * std::cos(103.0 * q + 3.0 * p) +
                             0.5 * std::cos(97.0 * q - p);
        REQUIRE(torque[k] == Approx(lines).margin(1e-9));
    }
}

TEST_CASE("a resonance answers each line as a mass on a spring does at its frequency, in both directions") {
    for (const double speed : {72.0, -72.0, 144.0, 288.0}) {  // order 1 at 20, 40, 80 Hz
        const Motion m = move({fmt::format("constant,duration=1s,speed={}", speed)});
        const auto torque = predict_nm(
            model_of({"ripple,order=1,amplitude_nm=1,phase_deg=25", "resonance,frequency_hz=40,damping=0.1"}),
            m);
        // x'' + 2 D w0 x' + w0^2 x = w0^2 cos(w t + 25 deg), solved in the frequency domain.
        const double w = 2.0 * pi * speed / 3.6, w0 = 2.0 * pi * 40.0;
        const auto response = w0 * w0 / (w0 * w0 - w * w + std::complex(0.0, 2.0 * 0.1 * w0 * w));
        for (std::size_t k = 0; k < m.size(); ++k) {
            const auto turned = response * std::polar(1.0, w * m.time_s[k] + 25.0 * pi / 180.0);
            REQUIRE(torque[k] == Approx(turned.real()).margin(1e-9));
        }
    }
}

TEST_CASE("output ripple and tone: one follows the position, the other the clock") {
    const Motion m = move({"constant,speed=90deg/s,duration=4s"}, 1.0);
    CHECK(predict_nm(model_of({"output-ripple,order=2,amplitude_nm=3,phase_deg=0"}), m) ==
          std::vector<double>{3.0, -3.0, 3.0, -3.0});
    const Motion rest = move({"rest,duration=1s"}, 200.0);
    const auto hum = predict_nm(model_of({"tone,frequency_hz=50,amplitude_nm=0.1,phase_deg=90"}), rest);
    CHECK(hum[0] == 0.0);
    CHECK(hum[1] == Approx(-0.1));
    CHECK(hum[4] == Approx(0.0).margin(1e-12));
}

TEST_CASE("delay and lag move the torque in time, and a delayed model is the model on the motion of before") {
    const Motion m = move({"sine,amplitude=40deg,frequency=1Hz,duration=3s"});
    const auto delayed =
        predict_nm(model_of({"inertia,inertia_kgm2=1", "ripple,order=1,amplitude_nm=1,phase_deg=0",
                             "delay,delay_s=4.3ms"}),
                   m);
    // The sine starts from rest at -90 deg of phase.
    for (std::size_t k = 100; k + 20 < m.size(); ++k) {
        const double t = m.time_s[k] - 0.0043, w = 2.0 * pi;
        const double q = 40.0 * (1.0 - std::cos(w * t)), a = 40.0 * w * w * std::cos(w * t);
        REQUIRE(delayed[k] == Approx(a * pi / 180.0 + std::cos(100.0 * q * pi / 180.0)).margin(2e-6));
    }
    const auto ramp =
        predict_nm(model_of({"viscous-friction,coefficient_nm_per_deg_s=1", "lag,time_constant_s=20ms"}),
                   move({"ramp,to-speed=100deg/s,duration=1s"}));
    CHECK(ramp[900] == Approx(90.0 - 2.0).epsilon(1e-10));
}

TEST_CASE("the converter clips and rounds noise along with torque") {
    const Motion m = move({"rest,duration=4s"}, 1.0);
    const std::vector<double> noise = {0.26, -0.74, 3.0, -3.0};
    CHECK(measure_nm(model_of({"offset,torque_nm=1", "saturation,limit_nm=1.5"}), m, noise) ==
          std::vector<double>{1.26, 0.26, 1.5, -1.5});
    CHECK(measure_nm(model_of({"quantization,step_nm=0.5"}), m, noise) ==
          std::vector<double>{0.5, -0.5, 3.0, -3.0});
    // A sensor's effect comes before the noise, wherever it stands in the list.
    const auto late = measure_nm(
        model_of({"saturation,limit_nm=1.5", "offset,torque_nm=1", "lag,time_constant_s=10s"}), m, noise);
    CHECK(largest_difference(late, {1.26, 0.26, 1.5, -1.5}) < 1e-12);
}

TEST_CASE("spikes hit their share of the samples, up and down alike") {
    const Motion m = move({"rest,duration=100s"});
    const auto torque = measure_nm(model_of({"spikes,rate_percent=0.5,size_nm=4"}), m, {});
    const auto up = std::count(torque.begin(), torque.end(), 4.0),
               down = std::count(torque.begin(), torque.end(), -4.0);
    CHECK(up + down + std::count(torque.begin(), torque.end(), 0.0) == 100000);
    // 500 expected; four standard deviations are 89, and 63 for each sign.
    CHECK(std::abs(static_cast<double>(up + down) - 500.0) < 89.0);
    CHECK(std::abs(static_cast<double>(up) - 250.0) < 63.0);
}

TEST_CASE("dropouts hold the value before them, as often and as long as asked") {
    const Motion m = move({"constant,speed=1deg/s,duration=400s"}, 1000.0);
    const auto torque =
        measure_nm(model_of({"viscous-friction,coefficient_nm_per_deg_s=1",
                             "drift,rate_nm_s=1,time_constant_s=1e6", "dropout,rate_hz=0.5,duration_s=0.1"}),
                   m, {});
    std::size_t stretches = 0, held = 0;
    for (std::size_t k = 1; k < torque.size(); ++k) {
        const bool same = torque[k] == torque[k - 1];
        held += same;
        stretches += same && torque[k - 1] != torque[k - (k > 1 ? 2 : 1)];
    }
    CHECK(std::abs(static_cast<double>(stretches) - 200.0) < 57.0);  // four standard deviations
    CHECK(static_cast<double>(held) / static_cast<double>(stretches) == Approx(100.0).margin(10.0));
}

TEST_CASE(
    "a wrong gear ratio is the model of the right one, and a velocity bias turns the ripple on with time") {
    Model wrong = base_model(), right = base_model();
    right.gear_ratio = GearRatio(80.0);
    wrong.terms.push_back(parse_term("gear-ratio,error_percent=-20"));
    CHECK(predict_nm(wrong, rich_motion()) == predict_nm(right, rich_motion()));
    // 0.9 deg/s for 1 s: 0.9 deg of the joint, a quarter of a cycle of order 1.
    const auto torque =
        predict_nm(model_of({"ripple,order=1,amplitude_nm=1,phase_deg=90", "velocity-bias,bias_deg_s=0.9"}),
                   move({"rest,duration=2s"}, 1.0));
    CHECK(torque[0] == 0.0);
    CHECK(torque[1] == Approx(1.0));
}
