// SPDX-License-Identifier: MIT
// What went wrong once, in this tool or in the trials before it, each with a log that shows it.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "diagnose_fixture.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using namespace ripplenotch::fixture;

namespace {

using Names = std::vector<std::string>;

Trace log_with(std::string_view hidden, std::uint64_t seed) {
    Model truth = joint();
    if (!hidden.empty()) truth.terms.push_back(parse_term(hidden));
    return logged(truth, tour(), seed);
}

Diagnosis diagnosed(const Trace& log) { return diagnose(opened(joint()), log.view(), nullptr); }

}  // namespace

TEST_CASE("the position that a noisy speed integrates to walks, and that is no bias of the speed") {
    Trace log = log_with("", 41);
    log.position_deg.clear();
    const Diagnosis found = diagnosed(log);
    CHECK(found.named.empty());
    CHECK(found.verdict == DiagnosisVerdict::matches);
}

TEST_CASE("a gear ratio that is hardly off and one that is quite another are both gear ratios",
          "[!shouldfail]") {
    for (const double ratio : {100.02, 80.0}) {
        Model truth = joint();
        truth.gear_ratio = GearRatio(ratio);
        const Diagnosis found = diagnosed(logged(truth, tour(), 42));
        CAPTURE(ratio);
        CHECK(found.named == Names{"gear-ratio"});
    }
}

TEST_CASE("modulation twice a turn is no ripple of another order, and keeps its order") {
    const Diagnosis found =
        diagnosed(log_with("ripple-modulation,output_order=2,depth_percent=50,phase_deg=40", 43));
    REQUIRE(found.named == Names{"ripple-modulation"});
    CHECK(*found.rounds[0].term.values[0] == 2.0);
}

TEST_CASE("a bump at one position is unexplained there and names nothing") {
    Trace log = log_with("", 44);
    for (std::size_t k = 0; k < log.size(); ++k)
        log.torque_nm[k] += 0.5 * std::exp(-std::pow((log.position_deg[k] - 60.0) / 8.0, 2));
    const Diagnosis found = diagnosed(log);
    CHECK(found.named.empty());
    CHECK(found.verdict == DiagnosisVerdict::unexplained);
    REQUIRE(found.remaining);
    CHECK(found.remaining->kind == RegionKind::position);
    CHECK(found.remaining->where.from < 60.0);
    CHECK(found.remaining->where.to > 60.0);
}

TEST_CASE("noise with a memory is nothing that is missing") {
    for (std::uint64_t seed = 46; seed < 49; ++seed) {
        Trace log = log_with("", seed);
        Noise noise(seed, NoiseChannel::torque);
        double before = 0.0;
        for (double& torque : log.torque_nm) torque += before = 0.5 * before + 0.05 * noise.normal();
        const Diagnosis found = diagnosed(log);
        CAPTURE(seed);
        CHECK(found.named.empty());
        CHECK(found.verdict == DiagnosisVerdict::matches);
    }
}

TEST_CASE("a strong tone is a name and does not raise the noise floor") {
    const Diagnosis found = diagnosed(log_with("tone,frequency_hz=50,amplitude_nm=0.6,phase_deg=0", 49));
    CHECK(found.named == Names{"tone"});
    CHECK(found.gap.noise_floor_nm == Approx(noise_nm).epsilon(0.15));
}

TEST_CASE("ripple that grows with the root or the square of the speed has one name") {
    for (const auto hidden : {"ripple-speed-dependence,gain_percent=60,exponent=0.5",
                              "ripple-speed-dependence,gain_percent=40,exponent=2"}) {
        CAPTURE(hidden);
        CHECK(diagnosed(log_with(hidden, 50)).named == Names{"ripple-speed-dependence"});
    }
}

TEST_CASE("a touch many times the noise is no match") {
    Trace log = log_with("", 55);
    for (std::size_t k = 0; k < log.size(); ++k) {
        const double share = (log.time_s[k] - 9.0) / 1.2;
        if (share > 0.0 && share < 1.0) log.torque_nm[k] += 0.6 * std::sin(std::numbers::pi * share);
    }
    const Diagnosis found = diagnosed(log);
    CHECK(found.named.empty());
    CHECK(found.verdict == DiagnosisVerdict::unexplained);
}

TEST_CASE("on one stroke in one direction no two findings cancel each other") {
    // Offset, friction, drift and gravity are nearly one column there: tens of newton-metres could be given
    // to one and taken by another.
    const std::vector<std::string> specs = {"rest,duration=0.5s,from=-50deg", "poly6,to=60deg,duration=8s",
                                            "rest,duration=0.5s"};
    const Motion motion = make_motion(specs, Hertz(500.0));
    Model truth = joint();
    truth.terms.push_back(parse_term("coulomb-friction,torque_nm=0.5,width_deg_s=0.3"));
    truth.terms.push_back(parse_term("viscous-friction,coefficient_nm_per_deg_s=0.01"));
    const Trace log = logged(truth, motion, 46);
    const Diagnosis found = diagnosed(log);
    double largest_nm = 0.0;
    for (const double torque : log.torque_nm) largest_nm = std::max(largest_nm, std::abs(torque));
    for (const Finding& finding : found.rounds) {
        const Parameter* const parameters = finding.term.effect->parameters.data();
        for (std::size_t p = 0; p < finding.term.values.size(); ++p) {
            if (parameters[p].unit != "Nm" || !finding.term.values[p]) continue;
            CAPTURE(finding.term.effect->name, parameters[p].name, *finding.term.values[p]);
            CHECK(std::abs(*finding.term.values[p]) < 2.0 * largest_nm);
        }
    }
}

TEST_CASE("modulation seen over half a turn is no ripple of orders beside") {
    const std::vector<std::string> specs = {"rest,duration=0.5s,from=0deg", "poly6,to=170deg,duration=2.5s",
                                            "rest,duration=0.5s",           "poly6,to=10deg,duration=4s",
                                            "rest,duration=0.5s",           "poly6,to=160deg,duration=6s",
                                            "rest,duration=0.5s",           "poly6,to=0deg,duration=3s"};
    Model truth = joint();
    truth.terms.push_back(parse_term("ripple-modulation,output_order=1,depth_percent=50,phase_deg=20"));
    const Diagnosis found = diagnosed(logged(truth, make_motion(specs, Hertz(500.0)), 47));
    // On half a turn it may look like another ratio or another order of modulation; lines of their own it has
    // not.
    for (const std::string& name : found.named) CHECK((name == "ripple-modulation" || name == "gear-ratio"));
    CHECK(found.verdict != DiagnosisVerdict::matches);
    CHECK(std::none_of(found.rounds.begin(), found.rounds.end(), [](const Finding& finding) {
        return finding.status == FindingStatus::confirmed && finding.term.effect->name == "ripple";
    }));
}
