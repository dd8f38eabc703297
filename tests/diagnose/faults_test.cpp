// SPDX-License-Identifier: MIT
// Faults of the converter, each with what can be taken for it.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "diagnose/answer/answer.hpp"
#include "diagnose_fixture.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using namespace ripplenotch::fixture;

namespace {

// A log with what is looked for in it.
struct Case {
    Motion motion;
    std::vector<double> torque_nm;
    std::vector<unsigned char> use;
    [[nodiscard]] std::size_t size() const { return torque_nm.size(); }
    [[nodiscard]] std::size_t used() const {
        return static_cast<std::size_t>(std::count(use.begin(), use.end(), 1));
    }
};

std::vector<Fault> find_faults(Case& c) { return ripplenotch::find_faults(c.motion, c.torque_nm, c.use); }

Case whole_case(const TraceView& log, Seconds smoothing) {
    return {motion_along(log, smoothing),
            {log.torque_nm.begin(), log.torque_nm.end()},
            std::vector<unsigned char>(log.size(), 1)};
}

Case case_with(std::initializer_list<std::string> hidden, std::uint64_t seed = 1) {
    Model truth = joint();
    for (const std::string& term : hidden) truth.terms.push_back(parse_term(term));
    const Trace log = logged(truth, tour(), seed);
    return whole_case(log.view(), default_smoothing);
}

std::vector<std::string> names(const std::vector<Fault>& faults) {
    std::vector<std::string> found;
    for (const Fault& fault : faults) found.emplace_back(fault.term.effect->name);
    return found;
}

using Names = std::vector<std::string>;

}  // namespace

TEST_CASE("a log without faults has none, whatever its noise") {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        Case c = case_with({}, seed);
        const std::size_t before = c.used();
        CHECK(names(find_faults(c)).empty());
        CHECK(c.used() == before);
    }
}

TEST_CASE("each fault is found alone, with its size, and what it spoiled does not count") {
    SECTION("clipping") {
        Case c = case_with({"saturation,limit_nm=0.9"});
        const auto faults = find_faults(c);
        CHECK(names(faults) == Names{"saturation"});
        CHECK(*faults[0].term.values[0] == 0.9);
        std::size_t counted = 0;
        for (std::size_t k = 0; k < c.size(); ++k) counted += std::abs(c.torque_nm[k]) == 0.9 ? c.use[k] : 0U;
        CHECK(counted == 0);
        CHECK(faults[0].samples > 100);
    }
    SECTION("whole steps") {
        Case c = case_with({"quantization,step_nm=0.4"});
        const std::size_t before = c.used();
        const auto faults = find_faults(c);
        CHECK(names(faults) == Names{"quantization"});
        CHECK(*faults[0].term.values[0] == Approx(0.4));
        CHECK(c.used() == before);
    }
    SECTION("spikes") {
        Case c = case_with({"spikes,rate_percent=0.15,size_nm=5"});
        const std::size_t before = c.used();
        const auto faults = find_faults(c);
        CHECK(names(faults) == Names{"spikes"});
        CHECK(*faults[0].term.values[1] == Approx(5.0).epsilon(0.05));
        CHECK(faults[0].samples == before - c.used());
        CHECK(faults[0].samples >= 5);
    }
    SECTION("held stretches") {
        Case c = case_with({"dropout,rate_hz=1,duration_s=0.1"});
        const auto faults = find_faults(c);
        CHECK(names(faults) == Names{"dropout"});
        CHECK(*faults[0].term.values[1] == Approx(0.1).epsilon(0.3));
        CHECK(faults[0].time_s.size() >= 6);
    }
}

TEST_CASE("an extreme that the recorder held is no clipping, a clipped torque of a recorder that holds is") {
    const auto hold = [](Case& c, std::size_t at, std::size_t samples) {
        for (std::size_t k = at + 1; k < at + samples; ++k) c.torque_nm[k] = c.torque_nm[at];
    };
    Case c = case_with({});
    const auto peak = std::max_element(c.torque_nm.begin(), c.torque_nm.end());
    hold(c, static_cast<std::size_t>(peak - c.torque_nm.begin()), 12);  // the longest of all
    for (std::size_t k = 100; k + 12 < c.size(); k += 300) {
        if (*std::max_element(&c.torque_nm[k], &c.torque_nm[k] + 12) < *peak) hold(c, k, 11);
    }
    CHECK_FALSE(std::ranges::count(names(find_faults(c)), "saturation"));

    Case clipped = case_with({"saturation,limit_nm=0.9"});
    for (std::size_t k = 100; k + 12 < clipped.size(); k += 300) {
        if (std::abs(clipped.torque_nm[k]) < 0.9) hold(clipped, k, 11);
    }
    CHECK(std::ranges::count(names(find_faults(clipped)), "saturation") == 1);
}

TEST_CASE("whole steps that were rounded once more are steps still, and nothing else") {
    for (const double step_nm : {0.482, 0.317, 0.75}) {
        Case c = case_with({fmt::format("quantization,step_nm={}", step_nm)});
        for (double& torque_nm : c.torque_nm) torque_nm = std::round(torque_nm / 0.1) * 0.1;
        const std::size_t before = c.used();
        const auto faults = find_faults(c);
        CHECK(names(faults) == Names{"quantization"});
        CHECK(*faults[0].term.values[0] == Approx(step_nm).margin(0.1 / 5));  // of five levels and more
        CHECK(c.used() == before);
    }
}

TEST_CASE("levels without order are no steps") {
    Case c = case_with({});
    for (double& torque_nm : c.torque_nm) {
        const double place = std::round(torque_nm / 0.4);
        torque_nm = 0.4 * place + 0.13 * std::sin(5.0 * place);
    }
    CHECK_FALSE(std::ranges::count(names(find_faults(c)), "quantization"));
}

TEST_CASE("steps finer than the noise are no fault: a log of four decimals is as good as continuous") {
    Case c = case_with({"quantization,step_nm=0.0001"});
    CHECK(names(find_faults(c)).empty());
    Case finer = case_with({"quantization,step_nm=0.02"});
    CHECK(names(find_faults(finer)).empty());
}

TEST_CASE("a torque that stays on a step while the joint runs fast is not held, one that then jumps is") {
    Case c = case_with({});
    // Ripple that a lag takes away at speed: slow, it goes up and down the steps; fast, it stays on one.
    for (std::size_t k = 0; k < c.size(); ++k) {
        const double left = std::max(0.0, 1.0 - std::abs(c.motion.velocity_deg_s[k]) / 60.0);
        const double turned = 2.0 * std::numbers::pi * c.motion.position_deg[k] / 3.6;
        c.torque_nm[k] = 0.4 * std::round(4.0 * left * std::sin(turned));
    }
    CHECK(names(find_faults(c)) == Names{"quantization"});
    std::size_t held = 0;
    for (std::size_t k = 1; k < c.size(); ++k) {
        if (std::abs(c.motion.velocity_deg_s[k]) < 60.0 || std::abs(c.motion.velocity_deg_s[k - 1]) >= 60.0)
            continue;
        // What stands before the fast stretch is held on through it.
        for (std::size_t i = k; i < c.size() && std::abs(c.motion.velocity_deg_s[i]) >= 60.0; ++i)
            c.torque_nm[i] = k % 2 == 0 ? 1.2 : -1.2;
        ++held;
    }
    REQUIRE(held >= 3);
    CHECK(names(find_faults(c)) == Names{"quantization", "dropout"});
}

TEST_CASE("a resonance and a burst of noise are no spikes") {
    Case c = case_with({"resonance,frequency_hz=30,damping=0.05"});
    CHECK(names(find_faults(c)) == Names{});
    Case burst = case_with({});
    Noise noise(3, NoiseChannel::torque);
    for (std::size_t k = 3000; k < 3600; ++k) burst.torque_nm[k] += 0.4 * noise.normal();
    CHECK(names(find_faults(burst)).empty());
}

TEST_CASE("noise with heavy tails has no spikes") {
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
        Case c = case_with({}, seed);
        // Student's t with 4 degrees of freedom, 0.08 Nm rms.
        Noise noise(seed + 10, NoiseChannel::torque);
        for (double& torque : c.torque_nm) {
            double squares = 0.0;
            for (int i = 0; i < 4; ++i) squares += std::pow(noise.normal(), 2);
            torque += 0.08 / std::sqrt(2.0) * noise.normal() / std::sqrt(squares / 4.0);
        }
        CHECK(names(find_faults(c)) == Names{});
    }
}

// What went wrong once, in this tool or in the trials before it, each with a log that shows it.

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

// A joint by itself whose ripple drives a mass on a spring.

namespace {

// y'' + 2 damping w y' + w^2 y = w^2 x by the trapezoidal rule, settled at the start.
std::vector<double> on_spring(const std::vector<double>& x, double rate_hz, double hertz, double damping) {
    const double c = rate_hz / (std::numbers::pi * hertz);
    const double a0 = c * c + 2.0 * damping * c + 1.0, a1 = 2.0 - 2.0 * c * c,
                 a2 = c * c - 2.0 * damping * c + 1.0;
    std::vector<double> y(x.size(), x[0]);
    for (std::size_t k = 1; k < x.size(); ++k) {
        const std::size_t before = k > 1 ? k - 2 : 0;
        y[k] = (x[k] + 2.0 * x[k - 1] + x[before] - a1 * y[k - 1] - a2 * y[before]) / a0;
    }
    return y;
}

// The joint's ripple made so at 8 kHz, and logged at 500 Hz.
Trace ringing_log(double hertz, double damping, std::uint64_t seed) {
    constexpr std::size_t finer = 16;
    const Motion fine = tour_at(Hertz(500.0 * finer));
    Model ripple = joint();
    std::erase_if(ripple.terms, [](const Term& term) { return !term.effect->ripple_order; });
    const std::vector<double> drive = predict_nm(ripple, fine);
    const std::vector<double> rung = on_spring(drive, 500.0 * finer, hertz, damping);
    Trace log = logged(joint(), tour(), seed);
    for (std::size_t k = 0; k < log.torque_nm.size() && finer * k < drive.size(); ++k)
        log.torque_nm[k] += rung[finer * k] - drive[finer * k];
    return log;
}

}  // namespace

TEST_CASE("ripple that drives a mass on a spring is explained whole, ramps through the mode included",
          "[!shouldfail]") {
    const Diagnosis found = diagnose(opened(joint()), ringing_log(36.0, 0.04, 51).view(), nullptr);
    CHECK(found.named == std::vector<std::string>{"resonance"});
    CHECK(found.verdict == DiagnosisVerdict::explained);
    // What kinks of the motion leave of a joint that does not ring is left here too, and nothing else.
    const Diagnosis plain = diagnose(opened(joint()), logged(joint(), tour(), 51).view(), nullptr);
    CHECK(found.gap.before_nm > 10.0 * plain.gap.after_nm);
    CHECK(found.gap.after_nm < 1.01 * plain.gap.after_nm);
}
