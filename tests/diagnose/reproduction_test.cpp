// SPDX-License-Identifier: MIT
// A finding that another log contradicts is withdrawn; one that it bears out stays.
#include "diagnose/judging/reproduction.hpp"

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
Reproduced held_against(const Model& other, const DiagnosisRules& rules = standard) {
    const TestBench on(case_of(plain_log(joint_with({offset, viscous}), 76)), rules);
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
    CHECK(last_against(found.findings[0].decisions).rule == "reproduction.most_left");
    CHECK(last_against(found.findings[0].decisions).number > 1.0);
    CHECK(found.findings[1].status == FindingStatus::confirmed);
    REQUIRE(found.kept.stated.terms.size() == 4);
    CHECK(found.kept.stated.terms[3].effect->name == "viscous-friction");
}

TEST_CASE("a rule that allows a worse prediction lets it stay") {
    DiagnosisRules rules;
    rules.reproduction.most_left = 10.0;
    CHECK(held_against(joint_with({viscous}), rules).kept.stated.terms.size() == 5);
}
