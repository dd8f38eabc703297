// SPDX-License-Identifier: MIT
#include "ripplenotch/analysis/vold_kalman.hpp"

#include <cstring>

#include "analysis/order_signals.hpp"
#include "ripplenotch/core/error.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using Catch::Contains;
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinRel;

TEST_CASE(
    "weights are Tuma's, and bandwidths too narrow for the arithmetic are refused with the narrowest one") {
    CHECK_THAT(vold_kalman_weight(0.01, 1), WithinRel(20.487, 1e-4));
    CHECK_THAT(vold_kalman_weight(0.01, 2), WithinRel(652.15, 1e-4));
    CHECK_THAT(vold_kalman_weight(0.01, 3), WithinRel(20759.5, 1e-4));
    CHECK_THAT(vold_kalman_weight(0.005, 1), WithinRel(40.973, 1e-4));
    CHECK_THAT(vold_kalman_weight(0.005, 2), WithinRel(2608.4, 1e-4));
    CHECK_THAT(vold_kalman_weight(0.005, 3), WithinRel(166064.0, 1e-4));
    CHECK_THROWS_WITH(vold_kalman_weight(0.001, 3),
                      Contains("ill-conditioned") && Contains("use at least 0.00"));
    CHECK_THROWS_AS(vold_kalman_weight(0.005, 4), UsageError);
    // The remedy that the message names is one.
    CHECK_NOTHROW(vold_kalman_weight(0.0039, 3));
    CHECK_THROWS_AS(vold_kalman_weight(0.01, 5), UsageError);
    CHECK_THROWS_AS(vold_kalman_weight(0.01, 0), UsageError);
    CHECK_THROWS_AS(vold_kalman_weight(0.0, 2), UsageError);
}

TEST_CASE("constant orders of a run-up come out with their amplitudes, and as waveforms") {
    const auto signal = tests::run_up();
    const int poles = GENERATE(1, 2, 3, 4);
    const VoldKalmanTracks found = track_vold_kalman(
        signal.tracked(tests::run_up_orders), {.bandwidth = Hertz(2.0), .poles = poles, .trend = false});
    REQUIRE(found.tracks.time_s.size() > 20);
    for (std::size_t i = 0; i < 4; ++i) {
        const double truth = tests::run_up_amplitudes[i];
        for (std::size_t row = 0; row < found.tracks.time_s.size(); ++row) {
            // Constant envelopes cost nothing and every other line is in the equations: rounding remains,
            // 2e-16 times a condition of up to 1e11 (four poles).
            CHECK_THAT(found.tracks.lines[i].amplitude_nm[row], WithinRel(truth, 3e-5));
        }
        for (std::size_t k = 0; k < signal.turns.size(); k += 7) {
            const double wave =
                truth * std::cos(2.0 * std::numbers::pi * tests::run_up_orders[i] * signal.turns[k]);
            CHECK_THAT(found.waveform_nm[i][k], WithinAbs(wave, 6e-5));
        }
    }
}

TEST_CASE("crossing orders of two shafts keep their amplitudes within 1 percent, the swell included") {
    const auto signal = tests::crossing();
    const VoldKalmanTracks found = track_vold_kalman(
        signal.tracked(),
        {.bandwidth = Hertz(10.0), .poles = 2, .trend = false, .rows_per_second = Hertz(100.0)});
    REQUIRE(found.tracks.time_s.size() > 200);
    double highest = 0.0;
    for (std::size_t row = 0; row < found.tracks.time_s.size(); ++row) {
        const double first = found.tracks.lines[0].amplitude_nm[row];
        highest = std::max(highest, first);
        CHECK_THAT(first, WithinRel(signal.first_amplitude_at(found.tracks.time_s[row]), 0.01));
        CHECK_THAT(found.tracks.lines[1].amplitude_nm[row], WithinRel(signal.second_amplitude, 0.01));
    }
    CHECK_THAT(highest, WithinRel(3.0 * std::numbers::sqrt2, 0.01));
}

TEST_CASE("the bandwidth obtained is the one asked for, and the filter is 3 dB down there") {
    const int poles = GENERATE(1, 2, 3, 4);
    const double width = 2.0, carrier = 40.0;
    auto signal = tests::shaft(tests::straight(carrier, carrier, 20000), 1000.0);
    // An amplitude that beats at half the bandwidth from the line: its envelope is passed at -3 dB.
    for (std::size_t k = 0; k < signal.turns.size(); ++k) {
        signal.torque_nm[k] = std::cos(2.0 * std::numbers::pi * (carrier + 0.5 * width) * signal.time_s[k]);
    }
    const VoldKalmanTracks found = track_vold_kalman(
        signal.tracked({1.0}), {.bandwidth = Hertz(width), .poles = poles, .rows_per_second = Hertz(50.0)});
    CHECK_THAT(found.bandwidth.value(), WithinRel(width, 0.005));
    const auto& amplitude = found.tracks.lines[0].amplitude_nm;
    CHECK_THAT(amplitude[amplitude.size() / 2], WithinRel(1.0 / std::numbers::sqrt2, 0.01));
}

TEST_CASE(
    "envelopes on forty points a width are those of one point a sample within 0.1 percent of the line") {
    auto signal = tests::shaft(tests::straight(20.0, 40.0, 4000), 500.0);
    for (std::size_t k = 0; k < signal.turns.size(); ++k) {
        const double amplitude = 1.0 + 0.5 * std::sin(2.0 * std::numbers::pi * 0.4 * signal.time_s[k]);
        signal.torque_nm[k] = 3.0 + amplitude * std::cos(2.0 * std::numbers::pi * signal.turns[k]);
    }
    tests::add_noise(signal, 0.1, 11);
    const VoldKalmanRule rule{.bandwidth = Hertz(1.5), .poles = 2};
    VoldKalmanRule full = rule;
    full.samples_per_point = 1;
    const VoldKalmanTracks coarse = track_vold_kalman(signal.tracked({1.0}), rule);
    const VoldKalmanTracks fine = track_vold_kalman(signal.tracked({1.0}), full);
    REQUIRE(coarse.envelope_step.value() > 7.9 * fine.envelope_step.value());
    for (std::size_t k = 0; k < signal.turns.size(); ++k) {
        CHECK_THAT(coarse.waveform_nm[0][k], WithinAbs(fine.waveform_nm[0][k], 1e-3));
    }
}

TEST_CASE("a long run solved in sections has no seams") {
    // 400 s at 2 Hz of bandwidth are 32000 points, four sections. Slow beat, so that the truth is known.
    auto signal = tests::shaft(tests::straight(20.0, 30.0, 80000), 200.0);
    for (std::size_t k = 0; k < signal.turns.size(); ++k) {
        const double amplitude = 1.0 + 0.5 * std::sin(2.0 * std::numbers::pi * 0.05 * signal.time_s[k]);
        signal.torque_nm[k] = amplitude * std::cos(2.0 * std::numbers::pi * signal.turns[k]);
    }
    const VoldKalmanTracks found =
        track_vold_kalman(signal.tracked({1.0}), {.bandwidth = Hertz(2.0), .poles = 4});
    for (std::size_t row = 8; row + 8 < found.tracks.time_s.size(); ++row) {
        const double truth = 1.0 + 0.5 * std::sin(2.0 * std::numbers::pi * 0.05 * found.tracks.time_s[row]);
        CHECK_THAT(found.tracks.lines[0].amplitude_nm[row], WithinAbs(truth, 2e-4));
    }
}

TEST_CASE("the stated standard error of a Vold-Kalman track is the scatter that white noise causes") {
    const int poles = GENERATE(1, 2, 3);
    double square = 0.0, stated = 0.0, end_square = 0.0, end_stated = 0.0;
    for (std::uint32_t seed = 0; seed < 60; ++seed) {
        auto signal = tests::shaft(tests::straight(20.0, 30.0, 5000), 500.0);
        tests::add_line(signal, {1.0, 0.8, 0.3});
        tests::add_noise(signal, 0.2, 900 + seed);
        const VoldKalmanTracks found =
            track_vold_kalman(signal.tracked({1.0, 2.0}),
                              {.bandwidth = Hertz(1.0), .poles = poles, .rows_per_second = Hertz(1.0)});
        const auto& line = found.tracks.lines[0];
        CHECK_THAT(found.tracks.residual_rms_nm, WithinRel(0.2, 0.05));
        for (std::size_t row = 0; row < line.amplitude_nm.size(); ++row) {
            const bool end = row == 0;
            (end ? end_square : square) += std::pow(line.amplitude_nm[row] - 0.8, 2);
            (end ? end_stated : end_stated) += end ? std::pow(line.standard_error_nm[row], 2) : 0.0;
            stated += end ? 0.0 : std::pow(line.standard_error_nm[row], 2);
        }
    }
    CHECK_THAT(square, WithinRel(stated, 0.25));          // about 500 values, nearly independent
    CHECK_THAT(end_square, WithinRel(end_stated, 0.55));  // 60 values: sqrt(2 / 60) = 18 %, three of that
}

TEST_CASE("a clock that jitters moves no amplitude") {
    auto signal = tests::shaft(tests::straight(20.0, 40.0, 4000), 500.0);
    tests::Noise jitter(7);
    for (std::size_t k = 0; k < signal.time_s.size(); ++k) {
        signal.time_s[k] += 0.0004 * std::clamp(jitter(), -1.0, 1.0);
        // The angle that the shaft really has then.
        signal.turns[k] = 20.0 * signal.time_s[k] + 0.5 * 20.0 / 7.998 * signal.time_s[k] * signal.time_s[k];
    }
    tests::add_line(signal, {1.0, 0.8, 0.3});
    const VoldKalmanTracks found = track_vold_kalman(signal.tracked({1.0}), {.bandwidth = Hertz(1.0)});
    for (const double amplitude : found.tracks.lines[0].amplitude_nm)
        CHECK_THAT(amplitude, WithinRel(0.8, 1e-5));
}

TEST_CASE(
    "where a line stands still or stays with another it is left out, and elsewhere it is not disturbed") {
    // Rest for 4 s, then 25 turns a second for 6 s; a torque that no order explains underneath.
    std::vector<double> speed(10000, 0.0);
    for (std::size_t k = 0; k < speed.size(); ++k) {
        speed[k] = 25.0 * std::clamp((static_cast<double>(k) - 4000.0) / 500.0, 0.0, 1.0);
    }
    auto signal = tests::shaft(speed, 1000.0);
    tests::add_line(signal, {1.0, 0.8, 0.3});
    for (double& torque : signal.torque_nm) torque += 5.0;
    const VoldKalmanTracks found = track_vold_kalman(signal.tracked({1.0}), {.bandwidth = Hertz(1.0)});
    // 4 Hz are reached 0.08 s after the start; half a second of the envelope lies before that.
    REQUIRE_FALSE(found.tracks.time_s.empty());
    CHECK(found.tracks.time_s.front() > 3.9);
    CHECK(found.tracks.rows_not_separable >= 31);
    for (std::size_t row = 0; row < found.tracks.time_s.size(); ++row) {
        if (found.tracks.time_s[row] > 5.0)
            CHECK_THAT(found.tracks.lines[0].amplitude_nm[row], WithinAbs(0.8, 1e-3));
    }

    // A tone at the speed of the shaft: told apart nowhere.
    signal = tests::shaft(tests::straight(25.0, 25.0, 5000), 1000.0);
    tests::add_line(signal, {1.0, 0.8, 0.0});
    TrackedSignal tracked = signal.tracked({1.0});
    tracked.lines.push_back({25.2, signal.time_s});
    const VoldKalmanTracks together = track_vold_kalman(tracked, {.bandwidth = Hertz(1.0)});
    CHECK(together.tracks.time_s.empty());
    CHECK(together.tracks.rows_not_separable > 30);
}

TEST_CASE("a log too short for the bandwidth is refused, and the message names one that works") {
    auto signal = tests::shaft(tests::straight(25.0, 25.0, 2001), 1000.0);
    tests::add_line(signal, {1.0, 0.8, 0.0});
    CHECK_THROWS_WITH(
        track_vold_kalman(signal.tracked({1.0}), {.bandwidth = Hertz(0.1)}),
        Contains("0.1 Hz needs 15 s") && Contains("longest run has 2 s") && Contains("0.79 Hz"));
    CHECK_NOTHROW(track_vold_kalman(signal.tracked({1.0}), {.bandwidth = Hertz(0.79)}));
    CHECK_THROWS_AS(track_vold_kalman(signal.tracked({1.0}), {.bandwidth = Hertz(300.0)}), UsageError);
    CHECK_THROWS_AS(track_vold_kalman(signal.tracked({}), {}), UsageError);
}

TEST_CASE("a gap in time is not bridged: each side is tracked alone") {
    auto signal = tests::shaft(tests::straight(25.0, 25.0, 8000), 1000.0);
    tests::add_line(signal, {1.0, 0.8, 0.0});
    for (std::size_t k = 4000; k < 8000; ++k) {
        signal.time_s[k] += 0.5;
        signal.torque_nm[k] *= 0.5;
    }
    TrackedSignal tracked = signal.tracked({1.0});
    const std::vector<std::size_t> run_starts = {4000};
    tracked.run_starts = run_starts;
    const VoldKalmanTracks found = track_vold_kalman(tracked, {.bandwidth = Hertz(1.0)});
    for (std::size_t row = 0; row < found.tracks.time_s.size(); ++row) {
        const double t = found.tracks.time_s[row];
        CHECK((t < 4.0 || t > 4.49));
        CHECK_THAT(found.tracks.lines[0].amplitude_nm[row], WithinRel(t < 4.2 ? 0.8 : 0.4, 1e-5));
    }
}

// That its cost grows with the samples alone is counted in tests/bench/instructions.py.
TEST_CASE("a Vold-Kalman track has the same bits twice") {
    constexpr std::size_t count = 50000;
    auto signal = tests::shaft(tests::straight(20.0, 30.0, count), 1000.0);
    tests::add_line(signal, {1.0, 0.5, 0.0});
    const auto once = track_vold_kalman(signal.tracked({1.0, 2.0}), {.bandwidth = Hertz(2.0)});
    const auto again = track_vold_kalman(signal.tracked({1.0, 2.0}), {.bandwidth = Hertz(2.0)});
    CHECK(std::memcmp(once.waveform_nm[0].data(), again.waveform_nm[0].data(), count * sizeof(double)) == 0);
}
