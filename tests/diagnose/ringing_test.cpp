// SPDX-License-Identifier: MIT
// Beside an arm: ripple of which a part has passed the elastic joint, and a friction that bends another's
// curve.

#include <algorithm>

#include "diagnose/beside/weighing/shapes.hpp"
#include "diagnose_fixture.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "support/catch.hpp"

namespace ripplenotch {
namespace {

using fixture::model_of;
using fixture::strokes;

// Weight of the arm along and across.
std::vector<GivenTerm> hanging_arm() {
    GivenTerm term{"arm", {{}, {}}, {0.0, 0.0}, {100.0, 100.0}};
    for (std::size_t k = 0; k < strokes().size(); ++k) {
        const double angle_deg =
            strokes().position_deg[k] + 40.0 * portable::sin_degrees(360.0 * 0.13 * strokes().time_s[k]);
        term.torque_nm[0].push_back(portable::cos_degrees(angle_deg));
        term.torque_nm[1].push_back(portable::sin_degrees(angle_deg));
    }
    return {term};
}

Diagnosis diagnosed(std::initializer_list<const char*> hidden, std::uint64_t seed,
                    std::vector<std::string> without = {}) {
    Trace log = fixture::logged(model_of(hidden), strokes(), seed);
    const auto given = hanging_arm();
    for (std::size_t k = 0; k < log.torque_nm.size(); ++k)
        log.torque_nm[k] += 12.0 * given[0].torque_nm[0][k] + 3.0 * given[0].torque_nm[1][k];
    return diagnose(Model{GearRatio(100.0), {}}, log.view(), nullptr,
                    {.without = std::move(without), .given = given});
}

std::vector<const Finding*> findings_of(const Diagnosis& found, std::string_view effect) {
    std::vector<const Finding*> findings;
    for (const Finding& finding : found.rounds) {
        if (finding.term.effect->name == effect) findings.push_back(&finding);
    }
    return findings;
}

std::string values_told(const Diagnosis& found) {
    std::string text;
    for (const Finding& finding : found.rounds) {
        text += std::string(finding.term.effect->name) + " " + std::string(status_name(finding.status));
        for (const FittedValue& value : finding.values) {
            text += " " + std::string(finding.term.effect->parameters[value.parameter].name) + " " +
                    std::to_string(value.value);
            if (value.ci95)
                text +=
                    " [" + std::to_string(value.ci95->low) + ", " + std::to_string(value.ci95->high) + "]";
        }
        text += "\n";
    }
    return text;
}

double value_of(const Finding& finding, std::string_view name) {
    for (const FittedValue& value : finding.values) {
        if (finding.term.effect->parameters[value.parameter].name == name) return value.value;
    }
    return 0.0;
}

constexpr const char* passing = "ripple,order=2,amplitude_nm=0.4,phase_deg=70";

}  // namespace

TEST_CASE("an error of the gear's angle makes no ripple at standstill and H - 1 of it at speed") {
    const Effect& resonance = find_effect("resonance");
    const std::vector<double> values{30.0, 0.25, 1.0, 180.0, 2.0, 0.0};  // as many as parameters
    // Order 2 of a gear of 100 at 0, half and all of 30 Hz, forth and back: each for some samples, settled.
    std::vector<std::complex<double>> gain;
    Motion motion;
    for (const double hz : {0.0, 15.0, 30.0, -30.0}) {
        motion = {Hertz(1000.0), {0.0, 0.001, 0.002}, {}, {}, {}};
        for (auto* column : {&motion.position_deg, &motion.acceleration_deg_s2}) column->assign(3, 0.0);
        motion.velocity_deg_s.assign(3, hz * 360.0 / 200.0);
        std::vector<std::complex<double>> steady(3, 1.0);
        resonance.change_ripple({motion, GearRatio(100.0)}, Order(2.0), values, steady);
        gain.push_back(steady.back());
    }
    CHECK(std::abs(gain[0]) < 1e-15);
    // u = 1/2: 1 / (3/4 + i/4) - 1 = (3/4 - i/4) * 16 / 10 - 1 = 1/5 - 2i/5
    CHECK(std::abs(gain[1] - std::complex<double>(0.2, -0.4)) < 1e-15);
    // u = 1: 1 / (i/2) - 1 = -1 - 2i; back in the other direction its conjugate.
    CHECK(std::abs(gain[2] - std::complex<double>(-1.0, -2.0)) < 1e-14);
    CHECK(std::abs(gain[3] - std::conj(gain[2])) < 1e-14);
    // Another order is left alone.
    std::vector<std::complex<double>> other(3, 1.0);
    resonance.change_ripple({motion, GearRatio(100.0)}, Order(1.0), values, other);
    CHECK(other == std::vector<std::complex<double>>(3, 1.0));
}

TEST_CASE("beside an arm ripple of which a part rings is named with its resonance") {
    const Diagnosis found = diagnosed(
        {passing, "resonance,frequency_hz=24,damping=0.2,direct=0.6,direct_phase_deg=150,order=2"}, 31);
    INFO(values_told(found));
    CHECK(found.named == std::vector<std::string>{"ripple", "resonance"});
    const auto ripples = findings_of(found, "ripple"), rings = findings_of(found, "resonance");
    REQUIRE((ripples.size() == 1 && rings.size() == 1));
    // 0.06 Nm of white noise over 20,000 samples and more: sizes to a few parts in a hundred.
    CHECK(value_of(*ripples[0], "order") == 0.0);  // stated, not fitted
    CHECK(*ripples[0]->term.values[0] == 2.0);
    CHECK(value_of(*ripples[0], "amplitude_nm") == Approx(0.4).epsilon(0.05));
    CHECK(value_of(*rings[0], "frequency_hz") == Approx(24.0).epsilon(0.02));
    CHECK(value_of(*rings[0], "damping") == Approx(0.2).epsilon(0.05));
    CHECK(value_of(*rings[0], "direct") == Approx(0.6).epsilon(0.08));
    CHECK(found.gap.after_nm < 1.05 * found.gap.noise_floor_nm);
    // The gap of the ripple is told with what rings in it, and closes once.
    CHECK(ripples[0]->gap_after_nm < 0.5 * ripples[0]->gap_before_nm);
    CHECK(rings[0]->gap_before_nm == rings[0]->gap_after_nm);
}

TEST_CASE("a broad turn of the ripple with the speed is no resonance, and the gap closes all the same") {
    const Diagnosis found = diagnosed({passing, "resonance,frequency_hz=30,damping=0.9,order=2"}, 32);
    INFO(values_told(found));
    CHECK(found.named == std::vector<std::string>{"ripple"});
    const auto rings = findings_of(found, "resonance");
    REQUIRE(rings.size() == 1);
    CHECK(rings[0]->status == FindingStatus::shape_correction);
    CHECK(found.gap.after_nm < 1.05 * found.gap.noise_floor_nm);
}

TEST_CASE("ripple that keeps its size has nothing that rings") {
    for (const std::uint64_t seed : {33U, 34U, 35U}) {
        const Diagnosis found = diagnosed({passing}, seed);
        INFO(values_told(found));
        CHECK(found.named == std::vector<std::string>{"ripple"});
        CHECK(findings_of(found, "resonance").empty());
    }
}

TEST_CASE("without resonance in the list ripple is named as far as one line goes") {
    const Diagnosis found =
        diagnosed({passing, "resonance,frequency_hz=60,damping=0.3,order=2"}, 36, {"resonance"});
    INFO(values_told(found));
    CHECK(findings_of(found, "resonance").empty());
    CHECK(std::count(found.named.begin(), found.named.end(), "ripple") == 1);
}

TEST_CASE("what passes the joint no faster than the errors of its masses rings in nothing") {
    const ScaleBounds bounds{130.0, 20.0, 100.0, DiagnosisRules{}.beside};
    REQUIRE(bounds.rules.least_ringing_hz == 4.0);
    const auto is_bent = [&](const char* ringing) {
        return bounds.is_ringing_bent({parse_term(passing), parse_term(ringing)});
    };
    // Half of the power passes at 1.51, 1.02 and 0.60 of the frequency: 7.6, 5.1 and 3.0 Hz.
    CHECK_FALSE(is_bent("resonance,frequency_hz=5,damping=0.2,order=2"));
    CHECK_FALSE(is_bent("resonance,frequency_hz=5,damping=0.69,order=2"));
    CHECK(is_bent("resonance,frequency_hz=5,damping=1.06,order=2"));
    CHECK_FALSE(is_bent("resonance,frequency_hz=12,damping=1.06,order=2"));
    CHECK(is_bent("resonance,frequency_hz=4.5,damping=0.2,order=2"));
}

TEST_CASE("quadratic friction that drives the joint bends the viscous friction, and is no name") {
    const Diagnosis found = diagnosed({"viscous-friction,coefficient_nm_per_deg_s=0.02",
                                       "quadratic-viscous-friction,coefficient_nm_per_deg2_s2=-6e-5"},
                                      37);
    INFO(values_told(found));
    CHECK(found.named == std::vector<std::string>{"viscous-friction"});
    const auto bending = findings_of(found, "quadratic-viscous-friction");
    REQUIRE(bending.size() == 1);
    CHECK(bending[0]->status == FindingStatus::shape_correction);
    CHECK(value_of(*bending[0], "coefficient_nm_per_deg2_s2") == Approx(-6e-5).epsilon(0.05));
    CHECK(found.gap.after_nm < 1.05 * found.gap.noise_floor_nm);
}

}  // namespace ripplenotch
