// SPDX-License-Identifier: MIT
#include "ripplenotch/analysis/order_track.hpp"

#include <cstring>

#include "analysis/order_signals.hpp"
#include "ripplenotch/core/error.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using Catch::Matchers::WithinAbs;
using Catch::Matchers::WithinRel;

TEST_CASE("the run-up of the textbook example is what its source says it is") {
    const auto signal = tests::run_up();
    CHECK_THAT(signal.turns.back(), WithinAbs(125.0, 1e-9));
    CHECK_THAT(signal.torque_nm[1 - 1], WithinAbs(4.914213562373, 1e-9));
    CHECK_THAT(signal.torque_nm.back(), WithinAbs(3.914213562373, 1e-9));
    double squares = 0.0;
    for (const double x : signal.torque_nm) squares += x * x;
    CHECK_THAT(std::sqrt(squares / 3001.0), WithinAbs(1.905382390196, 1e-9));
}

TEST_CASE("constant orders of a run-up are tracked to rounding, amplitude and phase") {
    const auto signal = tests::run_up();
    const OrderTracks tracks = track_orders(signal.tracked(tests::run_up_orders),
                                            {.turns = separating_window_turns(tests::run_up_orders)});
    REQUIRE(tracks.time_s.size() > 20);
    CHECK(tracks.rows_folded == 0);
    CHECK(tracks.rows_not_separable == 0);
    for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t row = 0; row < tracks.time_s.size(); ++row) {
            // The model holds exactly; what is left is rounding through normal equations.
            CHECK_THAT(tracks.lines[i].amplitude_nm[row], WithinRel(tests::run_up_amplitudes[i], 1e-7));
            CHECK_THAT(tracks.lines[i].phase_deg[row], WithinAbs(0.0, 1e-5));
            const double turns_per_s = 10.0 + 6.0 * tracks.time_s[row];
            CHECK_THAT(tracks.lines[i].hz[row], WithinRel(tests::run_up_orders[i] * turns_per_s, 0.01));
        }
    }
}

TEST_CASE("crossing orders of two shafts keep their amplitudes within 1 percent through the crossing") {
    const auto signal = tests::crossing();
    // 0.5 s around the crossing the lines turn by 2 pi * 30.7 Hz/s * (0.25 s)^2 / 2 = 6 rad against each
    // other.
    const OrderTracks tracks = track_orders(signal.tracked(), {.seconds = Seconds(0.5), .hop = 0.05});
    REQUIRE(tracks.time_s.size() > 80);
    bool at_crossing = false;
    for (std::size_t row = 0; row < tracks.time_s.size(); ++row) {
        at_crossing = at_crossing || std::abs(tracks.time_s[row] - 0.913) < 0.03;
        // The swell in the middle is narrower than the window and a quadratic cuts its top; elsewhere 1 %.
        if (std::abs(tracks.time_s[row] - 1.5) < 0.5) continue;
        CHECK_THAT(tracks.lines[0].amplitude_nm[row],
                   WithinRel(signal.first_amplitude_at(tracks.time_s[row]), 0.01));
        CHECK_THAT(tracks.lines[1].amplitude_nm[row], WithinRel(signal.second_amplitude, 0.01));
    }
    CHECK(at_crossing);
}

TEST_CASE("a short window follows the swell of one order to 1 percent where no other is near") {
    const auto signal = tests::crossing();
    const OrderTracks tracks = track_orders(signal.tracked(), {.seconds = Seconds(0.16), .hop = 0.1});
    double highest = 0.0;
    for (std::size_t row = 0; row < tracks.time_s.size(); ++row) {
        if (std::abs(tracks.time_s[row] - 1.5) > 0.35) continue;
        highest = std::max(highest, tracks.lines[0].amplitude_nm[row]);
        CHECK_THAT(tracks.lines[0].amplitude_nm[row],
                   WithinRel(signal.first_amplitude_at(tracks.time_s[row]), 0.01));
    }
    CHECK_THAT(highest, WithinRel(3.0 * std::numbers::sqrt2, 0.01));
}

TEST_CASE(
    "an amplitude that grows eightfold with speed is tracked within 5 percent, against time and speed") {
    // 20 to 160 deg/s in 8 s at a gear of 100; order 1 grows from 0.2 to 1.6 Nm, order 2 stays, noise 0.04
    // Nm.
    auto signal = tests::shaft(tests::straight(20.0 * 100.0 / 360.0, 160.0 * 100.0 / 360.0, 8001), 1000.0);
    const auto amplitude_at = [](double turns_per_s) { return 0.2 * turns_per_s / (20.0 * 100.0 / 360.0); };
    for (std::size_t k = 0; k < signal.turns.size(); ++k) {
        signal.speed_deg_s[k] /= 100.0;
        const double angle = 2.0 * std::numbers::pi * signal.turns[k];
        signal.torque_nm[k] = 10.0 + amplitude_at(signal.speed_deg_s[k] / 3.6) * std::cos(angle + 0.5) +
                              0.5 * std::cos(2.0 * angle);
    }
    tests::add_noise(signal, 0.04, 3);
    const OrderTracks tracks = track_orders(signal.tracked({1.0, 2.0}), {});
    REQUIRE(tracks.time_s.size() > 90);
    for (std::size_t row = 0; row < tracks.time_s.size(); ++row) {
        const double truth = amplitude_at((20.0 + 17.5 * tracks.time_s[row]) / 3.6);
        CHECK_THAT(tracks.lines[0].amplitude_nm[row],
                   WithinAbs(truth, 0.05 * truth + 4.0 * tracks.lines[0].standard_error_nm[row]));
    }
    const SpeedTrack by_speed = gather_by_speed(tracks, DegPerSec(10.0));
    REQUIRE(by_speed.speed_deg_s.size() > 12);
    for (std::size_t row = 0; row < by_speed.speed_deg_s.size(); ++row) {
        CHECK_THAT(by_speed.lines[0].amplitude_nm[row],
                   WithinRel(amplitude_at(by_speed.speed_deg_s[row] / 3.6), 0.05));
        CHECK_THAT(by_speed.lines[1].amplitude_nm[row], WithinRel(0.5, 0.05));
        CHECK_THAT(by_speed.lines[0].phase_deg[row], WithinAbs(0.5 * degrees_per_radian, 3.0));
    }
}

TEST_CASE("the stated standard error is the scatter that white noise causes") {
    double square = 0.0, stated = 0.0;
    std::size_t count = 0;
    for (std::uint32_t seed = 0; seed < 40; ++seed) {
        auto signal = tests::shaft(tests::straight(16.0, 24.0, 3000), 1000.0);
        tests::add_line(signal, {1.0, 0.8, 0.3});
        tests::add_line(signal, {2.0, 0.5, -0.7});
        tests::add_noise(signal, 0.2, 100 + seed);
        // Windows one after the other, so that their errors are independent.
        const OrderTracks tracks = track_orders(signal.tracked({1.0, 2.0}), {.hop = 1.0});
        for (const double amplitude : tracks.lines[0].amplitude_nm) square += std::pow(amplitude - 0.8, 2);
        for (const double error : tracks.lines[0].standard_error_nm) stated += error * error;
        count += tracks.time_s.size();
        CHECK_THAT(tracks.residual_rms_nm, WithinRel(0.2, 0.06));  // 3 of sqrt(1 / (2 * 2900)), and margin
    }
    REQUIRE(count > 250);
    // The variance of n values is known to sqrt(2 / n), 8 % here: 25 % is three of that.
    CHECK_THAT(square, WithinRel(stated, 0.25));
    // A quadratic envelope knows its middle 9/4 as badly as a constant: sigma sqrt(2/N) * 1.5, N = 400
    // samples.
    CHECK_THAT(std::sqrt(stated / static_cast<double>(count)),
               WithinRel(0.2 * std::sqrt(2.0 / 400.0) * 1.5, 0.1));
}

TEST_CASE("a mains tone that an order sweeps across is kept apart from it") {
    auto signal = tests::shaft(tests::straight(30.0, 70.0, 4000), 1000.0);
    tests::add_line(signal, {1.0, 0.5, 0.0});
    for (std::size_t k = 0; k < signal.time_s.size(); ++k) {
        signal.torque_nm[k] += 0.8 * std::cos(2.0 * std::numbers::pi * 50.0 * signal.time_s[k]);
    }
    TrackedSignal tracked = signal.tracked({1.0});
    tracked.lines.push_back({50.0, signal.time_s});
    const OrderTracks tracks = track_orders(tracked, {.seconds = Seconds(0.8)});
    REQUIRE(tracks.time_s.size() > 10);
    for (std::size_t row = 0; row < tracks.time_s.size(); ++row) {
        CHECK_THAT(tracks.lines[0].amplitude_nm[row], WithinRel(0.5, 1e-6));
        CHECK_THAT(tracks.lines[1].amplitude_nm[row], WithinRel(0.8, 1e-6));
    }
}

TEST_CASE("lines that never part within a window are left out, not invented") {
    auto signal = tests::shaft(tests::straight(20.0, 20.0, 3000), 1000.0);
    tests::add_line(signal, {1.0, 0.5, 0.0});
    TrackedSignal tracked = signal.tracked({1.0});
    tracked.lines.push_back({20.0, signal.time_s});  // at this one speed, 20 Hz is order 1
    const OrderTracks tracks = track_orders(tracked, {});
    CHECK(tracks.time_s.empty());
    CHECK(tracks.rows_not_separable > 0);
}

TEST_CASE("rest and turning back end a run, and slow motion is tracked in windows of as many turns") {
    auto signal = tests::shaft(tests::straight(0.0, 0.0, 3000), 1000.0);
    CHECK(track_orders(signal.tracked({1.0}), {}).time_s.empty());
    for (const double turns_per_s : {2.0, 0.4}) {
        signal = tests::shaft(tests::straight(turns_per_s, turns_per_s, 45000), 1000.0);
        tests::add_line(signal, {1.0, 0.5, 0.4});
        const OrderTracks slow = track_orders(signal.tracked({1.0}), {});
        REQUIRE(slow.time_s.size() > 3);
        CHECK_THAT(slow.lines[0].amplitude_nm[1], WithinRel(0.5, 1e-6));
    }
    // There and back, with the speed through zero: no window spans the turn.
    signal = tests::shaft(tests::straight(-40.0, 40.0, 4000), 1000.0);
    tests::add_line(signal, {1.0, 0.5, 0.4});
    const OrderTracks back = track_orders(signal.tracked({1.0}), {});
    REQUIRE(back.time_s.size() > 10);
    for (std::size_t row = 0; row < back.time_s.size(); ++row) {
        CHECK_THAT(back.lines[0].amplitude_nm[row], WithinRel(0.5, 1e-6));
        CHECK_THAT(back.lines[0].phase_deg[row], WithinAbs(0.4 * degrees_per_radian, 1e-4));
    }
}

TEST_CASE("the window that separates orders is eight periods of the lowest and two beats of the closest") {
    CHECK(separating_window_turns(std::vector{1.0, 2.0}) == 8.0);
    CHECK(separating_window_turns(std::vector{0.5, 4.0, 1.0}) == 16.0);
    CHECK_THAT(separating_window_turns(std::vector{2.0, 2.1}), WithinRel(20.0, 1e-12));
    CHECK_THROWS_AS(separating_window_turns(std::vector{1.0, 1.0}), UsageError);
    CHECK_THROWS_AS(separating_window_turns(std::vector{0.0}), UsageError);
}

// That its cost grows with the samples alone is counted in tests/bench/instructions.py.
TEST_CASE("tracking twice gives the same bits") {
    auto signal = tests::shaft(tests::straight(20.0, 30.0, 30000), 1000.0);
    tests::add_line(signal, {1.0, 0.5, 0.0});
    const OrderTracks once = track_orders(signal.tracked({1.0, 2.0}), {});
    const OrderTracks again = track_orders(signal.tracked({1.0, 2.0}), {});
    REQUIRE(once.time_s.size() == again.time_s.size());
    const auto bytes = once.time_s.size() * sizeof(double);
    CHECK(std::memcmp(once.lines[0].amplitude_nm.data(), again.lines[0].amplitude_nm.data(), bytes) == 0);
    CHECK(std::memcmp(once.lines[1].phase_deg.data(), again.lines[1].phase_deg.data(), bytes) == 0);
}

TEST_CASE("tracks at one speed gather into one range, and ranges without rows are left out") {
    OrderTracks tracks;
    tracks.lines.resize(1);
    for (const double speed : {60.0, 60.02, 59.98}) {
        tracks.time_s.push_back(0.0);
        tracks.speed_deg_s.push_back(speed);
        tracks.lines[0].amplitude_nm.push_back(0.5 + 5.0 * (speed - 60.0));
        tracks.lines[0].standard_error_nm.push_back(0.07);
        tracks.lines[0].phase_deg.push_back(170.0);
        tracks.lines[0].hz.push_back(16.7);
    }
    const SpeedTrack one = gather_by_speed(tracks, DegPerSec(0.0));
    REQUIRE(one.speed_deg_s.size() == 1);
    CHECK(one.rows[0] == 3);
    CHECK_THAT(one.lines[0].amplitude_nm[0], WithinAbs(0.5, 1e-12));
    CHECK_THAT(one.lines[0].phase_deg[0], WithinAbs(170.0, 1e-9));
    CHECK_THAT(one.lines[0].spread_nm[0], WithinAbs(0.1, 1e-12));  // of 0.4, 0.5 and 0.6
    const SpeedTrack each = gather_by_speed(tracks, DegPerSec(0.01));
    REQUIRE(each.speed_deg_s.size() == 3);
    CHECK_THAT(each.lines[0].spread_nm[0], WithinAbs(0.07, 1e-12));  // of one row, its own error
    CHECK(gather_by_speed(OrderTracks{}, DegPerSec(0.0)).speed_deg_s.empty());
    CHECK(speed_step({DegPerSec(0.0), DegPerSec(0.0)}) == 1.0);
    CHECK(speed_step({DegPerSec(0.0), DegPerSec(180.0)}) == 10.0);
}
