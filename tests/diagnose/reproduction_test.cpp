// SPDX-License-Identifier: MIT
// A finding that another log contradicts is withdrawn; one that it bears out stays.
#include "diagnose/judging/judge.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "bench_fixture.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using namespace ripplenotch::fixture;

namespace {

struct Reproduced {
    std::vector<Finding> findings;
    Candidate kept;
};

// Both are in the log; `other` says what is in the other one.
Reproduced held_against(const Model& other) {
    const TestBench on(case_of(plain_log(joint_with({offset, viscous}), 76)));
    const Candidate all = on.fitted(joint_with({offset, viscous}));
    Reproduced reproduced;
    for (std::size_t term = 3; term < 5; ++term) {
        reproduced.findings.emplace_back();
        reproduced.findings.back().term = all.stated.terms[term];
    }
    const Case second = case_of(plain_log(other, 77));
    reproduced.kept = ripplenotch::reproduced(on.bench, all, all, joint(), second, 3, reproduced.findings);
    return reproduced;
}

}  // namespace

TEST_CASE("what the other log holds as well stays, with what it leaves there") {
    const Reproduced found = held_against(joint_with({offset, viscous}));
    CHECK(found.kept.stated.terms.size() == 5);
    for (const Finding& finding : found.findings) {
        CHECK(finding.status == FindingStatus::confirmed);
        REQUIRE(finding.validation_after_nm);
        CHECK(*finding.validation_after_nm == Approx(noise_nm).epsilon(0.1));
        CHECK(*finding.validation_before_nm > 2.0 * noise_nm);
    }
}

TEST_CASE("what the other log does not hold is withdrawn by name, the rest stays") {
    const Reproduced found = held_against(joint_with({viscous}));
    CHECK(found.findings[0].status == FindingStatus::not_reproduced);
    CHECK(found.findings[1].status == FindingStatus::confirmed);
    REQUIRE(found.kept.stated.terms.size() == 4);
    CHECK(found.kept.stated.terms[3].effect->name == "viscous-friction");
}

TEST_CASE("a form that was mended goes before the name that it makes look wrong on the other log") {
    // Near the crest of a gravity of 4 Nm an offset of -3.6 Nm leaves 0.4 Nm. The other log goes everywhere,
    // and there 0.4 Nm is all: with both, nearly all of 4 Nm is wrong; with the gravity alone, 0.4 Nm.
    const Case second = case_of(plain_log(joint_with({"offset,torque_nm=0.4"}), 77));
    std::vector<double> places = second.motion.position_deg;
    std::sort(places.begin(), places.end());
    const double middle_deg = places[places.size() / 2];
    const std::string gravity = fmt::format("gravity,amplitude_nm=4,phase_deg={}", -middle_deg);
    const Model both = joint_with({"offset,torque_nm=-3.6", gravity.c_str()});
    Case near = case_of(plain_log(both, 76));
    for (std::size_t k = 0; k < near.size(); ++k)
        near.use[k] = std::abs(near.motion.position_deg[k] - middle_deg) < 15.0 ? near.use[k] : 0;
    const TestBench on(near);
    const Candidate all = on.fitted(both);
    std::vector<Finding> findings(2);
    for (std::size_t i = 0; i < 2; ++i) findings[i].term = all.stated.terms[3 + i];
    findings[1].status = FindingStatus::shape_correction;
    const Candidate kept = reproduced(on.bench, all, all, joint(), second, 3, findings);
    CHECK(findings[0].status == FindingStatus::confirmed);
    CHECK(findings[1].status == FindingStatus::not_reproduced);
    REQUIRE(kept.stated.terms.size() == 4);
    CHECK(kept.stated.terms[3].effect->name == "offset");
    CHECK(*kept.stated.terms[3].values[0] == Approx(0.4).margin(0.1));
}

TEST_CASE("a form that was mended goes where it alone spoils the other log, and the names stay") {
    const TestBench on(case_of(plain_log(joint_with({viscous, "gravity,amplitude_nm=2,phase_deg=0"}), 76)));
    const Candidate all = on.fitted(joint_with({viscous, "gravity,amplitude_nm=2,phase_deg=0"}));
    std::vector<Finding> findings(2);
    for (std::size_t i = 0; i < 2; ++i) findings[i].term = all.stated.terms[3 + i];
    findings[1].status = FindingStatus::shape_correction;
    const Case second = case_of(plain_log(joint_with({viscous}), 77));
    const Candidate kept = reproduced(on.bench, all, all, joint(), second, 3, findings);
    CHECK(findings[0].status == FindingStatus::confirmed);
    CHECK(findings[1].status == FindingStatus::not_reproduced);
    REQUIRE(kept.stated.terms.size() == 4);
    CHECK(kept.stated.terms[3].effect->name == "viscous-friction");
    // Where it does no harm, it stays.
    const Case third = case_of(plain_log(joint_with({viscous, "gravity,amplitude_nm=2,phase_deg=0"}), 78));
    findings[1].status = FindingStatus::shape_correction;
    CHECK(reproduced(on.bench, all, all, joint(), third, 3, findings).stated.terms.size() == 5);
}
