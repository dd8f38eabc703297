// SPDX-License-Identifier: MIT
// Faults of the converter, each with what can be taken for it.
#include "diagnose/answer/answer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

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
