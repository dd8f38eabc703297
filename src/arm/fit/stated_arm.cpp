// SPDX-License-Identifier: MIT
#include "arm/fit/stated_arm.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "arm/fit/arm_fit.hpp"
#include "core/matrices/factorisations.hpp"
#include "core/vectors/dot.hpp"
#include "ripplenotch/arm/arm_fit.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/model/motion.hpp"

namespace ripplenotch {

namespace {

// The weight of each value of a window for the parabola's middle: the same for every column.
class Kernels {
  public:
    Kernels(std::span<const double> time_s, Seconds window)
        : time_s_(time_s), half_s_(0.5 * window.value()) {}

    [[nodiscard]] std::size_t first() const { return first_; }
    /// The kernel for the values from first() on; empty where the value stays as it is.
    std::span<const double> about(std::size_t k) {
        while (time_s_[k] - time_s_[first_] > half_s_) ++first_;
        while (end_ < time_s_.size() && time_s_[end_] - time_s_[k] <= half_s_) ++end_;
        kernel_.clear();
        if (end_ - first_ <= 3) return kernel_;
        double moments[5] = {};
        for (std::size_t i = first_; i < end_; ++i) {
            const double u = (time_s_[i] - time_s_[k]) / half_s_, square = u * u;
            const double weight = (1.0 - square) * (1.0 - square);
            moments[0] += weight;
            moments[1] += weight * u;
            moments[2] += weight * square;
            moments[3] += weight * square * u;
            moments[4] += weight * square * square;
        }
        // Cramer's rule.
        const double a = moments[2] * moments[4] - moments[3] * moments[3],
                     b = moments[2] * moments[3] - moments[1] * moments[4],
                     c = moments[1] * moments[3] - moments[2] * moments[2];
        const double size = moments[0] * a + moments[1] * b + moments[2] * c;
        if (!(size > 1e-9 * moments[0] * moments[0] * moments[0])) return kernel_;
        for (std::size_t i = first_; i < end_; ++i) {
            const double u = (time_s_[i] - time_s_[k]) / half_s_, square = u * u;
            kernel_.push_back((1.0 - square) * (1.0 - square) * (a + b * u + c * square) / size);
        }
        return kernel_;
    }

  private:
    std::span<const double> time_s_;
    double half_s_;
    std::size_t first_ = 0, end_ = 0;
    std::vector<double> kernel_;
};

}  // namespace

std::vector<std::vector<double>> smooth_along(std::span<const double> time_s,
                                              std::span<const std::vector<double>> columns, Seconds window) {
    std::vector<std::vector<double>> smooth(columns.begin(), columns.end());
    Kernels kernels(time_s, window);
    for (std::size_t k = 0; k < time_s.size(); ++k) {
        const auto kernel = kernels.about(k);
        if (kernel.empty()) continue;
        for (std::size_t c = 0; c < columns.size(); ++c)
            smooth[c][k] = dot(kernel.data(), columns[c].data() + kernels.first(), kernel.size());
    }
    return smooth;
}

std::vector<double> smooth_along(std::span<const double> time_s, std::span<const double> values,
                                 Seconds window) {
    const std::vector<std::vector<double>> one = {{values.begin(), values.end()}};
    return smooth_along(time_s, one, window).front();
}

namespace {

using Eigen::Index;
using Eigen::VectorXd;

// Chosen, not derived: more than a rotor has, reflected through its gear.
constexpr double max_rotor_kgm2 = 1.0;

// Knowledge of values that belong together as knowledge of as many others that do not.
// With precision = L L', z = L' x has the covariance 1. Scaled, or the smallest inertia would be lost in
// rounding relative to the largest mass: z = L' S x, where the scaled precision is S^-1 precision S^-1.
class Parting {
  public:
    explicit Parting(const ArmJointFit& own) : own_(own) {
        const auto n = static_cast<Eigen::Index>(own.mean.size());
        const Eigen::MatrixXd precision = Eigen::Map<const Eigen::MatrixXd>(own.precision.data(), n, n);
        scale_ = precision.diagonal().cwiseSqrt();
        const Eigen::VectorXd inverse = scale_.cwiseInverse();
        Eigen::MatrixXd scaled = inverse.asDiagonal() * precision * inverse.asDiagonal();
        scaled.diagonal().array() += rounding_of_definite;
        lower_ = DefiniteFactors(scaled).lower();
    }

    // The prior mean, in the transformed coordinates.
    [[nodiscard]] Eigen::VectorXd of_values() const {
        const auto n = static_cast<Eigen::Index>(own_.mean.size());
        const Eigen::VectorXd mean = Eigen::Map<const Eigen::VectorXd>(own_.mean.data(), n);
        return lower_.transpose() * scale_.cwiseProduct(mean);
    }
    // The values that belong together again.
    [[nodiscard]] Eigen::VectorXd values_of(const Eigen::VectorXd& parted) const {
        const Eigen::VectorXd scaled = lower_.transpose().triangularView<Eigen::Upper>().solve(parted);
        return scaled.cwiseQuotient(scale_);
    }
    // A row of columns, in place: columns L'^-1.
    void part(Eigen::VectorXd& row) const {
        row = row.cwiseQuotient(scale_);
        lower_.triangularView<Eigen::Lower>().solveInPlace(row);
    }

  private:
    const ArmJointFit& own_;
    Eigen::VectorXd scale_;
    Eigen::MatrixXd lower_;
};

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
        term.deviation.push_back(max_rotor_kgm2 / std::sqrt(fit.pull));
    }
    term.torque_nm = smooth_along(log.joints[joint].time_s, term.torque_nm, fit.smoothing);
    const double own_noise = own->smoothed_error_nm * std::sqrt(fit.weighed_rows);
    if (row_noise_nm && own_noise > 0.0)
        for (double& deviation : term.deviation) deviation *= *row_noise_nm / own_noise;
    return term;
}

namespace {

constexpr std::size_t fewest_rows = 100;  // chosen, not derived
constexpr double rest_s = 1.0;            // chosen, not derived: the part of a standstill that is used

void check_sizes(const Chain& chain, const ArmLog& log, const ArmFitOptions& options) {
    if (log.joints.size() != chain.size() || log.has_torque.size() != chain.size())
        raise<UsageError>("arm: {} joints of a log for {} of {}", log.joints.size(), chain.size(),
                          chain.source);
    const std::size_t rows = log.joints.front().size();
    for (std::size_t j = 0; j < chain.size(); ++j) {
        const TraceView& joint = log.joints[j];
        if (joint.size() != rows || !joint.has_position())
            raise<UsageError>("arm: joint '{}' has {} rows{}, others have {}", chain.joints[j].name,
                              joint.size(), joint.has_position() ? "" : " without position", rows);
    }
    if (!options.use.empty() && options.use.size() != rows)
        raise<UsageError>("arm: {} marks for {} rows", options.use.size(), rows);
}

void check_numbers(const Chain& chain, const CheckedLog& checked) {
    for (std::size_t j = 0; j < chain.size(); ++j) {
        const TraceView& joint = checked.log.joints[j];
        const bool torque =
            std::find(checked.fitted.begin(), checked.fitted.end(), j) != checked.fitted.end();
        for (std::size_t k = 0; k < joint.size(); ++k) {
            const bool finite = std::isfinite(joint.position_deg[k]) &&
                                std::isfinite(joint.velocity_deg_s[k]) &&
                                (!torque || std::isfinite(joint.torque_nm[k]));
            if (!finite)
                raise<DataError>("arm: joint '{}' holds a number that is not finite in row {}",
                                 chain.joints[j].name, k + 1);
        }
    }
}

void leave_out_long_rests(CheckedLog& checked) {
    const auto& time_s = checked.log.joints.front().time_s;
    std::size_t since = 0;
    for (std::size_t k = 0; k < time_s.size(); ++k) {
        const bool rests = std::all_of(checked.friction.begin(), checked.friction.end(),
                                       [&](const Motion& joint) { return joint.velocity_deg_s[k] == 0.0; });
        if (!rests) since = k + 1;
        if (rests && time_s[k] - time_s[since] > rest_s) checked.use[k] = false;
    }
}

}  // namespace

CheckedLog check_log(const Chain& chain, const ArmLog& log, const ArmFitOptions& options) {
    check_sizes(chain, log, options);
    CheckedLog checked{log, {}, options.joints, options.use};
    for (std::size_t j = 0; j < chain.size(); ++j)
        if (options.joints.empty() && log.has_torque[j]) checked.fitted.push_back(j);
    if (checked.fitted.empty())
        raise<UsageError>("arm: no joint of {} has a torque in the log", chain.source);
    for (const std::size_t joint : checked.fitted) {
        if (joint >= chain.size() || !log.has_torque[joint])
            raise<UsageError>("arm: joint {} of {} has no torque in the log", joint + 1, chain.source);
    }
    check_numbers(chain, checked);
    checked.friction = arm_motions(log, default_smoothing);
    const bool moves = std::any_of(checked.friction.begin(), checked.friction.end(), [](const Motion& joint) {
        return std::any_of(joint.velocity_deg_s.begin(), joint.velocity_deg_s.end(),
                           [](double v) { return v != 0.0; });
    });
    if (!moves) raise<DataError>("arm: no joint moves; the log contains almost no information about the arm");
    if (checked.use.empty()) checked.use.assign(log.joints.front().size(), true);
    leave_out_long_rests(checked);
    const auto rows = static_cast<std::size_t>(std::count(checked.use.begin(), checked.use.end(), true));
    if (rows < fewest_rows)
        raise<DataError>("arm: {} rows count for the fit, expected {} or more", rows, fewest_rows);
    return checked;
}

StatedJoints StatedArm::stated_joints() const {
    StatedJoints pairs;
    for (std::size_t j = 0; j < log_joints.size(); ++j)
        pairs.emplace_back(chain.joints[j].name, log_joints[j]);
    return pairs;
}

ArmValues arm_values(const Chain& chain, const ArmFit& fit, std::size_t joint,
                     std::span<const double> of_term, ArmKnowledge knowledge) {
    const ArmJointFit* const own = fit.find(joint);
    const bool rotor = rotor_is_identifiable(chain, joint);
    const std::size_t links = values_of_a_link * chain.size(), before = values_of_a_link * joint;
    if (own == nullptr || of_term.size() != links - before + (rotor ? 1 : 0))
        raise<UsageError>("arm: {} values for joint {} of {}", of_term.size(), joint + 1, chain.source);
    ArmValues values;
    if (rotor) values.rotor_inertia_kgm2 = of_term.back();
    if (knowledge == ArmKnowledge::other_joints && fit.joints.size() > 1) {
        const Parting parting(*own);
        Eigen::VectorXd parted = parting.of_values();
        for (std::size_t v = before; v < links; ++v)
            parted[static_cast<Eigen::Index>(v)] = of_term[v - before];
        const Eigen::VectorXd found = parting.values_of(parted);
        values.links.assign(found.begin(), found.end());
        return values;
    }
    values.links.assign(before, 0.0);
    values.links.insert(values.links.end(), of_term.begin(),
                        of_term.begin() + static_cast<std::ptrdiff_t>(links - before));
    return values;
}

std::vector<double> stated_torque(const Chain& chain, const ArmValues& values, Seconds smoothing,
                                  const ArmLog& log, std::size_t joint) {
    const auto motions = arm_motions(log, smoothing);
    std::vector<double> torque_nm = arm_torque(chain, values.links, motions, joint);
    const double unit = chain.joints[joint].kind == JointKind::revolute ? std::numbers::pi / 180.0 : 1.0;
    for (std::size_t k = 0; k < torque_nm.size(); ++k)
        torque_nm[k] += values.rotor_inertia_kgm2 * unit * motions[joint].acceleration_deg_s2[k];
    return smooth_along(log.joints[joint].time_s, torque_nm, smoothing);
}

}  // namespace ripplenotch
