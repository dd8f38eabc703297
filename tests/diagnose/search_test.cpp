// SPDX-License-Identifier: MIT
// The search adds what is worth its price, and says of the last candidates why they were not.
#include "diagnose/search/search.hpp"
#include "diagnose/search/search_starts.hpp"

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

std::vector<const Effect*> effects_of_the_ripple() {
    return {&find_effect("delay"),
            &find_effect("lag"),
            &find_effect("resonance"),
            &find_effect("ripple-speed-dependence"),
            &find_effect("ripple-direction-dependence"),
            &find_effect("gear-ratio")};
}

Found found_in(const Model& truth, const std::vector<const Effect*>& effects = three_effects()) {
    TestBench on(case_of(plain_log(truth, 58)));
    const Candidate start = baseline(on.bench, opened(joint()));
    Found found;
    const Candidate last = search(on.bench, start, 3, effects, found.refused);
    for (std::size_t term = 3; term < last.stated.terms.size(); ++term)
        found.names.emplace_back(last.stated.terms[term].effect->name);
    for (const RefusedCandidate& candidate : found.refused) CHECK(!candidate.reason.empty());
    return found;
}

}  // namespace

TEST_CASE("two effects that are there are added, the larger first, and no third") {
    const Found found =
        found_in(joint_with({"offset,torque_nm=0.5", "tone,frequency_hz=30,amplitude_nm=0.2,phase_deg=10"}));
    CHECK(found.names == std::vector<std::string>{"offset", "tone"});
}

TEST_CASE("nothing is added where nothing is missing: the reason is told") {
    const Found found = found_in(joint());
    CHECK(found.names.empty());
    REQUIRE(!found.refused.empty());
    CHECK(found.refused[0].reason == "it improves the fit no more than chance would");
}

TEST_CASE("a lag and a resonance are both found, though a delay by itself closes more than either") {
    const Model truth = joint_with({"lag,time_constant_s=0.0097", "resonance,frequency_hz=40,damping=0.11"});
    CHECK(found_in(truth, effects_of_the_ripple()).names == std::vector<std::string>{"lag", "resonance"});
}

TEST_CASE("a wrong ratio and a delay that hide each other are added together") {
    Model truth = joint_with({"delay,delay_s=0.0105"});
    truth.gear_ratio = GearRatio(120.0);
    CHECK(found_in(truth, effects_of_the_ripple()).names == std::vector<std::string>{"delay", "gear-ratio"});
}

TEST_CASE("only an order that the user stated tells which multiple of the gear ratio is meant") {
    const TestBench on(case_of(plain_log(joint(), 67)));
    Candidate model = on.fitted(joint());
    const RatioRange stated = ratios_beside(model, 100.0);
    CHECK(stated.highest == Approx(100.0 * limits::screening::highest_ratio));
    model.prices.assign(model.prices.size(), 30.0);
    const RatioRange chosen = ratios_beside(model, 100.0);
    CHECK(chosen.lowest > 50.0);
    CHECK(chosen.lowest < 100.0);
    CHECK(chosen.highest > 100.0);
    CHECK(chosen.highest < 200.0);
}
