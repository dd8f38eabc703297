// SPDX-License-Identifier: MIT
// The Kalman filter of torque and ripple, on motions whose true torque is known.

#include <fmt/format.h>

#include <array>

#include "filter/moves.hpp"
#include "filter/ripple_kalman.hpp"
#include "filter/ripple_keys.hpp"
#include "ripplenotch/core/error.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using namespace ripplenotch::testing;

namespace {

const std::string cold = "oscillator,gear-ratio=100,orders=1:2";
const std::string warm = cold + ",amplitudes=0.8Nm:0.5Nm,phases=90:90";
constexpr std::size_t moves = 5;

// Mean rms error over five seeds; `change` makes another log of each move.
template <class Change>
double error_on_move(const std::string& text, Change change, bool with_position = true) {
    double sum = 0.0;
    for (std::uint64_t seed = 1; seed <= moves; ++seed) {
        KnownMove move = paper_move(seed);
        change(move, seed);
        Samples samples = move.signals.samples();
        if (!with_position) samples.position_deg = {};
        sum += rms_error(filtered(*start(text), samples), move.true_nm) / moves;
    }
    return sum;
}
double error_on_move(const std::string& text) {
    return error_on_move(text, [](KnownMove&, std::uint64_t) {});
}

// The delay in samples that makes two signals most alike, to a fraction of one.
double delay_samples(const std::vector<double>& late, const std::vector<double>& truth) {
    const auto misfit = [&](std::ptrdiff_t delay) {
        double sum = 0.0;
        for (std::size_t k = 20; k + 20 < late.size(); ++k)
            sum += std::pow(late[static_cast<std::size_t>(static_cast<std::ptrdiff_t>(k) + delay)] - truth[k],
                            2);
        return sum;
    };
    std::ptrdiff_t best = -19;
    for (std::ptrdiff_t d = -19; d <= 19; ++d) best = misfit(d) < misfit(best) ? d : best;
    const double before = misfit(best - 1), at = misfit(best), after = misfit(best + 1);
    return static_cast<double>(best) + 0.5 * (before - after) / (before - 2.0 * at + after);
}

// -40 to 40 deg/s at 8 deg/s^2 through standstill at 10 s; ripple of 2 and 1 Nm.
KnownMove reversal() {
    KnownMove move;
    double angle = 0.0;
    for (std::size_t k = 0; k < 15000; ++k) {
        const double t = static_cast<double>(k) / 1000.0;
        const double v = std::clamp(8.0 * (t - 10.0), -40.0, 40.0);
        angle += v / 1000.0;
        const double theta = 100.0 * angle * std::numbers::pi / 180.0;
        move.true_nm.push_back(10.0 + 5.0 * std::sin(2.0 * std::numbers::pi * 0.2 * t));
        move.signals.velocity_deg_s.push_back(v);
        move.signals.position_deg.push_back(angle);
        move.signals.torque_nm.push_back(move.true_nm.back() + 2.0 * std::sin(theta + 0.3) +
                                         std::sin(2.0 * theta + 1.1));
    }
    add_white_noise(move.signals.torque_nm, 0.05, 9, NoiseChannel::torque);
    return move;
}

}  // namespace

// A cold start waits for 0.4 s of this move: before, the ripple of 0.67 Nm rms stays.
TEST_CASE(
    "on the paper's move the oscillator leaves less than 0.27 Nm from a cold and 0.03 Nm from a warm start") {
    CHECK(error_on_move(cold) < 0.27);
    CHECK(error_on_move(warm) < 0.03);
}

TEST_CASE("an angle from a velocity with noise of 0.15 deg/s serves as well") {
    const auto noisy = [](KnownMove& move, std::uint64_t seed) {
        integrate_noisy_velocity(move, 0.15, 0.0, seed);
    };
    for (const bool with_position : {true, false}) {
        CHECK(error_on_move(cold, noisy, with_position) < 0.27);
        CHECK(error_on_move(warm + ",start=90deg", noisy, with_position) < 0.03);
    }
}

TEST_CASE("warm values that are 5 per cent and 5 degrees off still leave less than 0.05 Nm") {
    CHECK(error_on_move(cold + ",amplitudes=0.84Nm:0.475Nm,phases=95:85") < 0.04);
}

TEST_CASE("the warm oscillator delays by less than a millisecond") {
    for (std::uint64_t seed = 1; seed <= moves; ++seed) {
        const KnownMove move = paper_move(seed);
        const auto out = filtered(*start(warm), move.signals.samples());
        CHECK(std::abs(delay_samples(out, move.true_nm)) < 1.0);
    }
}

TEST_CASE("what a cold start costs is the ripple that stands still with the joint, whatever its phase") {
    double sum = 0.0, worst = 0.0;
    for (double phase1 = 0.0; phase1 < 360.0; phase1 += 60.0) {
        for (double phase2 = 0.0; phase2 < 360.0; phase2 += 60.0) {
            const KnownMove move = paper_move(7, phase1, phase2);
            const auto out = filtered(*start(cold), move.signals.samples());
            // From 0.4 s on the motor has turned three times and the ripple is known and taken out.
            CHECK(rms_error(out, move.true_nm, 400) < 0.06);
            const double error = rms_error(out, move.true_nm);
            sum += error * error / 36.0;
            worst = std::max(worst, error);
        }
    }
    CHECK(std::sqrt(sum) < 0.29);
    CHECK(worst < 0.38);
}

TEST_CASE(
    "a torque that rises while the motor has hardly turned is not learnt as ripple, cold or beside a map") {
    // Friction, gravity and ripple of five orders: at rest for 50 ms, then up to 50 deg/s.
    KnownMove move;
    double angle = -126.0, raw = 0.0;
    for (std::size_t k = 0; k < 3000; ++k) {
        const double t = static_cast<double>(k) / 1000.0,
                     v = 50.0 * std::pow(std::clamp((t - 0.05) / 0.6, 0.0, 1.0), 3);
        angle += v / 1000.0;
        const double theta = 120.0 * angle * std::numbers::pi / 180.0;
        move.true_nm.push_back(3.0 * std::tanh(v / 0.3) + 14.0 * std::cos(angle * std::numbers::pi / 180.0) +
                               0.02 * v);
        move.signals.velocity_deg_s.push_back(v);
        move.signals.position_deg.push_back(angle);
        double ripple = 0.0;
        for (const double order : {1.0, 2.0, 4.0, 6.0, 8.0}) ripple += 0.3 * std::cos(order * theta + order);
        move.signals.torque_nm.push_back(move.true_nm.back() + ripple);
    }
    add_white_noise(move.signals.torque_nm, 0.05, 6, NoiseChannel::torque);
    const auto worst_of = [&](const std::vector<double>& out) {
        double worst = 0.0;
        for (std::size_t k = 0; k < out.size(); ++k)
            worst = std::max(worst, std::abs(out[k] - move.true_nm[k]));
        return worst;
    };
    raw = worst_of(move.signals.torque_nm);
    for (const char* output : {"", ",output=minus-ripple", ",slip=0", ",gain=scheduled"}) {
        const auto out = filtered(*start("oscillator,gear-ratio=120,orders=1:2:4:6:8" + std::string(output)),
                                  move.signals.samples());
        CAPTURE(output);
        CHECK(worst_of(out) < 1.2 * raw);
        CHECK(rms_error(out, move.true_nm, 1500) < 0.05);
    }
}

TEST_CASE("told what the joint bears at rest, a cold start leaves less than 0.16 Nm, whatever the phases") {
    double worst = 0.0;
    for (double phase1 = 0.0; phase1 < 360.0; phase1 += 60.0) {
        for (double phase2 = 0.0; phase2 < 360.0; phase2 += 60.0) {
            KnownMove move = paper_move(7, phase1, phase2);
            worst = std::max(
                worst, rms_error(filtered(*start(cold + ",rest=0Nm"), move.signals.samples()), move.true_nm));
            // Another torque at rest is as good when it is the true one.
            for (double& torque : move.signals.torque_nm) torque += 3.0;
            for (double& torque : move.true_nm) torque += 3.0;
            worst = std::max(
                worst, rms_error(filtered(*start(cold + ",rest=3Nm"), move.signals.samples()), move.true_nm));
        }
    }
    CHECK(worst < 0.16);
}

TEST_CASE("what is said of the torque at rest does not count for a log that begins in motion") {
    KnownMove move = paper_move(1);
    Signals moving;
    for (auto member : {&Signals::velocity_deg_s, &Signals::torque_nm, &Signals::position_deg})
        (moving.*member).assign((move.signals.*member).begin() + 200, (move.signals.*member).end());
    const auto told = filtered(*start(cold + ",rest=0Nm"), moving.samples());
    const auto untold = filtered(*start(cold), moving.samples());
    CHECK(told == untold);
    CHECK(told.front() == moving.torque_nm.front());
}

TEST_CASE("through a reversal the oscillator stays within 0.15 Nm rms") {
    const KnownMove move = reversal();
    const auto out = filtered(*start(cold), move.signals.samples());
    CHECK(rms_error(out, move.true_nm, 8000, 12000) < 0.03);
    CHECK(rms_error(move.signals.torque_nm, move.true_nm, 8000, 12000) > 1.5);
    Samples blind = move.signals.samples();
    blind.position_deg = {};
    CHECK(rms_error(filtered(*start(cold), blind), move.true_nm, 8000, 12000) < 0.05);
}

TEST_CASE("at standstill a known ripple stays taken out, and a new torque is followed") {
    KnownMove move = paper_move(3);
    Signals& s = move.signals;
    for (std::size_t k = 0; k < 20000; ++k) {
        s.velocity_deg_s.push_back(0.0);
        s.position_deg.push_back(-90.0);
        move.true_nm.push_back(k < 10000 ? 0.0 : 2.0);
        const double ripple = 0.8 * std::cos(-50.0 * std::numbers::pi + std::numbers::pi / 3.0) +
                              0.5 * std::cos(-100.0 * std::numbers::pi + 2.0 * std::numbers::pi / 3.0);
        s.torque_nm.push_back(move.true_nm.back() + ripple);
    }
    for (std::size_t k = 0; k < 2000; ++k) {
        const double theta = 100.0 * s.position_deg[k] * std::numbers::pi / 180.0;
        s.torque_nm[k] = move.true_nm[k] + 0.8 * std::cos(theta + std::numbers::pi / 3.0) +
                         0.5 * std::cos(2.0 * theta + 2.0 * std::numbers::pi / 3.0);
    }
    const auto out = filtered(*start(cold), s.samples());
    CHECK(rms_error(out, move.true_nm, 2200, 11900) < 0.03);
    CHECK(rms_error(out, move.true_nm, 13000, 22000) < 0.03);
}

TEST_CASE("a velocity that is 1 deg/s off is corrected by the ripple itself when there is no position") {
    Signals s;
    std::vector<double> truth;
    for (std::size_t k = 0; k < 20000; ++k) {
        const double t = static_cast<double>(k) / 1000.0;
        const double theta = 100.0 * 60.0 * t * std::numbers::pi / 180.0;
        truth.push_back(std::sin(2.0 * t));
        s.velocity_deg_s.push_back(61.0);
        s.torque_nm.push_back(truth.back() + 0.8 * std::cos(theta) + 0.5 * std::cos(2.0 * theta + 1.0));
    }
    add_white_noise(s.torque_nm, 0.05, 5, NoiseChannel::torque);
    const Samples samples{s.velocity_deg_s, s.torque_nm, {}};
    const double followed = rms_error(filtered(*start(cold), samples), truth, 10000);
    const double unaided = rms_error(filtered(*start(cold + ",offset=0.001deg/s"), samples), truth, 10000);
    CHECK(followed < 0.03);
    CHECK(unaided > 3.0 * followed);
}

TEST_CASE("a gear ratio that is 2 per cent wrong is corrected by the ripple itself") {
    // 20 to 40 deg/s, ripple of 2 and 1 Nm.
    KnownMove move;
    double angle = 0.0;
    for (std::size_t k = 0; k < 15000; ++k) {
        const double t = static_cast<double>(k) / 1000.0, v = std::min(20.0 + 2.0 * t, 40.0);
        angle += v / 1000.0;
        const double theta = 100.0 * angle * std::numbers::pi / 180.0;
        move.true_nm.push_back(10.0);
        move.signals.velocity_deg_s.push_back(v);
        move.signals.position_deg.push_back(angle);
        move.signals.torque_nm.push_back(10.0 + 2.0 * std::sin(theta + 0.3) + std::sin(2.0 * theta + 1.1));
    }
    const auto left = [&](const std::string& text) {
        return rms_error(filtered(*start(text), move.signals.samples()), move.true_nm, 3000);
    };
    for (const char* ratio : {"98", "102"}) {
        const std::string wrong = std::string("oscillator,orders=1:2,gear-ratio=") + ratio;
        CHECK(left(wrong) < 0.1);
        CHECK(left(wrong + ",slip=0") > 0.3);
    }
    CHECK(left(cold) < 0.01);
}

TEST_CASE("where the position ends, the angle goes on by the velocity") {
    MotorAngle angle(100.0, 1000.0, MotorAngle::Source::best, 0.0);
    for (int k = 0; k < 2000; ++k) {
        const double position_deg = 0.05 * k;
        angle.next(50.0, k < 1000 ? &position_deg : nullptr);
    }
    CHECK(angle.from_velocity());
    CHECK(angle.turns() == Approx(100.0 * 0.05 * 1999 / 360.0).epsilon(1e-9));
}

TEST_CASE(
    "a position with noise or in steps is smoothed while the motor is slow, and costs next to nothing") {
    const auto noisy = [](KnownMove& move, std::uint64_t seed) {
        add_white_noise(move.signals.position_deg, 0.02, seed, NoiseChannel::spikes);
    };
    const auto in_steps = [](KnownMove& move, std::uint64_t) {
        for (double& p : move.signals.position_deg) p = 0.1 * std::round(10.0 * p);
    };
    CHECK(error_on_move(cold, noisy) < 0.27);
    CHECK(error_on_move(warm, noisy) < 0.03);
    CHECK(error_on_move(cold, in_steps) < 0.27);
    CHECK(error_on_move(warm, in_steps) < 0.05);
}

TEST_CASE("an exact position is the angle, whatever the velocity's offset, noise or clock") {
    const KnownMove move = paper_move(1);
    for (const char* fault : {"offset", "noise", "clock"}) {
        INFO(fault);
        Signals s = move.signals;
        if (fault == std::string("offset")) {
            for (double& v : s.velocity_deg_s) v += 1.0;
        } else if (fault == std::string("noise")) {
            add_white_noise(s.velocity_deg_s, 1.0, 4, NoiseChannel::velocity);
        } else {
            // Every twentieth row holds the row before, as a log that was polled does.
            for (std::size_t k = 20; k < 2000; k += 20) {
                s.velocity_deg_s[k] = s.velocity_deg_s[k - 1];
                s.position_deg[k] = s.position_deg[k - 1];
            }
        }
        MotorAngle angle(100.0, 1000.0, MotorAngle::Source::best, 0.0);
        double worst = 0.0;
        for (std::size_t k = 0; k < 2000; ++k) {
            angle.next(s.velocity_deg_s[k], &s.position_deg[k]);
            if (k > 6) worst = std::max(worst, std::abs(angle.turns() - 100.0 * s.position_deg[k] / 360.0));
        }
        // A hundredth of a turn is 3.6 degrees of order 1.
        CHECK(worst < 0.01);
    }
}

TEST_CASE("a position wrapped at 360 degrees is the same as one that is not") {
    KnownMove move = reversal();
    const auto straight = filtered(*start(cold), move.signals.samples());
    for (double& p : move.signals.position_deg) p -= 360.0 * std::floor(p / 360.0);
    const auto wrapped = filtered(*start(cold), move.signals.samples());
    for (std::size_t k = 0; k < wrapped.size(); ++k) REQUIRE(wrapped[k] == Approx(straight[k]).margin(1e-6));
}

namespace {

using SixValues = std::array<double, 6>;
using SixBySix = std::array<SixValues, 6>;

}  // namespace

TEST_CASE("the exact gain is that of the textbook's matrices, and settles to that of the Riccati equation") {
    RippleModel model{{1.0, 2.0}, 0.001, 2.0 * std::numbers::pi * 15.0, 2.0};
    const std::vector<AmplitudePrior> priors(2, {0.0, 0.0, 20.0});
    RippleKalman filter(model, priors);
    filter.start(0.0);
    // The same model written with matrices, in the frame that turns.
    const double step = 0.025;
    const RippleRotation frame = ripple_rotation(model, step);
    const auto f = [&](std::size_t r, std::size_t c) { return frame.step[6 * r + c]; };
    const auto& h = frame.seen;
    SixBySix q{}, p{};
    const auto noise = model.torque_noise();
    q[0][0] = noise.torque;
    q[0][1] = q[1][0] = noise.cross;
    q[1][1] = noise.rate;
    for (std::size_t i = 2; i < 6; ++i) q[i][i] = model.amplitude_noise(step);
    // Any torque: a variance beyond all others, then the first measurement.
    p[0][0] = 1e10;
    p[1][1] = 100.0 * std::numbers::sqrt2 * std::pow(model.bandwidth_rad_s, 3) * model.step_s;
    for (std::size_t i = 2; i < 6; ++i) p[i][i] = 400.0;
    SixValues x{}, gain{};
    const auto measure = [&](double y) {
        SixValues seen{};
        double variance = 1.0, foreseen = 0.0;
        for (std::size_t r = 0; r < 6; ++r)
            for (std::size_t c = 0; c < 6; ++c) seen[r] += p[r][c] * h[c];
        for (std::size_t r = 0; r < 6; ++r) {
            variance += h[r] * seen[r];
            foreseen += h[r] * x[r];
        }
        for (std::size_t r = 0; r < 6; ++r) {
            gain[r] = seen[r] / variance;
            x[r] += gain[r] * (y - foreseen);
        }
        SixBySix left{};
        for (std::size_t r = 0; r < 6; ++r)
            for (std::size_t c = 0; c < 6; ++c) left[r][c] = p[r][c] - gain[r] * seen[c];
        for (std::size_t r = 0; r < 6; ++r)
            for (std::size_t c = 0; c < 6; ++c) p[r][c] = 0.5 * (left[r][c] + left[c][r]);
    };
    const auto go_on = [&] {
        SixValues next{};
        SixBySix half{}, all = q;
        for (std::size_t r = 0; r < 6; ++r) {
            for (std::size_t c = 0; c < 6; ++c) {
                next[r] += f(r, c) * x[c];
                for (std::size_t i = 0; i < 6; ++i) half[r][c] += f(r, i) * p[i][c];
            }
        }
        for (std::size_t r = 0; r < 6; ++r)
            for (std::size_t c = 0; c < 6; ++c)
                for (std::size_t i = 0; i < 6; ++i) all[r][c] += half[r][i] * f(c, i);
        x = next;
        p = all;
    };
    measure(0.0);
    for (int k = 1; k <= 4000; ++k) {
        const double y = 3.0 * std::sin(0.01 * k) + 10.0 * std::cos(2.0 * std::numbers::pi * step * k + 0.4);
        go_on();
        measure(y);
        const double torque = filter.next(y, step * k, step);
        REQUIRE(torque == Approx(x[0]).margin(1e-4));
    }
    const auto settled = settled_gain(model, step);
    for (std::size_t i = 0; i < 6; ++i) CHECK(settled[i] == Approx(gain[i]).epsilon(1e-9).margin(1e-12));
}

TEST_CASE(
    "the scheduled gain is the settled one of the speed, in either direction, and falls to 0 at standstill") {
    const RippleModel model{{1.0, 2.0}, 0.001, 2.0 * std::numbers::pi * 15.0, 1.0};
    GainSchedule schedule(model);
    std::vector<double> gain(6), back(6);
    for (double step = 0.0005; step < 0.22; step *= 1.13) {
        const auto settled = settled_gain(model, step);
        schedule.at(step, gain);
        schedule.at(-step, back);
        const auto other = settled_gain(model, -step);
        double size = 0.0;
        for (const double g : settled) size += g * g;
        for (std::size_t i = 0; i < 6; ++i) {
            INFO("step " << step << " gain " << i);
            // The rate's gain is per second: held against itself.
            const double scale =
                i == 1 ? std::abs(settled[1]) : std::sqrt(std::abs(size - settled[1] * settled[1]));
            CHECK(gain[i] == Approx(settled[i]).margin(0.02 * scale));
            CHECK(back[i] == Approx(other[i]).margin(0.02 * scale));
        }
    }
    schedule.at(0.0, gain);
    for (std::size_t i = 2; i < 6; ++i) CHECK(gain[i] == 0.0);
    // Of one speed alone the same bits: at standstill, below the first point, between points and beyond the
    // last.
    for (const double step : {0.0, 1e-6, 0x1p-15, 0.0007, -0.013, 0.2, 0.25, -0.4, 3.0}) {
        schedule.at(step, gain);
        GainSchedule(model).at(step, back);
        CHECK(back == gain);
    }
    schedule.at(0.0, gain);
    RippleModel alone = model;
    alone.orders.clear();
    CHECK(gain[0] == Approx(settled_gain(alone, 1.0)[0]).epsilon(1e-12));
}

TEST_CASE("with scheduled gains a warm start and a reversal leave as little, a cold start more") {
    CHECK(error_on_move(warm + ",gain=scheduled") < 0.03);
    CHECK(error_on_move(cold + ",gain=scheduled") < 0.30);
    const KnownMove move = reversal();
    const auto out = filtered(*start(cold + ",gain=scheduled"), move.signals.samples());
    CHECK(rms_error(out, move.true_nm, 8000, 12000) < 0.15);
}

TEST_CASE("a joint at rest for ten million samples keeps a sound covariance") {
    RippleKalman filter({{1.0, 2.0}, 0.001, 100.0, 2.0}, {{0.0, 0.0, 20.0}, {0.0, 0.0, 20.0}});
    filter.start(0.0);
    for (int k = 1; k <= 2000; ++k) filter.next(std::cos(0.1 * k), 0.02 * k, 0.02);
    for (int k = 0; k < 10'000'000; ++k) filter.next(1.0, 40.3, 0.0);
    CHECK(std::abs(filter.torque() + filter.ripple() - 1.0) < 1e-9);
    double worst = 0.0;
    for (int k = 1; k <= 4000; ++k) {
        const double torque = filter.next(std::cos(2.0 * std::numbers::pi * 0.02 * k), 40.3 + 0.02 * k, 0.02);
        if (k > 2000) worst = std::max(worst, std::abs(torque));
    }
    CHECK(worst < 1e-6);
}

TEST_CASE("a line beyond half the sample rate is not taken for torque") {
    // 100 deg/s at 25 Hz: order 1 of a gear of 90 turns once a sample and looks like a constant.
    Signals s;
    for (std::size_t k = 0; k < 2000; ++k) {
        s.velocity_deg_s.push_back(100.0);
        s.position_deg.push_back(4.0 * static_cast<double>(k));
        s.torque_nm.push_back(5.0 + 0.3 * std::sin(0.05 * static_cast<double>(k)));
    }
    const auto out = filtered(*start("oscillator,gear-ratio=90,orders=1,bandwidth=2Hz", nullptr, Hertz(25.0)),
                              s.samples());
    CHECK(rms_error(out, s.torque_nm) < 0.01);
}

TEST_CASE("a torque that jumps comes out at once where a jump is looked for, and rings where it is not") {
    Signals s;
    std::vector<double> truth;
    for (std::size_t k = 0; k < 3000; ++k) {
        const double theta = 0.05 * std::numbers::pi * static_cast<double>(k);  // 25 Hz
        s.velocity_deg_s.push_back(90.0);
        s.position_deg.push_back(0.09 * static_cast<double>(k));
        truth.push_back(k < 2000 ? 0.0 : 10.0);
        s.torque_nm.push_back(truth.back() + 0.8 * std::cos(theta) + 0.5 * std::cos(2.0 * theta + 1.0));
    }
    add_white_noise(s.torque_nm, 0.05, 3, NoiseChannel::torque);
    CHECK(rms_error(filtered(*start(cold + ",jump=12"), s.samples()), truth, 2000, 2100) < 0.06);
    CHECK(rms_error(filtered(*start(cold), s.samples()), truth, 2000, 2100) > 1.0);
    CHECK(rms_error(filtered(*start(cold + ",jump=12"), s.samples()), truth, 500, 2000) < 0.03);
    CHECK_THROWS_WITH(start(cold + ",jump=12,gain=scheduled"), Catch::Contains("gain=exact"));
}

TEST_CASE("oscillator says what is wrong with its settings") {
    CHECK_THROWS_WITH(start(cold + ",phases=0:0"), Catch::Contains("without amplitudes"));
    CHECK_THROWS_WITH(start(cold + ",amplitudes=0.8"), Catch::Contains("1 values for 2 orders"));
    CHECK_THROWS_WITH(start(cold + ",amplitudes=0.8:-1"), Catch::Contains("amplitudes: -1 is below 0 Nm"));
    CHECK_THROWS_WITH(start(cold + ",bandwidth=300Hz"), Catch::Contains("250 Hz"));
    CHECK_THROWS_AS(start(cold + ",memory=0"), UsageError);
}
