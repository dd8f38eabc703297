// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>

#include "core/matrices/least_squares.hpp"
#include "ripplenotch/arm/arm_setup.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

// The residual squares of a joint, as a parabola over the delay.
struct Parabola {
    std::size_t joint;
    double lowest_s, weight;  ///< one over the variance, by the noise alone
};

// Squares on held-out fifths of all joints with the torques moved ahead.
std::vector<double> squares_at(const Chain& chain, const ArmLog& log, const ArmFitOptions& options,
                               double delay_s) {
    std::vector<double> squares;
    for (const ArmJointFit& joint : fit_arm(chain, AdvancedLog(log, delay_s).log, options).joints)
        squares.push_back(joint.smoothed_error_nm * joint.smoothed_error_nm);
    return squares;
}

std::vector<Parabola> parabolas_about(const Chain& chain, const ArmLog& log, const ArmFit& fit,
                                      const ArmFitOptions& options, double center_s, double step_s) {
    // Windows that do not overlap are independent.
    const auto& time_s = log.joints.front().time_s;
    const double windows = (time_s.back() - time_s.front()) / fit.smoothing.value();
    const auto before = squares_at(chain, log, options, center_s - step_s),
               here = squares_at(chain, log, options, center_s),
               after = squares_at(chain, log, options, center_s + step_s);
    std::vector<Parabola> found;
    for (std::size_t i = 0; i < here.size(); ++i) {
        const double slope = 0.5 * (after[i] - before[i]), bend = before[i] - 2.0 * here[i] + after[i];
        if (!(bend > 0.0)) continue;
        const double lowest = here[i] - 0.5 * slope * slope / bend;
        found.push_back({fit.joints[i].joint, center_s - step_s * slope / bend,
                         windows * bend / (step_s * step_s * std::max(lowest, 1e-6 * here[i]))});
    }
    return found;
}

struct Mean {
    double value = 0.0, weight = 0.0, excess = 1.0;  ///< ratio of the variance to that by noise (Birge ratio)
    std::size_t joints = 0;
};

// Weighted mean of all joints that do not contradict, but for one.
Mean mean_of(const std::vector<Parabola>& parabolas, const ArmLag& lag, std::size_t without) {
    Mean mean;
    const auto counts = [&](std::size_t i) { return i != without && !lag.joints[i].contradicts; };
    for (std::size_t i = 0; i < parabolas.size(); ++i) {
        if (!counts(i)) continue;
        mean.value += parabolas[i].weight * parabolas[i].lowest_s;
        mean.weight += parabolas[i].weight;
        ++mean.joints;
    }
    mean.value /= std::max(mean.weight, 1e-300);
    double squares = 0.0;
    for (std::size_t i = 0; i < parabolas.size(); ++i) {
        const double off = parabolas[i].lowest_s - mean.value;
        if (counts(i)) squares += parabolas[i].weight * off * off;
    }
    if (mean.joints > 1) mean.excess = std::max(squares / static_cast<double>(mean.joints - 1), 1.0);
    return mean;
}

// Marks the joint farthest from the others, relative to their scatter; false where none contradicts.
bool mark_outlier(const std::vector<Parabola>& parabolas, ArmLag& lag) {
    std::size_t farthest = parabolas.size();
    double most = 1.0;
    for (std::size_t i = 0; i < parabolas.size(); ++i) {
        if (lag.joints[i].contradicts) continue;
        const Mean others = mean_of(parabolas, lag, i);
        if (others.joints < 2) return false;
        const double error = std::sqrt(others.excess * (1.0 / parabolas[i].weight + 1.0 / others.weight));
        // Each of n joints is tested, at 5 % / n: the tail of Student's t falls as the power of its freedom.
        const auto freedom = static_cast<double>(others.joints - 1), asked = freedom + 2.0;
        const double limit =
            portable::pow(asked, 1.0 / freedom) * student_95(freedom) * std::max(error, 1e-12);
        const double off = std::abs(parabolas[i].lowest_s - others.value) / limit;
        if (off <= most) continue;
        most = off;
        farthest = i;
    }
    if (farthest == parabolas.size()) return false;
    return lag.joints[farthest].contradicts = true;
}

}  // namespace

bool ArmLag::contradicted_by(std::size_t joint) const {
    return std::ranges::any_of(joints,
                               [&](const JointLag& one) { return one.joint == joint && one.contradicts; });
}

AdvancedLog::AdvancedLog(const ArmLog& of, double delay_s) : log(of), torques_nm(of.joints.size()) {
    for (std::size_t j = 0; j < torques_nm.size(); ++j) {
        const TraceView& joint = of.joints[j];
        if (joint.torque_nm.empty() || delay_s == 0.0) continue;
        std::size_t at = 0;
        for (std::size_t k = 0; k < joint.size(); ++k) {
            const double wanted_s = joint.time_s[k] + delay_s;
            while (at + 2 < joint.size() && joint.time_s[at + 1] <= wanted_s) ++at;
            const double step_s = joint.time_s[at + 1] - joint.time_s[at];
            const double into = std::clamp((wanted_s - joint.time_s[at]) / step_s, 0.0, 1.0);
            torques_nm[j].push_back(joint.torque_nm[at] +
                                    into * (joint.torque_nm[at + 1] - joint.torque_nm[at]));
        }
        log.joints[j].torque_nm = torques_nm[j];
    }
}

std::optional<ArmLag> common_lag(const Chain& chain, const ArmLog& log, const ArmFit& fit,
                                 ArmFitOptions options) {
    if (fit.joints.size() < 2) return {};
    options.smoothing = fit.smoothing;
    options.pull = fit.pull;
    // Over half of the shortest window a smoothed torque is a parabola of the time.
    const double step_s = 0.5 * arm_smoothings.front().value();
    ArmLag lag;
    // A minimum far from the center is where the third power of the delay counts.
    constexpr int most_looks = 3;
    for (int look = 0; look < most_looks; ++look) {
        const double center_s = lag.delay_s;
        const auto parabolas = parabolas_about(chain, log, fit, options, center_s, step_s);
        lag.joints.clear();
        for (const Parabola& one : parabolas) lag.joints.push_back({one.joint, one.lowest_s, false});
        if (parabolas.size() < 2) return {};
        while (mark_outlier(parabolas, lag))
            ;
        const Mean mean = mean_of(parabolas, lag, parabolas.size());
        lag.delay_s = mean.value;
        const double half_s =
            student_95(static_cast<double>(mean.joints - 1)) * std::sqrt(mean.excess / mean.weight);
        lag.delay_95_s = {lag.delay_s - half_s, lag.delay_s + half_s};
        if (std::abs(lag.delay_s - center_s) <= 0.1 * step_s) return lag;
    }
    return {};
}

}  // namespace ripplenotch
