// SPDX-License-Identifier: MIT
// The values told at the end: what pulls them to one side is away, and their intervals hold the truth.
#include <cmath>

#include "diagnose/judging/judge.hpp"
#include "diagnose/search/search.hpp"
#include "diagnose_fixture.hpp"
#include "ripplenotch/model/motion.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using namespace ripplenotch::fixture;

namespace {

// What a joint's encoder of 19 bits logs.
Trace with_encoder(Trace log) {
    const double step_deg = 360.0 / 524288.0;
    for (double& position : log.position_deg) position = step_deg * std::round(position / step_deg);
    return log;
}

// Strokes that begin as smoothly as a trajectory generator makes them, with the cube of time: several
// hundredths of a second at speeds that noise hides.
Motion smooth_strokes() {
    Motion motion{Hertz(500.0), {}, {}, {}, {}};
    double position_deg = 0.0;
    const auto hold = [&](double speed_deg_s, double from_deg_s, double duration_s) {
        const auto count = static_cast<int>(duration_s * 500.0);
        for (int i = 0; i < count; ++i) {
            const double s = i / (duration_s * 500.0), change = speed_deg_s - from_deg_s;
            motion.time_s.push_back(static_cast<double>(motion.time_s.size()) / 500.0);
            motion.velocity_deg_s.push_back(from_deg_s + change * s * s * s * (10.0 + s * (6.0 * s - 15.0)));
            motion.acceleration_deg_s2.push_back(change * 30.0 * s * s * (1.0 - s) * (1.0 - s) / duration_s);
            const double share = s * s * s * s * (2.5 + s * (s - 3.0));
            motion.position_deg.push_back(position_deg + duration_s * (from_deg_s * s + change * share));
        }
        position_deg += duration_s * 0.5 * (from_deg_s + speed_deg_s);
    };
    hold(0.0, 0.0, 0.4);
    for (const double speed_deg_s : {30.0, -30.0, 100.0, -100.0, 60.0, -60.0, 45.0, -45.0}) {
        hold(speed_deg_s, 0.0, 0.4);
        hold(speed_deg_s, speed_deg_s, 0.4);
        hold(0.0, speed_deg_s, 0.4);
        hold(0.0, 0.0, 0.3);
    }
    return motion;
}

Candidate told_of(const Case& looked_at, const Model& open, const Model& near,
                  const std::vector<Fault>& faults) {
    Work work(1e9);
    std::vector<Finding> none;
    return final_values(looked_at, {noise_nm, noise_nm, {}},
                        {open, near, {}, std::vector<double>(open.terms.size(), 0.0), 0.0, true},
                        {faults, none, open.terms.size()}, work);
}

Candidate told(const Trace& log, const Model& open, const Model& near) {
    return told_of(whole_case(log.view(), default_smoothing), open, near, {});
}

struct Errors {
    double sum = 0.0;  ///< in units of the half-interval
    int held = 0, all = 0;
    void look_at(const Candidate& found, const Model& truth, std::size_t term, std::size_t parameter) {
        for (const FittedValue& value : found.values) {
            if (value.term != term || value.parameter != parameter) continue;
            REQUIRE(value.ci95.has_value());
            const double true_value = *truth.terms[term].values[parameter];
            const double half = 0.5 * (value.ci95->high - value.ci95->low);
            sum += (value.value - true_value) / half;
            held += value.ci95->low <= true_value && true_value <= value.ci95->high;
            ++all;
        }
    }
    [[nodiscard]] double mean() const { return sum / all; }
};

}  // namespace

TEST_CASE("Stribeck friction comes out neither too small nor too wide, and its intervals hold it") {
    Model truth = joint();
    truth.terms.push_back(parse_term("stribeck-friction,torque_nm=0.8,stribeck_speed_deg_s=12"));
    Model open = opened(joint());
    open.terms.push_back({truth.terms[3].effect, {std::nullopt, std::nullopt, 0.2}});
    Errors torque, speed, blind_torque;
    const Motion motion = smooth_strokes();
    for (std::uint64_t seed = 50; seed < 66; ++seed) {
        Trace log = with_encoder(logged(truth, motion, seed));
        add_white_noise(log.velocity_deg_s, 0.15, seed + 1000, NoiseChannel::velocity);
        const Candidate found = told(log, open, truth);
        torque.look_at(found, truth, 3, 0);
        speed.look_at(found, truth, 3, 1);
        // From the velocity alone, with 0.15 deg/s of noise, it is always too small.
        Trace blind = log;
        blind.position_deg.clear();
        blind_torque.look_at(told(blind, open, truth), truth, 3, 0);
    }
    CAPTURE(torque.mean(), speed.mean(), blind_torque.mean());
    // A mean of 16 errors with no bias is within 0.5 / sqrt(16) half-intervals of 0, one standard deviation.
    CHECK(std::abs(torque.mean()) < 0.4);
    CHECK(std::abs(speed.mean()) < 0.4);
    CHECK(torque.held + speed.held >= 28);
    CHECK(torque.all + speed.all == 32);
    CHECK(blind_torque.mean() < -0.3);
}

TEST_CASE("a torque that the converter cuts on one side does not pull the values down") {
    Model truth = joint();
    truth.terms.push_back(parse_term("offset,torque_nm=0.4"));
    Model cut = truth;
    cut.terms.push_back(parse_term("saturation,limit_nm=1.2"));
    Model open = opened(truth);
    Errors offset, ripple;
    for (std::uint64_t seed = 80; seed < 96; ++seed) {
        const Trace log = with_encoder(logged(cut, tour(), seed));
        Case looked_at = whole_case(log.view(), default_smoothing);
        const auto faults = find_faults(looked_at);
        REQUIRE(faults.size() == 1);
        const Candidate found = told_of(looked_at, open, truth, faults);
        offset.look_at(found, truth, 3, 0);
        ripple.look_at(found, truth, 1, 1);
    }
    CAPTURE(offset.mean(), ripple.mean());
    CHECK(std::abs(offset.mean()) < 0.4);
    CHECK(std::abs(ripple.mean()) < 0.4);
    CHECK(offset.held + ripple.held >= 28);
}

TEST_CASE("a name whose size the values told in the end do not tell is taken back, and its term with it") {
    // Viscous friction that is there, and an offset that was believed beside other values and is not.
    const double offset_nm = GENERATE(0.0, 0.3);
    Model truth = joint();
    truth.terms.push_back(parse_term("viscous-friction,coefficient_nm_per_deg_s=0.005"));
    truth.terms.push_back(parse_term("offset,torque_nm=0.3"));
    Model hidden = truth;
    hidden.terms[4].values[0] = offset_nm;
    const Trace log = with_encoder(logged(hidden, tour(), 7));
    std::vector<Finding> findings(2);
    for (std::size_t i = 0; i < 2; ++i) findings[i].term = truth.terms[3 + i];
    const std::vector<Fault> no_fault;
    Model open = opened(truth);
    Work work(1e9);
    const Candidate found =
        final_values(whole_case(log.view(), default_smoothing), {noise_nm, noise_nm, {}},
                     {open, truth, {}, std::vector<double>(open.terms.size(), 0.0), 0.0, true},
                     {no_fault, findings, 3}, work);
    CHECK(findings[0].status == FindingStatus::confirmed);
    if (offset_nm == 0.0) {
        CHECK(findings[1].status == FindingStatus::unidentifiable);
        CHECK(findings[1].reason == "its torque_nm is not identifiable from this log");
        CHECK(found.stated.terms.size() == 4);
    } else {
        CHECK(findings[1].status == FindingStatus::confirmed);
        CHECK(found.stated.terms.size() == 5);
    }
}
