// SPDX-License-Identifier: MIT
// A screening ranks what is there first, asks its price, and is made once.
#include "diagnose/search/screening.hpp"

#include <fmt/format.h>

#include <cmath>

#include "bench_fixture.hpp"
#include "diagnose/search/search.hpp"
#include "diagnose/search/search_starts.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using namespace ripplenotch::fixture;

namespace {

using Effects = std::vector<const Effect*>;

Effects four_effects() {
    return {&find_effect("offset"), &find_effect("gravity"), &find_effect("coulomb-friction"),
            &find_effect("delay")};
}

}  // namespace

TEST_CASE("what is hidden is ranked first, with about the gain that a fit of the whole log finds") {
    const Model truth = joint_with({"coulomb-friction,torque_nm=0.4,width_deg_s=0.2"});
    const TestBench on(case_of(plain_log(truth, 73)));
    const Candidate without = on.fitted(joint());
    const auto trials = screen(on.bench, without, four_effects());
    REQUIRE(!trials.empty());
    CHECK(trials[0].start.effect->name == "coulomb-friction");
    for (std::size_t i = 1; i < trials.size(); ++i) CHECK(trials[i].score() <= trials[i - 1].score());
    CHECK(trials[0].gain == Approx(without.gain_left - on.fitted(truth).gain_left).epsilon(0.15));
}

TEST_CASE("where nothing is missing no trial is worth its price") {
    const TestBench on(case_of(plain_log(joint(), 74)));
    const auto trials = screen(on.bench, on.fitted(joint()), four_effects());
    REQUIRE(!trials.empty());
    for (const Trial& trial : trials) CHECK(trial.score() < 0.0);
}

TEST_CASE("ripple behind a delay and a hysteresis that the model has is ranked first") {
    const auto known = {std::string_view("delay,delay_s=0.0114"),
                        std::string_view("hysteresis,torque_nm=1,width_deg=4")};
    Model model = joint_with(known), truth = joint_with(known);
    truth.terms.push_back(parse_term("ripple,order=4,amplitude_nm=0.2,phase_deg=-97"));
    const TestBench on(case_of(plain_log(truth, 76)));
    const auto trials = screen(on.bench, on.fitted(model),
                               Effects{&find_effect("coulomb-friction"), &find_effect("viscous-friction"),
                                       &find_effect("ripple"), &find_effect("output-ripple")});
    REQUIRE(!trials.empty());
    CHECK(trials[0].start.effect->name == "ripple");
    CHECK(*trials[0].start.values[0] == 4.0);
}

TEST_CASE(
    "an error of the acceleration comes late where the joint's torque does, whichever model was settled on") {
    const Model truth = joint_with({"delay,delay_s=0.021"});
    Case late = case_of(plain_log(truth, 77));
    std::vector<double> error = late.blunted_deg_s2;
    for (double& value : error) value *= 10.0 * noise_nm / rms(late.blunted_deg_s2);
    const std::vector<double> passed = sensed_nm(truth, late.motion, error);
    for (std::size_t k = 0; k < late.size(); ++k) late.torque_nm[k] += passed[k];
    TestBench on(std::move(late));
    on.bench.settle_on(joint());
    const Candidate with = on.fitted(truth), without = on.fitted(joint());
    // The error is ten times the noise: where it is not taken off, it is what is left.
    CHECK(with.gain_left == Approx(on.bench.samples()).epsilon(0.05));
    CHECK(rms(on.bench.residual(with.stated)) == Approx(1.0).epsilon(0.025));
    CHECK(rms(on.bench.cleared_residual(with.stated)) == Approx(noise_nm).epsilon(0.025));
    const auto trials = screen(on.bench, without, four_effects());
    REQUIRE(!trials.empty());
    CHECK(trials[0].start.effect->name == "delay");
    const Candidate found = with_trial(on.bench, without, trials[0]);
    CHECK(*found.stated.terms.back().values[0] == Approx(0.021).epsilon(0.01));
    CHECK(found.gain_left == Approx(with.gain_left).epsilon(0.01));
}

TEST_CASE("errors of the acceleration stay where they are where the torque comes before its motion") {
    const Case c = case_of(plain_log(joint(), 78));
    const auto plain = acceleration_errors(c, joint());
    CHECK(plain[0].torque_nm == c.rough_deg_s2);
    CHECK(plain[1].torque_nm == c.blunted_deg_s2);
    const auto with = [&](std::string_view term) { return acceleration_errors(c, joint_with({term})); };
    CHECK(with("delay,delay_s=-0.01")[1].torque_nm == plain[1].torque_nm);
    CHECK(with("resonance,frequency_hz=20,damping=0.1")[1].torque_nm == plain[1].torque_nm);
    // Five samples.
    const auto late = with("delay,delay_s=0.01");
    for (std::size_t k = 100; k < 200; ++k)
        REQUIRE(late[1].torque_nm[k] == Approx(c.blunted_deg_s2[k - 5]).margin(1e-9));
    CHECK(with("resonance,frequency_hz=20,damping=0.1,whole=1")[1].torque_nm != plain[1].torque_nm);
}

TEST_CASE("a screening is made once beside models whose torques differ by less than the noise can tell") {
    TestBench on(case_of(plain_log(joint(), 75)));
    const Effects effects = four_effects();
    const Candidate model = on.fitted(joint());
    const auto is_made = [&](const ModelBench& bench, const Candidate& beside, const Effects& tried) {
        const double before = on.work.spent();
        (void)screen(bench, beside, tried);
        return on.work.spent() > before;
    };
    // Ripple of order 1 by so many times the noise, so that its squares come to half of them or to twice.
    const auto with_ripple_of = [&](double squares) {
        Candidate other = model;
        double& amplitude_nm = *other.stated.terms[1].values[1];
        amplitude_nm += noise_nm * std::sqrt(2.0 * squares / static_cast<double>(on.c.used()));
        return other;
    };
    REQUIRE(model.stated.terms[1].effect->name == "ripple");
    CHECK(is_made(on.bench, model, effects));
    CHECK(!is_made(on.bench, model, effects));
    CHECK(!is_made(on.bench, with_ripple_of(0.5), effects));
    CHECK(is_made(on.bench, with_ripple_of(2.0), effects));
    on.bench.settle_on(model.stated);
    CHECK(!is_made(on.bench, model, effects));
    const Effects fewer{&find_effect("offset"), &find_effect("delay")};
    for (const Trial& trial : screen(on.bench, model, fewer)) CHECK(trial.start.effect->name != "gravity");
    // Values that are not fitted make another model.
    Candidate fixed = model;
    fixed.open.terms[1] = fixed.stated.terms[1];
    CHECK(is_made(on.bench, fixed, effects));
}

TEST_CASE("what was screened against another noise is told in units of this one") {
    const Model truth = joint_with({"coulomb-friction,torque_nm=0.4,width_deg_s=0.2"});
    TestBench on(case_of(plain_log(truth, 73)));
    const Candidate model = on.fitted(joint());
    const ModelBench louder(on.c, {2.0 * noise_nm, 2.0 * noise_nm, {}}, on.work, on.bench.kept());
    const auto first = screen(on.bench, model, four_effects());
    const double spent = on.work.spent();
    const auto again = screen(louder, model, four_effects());
    CHECK(on.work.spent() == spent);
    REQUIRE(again.size() == first.size());
    CHECK(again[0].gain == Approx(first[0].gain / 4.0));
    CHECK(again[0].price == first[0].price);
    for (std::size_t i = 1; i < again.size(); ++i) CHECK(again[i].score() <= again[i - 1].score());
}

TEST_CASE(
    "the time at which a payload changes is found to a tenth of a second, in moves and at rest, and comes "
    "first") {
    for (const double time_s : {4.3, 9.1, 13.7}) {
        Model truth = joint();
        truth.terms.push_back(parse_term(
            fmt::format("payload-change,inertia_kgm2=0.1,cosine_nm=0.5,sine_nm=-0.3,time_s={}", time_s)));
        const TestBench on(case_of(plain_log(truth, 79)));
        const Candidate without = on.fitted(joint());
        const ChangeTimes found = change_times(on.c, on.bench.raw_residual(without.stated), noise_nm);
        REQUIRE(!found.times_s.empty());
        CHECK(found.times_s.size() <= limits::screening::most_change_times);
        CHECK(found.times_s.front() == Approx(time_s).margin(0.1));
        CHECK(found.compared == static_cast<double>(limits::screening::compared_times));
        const auto trials = screen(on.bench, without,
                                   Effects{&find_effect("offset"), &find_effect("gravity"),
                                           &find_effect("drift"), &find_effect("payload-change")});
        REQUIRE(!trials.empty());
        CHECK(trials[0].start.effect->name == "payload-change");
    }
}

TEST_CASE("a log of few samples has no times of a change to be compared") {
    Case c = case_of(plain_log(joint(), 80));
    std::fill(c.use.begin() + 200, c.use.end(), 0);
    CHECK(change_times(c, std::vector<double>(c.size(), 0.1), noise_nm).times_s.empty());
}

TEST_CASE("a residual that no change of inertia and gravity closes has no times of a change") {
    const Model truth = joint_with({"viscous-friction,coefficient_nm_per_deg_s=0.006"});
    const TestBench on(case_of(plain_log(truth, 81)));
    const Candidate without = on.fitted(joint());
    CHECK(change_times(on.c, on.bench.raw_residual(without.stated), noise_nm).times_s.empty());
}

TEST_CASE("a friction by position is tried only where the log passes its positions in both directions") {
    const Effects effects{&find_effect("position-dependent-friction")};
    const Model truth = joint_with({"position-dependent-friction,order=1,amplitude_nm=0.4,phase_deg=20"});
    const TestBench on(case_of(plain_log(truth, 82)));
    const auto trials = screen(on.bench, on.fitted(joint()), effects);
    REQUIRE(!trials.empty());
    CHECK(*trials[0].start.values[0] == 1.0);
    Case one_way = case_of(plain_log(truth, 82));
    for (std::size_t k = 0; k < one_way.size(); ++k) {
        if (one_way.motion.velocity_deg_s[k] < 0.0) one_way.use[k] = 0;
    }
    const TestBench poor(std::move(one_way));
    CHECK(screen(poor.bench, poor.fitted(joint()), effects).empty());
}
