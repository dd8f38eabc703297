// SPDX-License-Identifier: MIT
#include "ripplenotch/model/model.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "effects_fixture.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/model/motion.hpp"
#include "ripplenotch/model/noise.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using fixture::model_of;
using namespace ripplenotch::literals;
using Catch::Contains;

namespace {

// A sensor that doubles and a sensor that adds one: their order shows.
Effect sensor(void (*apply)(const Situation&, std::span<const double>, std::span<double>)) {
    Effect effect{};
    effect.side = Side::sensor;
    effect.apply = apply;
    return effect;
}
const Effect doubling = sensor([](const Situation&, std::span<const double>, std::span<double> torque_nm) {
    for (double& t : torque_nm) t *= 2.0;
});
const Effect adding_one = sensor([](const Situation&, std::span<const double>, std::span<double> torque_nm) {
    for (double& t : torque_nm) t += 1.0;
});

}  // namespace

TEST_CASE("inertia: 1 kg m2 at 57.3 deg/s2 takes 1 Nm") {
    const Motion m = make_motion("ramp,to-speed=1rad/s,duration=1s", 100_Hz);
    for (const double torque : predict_nm(model_of({"inertia,inertia_kgm2=1"}), m))
        CHECK(torque == Approx(1.0).epsilon(1e-14));
}

TEST_CASE("what the sensors make of a joint's torque is what the model expects") {
    const Motion m = make_motion("sine,amplitude=20deg,frequency=3Hz,duration=1s,phase=0deg", 500_Hz);
    // Torques that go by nothing that a spring changes.
    const std::initializer_list<std::string_view> joint = {"inertia,inertia_kgm2=0.4",
                                                           "offset,torque_nm=0.5"};
    Model model = model_of(joint);
    const std::vector<double> torque_nm = predict_nm(model, m);
    CHECK(sensed_nm(model, m, torque_nm) == torque_nm);
    for (const auto term : {"delay,delay_s=0.011", "lag,time_constant_s=0.004",
                            "resonance,frequency_hz=20,damping=0.1,whole=1"})
        model.terms.push_back(parse_term(term));
    CHECK(sensed_nm(model, m, torque_nm) == predict_nm(model, m));
    CHECK(sensed_nm(model, m, torque_nm) != torque_nm);
    // Neither what a resonance does to ripple alone nor what a converter does is a sensor's.
    model = model_of(joint);
    for (const auto term : {"resonance,frequency_hz=20,damping=0.1", "saturation,limit_nm=0.1"})
        model.terms.push_back(parse_term(term));
    CHECK(sensed_nm(model, m, torque_nm) == torque_nm);
}

TEST_CASE("ripple of order n at speed v oscillates at n Kg v / 360") {
    // 36 deg/s, ratio 100, order 1: 10 Hz; sampled at 1 kHz, 100 samples a cycle. Order 2: 50 samples.
    const Motion m = make_motion("constant,speed=36deg/s,duration=1s", 1000_Hz);
    for (const int order : {1, 2}) {
        const auto torque = predict_nm(model_of({order == 1 ? "ripple,order=1,amplitude_nm=0.8,phase_deg=0"
                                                            : "ripple,order=2,amplitude_nm=0.8,phase_deg=0"}),
                                       m);
        for (std::size_t k = 0; k < m.size(); ++k) {
            const double expected = 0.8 * std::cos(2.0 * std::numbers::pi * 10.0 * order * m.time_s[k]);
            REQUIRE(torque[k] == Approx(expected).margin(1e-12));
        }
    }
}

TEST_CASE(
    "the phase of ripple is that of the cosine at position zero, and the ratio and the order both multiply") {
    // Ratio 100, order 2: a quarter cycle is 360 / 200 / 4 = 0.45 deg of the joint.
    const Motion m = make_motion("constant,speed=0.45deg/s,duration=4s", 1_Hz);
    CHECK(predict_nm(model_of({"ripple,order=2,amplitude_nm=3,phase_deg=90"}), m) ==
          std::vector<double>{0.0, -3.0, 0.0, 3.0});
    CHECK(predict_nm(model_of({"ripple,order=2,amplitude_nm=3,phase_deg=-90"}), m) ==
          std::vector<double>{0.0, 3.0, 0.0, -3.0});
}

TEST_CASE("the ripple of the paper's model, 0.8 and 0.5 Nm, spans 1.96 Nm peak to peak at any speed") {
    // Worked: the maximum is 1.3 at angle 0; the minimum of 0.8 c + 0.5 (2 c^2 - 1) is at c = -0.4: -0.66. At
    // 180 deg/s a cycle has 20 samples, which miss the minimum by up to 9 degrees: 2.4 (9 pi / 180)^2 / 2 =
    // 0.03 Nm.
    for (const char* speed : {"60", "120", "180"}) {
        const auto torque =
            predict_nm(model_of({"ripple,order=1,amplitude_nm=0.8,phase_deg=0",
                                 "ripple,order=2,amplitude_nm=0.5,phase_deg=0"}),
                       make_motion(std::string("constant,duration=4s,speed=") + speed, 1000_Hz));
        const auto [low, high] = std::minmax_element(torque.begin(), torque.end());
        CHECK(*high - *low == Approx(1.96).margin(0.03));
    }
}

TEST_CASE("ripple is a function of position: turning back retraces it") {
    const std::vector<std::string> there_and_back = {"poly6,to=30deg,duration=1s",
                                                     "poly6,to=0deg,duration=1s"};
    const Motion m = make_motion(there_and_back, 1000_Hz);
    const auto torque = predict_nm(model_of({"ripple,order=1,amplitude_nm=0.8,phase_deg=33",
                                             "gravity,amplitude_nm=2,phase_deg=-10", "offset,torque_nm=0.1"}),
                                   m);
    for (std::size_t k = 1; k < 1000; ++k) REQUIRE(torque[1000 + k] == Approx(torque[1000 - k]).margin(1e-9));
}

TEST_CASE("gravity is 0 upright and largest when horizontal") {
    const Motion m = make_motion("constant,speed=90deg/s,duration=4s", 1_Hz);  // at 0, 90, 180, 270 deg
    CHECK(predict_nm(model_of({"gravity,amplitude_nm=5,phase_deg=0"}), m) ==
          std::vector<double>{5.0, 0.0, -5.0, 0.0});
    CHECK(predict_nm(model_of({"gravity,amplitude_nm=5,phase_deg=90"}), m) ==
          std::vector<double>{0.0, -5.0, 0.0, 5.0});
}

TEST_CASE("friction opposes the motion, so the sensor sees the sign of the speed, and nothing at rest") {
    const auto torque_at = [](std::string_view term, const char* speed) {
        return predict_nm(model_of({term}),
                          make_motion(std::string("constant,duration=1s,speed=") + speed, 1_Hz))
            .front();
    };
    constexpr std::string_view coulomb = "coulomb-friction,torque_nm=0.5,width_deg_s=0.2";
    CHECK(torque_at(coulomb, "30") == 0.5);
    CHECK(torque_at(coulomb, "-30") == -0.5);
    CHECK(torque_at(coulomb, "0") == 0.0);
    CHECK(torque_at(coulomb, "0.2") ==
          Approx(0.5 * 0.76159).margin(1e-5));  // tanh(1), as the width's help says
    constexpr std::string_view viscous = "viscous-friction,coefficient_nm_per_deg_s=0.005";
    CHECK(torque_at(viscous, "100") == Approx(0.5));
    CHECK(torque_at(viscous, "-100") == Approx(-0.5));
}

TEST_CASE("a model is the sum of its effects") {
    const Motion m = make_motion("poly6,to=80deg,duration=1s", 1000_Hz);
    const auto together = predict_nm(model_of({"inertia,inertia_kgm2=0.5", "offset,torque_nm=0.3"}), m);
    const auto inertia = predict_nm(model_of({"inertia,inertia_kgm2=0.5"}), m);
    const auto reordered = predict_nm(model_of({"offset,torque_nm=0.3", "inertia,inertia_kgm2=0.5"}), m);
    for (std::size_t k = 0; k < m.size(); ++k) {
        CHECK(together[k] == Approx(inertia[k] + 0.3).margin(1e-14));
        CHECK(reordered[k] == Approx(together[k]).margin(1e-14));
    }
    CHECK(predict_nm(model_of({}), m) == std::vector<double>(m.size(), 0.0));
}

TEST_CASE("sensor effects see the whole sum, in the order given, wherever they stand in the list") {
    const Motion m = make_motion("rest,duration=1s", 1_Hz);
    const Term offset = parse_term("offset,torque_nm=3");
    const Term twice{&doubling, {}}, plus_one{&adding_one, {}};
    const auto torque = [&](std::vector<Term> terms) {
        return predict_nm({GearRatio(1.0), std::move(terms)}, m).front();
    };
    CHECK(torque({offset, twice, plus_one}) == 7.0);
    CHECK(torque({offset, plus_one, twice}) == 8.0);
    CHECK(torque({twice, plus_one, offset}) == 7.0);
}

TEST_CASE("a value that the model does not state is named, and the model does not run") {
    const Model model = model_of({"inertia", "ripple,order=1,amplitude_nm=0.8"});
    CHECK(missing_values(model) ==
          std::vector<std::string>{"effects[0].inertia_kgm2 of inertia", "effects[1].phase_deg of ripple"});
    const Motion m = make_motion("rest,duration=1s", 1_Hz);
    CHECK_THROWS_WITH(predict_nm(model, m), Contains("inertia_kgm2 of inertia") &&
                                                Contains("phase_deg of ripple") && Contains("fit"));
}

TEST_CASE("values of a term are read with their units and within their bounds") {
    CHECK(parse_term("ripple,order=2,amplitude_nm=800mNm,phase_deg=3.141592653589793rad").values[1] == 0.8);
    CHECK(*parse_term("ripple,phase_deg=1.5707963267948966rad").values[2] == Approx(90.0));
    CHECK_THROWS_WITH(parse_term("ripple,amplitude_nm=-1"), Contains("not between 0 and"));
    CHECK_THROWS_WITH(parse_term("ripple,amplitude_nm=1deg"), Contains("has the unit 'deg'"));
    CHECK_THROWS_WITH(parse_term("ripple,amplitud_nm=1"), Contains("did you mean amplitude_nm?"));
    CHECK_THROWS_WITH(parse_term("riple,order=1"), Contains("did you mean ripple?"));
}

namespace {

std::vector<double> draw(std::uint64_t seed, NoiseChannel channel, std::size_t count) {
    std::vector<double> values(count, 0.0);
    add_noise(values, {.rms = 1.0}, seed, channel);
    return values;
}

double correlation(const std::vector<double>& a, const std::vector<double>& b, std::size_t lag) {
    double sum = 0.0;
    for (std::size_t k = lag; k < a.size(); ++k) sum += a[k] * b[k - lag];
    return sum / static_cast<double>(a.size() - lag);
}

}  // namespace

TEST_CASE("a longer draw begins with the shorter one") {
    const auto shorter = draw(1, NoiseChannel::torque, 999);
    auto longer = draw(1, NoiseChannel::torque, 2000);
    longer.resize(999);
    CHECK(longer == shorter);
}

TEST_CASE("noise has mean 0, rms 1 and the tails of a normal distribution") {
    constexpr std::size_t n = 1'000'000;
    double mean = 0.0, square = 0.0, fourth = 0.0;
    std::size_t beyond_2 = 0;
    for (const double x : draw(3, NoiseChannel::torque, n)) {
        mean += x;
        square += x * x;
        fourth += x * x * x * x;
        if (std::abs(x) > 2.0) ++beyond_2;
    }
    const double count = static_cast<double>(n);
    // Five standard errors each: 1 / sqrt(n), sqrt(2 / n), sqrt(96 / n), sqrt(p (1 - p) / n) with p = 0.0455.
    CHECK(std::abs(mean / count) < 0.005);
    CHECK(std::abs(square / count - 1.0) < 0.0071);
    CHECK(std::abs(fourth / count - 3.0) < 0.049);
    CHECK(std::abs(static_cast<double>(beyond_2) / count - 0.045500) < 0.00105);
}

TEST_CASE("noise is white, and its channels and neighbouring seeds are unrelated") {
    constexpr std::size_t n = 200'000;
    const auto torque = draw(1, NoiseChannel::torque, n);
    const double limit = 5.0 / std::sqrt(static_cast<double>(n));
    for (std::size_t lag = 1; lag <= 20; ++lag) CHECK(std::abs(correlation(torque, torque, lag)) < limit);
    for (std::size_t lag = 0; lag <= 3; ++lag) {
        CHECK(std::abs(correlation(torque, draw(1, NoiseChannel::velocity, n), lag)) < limit);
        CHECK(std::abs(correlation(torque, draw(2, NoiseChannel::torque, n), lag)) < limit);
    }
}

TEST_CASE("uniform numbers are 0 or above, stay below 1 and fill it") {
    Noise noise(11, NoiseChannel::torque);
    std::vector<int> tenths(10, 0);
    for (int i = 0; i < 100'000; ++i) {
        const double x = noise.uniform();
        REQUIRE(x >= 0.0);
        REQUIRE(x < 1.0);
        ++tenths[static_cast<std::size_t>(10.0 * x)];
    }
    for (const int count : tenths)
        CHECK(std::abs(count - 10'000) < 475);  // five standard errors: 5 sqrt(n p (1 - p))
}

TEST_CASE("noise of rms 0 changes nothing, not even a sign of zero") {
    std::vector<double> values{-0.0, 1.5};
    add_noise(values, {.rms = 0.0}, 1, NoiseChannel::torque);
    CHECK(std::signbit(values[0]));
    CHECK(values[1] == 1.5);
}

// The first numbers of two streams as they were when the files in data/ were made: a change here is a change
// of every simulated log that anyone has kept the seed of.
