// SPDX-License-Identifier: MIT
#include "ripplenotch/arm/arm_fit.hpp"

#include <algorithm>
#include <cmath>

#include "arm/fit/checked_log.hpp"
#include "arm/fit/ridge.hpp"
#include "arm/fit/smooth_along.hpp"
#include "core/matrices/factorisations.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/model/measured_motion.hpp"

namespace ripplenotch {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::array pulls = {1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1.0, 1e1, 1e2, 1e3, 1e4};
// A stronger pull, or a longer window, has to be better by this part.
constexpr double clearly = 0.002;
constexpr double first_noise = 0.03;    // of a torque, before anything has been fitted
constexpr double full_size_nm = 100.0;  // by hand
// Of the eigenvalues of what the log says about the links, each scaled alone.
constexpr double identifiable_share = 1e-6;

struct Found {
    double pull = 0.0;
    std::vector<double> noise_nm;  ///< that the joints were weighed by
    ArmRidge::Errors errors;
};

// The sums of a log for one window, and what was found by them.
struct Trial {
    Seconds smoothing;
    double step = 1.0;
    std::vector<JointSums> joints;
    Found found;
};

std::vector<double> torque_rms(const std::vector<JointSums>& joints) {
    std::vector<double> rms;
    for (const JointSums& joint : joints) {
        FoldSums all;
        for (const FoldSums& fold : joint.smoothed) {
            all.torque_by_torque += fold.torque_by_torque;
            all.count += fold.count;
        }
        rms.push_back(std::max(std::sqrt(all.torque_by_torque / all.count), 1e-9));
    }
    return rms;
}

double size_of(const std::vector<JointSums>& joints) {
    const auto rms = torque_rms(joints);
    return std::max(1.0, *std::max_element(rms.begin(), rms.end()) / full_size_nm);
}

Found best_pull(const ArmRidge& ridge, std::vector<double> noise_nm, std::optional<double> asked) {
    std::optional<Found> best;
    for (const double pull : pulls) {
        if (asked && best) break;
        Found found{asked.value_or(pull), noise_nm, ridge.left_out_errors(asked.value_or(pull), noise_nm)};
        const bool better =
            !best || found.errors.smoothed_mean() < (1.0 - clearly) * best->errors.smoothed_mean();
        if (better) best = std::move(found);
    }
    return *std::move(best);
}

// Joints are first weighed by what they have, then by what was left of them.
Found two_passes(const std::vector<JointSums>& joints, std::size_t links, std::optional<double> pull) {
    const ArmRidge ridge(links, joints, size_of(joints));
    std::vector<double> noise_nm = torque_rms(joints);
    for (double& noise : noise_nm) noise *= first_noise;
    Found found = best_pull(ridge, std::move(noise_nm), pull);
    std::vector<double> left_nm = found.errors.smoothed_nm;
    for (double& left : left_nm) left = std::max(left, 1e-9);
    return best_pull(ridge, std::move(left_nm), pull);
}

Trial tried(const Chain& chain, const CheckedLog& log, Seconds smoothing, std::optional<double> pull) {
    Trial trial{smoothing, 1.0, {}, {}};
    const std::vector<Motion> motions = smoothing == default_smoothing
                                            ? std::vector<Motion>(log.friction.begin(), log.friction.end())
                                            : arm_motions(log.log, smoothing);
    const FitRows chosen = fit_rows(log.log.joints.front(), smoothing, log.use);
    trial.step = chosen.step;
    for (const std::size_t joint : log.fitted) {
        ArmRows rows(chain, motions, log.friction, joint);
        trial.joints.push_back(sums_of(rows, log.log.joints[joint], joint, smoothing, chosen, log.use));
    }
    trial.found = two_passes(trial.joints, values_of_a_link * chain.size(), pull);
    return trial;
}

// How many combinations of the links' values the log tells.
std::size_t told(const ArmRidge& ridge, const Found& found, std::size_t links) {
    MatrixXd said = MatrixXd::Zero(static_cast<Index>(links), static_cast<Index>(links));
    for (std::size_t j = 0; j < found.noise_nm.size(); ++j)
        said += ridge.word_of(j, found.noise_nm[j]).matrix;
    VectorXd scale = said.diagonal();
    const double largest = scale.maxCoeff();
    for (Index v = 0; v < scale.size(); ++v)
        scale[v] = scale[v] > 1e-12 * largest ? 1.0 / std::sqrt(scale[v]) : 0.0;
    const MatrixXd scaled = scale.asDiagonal() * said * scale.asDiagonal();
    const VectorXd sizes = singular_directions(scaled).lengths;
    return static_cast<std::size_t>((sizes.array() > identifiable_share * sizes.maxCoeff()).count());
}

// What all joints but one say of the links.
void add_others(const ArmRidge& ridge, const Found& found, std::size_t links, ArmFit& fit) {
    std::vector<ArmRidge::Word> words;
    for (std::size_t j = 0; j < fit.joints.size(); ++j) words.push_back(ridge.word_of(j, found.noise_nm[j]));
    for (std::size_t j = 0; j < fit.joints.size(); ++j) {
        MatrixXd precision = MatrixXd::Zero(static_cast<Index>(links), static_cast<Index>(links));
        VectorXd side = VectorXd::Zero(static_cast<Index>(links));
        for (std::size_t v = 0; v < links; ++v)
            precision(static_cast<Index>(v), static_cast<Index>(v)) =
                1.0 / (fit.deviation[v] * fit.deviation[v]);
        for (std::size_t other = 0; other < words.size(); ++other) {
            if (other == j) continue;
            precision += words[other].matrix;
            side += words[other].side;
        }
        const VectorXd mean = ScaledDefiniteFactors(precision, rounding_of_definite).solve(side);
        fit.joints[j].mean.assign(mean.begin(), mean.end());
        fit.joints[j].precision.assign(precision.data(), precision.data() + precision.size());
    }
}

ArmFit fit_of(const Chain& chain, const Trial& trial) {
    const std::size_t links = values_of_a_link * chain.size();
    const ArmRidge ridge(links, trial.joints, size_of(trial.joints));
    const Found& found = trial.found;
    const auto values = ridge.solve(found.pull, found.noise_nm);
    ArmFit fit;
    fit.pull = found.pull;
    fit.smoothing = trial.smoothing;
    fit.weighed_rows = trial.step;
    for (std::size_t v = 0; v < links; ++v) {
        fit.values.push_back(values.front()[static_cast<Index>(v)]);
        fit.deviation.push_back(ridge.reach(v) / std::sqrt(found.pull));
    }
    for (std::size_t j = 0; j < trial.joints.size(); ++j) {
        ArmJointFit joint;
        joint.joint = trial.joints[j].joint;
        const auto own = values[j].tail(static_cast<Index>(values_of_a_joint));
        joint.rotor_inertia_kgm2 = own[0];
        for (std::size_t v = 0; v < values_beside_arm; ++v)
            joint.beside_nm[v] = own[static_cast<Index>(v + 1)];
        joint.smoothed_error_nm = found.errors.smoothed_nm[j];
        joint.error_nm = found.errors.logged_nm[j];
        fit.joints.push_back(std::move(joint));
    }
    add_others(ridge, found, links, fit);
    fit.values_there =
        fit.joints.size() == 1 ? arm_values_there(chain, fit.joints.front().joint) : arm_values_there(chain);
    fit.values_told = std::min(told(ridge, found, links), fit.values_there);
    return fit;
}

}  // namespace

const ArmJointFit* ArmFit::find(std::size_t joint) const {
    const auto found = std::find_if(joints.begin(), joints.end(),
                                    [&](const ArmJointFit& each) { return each.joint == joint; });
    return found == joints.end() ? nullptr : &*found;
}

std::vector<Motion> arm_motions(const ArmLog& log, Seconds smoothing) {
    std::vector<Motion> motions;
    for (const TraceView& joint : log.joints) motions.push_back(motion_along(joint, smoothing));
    return motions;
}

ArmFit fit_arm(const Chain& chain, const ArmLog& log, const ArmFitOptions& options) {
    const CheckedLog checked = check_log(chain, log, options);
    if (options.smoothing) return fit_of(chain, tried(chain, checked, *options.smoothing, options.pull));
    std::optional<Trial> best;
    for (const Seconds smoothing : arm_smoothings) {
        Trial trial = tried(chain, checked, smoothing, options.pull);
        const bool better =
            !best || trial.found.errors.logged_mean() < (1.0 - clearly) * best->found.errors.logged_mean();
        if (better) best = std::move(trial);
    }
    return fit_of(chain, *best);
}

std::vector<double> fitted_torque(const Chain& chain, const ArmFit& fit, const ArmLog& log,
                                  std::size_t joint) {
    const ArmJointFit* const own = fit.find(joint);
    if (own == nullptr) raise<UsageError>("arm: the torque of joint {} was not fitted", joint + 1);
    const auto motions = arm_motions(log, fit.smoothing);
    std::vector<Motion> friction(log.joints.size());
    friction[joint] = motion_along(log.joints[joint], default_smoothing);
    ArmRows rows(chain, motions, friction, joint);
    const std::size_t bodies = fit.values.size() + 1;
    std::vector<double> values = fit.values, row(rows.values()), torque_nm(rows.size()),
                        beside_nm(rows.size());
    values.push_back(own->rotor_inertia_kgm2);
    values.insert(values.end(), own->beside_nm.begin(), own->beside_nm.end());
    for (std::size_t k = 0; k < rows.size(); ++k) {
        rows.at(k, row);
        for (std::size_t v = 0; v < bodies; ++v) torque_nm[k] += values[v] * row[v];
        for (std::size_t v = bodies; v < row.size(); ++v) beside_nm[k] += values[v] * row[v];
    }
    torque_nm = smooth_along(log.joints[joint].time_s, torque_nm, fit.smoothing);
    for (std::size_t k = 0; k < torque_nm.size(); ++k) torque_nm[k] += beside_nm[k];
    return torque_nm;
}

}  // namespace ripplenotch
