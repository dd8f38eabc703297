// SPDX-License-Identifier: MIT
// Which names a diagnosis gives, and which it keeps to itself: look-alikes, surrogates, what another log
// contradicts, what the log does not hold.
#include <algorithm>

#include "diagnose/answer/answer.hpp"
#include "diagnose_fixture.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using namespace ripplenotch::fixture;

namespace {

using Names = std::vector<std::string>;

void tell(const Diagnosis& found) {
    for (const Finding& finding : found.rounds) {
        UNSCOPED_INFO(finding.term.effect->name << " " << status_name(finding.status) << " "
                                                << finding.reason);
    }
}

Names sorted(Names names) {
    std::sort(names.begin(), names.end());
    return names;
}

}  // namespace

TEST_CASE("with an effect taken out of the list, no look-alike takes its place", "[!shouldfail]") {
    const std::pair<std::string, std::string_view> cases[] = {
        {"offset", "offset,torque_nm=-0.43"},
        {"viscous-friction", "viscous-friction,coefficient_nm_per_deg_s=0.0063"},
        {"coulomb-friction", "coulomb-friction,torque_nm=0.84,width_deg_s=0.12"}};
    for (const auto& [name, hidden] : cases) {
        const Trace log = logged(joint_with({hidden}), coarse_tour(), 32);
        const Names without = {name};
        const Diagnosis found = diagnose(opened(joint()), log.view(), nullptr, {.without = without});
        CAPTURE(name);
        tell(found);
        CHECK(found.named.empty());
        CHECK(found.remaining);
    }
}

TEST_CASE("an offset beside gravity and a drift is a finding and no correction of theirs") {
    const Model truth = joint_with({"drift,rate_nm_s=0.04,time_constant_s=8",
                                    "gravity,amplitude_nm=3,phase_deg=69", "offset,torque_nm=0.5"});
    const Diagnosis found = diagnose(opened(joint()), logged(truth, coarse_tour(), 33).view(), nullptr);
    tell(found);
    CHECK(sorted(found.named) == Names{"drift", "gravity", "offset"});
}

TEST_CASE("a name that the validation log contradicts is withdrawn, with the figures") {
    const Model with = joint_with({"viscous-friction,coefficient_nm_per_deg_s=0.005"});
    const Trace log = logged(with, coarse_tour(), 34), same = logged(with, coarse_tour(), 35),
                other = logged(joint(), coarse_tour(), 36);
    const TraceView same_view = same.view(), other_view = other.view();
    const Diagnosis kept = diagnose(opened(joint()), log.view(), &same_view);
    tell(kept);
    CHECK(kept.named == Names{"viscous-friction"});
    CHECK(*kept.rounds[0].validation_after_nm < 0.5 * *kept.rounds[0].validation_before_nm);
    const Diagnosis withdrawn = diagnose(opened(joint()), log.view(), &other_view);
    tell(withdrawn);
    CHECK(withdrawn.named.empty());
    REQUIRE(!withdrawn.rounds.empty());
    const Finding& finding = withdrawn.rounds[0];
    CHECK(finding.status == FindingStatus::not_reproduced);
    CHECK(*finding.validation_after_nm > *finding.validation_before_nm);
    CHECK(finding.reason.find("validation log") != std::string::npos);
    // It is not in the improved model, and what it would explain is unexplained.
    CHECK(withdrawn.model.terms.size() == joint().terms.size());
    CHECK(withdrawn.verdict == DiagnosisVerdict::unexplained);
    CHECK(withdrawn.remaining);
}

TEST_CASE(
    "with a validation log that none of the names fits, the improved model does no worse there than the one "
    "given") {
    // An offset of the other sign and no friction: nothing that one teaches helps the other.
    const Trace log =
        logged(joint_with({"offset,torque_nm=0.4", "coulomb-friction,torque_nm=0.6,width_deg_s=0.3"}),
               coarse_tour(), 41);
    const Trace other = logged(joint_with({"offset,torque_nm=-0.4"}), coarse_tour(), 42);
    const TraceView other_view = other.view();
    const Diagnosis found = diagnose(opened(joint()), log.view(), &other_view);
    tell(found);
    CHECK(found.named.empty());
    REQUIRE(found.gap.validation_after_nm);
    CHECK(*found.gap.validation_after_nm <= *found.gap.validation_before_nm * (1.0 + 1e-9));
}

TEST_CASE("on a short way without position, what depends on where the joint is cannot be decided") {
    Names needing;
    for (const Effect* effect : catalogue()) {
        if (needs_position(*effect)) needing.emplace_back(effect->name);
    }
    CHECK(sorted(needing) == Names{"gravity", "output-ripple", "payload-change",
                                   "position-dependent-friction", "ripple-modulation"});
    // The joint turns back before it has made a turn.
    std::vector<std::string> specs = {"rest,duration=0.4s", "poly6,to=150deg,duration=2.2s",
                                      "rest,duration=0.4s", "poly6,to=-60deg,duration=3s",
                                      "rest,duration=0.4s"};
    Trace log =
        logged(joint_with({"gravity,amplitude_nm=2,phase_deg=30"}), make_motion(specs, Hertz(500.0)), 37);
    log.position_deg.clear();
    const Diagnosis found = diagnose(opened(joint()), log.view(), nullptr);
    tell(found);
    CHECK(std::find(found.named.begin(), found.named.end(), "gravity") == found.named.end());
    CHECK(found.remaining);
    REQUIRE(found.undecidable.size() == 5);
    // What is missing does not blow up the ripple, by which a walk of the angle could stand in for it.
    CHECK(found.gap.after_nm < 1.01 * found.gap.before_nm);
    CHECK(*found.model.terms[2].values[1] == Approx(0.45).margin(0.1));
}
