// SPDX-License-Identifier: MIT
#include "ripplenotch/model/fit.hpp"

#include <map>
#include <vector>

#include "effects_fixture.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using namespace ripplenotch::fixture;
using Catch::Contains;

namespace {

// Strokes of different speed and length both ways, rests, slow passes: nothing of the catalogue looks like
// anything else.
const Motion& strokes() {
    static const std::vector<std::string> specs = {"rest,duration=0.4s,from=-60deg",
                                                   "poly6,to=150deg,duration=2s",
                                                   "rest,duration=0.4s",
                                                   "poly6,to=-40deg,duration=3.1s",
                                                   "rest,duration=0.4s",
                                                   "constant,speed=4deg/s,duration=2s",
                                                   "poly6,to=200deg,duration=1.7s",
                                                   "constant,speed=-9deg/s,duration=1.5s",
                                                   "poly6,to=-90deg,duration=2.6s",
                                                   "sine,amplitude=40deg,frequency=0.4Hz,duration=5s",
                                                   "rest,duration=0.5s"};
    static const Motion motion = make_motion(specs, Hertz(500.0));
    return motion;
}

std::vector<double> noisy(std::vector<double> torque_nm, double rms, unsigned seed) {
    std::mt19937_64 engine(seed);
    std::normal_distribution<double> noise(0.0, rms);
    for (double& value : torque_nm) value += noise(engine);
    return torque_nm;
}

// The same model with everything left out that a fit can find.
Model opened(Model model) {
    for (Term& term : model.terms) {
        for (std::size_t p = 0; p < term.values.size(); ++p) {
            if (term.effect->parameters[p].left_out == LeftOut::fitted) term.values[p].reset();
        }
    }
    return model;
}

double turned_to(double value, double near, std::string_view unit) {
    return unit == "deg" ? near + std::remainder(value - near, 360.0) : value;
}

// A value away from the first guess, by what a screening of the log would leave.
std::vector<double> planted_values(const Effect& effect) {
    static const std::map<std::string_view, double> special = {{"ripple-speed-dependence.exponent", 1.3},
                                                               {"gear-ratio.error_percent", 0.05},
                                                               {"tone.frequency_hz", 50.01},
                                                               {"velocity-bias.bias_deg_s", 0.02},
                                                               {"drift.time_constant_s", 8.0},
                                                               {"drift.rate_nm_s", 0.1},
                                                               {"payload-change.time_s", 1.03},
                                                               {"saturation.limit_nm", 2.2}};
    std::vector<double> values;
    for (const Parameter& p : effect.parameters) {
        const auto found = special.find(std::string(effect.name) + "." + std::string(p.name));
        if (found != special.end()) {
            values.push_back(found->second);
        } else if (p.left_out != LeftOut::fitted) {
            values.push_back(p.start);
        } else if (p.unit == "deg" && effect.polar) {
            values.push_back(70.0);
        } else {
            values.push_back(p.start == 0.0 ? std::min(20.0, 0.3 * p.upper) : 1.25 * p.start);
        }
    }
    if (effect.name == "offset") values = {0.4};
    return values;
}

}  // namespace

TEST_CASE("each effect planted in a log is found again with its values, within its interval's reach") {
    Motion moved = strokes();
    // What a simulation knows of the joint.
    for (const double t : moved.time_s) moved.known_nm.push_back(2.0 * portable::sin_degrees(210.0 * t));
    for (const Effect* effect : catalogue()) {
        if (effect->chance || effect->name == "quantization") continue;  // steps and chance have no slope
        if (effect->other_joint) continue;  // its ratio has several valleys, which a search tries
        CAPTURE(effect->name);
        Model truth = base_model();
        if (effect->name == "inertia" || effect->name == "gravity")
            truth.terms.erase(truth.terms.begin(), truth.terms.begin() + 2);
        auto values = planted_values(*effect);
        if (effect->ripple_order) values[*effect->ripple_order] = 3.0;
        truth.terms.push_back({effect, {values.begin(), values.end()}});
        if (effect->name == "gear-ratio") truth.terms.back().values[0] = 0.05;
        const auto torque_nm = noisy(predict_nm(truth, moved), 0.02, 17);
        const Fit found = fit(opened(truth), moved, torque_nm);
        CHECK(found.converged);
        CHECK(found.residual_rms_nm == Approx(0.02).epsilon(0.03));
        for (const FittedValue& value : found.values) {
            const Parameter& parameter = truth.terms[value.term].effect->parameters[value.parameter];
            const double expected = *truth.terms[value.term].values[value.parameter];
            CAPTURE(truth.terms[value.term].effect->name, parameter.name, value.value, expected);
            REQUIRE(value.standard_error.has_value());
            const double off = std::abs(turned_to(value.value, expected, parameter.unit) - expected);
            // Four standard errors; and the errors are small enough to be of use.
            CHECK(off < 4.0 * *value.standard_error + 1e-6 * std::abs(expected));
            CHECK(*value.standard_error <
                  0.2 * std::max(std::abs(expected), parameter.unit == "deg" ? 90.0 : 0.0));
        }
    }
}

TEST_CASE("95 of 100 intervals hold the truth") {
    Model truth = base_model();
    for (const auto term : {"viscous-friction,coefficient_nm_per_deg_s=0.004", "delay,delay_s=3ms",
                            "stribeck-friction,torque_nm=0.6,stribeck_speed_deg_s=12"}) {
        truth.terms.push_back(parse_term(term));
    }
    const Motion motion = first_part(strokes(), 4200);
    const auto clean = predict_nm(truth, motion);
    const Model open = opened(truth);
    int held = 0, all = 0;
    for (unsigned seed = 0; seed < 60; ++seed) {
        const Fit found = fit(open, motion, noisy(clean, 0.06, 100 + seed));
        for (const FittedValue& value : found.values) {
            const Parameter& parameter = truth.terms[value.term].effect->parameters[value.parameter];
            const double expected = *truth.terms[value.term].values[value.parameter];
            const double shift = turned_to(value.value, expected, parameter.unit) - value.value;
            REQUIRE(value.ci95.has_value());
            held += value.ci95->low + shift <= expected && expected <= value.ci95->high + shift;
            ++all;
        }
    }
    // 660 intervals; values of one log share its noise, so that their number counts for less.
    CHECK(all == 660);
    const double share = static_cast<double>(held) / all;
    CAPTURE(share);
    CHECK(share > 0.92);
    CHECK(share < 0.98);
}

TEST_CASE("errors that look at each stretch hold the truth under coloured noise, where white ones do not") {
    Model truth{GearRatio(100.0),
                {parse_term("offset,torque_nm=0.3"), parse_term("inertia,inertia_kgm2=0.5")}};
    const Motion motion = first_part(strokes(), 3000);
    const auto clean = predict_nm(truth, motion);
    int held_as_white = 0, held_by_stretch = 0;
    for (unsigned seed = 0; seed < 100; ++seed) {
        auto torque_nm =
            noisy(std::vector<double>(motion.size(), 0.0), 0.06 * std::sqrt(1.0 - 0.81), 300 + seed);
        for (std::size_t k = 1; k < torque_nm.size(); ++k) torque_nm[k] += 0.9 * torque_nm[k - 1];
        for (std::size_t k = 0; k < torque_nm.size(); ++k) torque_nm[k] += clean[k];
        const auto holds = [](const Fit& found) {
            return found.values[0].ci95->low <= 0.3 && 0.3 <= found.values[0].ci95->high;
        };
        held_as_white += holds(fit(opened(truth), motion, torque_nm));
        held_by_stretch += holds(fit(opened(truth), motion, torque_nm, {.error_stretch = 100}));
    }
    CHECK(held_as_white < 60);
    CHECK(held_by_stretch >= 88);
}

TEST_CASE(
    "errors that look at each stretch widen an interval where the model lacks something, and never narrow "
    "it") {
    Model truth{GearRatio(100.0),
                {parse_term("offset,torque_nm=0.3"), parse_term("inertia,inertia_kgm2=0.5")}};
    const Motion motion = first_part(strokes(), 3000);
    const auto clean = predict_nm(truth, motion);
    const auto errors_of = [&](const std::vector<double>& torque_nm, std::size_t stretch) {
        const Fit found = fit(opened(truth), motion, torque_nm, {.error_stretch = stretch});
        return std::pair(*found.values[0].standard_error, *found.values[1].standard_error);
    };
    for (unsigned seed = 0; seed < 20; ++seed) {
        const auto torque_nm = noisy(clean, 0.06, 700 + seed);
        const auto white = errors_of(torque_nm, 0), robust = errors_of(torque_nm, 100);
        CHECK(robust.first >= white.first);
        CHECK(robust.second >= white.second);
        // 30 stretches tell a standard deviation within 13 %.
        CHECK(robust.first < 1.5 * white.first);
        // 0.05 Nm too much or too little in each half second: 6 of them, a mean that is off by
        // 0.05 / sqrt(6) = 0.02 Nm, where white noise lets expect 0.001.
        auto lacking = torque_nm;
        for (std::size_t k = 0; k < lacking.size(); ++k) lacking[k] += k / 250 % 2 == 0 ? 0.05 : -0.05;
        CHECK(errors_of(lacking, 250).first > 5.0 * errors_of(lacking, 0).first);
    }
}

TEST_CASE("samples left out do not count, whatever they hold") {
    const Model truth{GearRatio(100.0),
                      {parse_term("offset,torque_nm=0.3"), parse_term("inertia,inertia_kgm2=0.5")}};
    auto torque_nm = predict_nm(truth, strokes());
    std::vector<unsigned char> use(torque_nm.size(), 1);
    for (std::size_t k = 5; k < torque_nm.size(); k += 7) {
        torque_nm[k] += 1000.0;
        use[k] = 0;
    }
    const Fit found = fit(opened(truth), strokes(), torque_nm, {.use = use});
    CHECK(found.samples == static_cast<std::size_t>(std::count(use.begin(), use.end(), 1)));
    CHECK(found.values[0].value == Approx(0.3).epsilon(1e-9));
    CHECK(found.values[1].value == Approx(0.5).epsilon(1e-9));
}

TEST_CASE("what a log does not tell has a value and no interval") {
    // One speed, one direction, no rest: offset and Coulomb friction are the same column.
    const Motion motion = make_motion("constant,speed=30deg/s,duration=2s", Hertz(500.0));
    const Model open{
        GearRatio(100.0),
        {parse_term("offset"), parse_term("coulomb-friction,width_deg_s=0.2"), parse_term("ripple,order=1")}};
    Model truth = open;
    truth.terms[0].values[0] = 0.2;
    truth.terms[1].values[0] = 0.5;
    truth.terms[2] = parse_term("ripple,order=1,amplitude_nm=0.5,phase_deg=40");
    const Fit found = fit(open, motion, noisy(predict_nm(truth, motion), 0.05, 3));
    REQUIRE(found.values.size() == 4);
    CHECK_FALSE(found.values[0].standard_error.has_value());
    CHECK_FALSE(found.values[1].ci95.has_value());
    CHECK(found.values[0].value + found.values[1].value == Approx(0.7).margin(0.01));
    CHECK(found.values[2].standard_error.has_value());
    CHECK(found.values[2].value == Approx(0.5).margin(0.02));
}

TEST_CASE("a value stays within its bounds and says when it lies on one") {
    Model truth{GearRatio(100.0),
                {parse_term("offset,torque_nm=0.3"), parse_term("inertia,inertia_kgm2=0.5")}};
    auto torque_nm = predict_nm(truth, strokes());
    for (double& value : torque_nm) value = 0.6 - value;  // an inertia of -0.5, which none can have
    const Fit found = fit(opened(truth), strokes(), torque_nm);
    CHECK(found.values[1].value == 0.0);
    CHECK(found.values[1].at_bound);
    CHECK_FALSE(found.values[1].ci95.has_value());
    CHECK_FALSE(found.values[0].at_bound);
}

TEST_CASE("a first guess takes a fit to the minimum nearby") {
    Model truth = base_model();
    truth.terms.push_back(parse_term("gear-ratio,error_percent=-20"));
    const auto torque_nm = noisy(predict_nm(truth, strokes()), 0.02, 5);
    Model guess = opened(truth);
    guess.terms.back().values[0] = -20.05;
    const Fit far = fit(opened(truth), strokes(), torque_nm);
    CHECK(far.residual_rms_nm > 0.3);
    const Fit near = fit(opened(truth), strokes(), torque_nm, {.first_guess = &guess});
    CHECK(near.residual_rms_nm == Approx(0.02).epsilon(0.03));
    CHECK(near.values.back().value == Approx(-20.0).margin(0.001));
}

TEST_CASE("a fit refuses what it does not search for, and a log that is too short") {
    const Model no_order{GearRatio(100.0), {parse_term("offset"), parse_term("ripple")}};
    const std::vector<double> torque_nm(strokes().size(), 0.0);
    CHECK_THROWS_WITH(fit(no_order, strokes(), torque_nm), Contains("effects[1].order of ripple"));
    const Motion shortest_motion = first_part(strokes(), 3);
    CHECK_THROWS_WITH(fit(opened(base_model()), shortest_motion, std::vector<double>(3, 0.0)),
                      Contains("3 samples"));
}

TEST_CASE("a torque beyond the bound of a linear value leaves that at its bound") {
    const Effect& friction = find_effect("coulomb-friction");
    const double upper = friction.parameters[0].upper;
    std::vector<double> torque_nm =
        predict_nm({GearRatio(100.0), {{&friction, {0.5 * upper, 0.2}}}}, strokes());
    for (double& value : torque_nm) value *= 4.0;
    const Fit found = fit({GearRatio(100.0), {{&friction, {std::nullopt, 0.2}}}}, strokes(), torque_nm, {});
    CHECK(found.model.terms[0].values[0] == upper);
}
