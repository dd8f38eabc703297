// SPDX-License-Identifier: MIT
#include "ripplenotch/arm/arm_term.hpp"

#include <cmath>
#include <numbers>

#include "arm/fit/parting.hpp"
#include "arm/fit/smooth_along.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double most_rotor_kgm2 = 1.0;  // by hand: more than a rotor has, seen through its gear

// Columns and knowledge of values that do not belong together.
void part(const ArmJointFit& own, std::vector<std::vector<double>>& columns, GivenTerm& term) {
    const Parting parting(own);
    const auto n = static_cast<Index>(own.mean.size());
    VectorXd row(n);
    for (std::size_t k = 0; k < columns.front().size(); ++k) {
        for (Index c = 0; c < n; ++c) row[c] = columns[static_cast<std::size_t>(c)][k];
        parting.part(row);
        for (Index c = 0; c < n; ++c) columns[static_cast<std::size_t>(c)][k] = row[c];
    }
    const VectorXd mean = parting.of_values();
    term.torque_nm = std::move(columns);
    term.mean.assign(mean.begin(), mean.end());
    term.deviation.assign(own.mean.size(), 1.0);
}

// Links before the joint bring it no torque; all others stay, so that two logs have the same columns.
void leave_out_links_before(std::size_t joint, GivenTerm& term) {
    const auto count = static_cast<std::ptrdiff_t>(values_of_a_link * joint);
    term.torque_nm.erase(term.torque_nm.begin(), term.torque_nm.begin() + count);
    term.mean.erase(term.mean.begin(), term.mean.begin() + count);
    term.deviation.erase(term.deviation.begin(), term.deviation.begin() + count);
}

}  // namespace

GivenTerm arm_term(const Chain& chain, const ArmFit& fit, const ArmLog& log, std::size_t joint,
                   ArmKnowledge knowledge, std::optional<double> row_noise_nm,
                   std::span<const Motion> motions) {
    const ArmJointFit* const own = fit.find(joint);
    if (own == nullptr) raise<UsageError>("arm: the torque of joint {} was not fitted", joint + 1);
    std::vector<Motion> made;
    if (motions.empty()) {
        made = arm_motions(log, fit.smoothing);
        motions = made;
    }
    auto columns = arm_columns(chain, motions, joint);
    GivenTerm term{"arm", {}, {}, {}};
    if (knowledge == ArmKnowledge::other_joints && fit.joints.size() > 1) {
        part(*own, columns, term);
    } else {
        term.torque_nm = std::move(columns);
        term.mean.assign(fit.deviation.size(), 0.0);
        term.deviation = fit.deviation;
    }
    leave_out_links_before(joint, term);
    if (rotor_is_identifiable(chain, joint)) {
        std::vector<double> rotor = motions[joint].acceleration_deg_s2;
        const double unit = chain.joints[joint].kind == JointKind::revolute ? std::numbers::pi / 180.0 : 1.0;
        for (double& value : rotor) value *= unit;
        term.torque_nm.push_back(std::move(rotor));
        term.mean.push_back(0.0);
        term.deviation.push_back(most_rotor_kgm2 / std::sqrt(fit.pull));
    }
    term.torque_nm = smooth_along(log.joints[joint].time_s, term.torque_nm, fit.smoothing);
    const double own_noise = own->smoothed_error_nm * std::sqrt(fit.weighed_rows);
    if (row_noise_nm && own_noise > 0.0)
        for (double& deviation : term.deviation) deviation *= *row_noise_nm / own_noise;
    return term;
}

}  // namespace ripplenotch
