// SPDX-License-Identifier: MIT
// The response of a mass on a damped spring against the equation of motion, integrated in steps a hundred
// times finer.
#include "model/spring/mass_on_spring.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "ripplenotch/model/model.hpp"
#include "ripplenotch/model/motion.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using std::numbers::pi;

namespace {

using Complex = std::complex<double>;

// Angle in deg and speed of a joint that goes from one speed to another and back to rest, smoothly.
struct Ride {
    double fastest_deg_s;
    [[nodiscard]] double speed(double t) const {
        const double part = std::clamp(t - 0.2, 0.0, 1.0);
        return fastest_deg_s * (0.5 - 0.5 * std::cos(2.0 * pi * part));
    }
    [[nodiscard]] double angle(double t) const {
        const double part = std::clamp(t - 0.2, 0.0, 1.0);
        return fastest_deg_s * (0.5 * part - std::sin(2.0 * pi * part) / (4.0 * pi));
    }
};

Motion motion_of(const Ride& ride, const std::vector<double>& times, double rate_hz) {
    Motion motion{Hertz(rate_hz), times, {}, {}, {}};
    for (const double t : times) {
        motion.position_deg.push_back(ride.angle(t));
        motion.velocity_deg_s.push_back(ride.speed(t));
        motion.acceleration_deg_s2.push_back(0.0);
    }
    return motion;
}

// y'' + 2 damping w y' + w^2 y = w^2 x, x turning with the angle, by Runge and Kutta; y / x at the times.
std::vector<Complex> integrated(const Spring& spring, const Ride& ride, const std::vector<double>& times,
                                double cycles_per_deg) {
    const double w = 2.0 * pi * spring.frequency_hz;
    const auto drive = [&](double t) { return std::polar(1.0, 2.0 * pi * cycles_per_deg * ride.angle(t)); };
    const auto slope = [&](double t, std::array<Complex, 2> y) {
        return std::array<Complex, 2>{y[1], w * w * (drive(t) - y[0]) - 2.0 * spring.damping * w * y[1]};
    };
    const auto moved = [](std::array<Complex, 2> y, const std::array<Complex, 2>& by, double h) {
        return std::array<Complex, 2>{y[0] + h * by[0], y[1] + h * by[1]};
    };
    std::array<Complex, 2> y{drive(times[0]), 0.0};
    std::vector<Complex> response{1.0};
    for (std::size_t k = 1; k < times.size(); ++k) {
        constexpr int finer = 100;
        const double h = (times[k] - times[k - 1]) / finer;
        for (int i = 0; i < finer; ++i) {
            const double t = times[k - 1] + i * h;
            const auto a = slope(t, y), b = slope(t + h / 2, moved(y, a, h / 2)),
                       c = slope(t + h / 2, moved(y, b, h / 2)), d = slope(t + h, moved(y, c, h));
            for (std::size_t s = 0; s < 2; ++s) y[s] += h / 6.0 * (a[s] + 2.0 * b[s] + 2.0 * c[s] + d[s]);
        }
        response.push_back(y[0] / drive(times[k]));
    }
    return response;
}

std::vector<double> even_times(double rate_hz) {
    std::vector<double> times;
    for (double k = 0.0; k < 1.5 * rate_hz; ++k) times.push_back(k / rate_hz);
    return times;
}

double largest(const std::vector<Complex>& a, const std::vector<Complex>& b) {
    double most = 0.0;
    for (std::size_t k = 0; k < a.size(); ++k) most = std::max(most, std::abs(a[k] - b[k]));
    return most;
}

std::vector<Complex> response(const Spring& spring, const Motion& motion, double cycles_per_deg) {
    std::vector<Complex> found(motion.size());
    response_of(spring, motion, cycles_per_deg, found);
    return found;
}

constexpr double order_2_of_100 = 200.0 / 360.0;

}  // namespace

TEST_CASE("a mass that a ramp takes through its own frequency rings as the equation of motion says") {
    const std::vector<double> times = even_times(1000.0);
    for (const double fastest : {170.0, -170.0}) {
        const Ride ride{fastest};
        const Motion motion = motion_of(ride, times, 1000.0);
        for (const Spring spring :
             {Spring{45.0, 0.05}, Spring{45.0, 1.0}, Spring{45.0, 1.9}, Spring{8.0, 0.002}}) {
            CAPTURE(fastest, spring.frequency_hz, spring.damping);
            const auto expected = integrated(spring, ride, times, order_2_of_100);
            const double most = largest(expected, std::vector<Complex>(expected.size()));
            CHECK(largest(response(spring, motion, order_2_of_100), expected) < 3e-4 * most);
        }
        // The steady response is far from it.
        const Spring sharp{45.0, 0.05};
        const auto expected = integrated(sharp, ride, times, order_2_of_100);
        double off = 0.0;
        for (std::size_t k = 0; k < times.size(); ++k) {
            const double u = order_2_of_100 * motion.velocity_deg_s[k] / sharp.frequency_hz;
            off = std::max(off, std::abs(1.0 / Complex(1.0 - u * u, 2.0 * sharp.damping * u) - expected[k]));
        }
        CHECK(off > 1.0);
    }
}

TEST_CASE("times that are uneven, and rows that are lost, ring as the time between them says") {
    std::vector<double> times;
    for (int k = 0; k < 1500; ++k) {
        if (k % 37 == 5 || k % 37 == 6) continue;
        times.push_back(k * 1e-3 + (k > 0 ? 2e-4 * std::sin(7.0 * k) : 0.0));
    }
    const Ride ride{170.0};
    const Spring spring{45.0, 0.05};
    CHECK(largest(response(spring, motion_of(ride, times, 1000.0), order_2_of_100),
                  integrated(spring, ride, times, order_2_of_100)) < 3e-3);
}

TEST_CASE("at a constant speed a mass answers steadily, to the last bit") {
    const std::vector<double> times = even_times(500.0);
    Motion motion = motion_of({0.0}, times, 500.0);
    for (const double speed : {0.0, 81.0, -300.0}) {
        std::fill(motion.velocity_deg_s.begin(), motion.velocity_deg_s.end(), speed);
        const double u = order_2_of_100 * speed / 45.0;
        const double real = 1.0 - u * u, imaginary = 2.0 * 0.1 * u,
                     square = real * real + imaginary * imaginary;
        const Complex steady(real / square, -imaginary / square);
        CHECK(response({45.0, 0.1}, motion, order_2_of_100) == std::vector<Complex>(times.size(), steady));
    }
}

TEST_CASE("few samples of a ramp show nearly what many show") {
    // As a search looks at a long log: every tenth sample, a step of nearly half a cycle.
    const Ride ride{120.0};
    const Spring spring{45.0, 0.2};
    const std::vector<double> few = even_times(100.0);
    const auto expected = integrated(spring, ride, few, order_2_of_100);
    CHECK(largest(response(spring, motion_of(ride, few, 100.0), order_2_of_100), expected) < 0.05);
}

TEST_CASE(
    "a signal that drives a mass comes out as the equation of motion says, from a quarter of a hertz to 80") {
    constexpr double rate_hz = 1000.0;
    for (const Spring spring : {Spring{12.0, 0.05}, Spring{36.0, 0.03}, Spring{25.0, 1.0}, Spring{400.0, 0.2},
                                Spring{9000.0, 0.7}, Spring{30.0, 2.0}}) {
        for (const double hertz : {0.25, 4.0, 8.0, 30.0, 80.0}) {
            CAPTURE(spring.frequency_hz, spring.damping, hertz);
            // From its first value, held before: what still rings of that has died away in the second half.
            const double settled_s =
                40.0 / (2.0 * std::numbers::pi * spring.frequency_hz * std::min(spring.damping, 0.25));
            std::vector<double> values;
            for (double k = 0.0; k < rate_hz * (settled_s + 4.0); ++k)
                values.push_back(std::cos(2.0 * std::numbers::pi * hertz * k / rate_hz));
            pass_spring(spring, Hertz(rate_hz), values);
            const double u = hertz / spring.frequency_hz;
            const Complex response = 1.0 / Complex(1.0 - u * u, 2.0 * spring.damping * u);
            double off = 0.0;
            for (std::size_t k = values.size() - 3000; k + 10 < values.size(); ++k) {
                const Complex drive =
                    std::polar(1.0, 2.0 * std::numbers::pi * hertz * static_cast<double>(k) / rate_hz);
                off = std::max(off, std::abs(values[k] - (response * drive).real()));
            }
            CHECK(off < 2e-4 * std::abs(response));
        }
    }
}

TEST_CASE("a mass that is held and let go where it rests stays there") {
    std::vector<double> values(500, 0.7);
    pass_spring({20.0, 0.05}, Hertz(1000.0), values);
    for (const double value : values) CHECK(std::abs(value - 0.7) < 1e-12);
}

// A link of 0.1 kg m2 on a spring behind a motor that goes to and fro, with ripple of 0.3 Nm at the link's
// angle; what the spring bears, Nm, at the times. Speeds before angles, in steps a hundred times finer.
TEST_CASE(
    "behind a spring ripple goes by the link's angle, and where inertia twists it that is another one") {
    constexpr double half_turn = std::numbers::pi;
    constexpr double inertia = 0.1, ripple_nm = 0.3, ratio = 20.0, reach = 6.0 * half_turn / 180.0,
                     hertz = 5.0;
    const Spring spring{14.0, 0.1};
    constexpr int finer = 100;
    constexpr double rate_hz = 1000.0, step_s = 1.0 / rate_hz / finer, turn = 2.0 * half_turn * hertz;
    const double w = 2.0 * half_turn * spring.frequency_hz, rub = 2.0 * spring.damping * w;
    Motion motor{Hertz(rate_hz), {}, {}, {}, {}};
    std::vector<double> borne_nm;
    double link = 0.0, speed = reach * turn;
    for (std::size_t k = 0; k < 4000; ++k) {
        const double t = static_cast<double>(k) / rate_hz;
        motor.time_s.push_back(t);
        motor.position_deg.push_back(180.0 / half_turn * reach * std::sin(turn * t));
        motor.velocity_deg_s.push_back(180.0 / half_turn * reach * turn * std::cos(turn * t));
        motor.acceleration_deg_s2.push_back(-turn * turn * motor.position_deg.back());
        borne_nm.push_back(inertia * w * w * (reach * std::sin(turn * t) - link));
        for (int part = 0; part < finer; ++part) {
            const double now_s = t + part * step_s;
            const double twist = reach * std::sin(turn * now_s) - link,
                         untwisting = reach * turn * std::cos(turn * now_s) - speed;
            speed +=
                step_s * (w * w * twist + rub * untwisting - ripple_nm / inertia * std::cos(ratio * link));
            link += step_s * speed;
        }
    }
    Model rigid{GearRatio(ratio), {}};
    rigid.terms.push_back(parse_term("inertia,inertia_kgm2=0.1"));
    rigid.terms.push_back(parse_term("ripple,order=1,amplitude_nm=0.3,phase_deg=0"));
    Model elastic = rigid;
    elastic.terms.push_back(parse_term("resonance,frequency_hz=14,damping=0.1,whole=1"));
    const auto expected = predict_nm(elastic, motor),
               at_motor = sensed_nm(elastic, motor, predict_nm(rigid, motor));
    double off = 0.0, off_at_motor = 0.0;
    for (std::size_t k = 2000; k < borne_nm.size(); ++k) {
        off += std::pow(expected[k] - borne_nm[k], 2) / 2000.0;
        off_at_motor += std::pow(at_motor[k] - borne_nm[k], 2) / 2000.0;
    }
    // What is left is the spring's twist by the ripple itself: 0.3 Nm are 0.022 deg.
    CHECK(std::sqrt(off) < 0.03 * ripple_nm);
    CHECK(std::sqrt(off_at_motor) > 0.2 * ripple_nm);
}

namespace {

// cos(2 pi f k), f in cycles per sample.
std::vector<double> wave(double frequency, std::size_t count = 400) {
    std::vector<double> values(count);
    for (std::size_t k = 0; k < count; ++k)
        values[k] = std::cos(2.0 * pi * frequency * static_cast<double>(k));
    return values;
}

// Largest difference from size * cos(2 pi f k + phase) away from both ends.
double error(const std::vector<double>& values, double frequency, std::complex<double> response) {
    double most = 0.0;
    for (std::size_t k = 200; k + 20 < values.size(); ++k) {
        const auto turned = response * std::polar(1.0, 2.0 * pi * frequency * static_cast<double>(k));
        most = std::max(most, std::abs(values[k] - turned.real()));
    }
    return most;
}

}  // namespace

TEST_CASE("a shift by a part of a sample is exact to the error that its header states") {
    for (const double delay : {0.5, 3.25, -0.5, -7.8, 12.5}) {
        for (const auto& [frequency, bound] :
             {std::pair(0.01, 1e-12), {0.1, 1e-7}, {0.2, 5e-5}, {0.3, 1e-2}}) {
            CAPTURE(delay, frequency);
            auto values = wave(frequency);
            shift_samples(values, delay);
            CHECK(error(values, frequency, std::polar(1.0, -2.0 * pi * frequency * delay)) < bound);
        }
    }
}

TEST_CASE("a shift by whole samples moves samples, and the ends stay") {
    std::vector<double> values = {1.0, 2.0, 4.0, 8.0};
    shift_samples(values, 2.0);
    CHECK(values == std::vector<double>{1.0, 1.0, 1.0, 2.0});
    values = {1.0, 2.0, 4.0, 8.0};
    shift_samples(values, -1.0);
    CHECK(values == std::vector<double>{2.0, 4.0, 8.0, 8.0});
    values.clear();
    shift_samples(values, 1.5);
    CHECK(values.empty());
}

TEST_CASE("a lag answers as 1 / (1 + i w tau) says, without half a sample too much or too little") {
    for (const double tau : {0.05, 0.5, 1.0, 3.0, 8.0, 50.0}) {
        for (const auto& [frequency, bound] : {std::pair(0.002, 1e-9), {0.02, 1e-7}, {0.1, 5e-4}}) {
            CAPTURE(tau, frequency);
            auto values = wave(frequency, 1400);
            first_order_lag(values, tau);
            // What the start leaves decays within tau; beyond 20 tau it is below 1e-8.
            values.erase(values.begin(), values.begin() + 1000);
            const std::complex<double> response = 1.0 / std::complex(1.0, 2.0 * pi * frequency * tau);
            const auto turn = std::polar(1.0, 2.0 * pi * frequency * 1000.0);
            CHECK(error(values, frequency, response * turn) < bound);
        }
    }
}

TEST_CASE("a lag starts settled, and a step reaches 1 - 1/e of its way after the time constant") {
    std::vector<double> values(400, 3.0);
    first_order_lag(values, 20.0);
    for (const double value : values) CHECK(value == Approx(3.0).epsilon(1e-14));
    // A ramp lags by tau, whatever tau.
    for (const double tau : {0.3, 4.0, 20.0}) {
        std::vector<double> ramp(1000);
        for (std::size_t k = 0; k < ramp.size(); ++k) ramp[k] = static_cast<double>(k);
        first_order_lag(ramp, tau);
        CHECK(ramp[900] == Approx(900.0 - tau).epsilon(1e-12));
    }
    // The step happens half-way between the samples 99 and 100.
    std::vector<double> step(400, 0.0);
    for (std::size_t k = 100; k < step.size(); ++k) step[k] = 1.0;
    first_order_lag(step, 20.0);
    for (const std::size_t k : {110U, 120U, 160U})
        CHECK(step[k] == Approx(1.0 - std::exp(-(static_cast<double>(k) - 99.5) / 20.0)).margin(1e-3));
}

// A free mass on a damped spring, over steps of many lengths.

namespace {

struct FreeState {
    double at, moving;
};

FreeState after(const FreeMove& move, const FreeState& begun) {
    return {move.at_of_at * begun.at + move.at_of_moving * begun.moving,
            move.moving_of_moving * begun.moving - move.at_of_moving * begun.at};
}

}  // namespace

TEST_CASE("two steps are as one of their length, and a step of none changes nothing") {
    for (const double damping : {0.001, 0.1, 0.7, 1.0, 2.0}) {
        const FreeState begun{1.0, 0.25};
        for (const double radians : {0.0, 1e-3, 0.4, 3.0, 50.0}) {
            const FreeState once = after(free_move(damping, 1.5 * radians), begun),
                            twice = after(free_move(damping, 0.5 * radians),
                                          after(free_move(damping, radians), begun));
            CHECK(std::abs(once.at - twice.at) < 1e-14);
            CHECK(std::abs(once.moving - twice.moving) < 1e-14);
        }
        const FreeState stays = after(free_move(damping, 0.0), begun);
        CHECK(stays.at == begun.at);
        CHECK(stays.moving == begun.moving);
    }
}

// A drive that turns with the joint.

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

TEST_CASE(
    "stamps that stand still or go back are a usual step, and after a gap of any length all is steady") {
    const Spring spring{40.0, 0.1};
    Motion odd = motion_at({0.0, 0.001, 0.001, 0.0005, 1e9});
    odd.velocity_deg_s[4] = 100.0;
    const Motion plain = motion_at({0.0, 0.001, 0.002});
    std::vector<std::complex<double>> found(odd.size()), usual(plain.size());
    response_of(spring, odd, cycles_per_deg, found);
    response_of(spring, plain, cycles_per_deg, usual);
    CHECK(found[1] == usual[1]);
    CHECK(std::isfinite(std::norm(found[2])));
    CHECK(std::isfinite(std::norm(found[3])));
    const double u =
        cycles_per_deg * 0.5 * (odd.velocity_deg_s[3] + odd.velocity_deg_s[4]) / spring.frequency_hz;
    CHECK(std::abs(found[4] - 1.0 / std::complex<double>(1.0 - u * u, 0.2 * u)) < 1e-12);
}
