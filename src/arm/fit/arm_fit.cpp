// SPDX-License-Identifier: MIT
#include "arm/fit/arm_fit.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "arm/fit/stated_arm.hpp"
#include "core/matrices/factorisations.hpp"
#include "core/matrices/linear_algebra.hpp"
#include "ripplenotch/arm/arm_fit.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/model/motion.hpp"

namespace ripplenotch {

namespace {

// Wide enough for a log's speed to be distinguished from zero, narrow enough for friction to reverse at once.
constexpr double width_deg_s = 1.5, stribeck_deg_s = 8.6;

}  // namespace

FrictionBeside friction_beside(double speed_deg_s) {
    const double side = portable::tanh(speed_deg_s / width_deg_s), slow = speed_deg_s / stribeck_deg_s;
    return {side, slow * slow < 700.0 ? side * portable::exp(-slow * slow) : 0.0};
}

double deg_s_of(JointKind kind) { return kind == JointKind::revolute ? 1.0 : 1800.0 / std::numbers::pi; }

ArmRows::ArmRows(const Chain& chain, std::span<const Motion> motions, std::span<const Motion> friction,
                 std::size_t joint)
    : links_(values_of_a_link * chain.size()),
      joint_(joint),
      states_(chain, motions),
      arm_(chain),
      friction_(friction[joint]),
      unit_(deg_s_of(chain.joints[joint].kind)) {}

void ArmRows::at(std::size_t k, std::span<double> row) {
    const auto states = states_.at(k);
    arm_.move(states);
    arm_.torque_of(joint_, row.first(links_));
    const double v_deg_s = unit_ * friction_.velocity_deg_s[k], v = v_deg_s * std::numbers::pi / 180.0;
    const FrictionBeside friction = friction_beside(v_deg_s);
    const std::span<double> own = row.subspan(links_);
    own[0] = states[joint_].acceleration;
    own[1] = 1.0;
    own[2] = friction.side;
    own[3] = v;
    own[4] = friction.stribeck;
    own[5] = std::abs(friction.side);
    own[6] = std::abs(v);
}

namespace {

using Eigen::Index;

// Rows as logged only serve to select a window; more of them would not improve the selection.
constexpr std::size_t max_judging_rows = 6000;
constexpr double rows_a_window = 4.0;
// A short log has more rows a window, so that each fifth has some.
constexpr std::size_t fewest_fit_rows = 100;

struct Window {
    std::size_t first = 0, end = 0;
};

std::vector<Window> windows_about(const std::vector<std::size_t>& centers, std::span<const double> time_s,
                                  double half_s) {
    std::vector<Window> windows;
    Window window;
    for (const std::size_t center : centers) {
        while (time_s[center] - time_s[window.first] > half_s) ++window.first;
        window.end = std::max(window.end, center + 1);
        while (window.end < time_s.size() && time_s[window.end] - time_s[center] <= half_s) ++window.end;
        windows.push_back(window);
    }
    return windows;
}

// The rows of a window that goes forward, each computed once.
class RecentRows {
  public:
    RecentRows(ArmRows& rows, std::size_t most) : rows_(rows), room_(most), values_(most * rows.values()) {}

    std::span<const double> at(std::size_t k) const {
        return std::span(values_).subspan((k % room_) * rows_.values(), rows_.values());
    }
    void reach(Window window) {
        next_ = std::max(next_, window.first);
        for (; next_ < window.end; ++next_)
            rows_.at(next_, std::span(values_).subspan((next_ % room_) * rows_.values(), rows_.values()));
    }

  private:
    ArmRows& rows_;
    std::size_t room_, next_ = 0;
    std::vector<double> values_;
};

std::vector<FoldSums> empty_folds(std::size_t values) { return std::vector(arm_folds, FoldSums(values)); }

std::vector<FoldSums> smoothed_sums(ArmRows& rows, const TraceView& log, double half_s,
                                    const std::vector<std::size_t>& centers, const std::vector<bool>& use) {
    std::vector<FoldSums> folds = empty_folds(rows.values());
    const auto windows = windows_about(centers, log.time_s, half_s);
    std::size_t most = 1;
    for (const Window& window : windows) most = std::max(most, window.end - window.first);
    RecentRows recent(rows, most);
    std::vector<double> mean(rows.values());
    for (std::size_t c = 0; c < centers.size(); ++c) {
        recent.reach(windows[c]);
        std::fill(mean.begin(), mean.end(), 0.0);
        double torque_nm = 0.0, sum = 0.0;
        for (std::size_t k = windows[c].first; k < windows[c].end; ++k) {
            if (!use[k]) continue;
            const double u = half_s > 0.0 ? (log.time_s[k] - log.time_s[centers[c]]) / half_s : 0.0;
            const double weight = k == centers[c] ? 1.0 : (1.0 - u * u) * (1.0 - u * u);
            const auto row = recent.at(k);
            for (std::size_t v = 0; v < row.size(); ++v) mean[v] += weight * row[v];
            torque_nm += weight * log.torque_nm[k];
            sum += weight;
        }
        for (double& value : mean) value /= sum;
        folds[c * arm_folds / centers.size()].add(mean, torque_nm / sum);
    }
    return folds;
}

std::vector<FoldSums> logged_sums(ArmRows& rows, const TraceView& log,
                                  const std::vector<std::size_t>& centers) {
    std::vector<FoldSums> folds = empty_folds(rows.values());
    std::vector<double> row(rows.values());
    const std::size_t step = centers.size() / max_judging_rows + 1;
    for (std::size_t c = 0; c < centers.size(); c += step) {
        rows.at(centers[c], row);
        folds[c * arm_folds / centers.size()].add(row, log.torque_nm[centers[c]]);
    }
    return folds;
}

}  // namespace

FoldSums::FoldSums(std::size_t values)
    : rows_by_rows(Eigen::MatrixXd::Zero(static_cast<Index>(values), static_cast<Index>(values))),
      rows_by_torque(Eigen::VectorXd::Zero(static_cast<Index>(values))) {}

void FoldSums::add(std::span<const double> row, double torque_nm) {
    for (std::size_t b = 0; b < row.size(); ++b) {
        if (row[b] == 0.0) continue;  // links before the joint
        double* const column = rows_by_rows.data() + b * row.size();
        for (std::size_t a = 0; a <= b; ++a) column[a] += row[a] * row[b];
        rows_by_torque[static_cast<Index>(b)] += row[b] * torque_nm;
    }
    torque_by_torque += torque_nm * torque_nm;
    count += 1.0;
}

void FoldSums::add(const FoldSums& other) {
    rows_by_rows += other.rows_by_rows;
    rows_by_torque += other.rows_by_torque;
    torque_by_torque += other.torque_by_torque;
    count += other.count;
}

void FoldSums::complete() {
    rows_by_rows.triangularView<Eigen::StrictlyLower>() = rows_by_rows.transpose().eval();
}

double FoldSums::left(const Eigen::VectorXd& values) const {
    const double sum =
        torque_by_torque - 2.0 * values.dot(rows_by_torque) + values.dot(rows_by_rows * values);
    return std::max(0.0, sum);
}

namespace {

FitRows fit_rows(const TraceView& log, Seconds window, const std::vector<bool>& use) {
    const double step = window.value() * log.sample_rate.value() / rows_a_window;
    const auto there = static_cast<std::size_t>(std::count(use.begin(), use.end(), true));
    const std::size_t every = std::clamp<std::size_t>(static_cast<std::size_t>(step), 1,
                                                      std::max<std::size_t>(1, there / fewest_fit_rows));
    FitRows rows{{}, static_cast<double>(every)};
    for (std::size_t k = every / 2; k < log.size(); k += every)
        if (use[k]) rows.centers.push_back(k);
    return rows;
}

}  // namespace

JointSums sums_of(ArmRows& rows, const TraceView& log, std::size_t joint, Seconds window,
                  const FitRows& chosen, const std::vector<bool>& use) {
    // A millionth of a sample wider, so that rounding of the times does not decide which rows are in.
    const double half_s = 0.5 * window.value() + 1e-6 / log.sample_rate.value();
    std::vector<std::size_t> logged;
    for (std::size_t k = 0; k < log.size(); ++k)
        if (use[k]) logged.push_back(k);
    JointSums sums{joint, smoothed_sums(rows, log, half_s, chosen.centers, use),
                   logged_sums(rows, log, logged)};
    for (auto* folds : {&sums.smoothed, &sums.logged})
        for (FoldSums& fold : *folds) fold.complete();
    return sums;
}

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::array pulls = {1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1.0, 1e1, 1e2, 1e3, 1e4};
// A stronger pull, or a longer window, has to be better by this part.
constexpr double clearly = 0.002;
constexpr double first_noise = 0.03;    // noise of a torque before anything has been fitted
constexpr double full_size_nm = 100.0;  // chosen, not derived
// Share of the largest eigenvalue of the links' information matrix, each value scaled alone.
constexpr double identifiable_share = 1e-6;

struct Found {
    double pull = 0.0;
    std::vector<double> noise_nm;  ///< noise by which the joints were weighted
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

// Joints are first weighted by the rms of their torque, then by that of their residual.
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

// How many combinations of the links' values are identifiable from the log.
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

// The information of all joints but one on the links.
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
