// SPDX-License-Identifier: MIT
// The notch that follows the speed, against figures worked out independently (SciPy, Octave) and against the
// formulas of the firmwares whose rules it takes over.

#include <fmt/format.h>
#include <complex>

#include "filter/moves.hpp"
#include "ripplenotch/core/biquad.hpp"
#include "ripplenotch/core/error.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using namespace ripplenotch::testing;

namespace {

const std::string gear = "tracking,gear-ratio=100,orders=1:2";

struct Left {
    double hold = 0.0, ramp = 0.0,
           peak = 0.0;  ///< Nm: rms of 2 to 5 and 17 to 20 s, rms and largest of 5 to 15 s
};

Left left_on(const Signals& s, const std::string& text) {
    const auto out = filtered(*start(text), s.samples());
    const std::vector<double> truth(out.size(), 10.0);
    Left left{
        std::hypot(rms_error(out, truth, 2000, 5000), rms_error(out, truth, 17000)) / std::numbers::sqrt2,
        rms_error(out, truth, 5000, 15000), 0.0};
    for (std::size_t k = 5000; k < 15000; ++k) left.peak = std::max(left.peak, std::abs(out[k] - 10.0));
    return left;
}

Signals late(Signals s, std::size_t samples) {
    for (std::size_t k = s.velocity_deg_s.size(); k-- > samples;)
        s.velocity_deg_s[k] = s.velocity_deg_s[k - samples];
    return s;
}

FrozenFilter frozen_at(const std::string& text, double line_hz, Hertz sample_rate = Hertz(1000.0)) {
    const Spec spec = parse_spec(text);
    const Method& method = find_method(spec.name);
    return method.frozen(Settings("method", spec, method.keys), sample_rate, nullptr,
                         DegPerSec(3.6 * line_hz));
}

double gain_db(const std::string& text, double line_hz, double at_hz) {
    const double gain =
        std::abs(response(frozen_at(text, line_hz).cascade, Hertz(at_hz), SampledAt(Hertz(1000.0))));
    return 20.0 * std::log10(std::max(gain, 1e-20));
}

double lag_deg(const std::string& text, double line_hz, double at_hz) {
    const auto cascade = frozen_at(text, line_hz, Hertz(2000.0)).cascade;
    // Step by step, so that a lag beyond half a turn is counted in full.
    double lag = 0.0;
    std::complex<double> before = 1.0;
    for (int i = 1; i <= 200; ++i) {
        const auto now = response(cascade, Hertz(at_hz * i / 200.0), SampledAt(Hertz(2000.0)));
        lag -= std::arg(now / before) * 180.0 / std::numbers::pi;
        before = now;
    }
    return lag;
}

}  // namespace

TEST_CASE(
    "on a ramp from 20 to 40 deg/s a notch retuned every sample leaves less than a thousandth of a "
    "newton-metre") {
    for (const char* q : {"q=1", "q=2", "q=2.5", "q=4"}) {
        const Left left = left_on(ramp(), fmt::format("{},{}", gear, q));
        INFO(q);
        CHECK(left.ramp < 1e-4);
        CHECK(left.peak < 1e-3);
        CHECK(left.hold < 1e-4);
    }
    CHECK(left_on(ramp(), gear + ",q=1").peak < 5e-5);
}

TEST_CASE("what a wrong speed costs a retuned notch is what an independent computation gives") {
    // Without the fade: 2 deg/s of noise would move 20 deg/s in and out of it.
    const std::string off = ",min=0.5Hz,fade=0Hz", q1 = gear + ",q=1" + off;
    const auto near = [](double value) { return Approx(value).epsilon(0.2); };
    const Left late10 = left_on(late(ramp(), 10), q1), late50 = left_on(late(ramp(), 50), q1);
    CHECK(late10.ramp == near(0.0019));
    CHECK(late10.peak == near(0.0047));
    CHECK(late50.ramp == near(0.0093));
    CHECK(late50.peak == near(0.0233));
    const std::string wrong = "tracking,gear-ratio=102,orders=1:2" + off;
    const Left wrong1 = left_on(ramp(), wrong + ",q=1"), wrong2 = left_on(ramp(), wrong + ",q=2");
    CHECK(wrong1.hold == near(0.0523));
    CHECK(wrong1.ramp == near(0.0524));
    CHECK(wrong1.peak == near(0.0945));
    CHECK(wrong2.hold == near(0.118));
    CHECK(wrong2.ramp == near(0.119));
    CHECK(wrong2.peak == near(0.202));
    for (const auto& [noise, hold, on_ramp] :
         {std::tuple{0.5, 0.0069, 0.0057}, std::tuple{2.0, 0.0221, 0.0224}}) {
        Left mean;
        for (std::uint64_t seed = 1; seed <= 5; ++seed) {
            Signals s = ramp();
            add_white_noise(s.velocity_deg_s, noise, seed, NoiseChannel::velocity);
            const Left left = left_on(s, q1);
            mean.hold += left.hold / 5.0;
            mean.ramp += left.ramp / 5.0;
        }
        CHECK(mean.hold == near(hold));
        CHECK(mean.ramp == near(on_ramp));
    }
}

TEST_CASE("a noisy speed is better low-passed") {
    Signals s = ramp();
    add_white_noise(s.velocity_deg_s, 2.0, 3, NoiseChannel::velocity);
    const std::string text = gear + ",q=1,min=0.5Hz,fade=0Hz";
    CHECK(left_on(s, text + ",speed-lowpass=2Hz").hold < 0.7 * left_on(s, text).hold);
}

TEST_CASE("low=fade follows Betaflight's weight: min 100 Hz, fade 50 Hz") {
    const std::string text = "tracking,gear-ratio=100,orders=1,q=5,min=100Hz,fade=50Hz";
    CHECK(frozen_at(text, 100.0).cascade.empty());
    CHECK(gain_db(text, 110.0, 110.0) == Approx(-1.938).margin(0.001));
    CHECK(gain_db(text, 125.0, 125.0) == Approx(-6.021).margin(0.001));
    CHECK(gain_db(text, 140.0, 140.0) == Approx(-13.979).margin(0.001));
    CHECK(gain_db(text, 150.0, 150.0) < -200.0);
    // Q 5 at 300 Hz: 60 Hz between the -3 dB edges of the prototype.
    CHECK(gain_db("tracking,gear-ratio=100,orders=1,q=5", 30.0, 30.0) < -200.0);
}

TEST_CASE("a weight takes its share of each order and no more") {
    const std::string text = gear + ",weights=1:0.5";
    CHECK(gain_db(text, 50.0, 50.0) < -200.0);
    const double alone = gain_db("tracking,gear-ratio=100,orders=1", 50.0, 100.0);
    CHECK(gain_db(text, 50.0, 100.0) - alone == Approx(-6.021).margin(0.001));
    CHECK(frozen_at(gear + ",weights=0:0", 50.0).cascade.empty());
}

TEST_CASE(
    "low=park follows ArduPilot below the minimum: the centre stays, the depth ends at a quarter of it") {
    const std::string text = "tracking,gear-ratio=100,orders=1,q=1.714285714,depth=40dB,min=80Hz,low=park";
    const double hz[] = {80.0, 65.0, 50.0, 35.0}, db[] = {-40.0, -19.53, -10.39, -4.43};
    for (int i = 0; i < 4; ++i) CHECK(gain_db(text, hz[i], 80.0) == Approx(db[i]).margin(0.01));
    CHECK(frozen_at(text, 20.0).cascade.empty());
    // Their defaults above the minimum (80 Hz, bandwidth 40 Hz, 40 dB).
    const double at[] = {60.0, 70.0, 90.0, 100.0}, expected[] = {-2.868, -7.322, -8.155, -3.990};
    for (int i = 0; i < 4; ++i) CHECK(gain_db(text, 80.0, at[i]) == Approx(expected[i]).margin(0.001));
}

TEST_CASE("double notches on four harmonics lag as ArduPilot's do, single ones more") {
    // Eight such filters in series: 46 Hz, bandwidth 23 Hz, 60 dB, 2 kHz.
    const std::string text =
        "tracking,gear-ratio=100,orders=1:2:3:4,q=1.7142857142857142,depth=60dB,composite=";
    const double at[] = {1.0, 2.0, 5.0, 10.0};
    const double twice[] = {11.022, 22.062, 55.462, 113.199}, once[] = {11.999, 24.015, 60.339, 122.904};
    for (int i = 0; i < 4; ++i) {
        CHECK(8.0 * lag_deg(text + "double", 46.0, at[i]) == Approx(twice[i]).margin(0.01));
        CHECK(8.0 * lag_deg(text + "single", 46.0, at[i]) == Approx(once[i]).margin(0.01));
    }
    CHECK(frozen_at(text + "triple", 46.0).cascade.size() == 12);
}

TEST_CASE("a slew limit lets a centre move by at most its share from sample to sample") {
    Signals jump;
    for (std::size_t k = 0; k < 400; ++k) {
        jump.velocity_deg_s.push_back(k < 100 ? 60.0 : k < 250 ? 120.0 : 30.0);
        jump.position_deg.push_back(0.0);
        jump.torque_nm.push_back(std::sin(0.3 * static_cast<double>(k)) +
                                 std::sin(0.11 * static_cast<double>(k)));
    }
    Signals gentle = jump;
    for (std::size_t k = 1; k < 400; ++k) {
        const double now = gentle.velocity_deg_s[k - 1];
        gentle.velocity_deg_s[k] = std::clamp(jump.velocity_deg_s[k], 0.95 * now, now / 0.95);
    }
    const auto limited = filtered(*start(gear + ",slew=0.05"), jump.samples());
    const auto expected = filtered(*start(gear), gentle.samples());
    const auto free = filtered(*start(gear), jump.samples());
    double worst = 0.0, differs = 0.0;
    for (std::size_t k = 0; k < 400; ++k) {
        worst = std::max(worst, std::abs(limited[k] - expected[k]));
        differs = std::max(differs, std::abs(limited[k] - free[k]));
    }
    CHECK(worst < 1e-9);
    CHECK(differs > 0.01);
}

TEST_CASE("through a reversal the notch leaves what low speed leaves, and nothing builds up") {
    // -40 to 40 deg/s in 10 s; 10 + 5 sin(2 pi 0.2 t) Nm, ripple of 2 and 1 Nm.
    Signals s;
    std::vector<double> truth;
    double angle = 0.0;
    for (std::size_t k = 0; k < 20000; ++k) {
        const double t = static_cast<double>(k) / 1000.0;
        const double v = std::clamp(8.0 * (t - 10.0), -40.0, 40.0);
        angle += v / 1000.0;
        const double theta = 100.0 * angle * std::numbers::pi / 180.0;
        truth.push_back(10.0 + 5.0 * std::sin(2.0 * std::numbers::pi * 0.2 * t));
        s.velocity_deg_s.push_back(v);
        s.position_deg.push_back(angle);
        s.torque_nm.push_back(truth.back() + 2.0 * std::sin(theta + 0.3) + std::sin(2.0 * theta + 1.1));
    }
    for (const auto* rule :
         {"min=1Hz,fade=1Hz", "min=2Hz,fade=2Hz", "min=1Hz,low=park", "min=4Hz,fade=1.5Hz"}) {
        INFO(rule);
        const auto out = filtered(*start(gear + ",q=1," + rule), s.samples());
        const double left = rms_error(out, truth, 9000, 11000);
        CHECK(left > 0.5);
        CHECK(left < 2.6);
        for (const double y : out) REQUIRE(std::abs(y) < 25.0);
    }
}

TEST_CASE(
    "on the paper's move the default tracking notch leaves 0.27 Nm of 0.65, at Q 4 without fading 0.32") {
    double raw = 0.0, q4 = 0.0, usual = 0.0;
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        const KnownMove move = paper_move(seed);
        raw += rms_error(move.signals.torque_nm, move.true_nm) / 5.0;
        q4 += rms_error(filtered(*start(gear + ",q=4,min=0.5Hz,fade=0Hz"), move.signals.samples()),
                        move.true_nm) /
              5.0;
        usual += rms_error(filtered(*start(gear), move.signals.samples()), move.true_nm) / 5.0;
    }
    CHECK(raw == Approx(0.65).margin(0.01));
    CHECK(q4 == Approx(0.32).margin(0.01));
    CHECK(usual < 0.28);
}

TEST_CASE("max-delay narrows a slow line's notch until its delay is that, and leaves a fast one's as it is") {
    const auto delay_ms = [](const std::string& text, double line_hz) {
        return 1e3 *
               group_delay(frozen_at(text, line_hz).cascade, Hertz(0.0), SampledAt(Hertz(1000.0))).value();
    };
    const auto rule = [](double hz, double q) { return 1e3 / (2.0 * std::numbers::pi * hz * q); };
    const std::string one = "tracking,gear-ratio=100,orders=1";
    for (const double hz : {6.0, 8.0, 12.0, 15.0}) {
        CHECK(delay_ms(one + ",q=2,max-delay=5ms", hz) == Approx(5.0).epsilon(2e-3));
        CHECK(delay_ms(one + ",q=2", hz) == Approx(rule(hz, 2.0)).epsilon(5e-3));
        CHECK(delay_ms(one, hz) == Approx(4.5).epsilon(2e-3));
    }
    for (const double hz : {17.0, 40.0}) {
        CHECK(delay_ms(one + ",q=2,max-delay=5ms", hz) == delay_ms(one + ",q=2", hz));
        CHECK(gain_db(one + ",max-delay=5ms", hz, hz) < -200.0);
    }
    CHECK(delay_ms(one, 60.0) == delay_ms(one + ",q=1.7", 60.0));
}

TEST_CASE("tracking says what is wrong with its settings") {
    CHECK_THROWS_WITH(start("tracking,orders=1"), Catch::Contains("gear-ratio"));
    CHECK_THROWS_WITH(start(gear + ",weights=1"), Catch::Contains("1 values for 2 orders"));
    CHECK_THROWS_WITH(start(gear + ",weights=1:-0.5"), Catch::Contains("weights: -0.5 is below 0"));
    CHECK_THROWS_WITH(start(gear + ",fade=-1Hz"), Catch::Contains("fade: -1Hz is below 0 Hz"));
    CHECK_THROWS_WITH(start("tracking,gear-ratio=100,orders=2:1:2"), Catch::Contains("2 is given twice"));
    CHECK_THROWS_WITH(start(gear + ",min=460Hz"), Catch::Contains("450 Hz"));
    CHECK_THROWS_AS(start("tracking,gear-ratio=0,orders=1"), UsageError);
}

TEST_CASE("a line that nears half the sample rate is let go before it gets there") {
    const std::string text = "tracking,gear-ratio=100,orders=1";
    CHECK(gain_db(text, 440.0, 440.0) < -200.0);
    CHECK(gain_db(text, 465.0, 465.0) == Approx(-6.021).margin(0.001));
    CHECK(frozen_at(text, 490.0).cascade.empty());
}
