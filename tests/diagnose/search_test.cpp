// SPDX-License-Identifier: MIT
// The search adds what is worth its price, and says of the last candidates why they were not.
#include "diagnose/search/search.hpp"

#include "bench_fixture.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using namespace ripplenotch::fixture;

namespace {

std::vector<const Effect*> three_effects() {
    return {&find_effect("offset"), &find_effect("viscous-friction"), &find_effect("tone")};
}

struct Found {
    std::vector<std::string> names;
    std::vector<RefusedCandidate> refused;
};

Found found_in(const Model& truth, const DiagnosisRules& rules = standard) {
    TestBench on(case_of(plain_log(truth, 58)), rules);
    const Candidate start = baseline(on.bench, opened(joint()));
    Found found;
    const Candidate last = search(on.bench, start, 3, three_effects(), found.refused);
    for (std::size_t term = 3; term < last.stated.terms.size(); ++term)
        found.names.emplace_back(last.stated.terms[term].effect->name);
    for (const RefusedCandidate& candidate : found.refused) {
        REQUIRE(!candidate.decisions.empty());
        CHECK(candidate.decisions.back().against);
    }
    return found;
}

}  // namespace

TEST_CASE("two effects that are there are added, the larger first, and no third") {
    const Found found =
        found_in(joint_with({"offset,torque_nm=0.5", "tone,frequency_hz=30,amplitude_nm=0.2,phase_deg=10"}));
    CHECK(found.names == std::vector<std::string>{"offset", "tone"});
}

TEST_CASE("nothing is added where nothing is missing: the price is told") {
    const Found found = found_in(joint());
    CHECK(found.names.empty());
    REQUIRE(!found.refused.empty());
    CHECK(found.refused[0].decisions.back().rule == "price");
    CHECK(found.refused[0].decisions.back().number < found.refused[0].decisions.back().limit);
}

TEST_CASE("a candidate is refused by the rule that is moved, with its number and its limit") {
    DiagnosisRules rules;
    rules.judge.material_sigma = 10.0;
    const Found found = found_in(joint_with({"offset,torque_nm=0.4"}), rules);
    CHECK(found.names.empty());
    REQUIRE(!found.refused.empty());
    CHECK(found.refused[0].term.effect->name == "offset");
    const Decision& last = found.refused[0].decisions.back();
    CHECK(last.rule == "judge.material_sigma");
    CHECK(last.number == Approx(0.4 / noise_nm).epsilon(0.05));
    CHECK(last.limit == 10.0);
}

TEST_CASE("no more is added than the rules allow") {
    DiagnosisRules rules;
    rules.search.most_names = 1;
    const Found found = found_in(
        joint_with({"offset,torque_nm=0.5", "tone,frequency_hz=30,amplitude_nm=0.2,phase_deg=10"}), rules);
    CHECK(found.names == std::vector<std::string>{"offset"});
}
