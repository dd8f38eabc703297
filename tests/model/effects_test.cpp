// SPDX-License-Identifier: MIT
// Laws that hold for every effect of the catalogue: an effect is under test on the day it is listed.
#include <fmt/format.h>

#include <complex>
#include <fstream>
#include <numbers>
#include <regex>
#include <set>

#include "effects_fixture.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "support/catch.hpp"
#include "support/places.hpp"

using namespace ripplenotch;
using namespace ripplenotch::fixture;
using Catch::Contains;
using std::numbers::pi;

namespace {

// Noise on the torque, so that converters find something to change everywhere.
const std::vector<double>& noise_nm() {
    static const std::vector<double> values = [] {
        std::mt19937_64 engine(5);
        std::uniform_real_distribution<double> torque(-3.0, 3.0);
        std::vector<double> drawn(rich_motion().size());
        for (double& value : drawn) value = torque(engine);
        return drawn;
    }();
    return values;
}

std::vector<double> measured(const Model& model, const Motion& motion = rich_motion()) {
    return measure_nm(model, motion, std::span(noise_nm()).first(motion.size()));
}

std::vector<double> measured(const Effect& effect, const std::vector<double>& values) {
    return measured(with(base_model(), effect, values));
}

}  // namespace

TEST_CASE("effects have unique names in kebab-case, are found by them, and describe themselves") {
    std::set<std::string> seen;
    for (const Effect* effect : catalogue()) {
        CAPTURE(effect->name);
        const std::string name(effect->name);
        CHECK(std::regex_match(name, std::regex("[a-z]+(-[a-z]+)*")));
        CHECK(seen.insert(name).second);
        CHECK(&find_effect(name) == effect);
        for (const auto text : {effect->summary, effect->equation, effect->symptom, effect->source}) {
            CHECK(!text.empty());
        }
        CHECK(!effect->parameters.empty());
        const bool is_motion = effect->side == Side::motion, is_ripple = effect->side == Side::ripple;
        CHECK((effect->change_motion != nullptr) == (is_motion || effect->whole));
        CHECK((effect->change_ripple != nullptr) == is_ripple);
        CHECK((effect->apply != nullptr) == (effect->whole || !(is_motion || is_ripple)));
        CHECK((!effect->whole || is_ripple));
        CHECK((!effect->chance || effect->side == Side::converter));
        CHECK((!effect->bears_load || effect->side == Side::joint));
        if (effect->ripple_order) CHECK(effect->parameters[*effect->ripple_order].name == "order");
        if (effect->polar) {
            CHECK(effect->parameters[effect->polar->size].linear);
            CHECK(effect->parameters[effect->polar->phase].unit == "deg");
        }
    }
    CHECK_THROWS_WITH(
        find_effect("friction"),
        Contains(
            "coulomb-friction, asymmetric-friction, viscous-friction, asymmetric-viscous-friction, "
            "quadratic-viscous-friction, stribeck-friction, load-friction, position-dependent-friction"));
    CHECK_THROWS_WITH(find_effect("rippel"),
                      Contains("did you mean ripple?") && Contains("ripplenotch diagnose --effects"));
}

TEST_CASE("each effect of the converter says how a log shows it, and no other effect does") {
    for (const Effect* effect : catalogue()) {
        CAPTURE(effect->name);
        CHECK((effect->detect != nullptr) == (effect->side == Side::converter));
        CHECK((effect->detect_turn == 0 || effect->detect != nullptr));
    }
}

TEST_CASE("look-alikes are effects of the catalogue, or are said in words, and each says what decides") {
    for (const Effect* effect : catalogue()) {
        CAPTURE(effect->name);
        CHECK(!effect->look_alikes.empty());
        std::set<std::string_view> seen;
        for (const LookAlike& other : effect->look_alikes) {
            CAPTURE(other.name);
            CHECK(seen.insert(other.name).second);
            CHECK(other.name != effect->name);
            if (other.name.find(' ') == std::string_view::npos) CHECK_NOTHROW(find_effect(other.name));
            CHECK(!other.when.empty());
            CHECK(!other.told_by.empty());
        }
    }
}

TEST_CASE(
    "parameters have unique names that end in their unit, and bounds around neutral value and first guess") {
    const std::regex ends_in_unit(
        ".*_(nm|deg|deg_s|kgm2|hz|s|percent|percent_per_nm|nm_per_deg_s|nm_per_deg2_s2|nm_s)");
    for (const Effect* effect : catalogue()) {
        std::set<std::string> seen;
        for (const Parameter& parameter : effect->parameters) {
            CAPTURE(effect->name, parameter.name);
            const std::string name(parameter.name);
            CHECK(seen.insert(name).second);
            CHECK(std::regex_match(name, std::regex("[a-z0-9]+(_[a-z0-9]+)*")));
            CHECK(std::regex_match(name, ends_in_unit) == !parameter.unit.empty());
            CHECK(!parameter.help.empty());
            CHECK(parameter.lower < parameter.upper);
            CHECK((!parameter.logarithmic || parameter.lower > 0.0));
            CHECK(allows(parameter, parameter.neutral));
            CHECK(allows(parameter, parameter.start));
            CHECK(allows(parameter, parameter.lower));
            CHECK(allows(parameter, parameter.upper));
            CHECK_FALSE(allows(parameter, std::nextafter(parameter.upper, INFINITY)));
            CHECK_FALSE(allows(parameter, std::nan("")));
        }
    }
}

TEST_CASE("what resists is a friction at the joint whose first parameter is its size, 0 or more") {
    int count = 0;
    for (const Effect* effect : catalogue()) {
        if (!effect->resists) continue;
        CAPTURE(effect->name);
        ++count;
        CHECK(effect->side == Side::joint);
        CHECK_FALSE(effect->polar);
        CHECK(effect->parameters[0].linear);
        CHECK(effect->parameters[0].lower == 0.0);
    }
    CHECK(count == 6);
}

TEST_CASE("what is tried in both directions only is a torque of the joint that is the same forth and back") {
    int count = 0;
    const auto forth =
        make_motion(std::vector<std::string>{"poly6,from=0,to=90deg,duration=1s"}, Hertz(100.0));
    auto back = forth;
    for (std::size_t k = 0; k < back.size(); ++k) {
        back.velocity_deg_s[k] *= -1.0;
        back.acceleration_deg_s2[k] *= -1.0;
    }
    for (const Effect* effect : catalogue()) {
        if (!effect->differs) continue;
        CAPTURE(effect->name);
        ++count;
        CHECK(effect->side == Side::joint);
        CHECK_FALSE(effect->resists);
        const Model model = with({GearRatio(100.0), {}}, *effect, active_values(*effect));
        CHECK(predict_nm(model, forth) == predict_nm(model, back));
    }
    CHECK(count == 1);
}

TEST_CASE("neutral values change nothing, to the last bit") {
    const auto without = measured(base_model());
    for (const Effect* effect : catalogue()) {
        CAPTURE(effect->name);
        CHECK(measured(*effect, neutral_values(*effect)) == without);
    }
}

TEST_CASE("an effect with its first guess, or a larger amplitude, does change something") {
    const auto without = measured(base_model());
    for (const Effect* effect : catalogue()) {
        CAPTURE(effect->name);
        CHECK(measured(*effect, active_values(*effect)) != without);
    }
}

TEST_CASE("an effect does not act on what is not on its side") {
    const Model empty{GearRatio(100.0), {}};
    Motion unknown = rich_motion();
    unknown.known_nm.clear();  // what a simulation knows is a load as well
    for (const Effect* effect : catalogue()) {
        if (effect->name == "simulation-scale") continue;
        CAPTURE(effect->name);
        const auto alone = predict_nm(with(empty, *effect, active_values(*effect)), unknown);
        const bool adds = alone != predict_nm(empty, unknown);
        CHECK(adds == (effect->side == Side::joint && !effect->uses_load));
    }
}

TEST_CASE("finite torque stays finite at random values and at every corner of the bounds") {
    std::mt19937_64 engine(6);
    for (const Effect* effect : catalogue()) {
        CAPTURE(effect->name);
        std::vector<std::vector<double>> trials;
        for (int i = 0; i < 20; ++i) trials.push_back(random_values(*effect, engine));
        for (std::size_t corner = 0; corner < (std::size_t{1} << effect->parameters.size()); ++corner) {
            trials.emplace_back();
            for (std::size_t p = 0; p < effect->parameters.size(); ++p) {
                const Parameter& parameter = effect->parameters[p];
                // The arm of these tests has one other joint.
                const bool is_upper = ((corner >> p) & 1U) != 0 && effect->other_joint != p;
                trials.back().push_back(is_upper ? parameter.upper : parameter.lower);
            }
        }
        for (const auto& values : trials) {
            const auto torque = measured(*effect, values);
            REQUIRE(
                std::all_of(torque.begin(), torque.end(), [](double value) { return std::isfinite(value); }));
        }
    }
}

TEST_CASE("a parameter declared linear changes the torque in proportion, one that is not does not") {
    std::mt19937_64 engine(7);
    for (const Effect* effect : catalogue()) {
        for (std::size_t p = 0; p < effect->parameters.size(); ++p) {
            if (effect->parameters[p].left_out != LeftOut::fitted) continue;
            CAPTURE(effect->name, effect->parameters[p].name);
            double scale = 0.0, error = 0.0;
            for (int trial = 0; trial < 8; ++trial) {
                auto low = random_values(*effect, engine), middle = low, high = low;
                high[p] = random_values(*effect, engine)[p];
                middle[p] = 0.5 * (low[p] + high[p]);
                const auto a = measured(*effect, low), b = measured(*effect, middle),
                           c = measured(*effect, high);
                for (std::size_t k = 0; k < a.size(); ++k) {
                    scale = std::max(scale, std::abs(c[k] - a[k]));
                    error = std::max(error, std::abs(b[k] - 0.5 * (a[k] + c[k])));
                }
            }
            REQUIRE(scale > 0.0);
            if (effect->parameters[p].linear) {
                CHECK(error <= 1e-11 * std::max(scale, 1.0));
            } else {
                CHECK(error > 1e-6 * scale);
            }
        }
    }
}

TEST_CASE("size and phase of a polar effect are the polar form of two linear parameters") {
    std::mt19937_64 engine(11);
    for (const Effect* effect : catalogue()) {
        if (!effect->polar) continue;
        CAPTURE(effect->name);
        auto values = random_values(*effect, engine);
        const auto torque_at = [&](double size, double phase_deg) {
            values[effect->polar->size] = size;
            values[effect->polar->phase] = phase_deg;
            return measured(*effect, values);
        };
        const auto none = torque_at(0.0, 0.0), cosine = torque_at(1.0, 0.0), sine = torque_at(1.0, 90.0),
                   both = torque_at(5.0, 36.86989764584402);  // 4 cosines, 3 sines
        for (std::size_t k = 0; k < none.size(); ++k) {
            const double expected = none[k] + 4.0 * (cosine[k] - none[k]) + 3.0 * (sine[k] - none[k]);
            REQUIRE(both[k] == Approx(expected).margin(1e-11));
        }
    }
}

TEST_CASE("no torque depends on a later sample, but for the interpolation inside the sensor") {
    std::mt19937_64 engine(8);
    const Motion half = first_part(rich_motion(), rich_motion().size() / 2);
    for (const Effect* effect : catalogue()) {
        if (effect->side == Side::sensor) continue;
        CAPTURE(effect->name);
        const Model model = with(base_model(), *effect, random_values(*effect, engine));
        if (side_of(model.terms.back()) == Side::sensor) continue;
        const auto whole = measured(model), first_half = measured(model, half);
        CHECK(std::equal(first_half.begin(), first_half.end(), whole.begin()));
    }
}

TEST_CASE("sensor and converter act on a sum as the sum of their actions where they say so, and only there") {
    std::mt19937_64 engine(9);
    const Motion& motion = rich_motion();
    const Situation situation{.motion = motion, .ratio = GearRatio(100.0)};
    const auto first = predict_nm(base_model(), motion);
    for (const Effect* effect : catalogue()) {
        if (effect->side != Side::sensor && effect->side != Side::converter) continue;
        CAPTURE(effect->name);
        const auto values = active_values(*effect);
        auto a = first, b = noise_nm(), sum = first, none = std::vector<double>(motion.size(), 0.0);
        for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += b[k];
        for (auto* torque : {&a, &b, &sum, &none}) effect->apply(situation, values, *torque);
        for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += none[k] - a[k] - b[k];
        const double error = largest_difference(sum, std::vector<double>(sum.size(), 0.0));
        CHECK((error < 1e-12) == effect->linear_in_torque);
    }
}

TEST_CASE("what is expected holds no chance, and what is chance goes with its seed") {
    for (const Effect* effect : catalogue()) {
        if (!effect->chance) continue;
        CAPTURE(effect->name);
        auto values = active_values(*effect);
        CHECK(predict_nm(with(base_model(), *effect, values), rich_motion()) ==
              predict_nm(base_model(), rich_motion()));
        const auto once = measured(*effect, values);
        CHECK(measured(*effect, values) == once);
        values.back() += 1.0;
        REQUIRE(effect->parameters.back().name == "seed");
        CHECK(measured(*effect, values) != once);
    }
}

TEST_CASE("the page of effects lists the catalogue by its sides") {
    std::ifstream file(fmt::format("{}/docs/effects/README.md", source_folder()));
    std::string page((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
    for (const Effect* effect : catalogue()) {
        CAPTURE(effect->name);
        const std::size_t line = page.find(fmt::format("**{}**: ", side_name(effect->side)));
        REQUIRE(line != std::string::npos);
        CHECK(page.find(fmt::format("`{}`", effect->name), line) < page.find('\n', line));
    }
}

// Each effect against figures worked by hand, or against an independent formula in the C library's functions.

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

TEST_CASE("friction that differs by direction is half the difference either way, and nothing at rest") {
    constexpr std::string_view term = "asymmetric-friction,difference_nm=0.6";
    CHECK(at_speed({term}, 50.0) == Approx(0.3));
    CHECK(at_speed({term}, -50.0) == Approx(0.3));
    CHECK(at_speed({term}, 0.0) == 0.0);
    CHECK(at_speed({term}, -0.2) == Approx(0.3 * std::pow(std::tanh(1.0), 2)));
    // Beside Coulomb friction of 0.5 Nm: 0.8 Nm forth, 0.2 Nm back.
    constexpr std::string_view coulomb = "coulomb-friction,torque_nm=0.5,width_deg_s=0.2";
    CHECK(at_speed({coulomb, term}, 50.0) == Approx(0.8));
    CHECK(at_speed({coulomb, term}, -50.0) == Approx(-0.2));
    CHECK(at_speed({"asymmetric-friction,difference_nm=-0.6"}, 50.0) == Approx(-0.3));
}

TEST_CASE("viscous friction that differs by direction is half the difference times the speed either way") {
    constexpr std::string_view term = "asymmetric-viscous-friction,difference_nm_per_deg_s=0.004";
    CHECK(at_speed({term}, 50.0) == Approx(0.1));
    CHECK(at_speed({term}, -50.0) == Approx(0.1));
    CHECK(at_speed({term}, 0.0) == 0.0);
    // With a coefficient of 0.01: 0.012 Nm/(deg/s) forth, 0.008 Nm/(deg/s) back.
    constexpr std::string_view viscous = "viscous-friction,coefficient_nm_per_deg_s=0.01";
    CHECK(at_speed({viscous, term}, 50.0) == Approx(0.6));
    CHECK(at_speed({viscous, term}, -100.0) == Approx(-0.8));
}

TEST_CASE("friction by position turns with the position and with the direction") {
    // 90 deg/s, one sample a second: 0, 90, 180, 270 deg.
    constexpr std::string_view term = "position-dependent-friction,order=1,amplitude_nm=0.4,phase_deg=0";
    const auto forth = predict_nm(model_of({term}), move({"constant,duration=4s,speed=90"}, 1.0));
    const auto back = predict_nm(model_of({term}), move({"constant,duration=4s,speed=-90"}, 1.0));
    const double expected[] = {0.4, 0.0, -0.4, 0.0};
    for (std::size_t k = 0; k < 4; ++k) {
        CHECK(forth[k] == Approx(expected[k]).margin(1e-12));
        CHECK(back[k] == Approx(-expected[k]).margin(1e-12));
    }
    CHECK(at_speed({"position-dependent-friction,order=2,amplitude_nm=0.4,phase_deg=60"}, -9.0) ==
          Approx(-0.2));
}

TEST_CASE("warm-up leaves 37 % of the change after its time constant, with the sign of the speed") {
    for (const double speed : {30.0, -30.0}) {
        const double sign = speed / 30.0;
        const auto torque = predict_nm(model_of({"friction-warm-up,change_nm=0.8,time_constant_s=4"}),
                                       move({fmt::format("constant,duration=100s,speed={}", speed)}, 10.0));
        CHECK(torque[0] == Approx(sign * 0.8));
        CHECK(torque[40] == Approx(sign * 0.8 / std::numbers::e));
        CHECK(std::abs(torque.back()) < 1e-10);
    }
    CHECK(at_speed({"friction-warm-up,change_nm=-0.8,time_constant_s=4"}, 30.0) == Approx(-0.8));
    CHECK(at_speed({"friction-warm-up,change_nm=0.8,time_constant_s=4"}, 0.0) == 0.0);
}

TEST_CASE("a payload is not there before its time, and an inertia and a weight after it") {
    // 90 deg/s2 from rest: pi / 2 rad/s2; after 4 s the joint is at 720 deg.
    const Motion m = move({"ramp,from-speed=0,to-speed=900deg/s,duration=10s"}, 100.0);
    const auto torque =
        predict_nm(model_of({"payload-change,inertia_kgm2=0.2,cosine_nm=1.5,sine_nm=-0.7,time_s=3"}), m);
    CHECK(std::abs(torque[250]) < 1e-7);
    CHECK(torque[300] == Approx(0.5 * (0.1 * pi + 1.5 * std::cos(2.25 * pi) - 0.7 * std::sin(2.25 * pi))));
    CHECK(torque[400] == Approx(0.1 * pi + 1.5));
    // The same weight as gravity has with a phase: 1.5 cos q - 0.7 sin q.
    const auto gravity =
        predict_nm(model_of({"inertia,inertia_kgm2=0.2",
                             fmt::format("gravity,amplitude_nm={},phase_deg={}", std::hypot(1.5, 0.7),
                                         std::atan2(0.7, 1.5) * 180.0 / pi)}),
                   m);
    for (std::size_t k = 400; k < m.size(); ++k) REQUIRE(torque[k] == Approx(gravity[k]).margin(1e-9));
    // Gear and bearings carry it: half a newton-metre of friction at a weight of 5 Nm.
    const std::string_view friction = "load-friction,torque_nm=0.1,exponent=1",
                           weight = "payload-change,inertia_kgm2=0,cosine_nm=5,sine_nm=0,time_s=0";
    const Motion turning = move({"constant,duration=9s,speed=360"}, 1.0);
    CHECK(predict_nm(model_of({weight, friction}), turning)[5] == Approx(5.5));
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

TEST_CASE("backlash carries nothing in the middle of the play, and all at its ends") {
    const Motion m = move(
        {"constant,speed=10deg/s,duration=10s", "rest,duration=1s", "constant,speed=-10deg/s,duration=10s"},
        100.0);
    const auto torque = predict_nm(model_of({"backlash,torque_nm=0.6,width_deg=4"}), m);
    CHECK(torque[0] == 0.0);
    CHECK(torque[10] == Approx(0.6 * 0.125));  // from the middle half way to the flank: 1 of 2 deg
    CHECK(torque[20] == Approx(0.6));
    CHECK(torque[999] == Approx(0.6));
    CHECK(torque[1050] == Approx(0.6));  // at rest the flank stays in contact
    // 1 deg back: half of the way to the middle; 2 deg: the middle; 4 deg: the other flank.
    CHECK(torque[1110] == Approx(0.6 * 0.125).epsilon(1e-6));
    CHECK(torque[1120] == Approx(0.0).margin(1e-9));
    CHECK(torque[1130] == Approx(-0.6 * 0.125).epsilon(1e-6));
    CHECK(torque[1140] == Approx(-0.6));
    CHECK(torque.back() == Approx(-0.6));
    // Turned round within the play, it goes back the way that it came.
    const auto within = predict_nm(
        model_of({"backlash,torque_nm=0.6,width_deg=4,initial_state=1"}),
        move({"constant,speed=-10deg/s,duration=0.1s", "constant,speed=10deg/s,duration=1s"}, 100.0));
    CHECK(within[10] == Approx(0.6 * 0.125));
    CHECK(within[20] == Approx(0.6));
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

TEST_CASE("ringing starts with an acceleration and turns round at its end, in proportion to its size") {
    const Motion m = move({"rest,duration=1s", "ramp,to-speed=50deg/s,duration=1s",
                           "constant,speed=50deg/s,duration=1s", "ramp,to-speed=-50deg/s,duration=1s"});
    const auto torque = predict_nm(
        model_of({"start-stop-ringing,amplitude_nm=0.5,phase_deg=30,frequency_hz=8,decay_s=0.1"}), m);
    const auto ring = [](double t) {
        return t < 0.0 ? 0.0 : 0.5 * std::exp(-t / 0.1) * std::cos(16.0 * pi * t + pi / 6.0);
    };
    for (std::size_t k = 0; k < m.size(); ++k) {
        const double t = m.time_s[k];
        REQUIRE(torque[k] == Approx(0.5 * ring(t - 1.0) - 0.5 * ring(t - 2.0) - ring(t - 3.0)).margin(1e-12));
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

TEST_CASE(
    "a low-pass of second order answers a line as Butterworth says, and delays a slow torque by sqrt(2) / "
    "w") {
    for (const double speed : {72.0, -72.0, 144.0, 288.0}) {  // order 1 at 20, 40, 80 Hz
        const Motion m = move({fmt::format("constant,duration=2s,speed={}", speed)}, 2000.0);
        const auto torque = predict_nm(
            model_of({"ripple,order=1,amplitude_nm=1,phase_deg=25", "sensor-lowpass,cutoff_hz=40"}), m);
        const std::complex<double> s(0.0, speed / 3.6 / 40.0);
        const auto response = 1.0 / (1.0 + std::sqrt(2.0) * s + s * s);
        CHECK(std::abs(response) == Approx(1.0 / std::sqrt(1.0 + std::pow(speed / 144.0, 4))));
        for (std::size_t k = 1000; k + 10 < m.size(); ++k) {
            const auto turned =
                response * std::polar(1.0, 2.0 * pi * speed / 3.6 * m.time_s[k] + 25.0 * pi / 180.0);
            REQUIRE(torque[k] == Approx(turned.real()).margin(1e-4));
        }
    }
    const auto ramp =
        predict_nm(model_of({"viscous-friction,coefficient_nm_per_deg_s=1", "sensor-lowpass,cutoff_hz=10"}),
                   move({"ramp,to-speed=100deg/s,duration=1s"}));
    CHECK(ramp[900] == Approx(90.0 - 100.0 * std::sqrt(2.0) / (20.0 * pi)).epsilon(1e-6));
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

TEST_CASE(
    "an eccentric encoder turns the ripple on by its error, and speed and acceleration are its derivatives") {
    // Where the log shows 0 deg the joint is at -0.9 deg, a quarter of a cycle of order 1; at 90 deg it is
    // at 90.
    const auto torque = predict_nm(model_of({"ripple,order=1,amplitude_nm=1,phase_deg=90",
                                             "encoder-eccentricity,order=1,amplitude_deg=0.9,phase_deg=0"}),
                                   move({"constant,duration=4s,speed=90"}, 1.0));
    CHECK(torque[0] == Approx(1.0));
    CHECK(torque[1] == Approx(0.0).margin(1e-9));
    CHECK(torque[2] == Approx(-1.0));
    const Motion logged = move({"poly6,from=-50deg,to=170deg,duration=2s"});
    Motion seen = logged;
    GearRatio ratio(100.0);
    find_effect("encoder-eccentricity").change_motion(std::vector{2.0, 0.3, 40.0}, seen, ratio);
    for (std::size_t k = 1; k + 1 < seen.size(); ++k) {
        const double q = logged.position_deg[k];
        REQUIRE(seen.position_deg[k] ==
                Approx(q - 0.3 * std::cos((2.0 * q + 40.0) * pi / 180.0)).margin(1e-9));
        REQUIRE(seen.velocity_deg_s[k] ==
                Approx((seen.position_deg[k + 1] - seen.position_deg[k - 1]) / 0.002).margin(1e-3));
        REQUIRE(seen.acceleration_deg_s2[k] ==
                Approx((seen.velocity_deg_s[k + 1] - seen.velocity_deg_s[k - 1]) / 0.002).margin(2e-2));
    }
}
