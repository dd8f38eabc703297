// SPDX-License-Identifier: MIT
// A wrong gear ratio and a late torque are found together, and neither where only one of them is there.
#include "diagnose/search/search_starts.hpp"

#include "bench_fixture.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using namespace ripplenotch::fixture;

namespace {

std::vector<const Effect*> both_effects() { return {&find_effect("delay"), &find_effect("gear-ratio")}; }

// What is told of a log of `truth` whose model has no delay and a ratio of 100.
std::optional<Candidate> told_together(const Model& truth, std::uint64_t seed,
                                       const std::vector<const Effect*>& effects = both_effects()) {
    const TestBench on(case_of(plain_log(truth, seed)));
    return with_late_ratio(on.bench, on.fitted(joint()), 3, effects);
}

Model turned(double ratio, Model model) {
    model.gear_ratio = GearRatio(ratio);
    return model;
}

}  // namespace

TEST_CASE("a torque that is late sees the position of that much earlier, within its stretch") {
    const Case whole = case_of(plain_log(joint(), 91));
    const double period_s = 1.0 / whole.motion.sample_rate.value();
    const Case late = seen_late(whole, Seconds(2.5 * period_s));
    for (std::size_t k = 3; k < whole.size(); ++k) {
        const auto& position_deg = whole.motion.position_deg;
        CAPTURE(k);
        REQUIRE(late.motion.position_deg[k] ==
                Approx(0.5 * (position_deg[k - 3] + position_deg[k - 2])).margin(1e-6));
        REQUIRE(late.use[k] == whole.use[k]);
    }
    for (std::size_t k = 0; k < 2; ++k) CHECK(late.use[k] == 0);
    const Case early = seen_late(whole, Seconds(-2.0 * period_s));
    CHECK(early.motion.position_deg[10] == Approx(whole.motion.position_deg[12]).margin(1e-6));
    CHECK(early.use.back() == 0);

    // A second of rows is lost: nothing is known of what was behind them.
    Case lost = whole;
    for (std::size_t k = 4000; k < lost.size(); ++k) lost.motion.time_s[k] += 1.0;
    const Case seen = seen_late(lost, Seconds(2.5 * period_s));
    for (std::size_t k = 4000; k < 4002; ++k) CHECK(seen.use[k] == 0);
    CHECK(seen.use[4010] == lost.use[4010]);
}

TEST_CASE("a wrong ratio and a delay that hide each other are found together") {
    for (const double delay_s : {-0.011, 0.0105}) {
        Model truth = turned(120.0, joint());
        truth.terms.push_back({&find_effect("delay"), {delay_s}});
        CAPTURE(delay_s);
        const auto found = told_together(truth, 92);
        REQUIRE(found);
        REQUIRE(found->stated.terms.size() == 5);
        CHECK(found->stated.terms[3].values[0].value() == Approx(delay_s).margin(2e-4));
        CHECK(found->stated.terms[4].values[0].value() == Approx(20.0).margin(0.05));
        CHECK(found->prices.size() == 5);
    }
}

TEST_CASE("one of the two alone, or none, is not told as both") {
    CHECK(!told_together(joint(), 93));
    CHECK(!told_together(turned(120.0, joint()), 94));
    Model both = turned(120.0, joint_with({"delay,delay_s=0.0105"}));
    CHECK(!told_together(both, 95, {&find_effect("delay"), &find_effect("offset")}));
    CHECK(!told_together(both, 95, {&find_effect("gear-ratio")}));
}

TEST_CASE("a ratio that was found alone gives way to the pair, one that the model states does not") {
    Model truth = turned(120.0, joint());
    truth.terms.push_back({&find_effect("delay"), {0.0105}});
    const TestBench on(case_of(plain_log(truth, 96)));
    const Candidate with_wrong = on.fitted(joint_with({"gear-ratio,error_percent=-40"}));
    const auto found = with_late_ratio(on.bench, with_wrong, 3, both_effects());
    REQUIRE(found);
    REQUIRE(found->stated.terms.size() == 5);
    CHECK(found->stated.terms[4].values[0].value() == Approx(20.0).margin(0.05));
    CHECK(!with_late_ratio(on.bench, with_wrong, 4, both_effects()));
    const Candidate with_both =
        on.fitted(joint_with({"gear-ratio,error_percent=20", "delay,delay_s=0.0105"}));
    CHECK(!with_late_ratio(on.bench, with_both, 3, both_effects()));
}
