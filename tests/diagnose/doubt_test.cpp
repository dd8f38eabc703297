// SPDX-License-Identifier: MIT
// Each thing that speaks against a finding, alone, with the reason that is told for it.
#include "diagnose/judging/doubt.hpp"

#include <cmath>
#include <numbers>

#include "bench_fixture.hpp"
#include "diagnose/judging/judge.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using namespace ripplenotch::fixture;

namespace {

Evidence sound() {
    return {.gain = 5e4,
            .price = 25.0,
            .share_nm = 0.4,
            .share_sigma = 8.0,
            .own_nm = 0.4,
            .raw_gain = 1000.0,
            .elsewhere = 0.97};
}

struct Doubted {
    FindingStatus status;
    std::string reason;
};

// What is made of an offset that is there, told with this evidence.
Doubted doubted(const Evidence& evidence, std::string_view term = offset) {
    static const TestBench on(case_of(plain_log(joint_with({offset}), 54)));
    static const Candidate model = on.fitted(joint_with({offset}));
    Candidate given = model;
    given.stated.terms[3] = parse_term(term);
    Finding finding;
    finding.term = given.stated.terms[3];
    finding.evidence = evidence;
    doubt_alone(finding, on.bench, given, 3);
    CHECK((finding.status == FindingStatus::confirmed) == finding.reason.empty());
    return {finding.status, finding.reason};
}

Finding named(std::string_view term, double share_sigma) {
    Finding finding;
    finding.term = parse_term(term);
    finding.evidence.share_sigma = share_sigma;
    finding.evidence.share_nm = finding.evidence.own_nm = finding.evidence.sized_nm = share_sigma * noise_nm;
    return finding;
}

}  // namespace

TEST_CASE("an effect that is there and well told is confirmed") {
    const Doubted found = doubted(sound());
    CHECK(found.status == FindingStatus::confirmed);
    CHECK(found.reason.empty());
}

TEST_CASE("a torque below an eighth of the noise is immaterial") {
    Evidence evidence = sound();
    evidence.share_sigma = 0.1;
    const Doubted found = doubted(evidence);
    CHECK(found.status == FindingStatus::immaterial);
    evidence.share_sigma = 0.13;
    CHECK(doubted(evidence).status == FindingStatus::confirmed);
}

TEST_CASE("a delay of half a sample is a matter of when a sample is said to be taken") {
    const Doubted found = doubted(sound(), "delay,delay_s=0.001");
    CHECK(found.status == FindingStatus::immaterial);
}

TEST_CASE("a torque far larger than what it explains is nearly collinear with another") {
    Evidence evidence = sound();
    evidence.own_nm = 6.0;
    const Doubted found = doubted(evidence);
    CHECK(found.status == FindingStatus::unidentifiable);
}

TEST_CASE("what leaves the gap as it was, or explains one stretch alone, is tentative") {
    Evidence evidence = sound();
    evidence.raw_gain = -1.0;
    CHECK(doubted(evidence).reason == "the gap is no smaller with it");
    evidence = sound();
    evidence.elsewhere = 0.1;
    CHECK_THAT(doubted(evidence).reason, Catch::Contains("one short stretch"));
    CHECK(doubted(evidence).status == FindingStatus::tentative);
}

TEST_CASE(
    "a torque that is largest in rows that do not count is held against what it explains in those that do") {
    const Model truth = joint_with({"quadratic-viscous-friction,coefficient_nm_per_deg2_s2=4e-4"});
    Case slow = case_of(plain_log(truth, 82));
    double squares = 0.0;
    for (std::size_t k = 0; k < slow.size(); ++k) {
        const double v = slow.motion.velocity_deg_s[k];
        if (std::abs(v) > 30.0) slow.use[k] = 0;
        if (slow.use[k] != 0) squares += 16e-8 * v * v * v * v;
    }
    const double counted_nm = std::sqrt(squares / static_cast<double>(slow.used()));
    const TestBench on(slow);
    Candidate model = on.fitted(truth);
    const auto findings = judge(on.bench, model, 3, std::vector<const Effect*>{}, {});
    REQUIRE(findings.size() == 1);
    CHECK(findings[0].evidence.own_nm == Approx(counted_nm).epsilon(0.05));
    CHECK(rms(on.bench.torque_of(model.stated, 3)) > 8.0 * counted_nm);
}

TEST_CASE("beside more than it explains a finding is in doubt, and beside a region of its own kind") {
    const TestBench on(case_of(plain_log(joint(), 55)));
    const ResidualRegion at_speed{RegionKind::speed, {}, 0.3, 0.2}, slight{RegionKind::speed, {}, 0.1, 0.02};
    const auto with = [&](std::string_view term, double excess_nm, const std::vector<ResidualRegion>& left) {
        Finding finding = named(term, 8.0);
        doubt_for_residual(finding, excess_nm, on.bench, left);
        return std::pair(finding.status, finding.reason);
    };
    const std::string_view friction = "viscous-friction,coefficient_nm_per_deg_s=0.006";
    CHECK(with(friction, 0.3, {slight}) ==
          std::pair(FindingStatus::tentative,
                    std::string("the unexplained residual is larger than its share")));
    CHECK(with(friction, 0.1, {at_speed}) ==
          std::pair(FindingStatus::tentative, std::string("unexplained residual remains where it acts")));
    CHECK(with("gravity,amplitude_nm=1,phase_deg=0", 0.1, {at_speed}).first == FindingStatus::confirmed);
    CHECK(with(friction, 0.1, {slight}).first == FindingStatus::confirmed);
    CHECK(with(friction, 0.3, {}).first == FindingStatus::confirmed);
}

TEST_CASE("a curve of fixed form has to be ahead of another by more than doubtful findings took up") {
    const std::string_view square = "quadratic-viscous-friction,coefficient_nm_per_deg2_s2=4e-5",
                           tone = "tone,frequency_hz=3.7,amplitude_nm=0.1,phase_deg=20";
    const Model truth = joint_with({square, tone});
    const TestBench on(case_of(plain_log(truth, 57)));
    const Candidate model = on.fitted(truth);
    const auto judged = [&](double margin) {
        std::vector<Finding> findings = {named(square, 8.0), named(tone, 2.0)};
        findings[0].alternatives = {{"viscous-friction", margin}, {"coulomb-friction", 15.0}};
        findings[1].status = FindingStatus::tentative;
        const Candidate kept = believed(on.bench, model, 3, findings);
        return std::pair(findings[0], kept.gain_left - on.bench.samples());
    };
    const double left = judged(1e9).second, tie = tie_margin;
    CHECK(left > 1000.0);  // of the tone
    CHECK(judged(left + 2.0 * tie).first.status == FindingStatus::confirmed);
    const Finding tied = judged(left + 0.5 * tie).first;
    CHECK(tied.status == FindingStatus::ambiguous);
    CHECK(tied.alternatives[0].margin == Approx(0.5 * tie));
    CHECK(tied.alternatives[1].margin == 15.0);  // that curve has a width
}

TEST_CASE("a slight finding beside a far larger one of its kind may only mend its form") {
    std::vector<Finding> findings = {named("coulomb-friction,torque_nm=3,width_deg_s=0.2", 60.0),
                                     named("viscous-friction,coefficient_nm_per_deg_s=0.0001", 0.2)};
    doubt_for_size(findings[1], findings);
    CHECK(findings[1].status == FindingStatus::shape_correction);
    findings[0].status = FindingStatus::tentative;
    doubt_for_size(findings[1], findings);
    CHECK(findings[1].status == FindingStatus::tentative);
    Finding larger = named("viscous-friction,coefficient_nm_per_deg_s=0.003", 6.0);
    doubt_for_size(larger, findings);
    CHECK(larger.status == FindingStatus::confirmed);
}

TEST_CASE(
    "a phase alone, which acts without a size, may only mend the form of what changes the ripple as well") {
    std::vector<Finding> findings = {
        named("resonance,frequency_hz=27,damping=0.1", 4.0),
        named("ripple-direction-dependence,gain_percent=20,phase_deg=3,width_deg_s=0.2", 1.3)};
    doubt_for_size(findings[1], findings);
    CHECK(findings[1].status == FindingStatus::confirmed);
    findings[1].evidence.sized_nm = 0.03 * noise_nm;
    doubt_for_size(findings[1], findings);
    CHECK(findings[1].status == FindingStatus::shape_correction);
}

TEST_CASE("what the log does by itself, nearly as slowly, speaks against a slow finding") {
    const auto above = [](double wander_nm) {
        Trace log = plain_log(joint_with({offset}), 56);
        const auto rows = static_cast<double>(log.torque_nm.size());
        // Three to eight half periods over the log.
        for (std::size_t k = 0; k < log.torque_nm.size(); ++k) {
            for (double half_periods = 3.0; half_periods <= 8.0; half_periods += 1.0)
                log.torque_nm[k] +=
                    wander_nm * std::cos(std::numbers::pi * half_periods * static_cast<double>(k) / rows);
        }
        const TestBench on(case_of(log));
        const Candidate model = on.fitted(joint_with({offset}));
        // The offset's own square, as if the model could not do without it.
        const double gain_nm2 = 0.4 * 0.4 * on.bench.samples();
        return above_wandering(on.bench, model.stated, 3, gain_nm2);
    };
    const auto quiet = above(0.0), wandering = above(0.3);
    REQUIRE(quiet);
    REQUIRE(wandering);
    CHECK(*quiet > 20.0 * limits::wandering::least_above);
    // Six waves of twelve, each of half the square of its amplitude: 2 * (0.4 / 0.3)^2 * 2, less what
    // friction takes.
    CHECK(*wandering > 7.0);
    CHECK(*wandering < 15.0);
}

TEST_CASE("friction is no slow finding, however slowly the log wanders") {
    const std::string_view friction = "coulomb-friction,torque_nm=0.5,width_deg_s=0.2";
    const TestBench on(case_of(plain_log(joint_with({friction}), 57)));
    const Candidate model = on.fitted(joint_with({friction}));
    CHECK_FALSE(above_wandering(on.bench, model.stated, 3, 1.0));
}
