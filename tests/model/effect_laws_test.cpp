// SPDX-License-Identifier: MIT
// Laws that hold for every effect of the catalogue: an effect is under test on the day it is listed.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <random>
#include <regex>
#include <set>
#include <sstream>

#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/model/motion.hpp"

using namespace ripplenotch;
using namespace ripplenotch::literals;
using Catch::Matchers::Contains;

namespace {

constexpr GearRatio ratio{100.0};

// Rest, both directions, slow and fast, reversal: something for every effect to act on.
const Motion& rich_motion() {
    static const std::vector<std::string> specs = {
        "rest,duration=0.3s,from=20deg", "poly6,to=-70deg,duration=1s", "rest,duration=0.2s",
        "ramp,to-speed=100deg/s,duration=0.5s",
        "sine,amplitude=30deg,frequency=0.8Hz,duration=1.5s,phase=0deg"};
    static const Motion motion = make_motion(specs, 500_Hz);
    return motion;
}

std::vector<double> neutral_values(const Effect& effect) {
    std::vector<double> values;
    for (const Parameter& parameter : effect.parameters) values.push_back(parameter.neutral);
    return values;
}

// Within the bounds, and within a factor of ten of the first guess: where fits take place.
std::vector<double> random_values(const Effect& effect, std::mt19937_64& engine) {
    std::vector<double> values;
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    for (const Parameter& parameter : effect.parameters) {
        const double reach = 10.0 * std::max(std::abs(parameter.start), 1e-2);
        const double low = std::max(parameter.lower, -reach), high = std::min(parameter.upper, reach);
        values.push_back(low + (high - low) * unit(engine));
    }
    return values;
}

std::vector<double> some_torque(std::size_t count) {
    std::mt19937_64 engine(5);
    std::uniform_real_distribution<double> torque(-3.0, 3.0);
    std::vector<double> values(count);
    for (double& value : values) value = torque(engine);
    return values;
}

std::vector<double> applied(const Effect& effect, const std::vector<double>& values,
                            std::vector<double> torque_nm) {
    effect.apply(rich_motion(), ratio, values, torque_nm);
    return torque_nm;
}

std::string page_of(const Effect& effect) {
    std::ifstream file(fmt::format("{}/docs/effects/{}.md", RIPPLENOTCH_SOURCE_DIR, effect.name));
    std::stringstream text;
    text << file.rdbuf();
    return text.str();
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
        for (const auto text :
             {effect->summary, effect->equation, effect->symptom, effect->look_alikes, effect->source}) {
            CHECK(!text.empty());
        }
        CHECK(!effect->parameters.empty());
        CHECK(effect->apply != nullptr);
    }
    CHECK(seen.size() >= 6);
    CHECK_THROWS_WITH(find_effect("rippel"),
                      Contains("did you mean ripple?") && Contains("coulomb-friction"));
}

TEST_CASE(
    "parameters have unique names that end in their unit, and bounds around neutral value and first guess") {
    const std::regex ends_in_unit(".*_(nm|deg|deg_s|kgm2|hz|s|ms|percent|nm_per_deg_s|nm_s)");
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
            CHECK(allows(parameter, parameter.neutral));
            CHECK(allows(parameter, parameter.start));
            CHECK(allows(parameter, parameter.lower));
            CHECK(allows(parameter, parameter.upper));
            CHECK_FALSE(allows(parameter, std::nextafter(parameter.upper, INFINITY)));
            CHECK_FALSE(allows(parameter, std::nan("")));
        }
    }
}

TEST_CASE("neutral values change nothing, to the last bit") {
    const auto torque = some_torque(rich_motion().size());
    for (const Effect* effect : catalogue()) {
        CAPTURE(effect->name);
        CHECK(applied(*effect, neutral_values(*effect), torque) == torque);
    }
}

TEST_CASE("an effect with its first guess, or a larger amplitude, does change something") {
    const auto torque = some_torque(rich_motion().size());
    for (const Effect* effect : catalogue()) {
        CAPTURE(effect->name);
        std::vector<double> values;
        for (const Parameter& p : effect->parameters)
            values.push_back(p.start == p.neutral && p.linear ? p.neutral + 1.0 : p.start);
        CHECK(applied(*effect, values, torque) != torque);
    }
}

TEST_CASE("finite torque stays finite at random values and at every corner of the bounds") {
    std::mt19937_64 engine(6);
    const auto torque = some_torque(rich_motion().size());
    for (const Effect* effect : catalogue()) {
        CAPTURE(effect->name);
        std::vector<std::vector<double>> trials;
        for (int i = 0; i < 20; ++i) trials.push_back(random_values(*effect, engine));
        for (std::size_t corner = 0; corner < (std::size_t{1} << effect->parameters.size()); ++corner) {
            trials.emplace_back();
            for (std::size_t p = 0; p < effect->parameters.size(); ++p) {
                const Parameter& parameter = effect->parameters[p];
                trials.back().push_back((corner >> p) & 1U ? parameter.upper : parameter.lower);
            }
        }
        for (const auto& values : trials) {
            for (const double value : applied(*effect, values, torque)) REQUIRE(std::isfinite(value));
        }
    }
}

TEST_CASE("a parameter declared linear changes the torque in proportion, one that is not does not") {
    std::mt19937_64 engine(7);
    const std::vector<double> zero(rich_motion().size(), 0.0);
    for (const Effect* effect : catalogue()) {
        for (std::size_t p = 0; p < effect->parameters.size(); ++p) {
            CAPTURE(effect->name, effect->parameters[p].name);
            double scale = 0.0, error = 0.0;
            for (int trial = 0; trial < 5; ++trial) {
                auto low = random_values(*effect, engine), middle = low, high = low;
                high[p] = random_values(*effect, engine)[p];
                middle[p] = 0.5 * (low[p] + high[p]);
                const auto a = applied(*effect, low, zero), b = applied(*effect, middle, zero),
                           c = applied(*effect, high, zero);
                for (std::size_t k = 0; k < zero.size(); ++k) {
                    scale = std::max(scale, std::abs(c[k] - a[k]));
                    error = std::max(error, std::abs(b[k] - 0.5 * (a[k] + c[k])));
                }
            }
            if (effect->parameters[p].linear) {
                CHECK(error <= 1e-12 * scale);
            } else {
                CHECK(error > 1e-6 * scale);
            }
        }
    }
}

TEST_CASE(
    "a joint effect adds the same torque whatever is there already, and each sample depends on no later "
    "one") {
    std::mt19937_64 engine(8);
    const auto torque = some_torque(rich_motion().size());
    const std::vector<double> zero(torque.size(), 0.0);
    for (const Effect* effect : catalogue()) {
        if (effect->side != Side::joint) continue;
        CAPTURE(effect->name);
        const auto values = random_values(*effect, engine);
        const auto alone = applied(*effect, values, zero), on_top = applied(*effect, values, torque);
        for (std::size_t k = 0; k < zero.size(); ++k)
            REQUIRE(on_top[k] - torque[k] == Approx(alone[k]).margin(1e-11));
        Motion half = rich_motion();
        for (auto* column :
             {&half.time_s, &half.position_deg, &half.velocity_deg_s, &half.acceleration_deg_s2}) {
            column->resize(zero.size() / 2);
        }
        std::vector<double> first_half(half.size(), 0.0);
        effect->apply(half, ratio, values, first_half);
        CHECK(std::equal(first_half.begin(), first_half.end(), alone.begin()));
    }
}

TEST_CASE("every effect has a page that agrees with its record") {
    for (const Effect* effect : catalogue()) {
        CAPTURE(effect->name);
        const std::string page = page_of(*effect);
        REQUIRE(!page.empty());
        for (const auto text :
             {effect->summary, effect->equation, effect->symptom, effect->look_alikes, effect->source}) {
            CHECK_THAT(page, Contains(std::string(text)));
        }
        for (const Parameter& p : effect->parameters) {
            CHECK_THAT(page, Contains(fmt::format("| `{}` | {} | {} | {} | {} to {} | {} | {} |", p.name,
                                                  p.unit.empty() ? "-" : p.unit, shortest(p.neutral),
                                                  shortest(p.start), shortest(p.lower), shortest(p.upper),
                                                  p.linear ? "yes" : "no", p.help)));
        }
    }
}
