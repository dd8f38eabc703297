// SPDX-License-Identifier: MIT
// An arm whose values are stated gives the torque that its columns gave with the values they were fitted to.
#include "ripplenotch/arm/arm_fit.hpp"

#include "arm/arm_support.hpp"
#include "ripplenotch/core/error.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using namespace ripplenotch::test;
using Catch::Matchers::WithinAbs;

namespace {

const std::string three_dh = "a_m,alpha_deg,d_m,theta_deg\n0,90,0.3,0\n0.4,0,0,0\n0.3,0,0,0\n";

struct RecordedArm {
    std::vector<Trace> joints;

    RecordedArm(const Chain& chain, unsigned seed) {
        const auto motions = fourier_motions(chain.size(), 12.0, 100.0, seed, 60.0);
        const auto links = random_links(chain.size(), 5);
        for (std::size_t j = 0; j < chain.size(); ++j) {
            Trace& trace = joints.emplace_back();
            trace.sample_rate = Hertz(100.0);
            trace.time_s = motions[j].time_s;
            trace.position_deg = motions[j].position_deg;
            trace.velocity_deg_s = motions[j].velocity_deg_s;
            trace.torque_nm = arm_torque(chain, links, motions, j);
        }
    }
    [[nodiscard]] ArmLog view() const {
        ArmLog log;
        for (const Trace& joint : joints) log.joints.push_back(joint.view());
        log.has_torque.assign(joints.size(), true);
        return log;
    }
};

ArmFitOptions barely_pulled() {
    ArmFitOptions options;
    options.smoothing = Seconds(0.12);
    options.pull = 1e-3;
    return options;
}

std::vector<double> sum_of(const GivenTerm& term, const std::vector<double>& values) {
    std::vector<double> sum(term.torque_nm[0].size(), 0.0);
    for (std::size_t c = 0; c < values.size(); ++c)
        for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += values[c] * term.torque_nm[c][k];
    return sum;
}

}  // namespace

TEST_CASE("links of fitted columns give the same torque, along the log of the fit and along another",
          "[arm]") {
    const Chain chain = chain_of_dh("three.csv", three_dh);
    const RecordedArm log(chain, 3), other(chain, 8);
    const ArmFit fit = fit_arm(chain, log.view(), barely_pulled());
    for (const ArmKnowledge knowledge : {ArmKnowledge::other_joints, ArmKnowledge::pull}) {
        for (std::size_t joint = 0; joint < 3; ++joint) {
            GivenTerm term = arm_term(chain, fit, log.view(), joint, knowledge);
            std::vector<double> values = term.mean;
            for (std::size_t v = 0; v < values.size(); ++v)
                values[v] += term.deviation[v] * (0.3 * static_cast<double>(v % 5) - 0.5);
            const ArmValues stated = arm_values(chain, fit, joint, values, knowledge);
            CHECK(stated.links.size() == 30);
            for (const RecordedArm* recorded : {&log, &other}) {
                term = arm_term(chain, fit, recorded->view(), joint, knowledge);
                const auto by_columns = sum_of(term, values);
                const auto by_links = stated_torque(chain, stated, fit.smoothing, recorded->view(), joint);
                double size = 0.0, worst = 0.0;
                for (std::size_t k = 0; k < by_links.size(); ++k) {
                    size = std::max(size, std::abs(by_columns[k]));
                    worst = std::max(worst, std::abs(by_columns[k] - by_links[k]));
                }
                INFO("joint " << joint);
                CHECK(worst < 1e-9 * size);
            }
        }
    }
}

TEST_CASE("values for another joint are refused", "[arm]") {
    const Chain chain = chain_of_dh("three.csv", three_dh);
    const RecordedArm log(chain, 3);
    const ArmFit fit = fit_arm(chain, log.view(), barely_pulled());
    CHECK_THROWS_AS(arm_values(chain, fit, 1, std::vector<double>(30, 0.0)), UsageError);
}

TEST_CASE("a nuisance is an offset, and friction of the widths that the fit has", "[arm]") {
    const Chain chain = chain_of_dh("three.csv", three_dh);
    const RecordedArm log(chain, 3);
    const auto only = [&](const ArmNuisance& nuisance) {
        return nuisance_torque(chain, nuisance, log.joints[1].view(), 1);
    };
    CHECK(only({.offset_nm = 0.7}) == std::vector<double>(log.joints[1].size(), 0.7));
    const auto coulomb = only({.coulomb_nm = 2.0}), viscous = only({.viscous_nm_per_deg_s = 0.1});
    for (std::size_t k = 20; k + 20 < coulomb.size(); ++k) {
        const double v = log.joints[1].velocity_deg_s[k];
        CHECK_THAT(viscous[k], WithinAbs(0.1 * v, 0.05));
        if (std::abs(v) > 5.0) CHECK_THAT(coulomb[k], WithinAbs(v > 0 ? 2.0 : -2.0, 0.02));
    }
}
