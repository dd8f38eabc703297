// SPDX-License-Identifier: MIT
// Laws that hold for every effect of the catalogue: an effect is under test on the day it is listed.
#include <fmt/format.h>

#include <fstream>
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
