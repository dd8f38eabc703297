// SPDX-License-Identifier: MIT
#include "ripplenotch/arm/arm_setup.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>

#include "arm/fit/arm_fit.hpp"
#include "core/matrices/least_squares.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

// A log of an arm with the torque of each joint multiplied by a factor.
struct ScaledLog {
    ArmLog log;
    std::vector<std::vector<double>> torques_nm;

    ScaledLog(const ArmLog& of, const std::vector<double>& factors) : log(of), torques_nm(of.joints.size()) {
        for (std::size_t j = 0; j < torques_nm.size(); ++j) {
            if (factors[j] == 1.0) continue;
            torques_nm[j].assign(of.joints[j].torque_nm.begin(), of.joints[j].torque_nm.end());
            for (double& each : torques_nm[j]) each *= factors[j];
            log.joints[j].torque_nm = torques_nm[j];
        }
    }
};

// Torque and power of the arm fit's friction, along the log.
struct FrictionOfJoint {
    double rms_nm = 0.0, power = 0.0;
};

FrictionOfJoint friction_along(const Chain& chain, const ArmLog& log, const ArmJointFit& own) {
    FrictionOfJoint found;
    const double unit = deg_s_of(chain.joints[own.joint].kind);
    const auto value = [&](BesideArm which) { return own.beside_nm[static_cast<std::size_t>(which)]; };
    const auto velocity = log.joints[own.joint].velocity_deg_s;
    double squares = 0.0;
    for (const double each : velocity) {
        const double v_deg_s = unit * each;
        const FrictionBeside shapes = friction_beside(v_deg_s);
        const double torque_nm = value(BesideArm::coulomb) * shapes.side +
                                 value(BesideArm::viscous) * v_deg_s * std::numbers::pi / 180.0 +
                                 value(BesideArm::stribeck) * shapes.stribeck;
        squares += torque_nm * torque_nm;
        found.power += torque_nm * v_deg_s;
    }
    found.rms_nm = std::sqrt(squares / static_cast<double>(velocity.size()));
    return found;
}

double rms_of_torque(const TraceView& joint) {
    double squares = 0.0;
    for (const double each : joint.torque_nm) squares += each * each;
    return std::sqrt(squares / static_cast<double>(joint.torque_nm.size()));
}

// Geometric mean over the joints of the error on held-out fifths, each relative to its torque, so that it
// does not depend on the unit.
double mean_error(const ArmFit& fit, const ArmLog& log) {
    double sum = 0.0;
    for (const ArmJointFit& joint : fit.joints)
        sum += portable::log(std::max(joint.smoothed_error_nm, 1e-12) /
                             std::max(rms_of_torque(log.joints[joint.joint]), 1e-12));
    return portable::exp(sum / static_cast<double>(fit.joints.size()));
}

// Mean over the joints of the share of the torque's variance.
double explained_by(const ArmFit& fit, const ArmLog& log) {
    double sum = 0.0;
    for (const ArmJointFit& joint : fit.joints) {
        const auto torque = log.joints[joint.joint].torque_nm;
        double mean = 0.0, squares = 0.0;
        for (const double each : torque) mean += each / static_cast<double>(torque.size());
        for (const double each : torque) squares += (each - mean) * (each - mean);
        const double variance = squares / static_cast<double>(torque.size());
        if (variance > 0.0)
            sum +=
                (1.0 - joint.error_nm * joint.error_nm / variance) / static_cast<double>(fit.joints.size());
    }
    return sum;
}

// Factors by which the torques are multiplied, and the fit of that.
struct Factors {
    ArmFit fit;
    std::vector<double> of;
};

// Inverse factors of the mistakes in the torque of a joint. mNm for Nm is tested only where a thousandth is
// nearer to the torques of the other joints, on the scale of factors.
std::vector<double> possible_factors(const ArmLog& log, const ArmFit& fit, std::size_t joint) {
    constexpr double of_milli = 1e-3;  // by the definition of the unit
    double others = 0.0;
    for (const ArmJointFit& other : fit.joints)
        if (other.joint != joint)
            others += portable::log(std::max(rms_of_torque(log.joints[other.joint]), 1e-12)) /
                      static_cast<double>(fit.joints.size() - 1);
    const double distance = portable::log(std::max(rms_of_torque(log.joints[joint]), 1e-12)) - others;
    if (distance > -0.5 * portable::log(of_milli)) return {-1.0, of_milli};
    return {-1.0};
}

// The same with the torque of one more joint changed, where that fits clearly better; of several the best.
std::optional<Factors> one_more_changed(const Chain& chain, const ArmLog& log, const Factors& now,
                                        const ArmFitOptions& options, const ArmSetupLimits& limits) {
    std::optional<Factors> best;
    if (now.fit.joints.size() < 2) return best;
    double least = limits.most_error * mean_error(now.fit, log);
    for (const ArmJointFit& joint : now.fit.joints) {
        if (now.of[joint.joint] != 1.0) continue;
        for (const double factor : possible_factors(log, now.fit, joint.joint)) {
            Factors one{{}, now.of};
            one.of[joint.joint] = factor;
            const ScaledLog scaled(log, one.of);
            one.fit = fit_arm(chain, scaled.log, options);
            const double error = mean_error(one.fit, scaled.log);
            if (error >= least) continue;
            least = error;
            best = std::move(one);
        }
    }
    return best;
}

// Whether friction drives most of the joints whose friction is identifiable.
bool friction_drives(const Chain& chain, const ArmLog& log, const ArmFit& fit, const ArmSetupLimits& limits) {
    int drives = 0, resists = 0;
    for (const ArmJointFit& joint : fit.joints) {
        const FrictionOfJoint friction = friction_along(chain, log, joint);
        if (friction.rms_nm < limits.least_friction * joint.smoothed_error_nm) continue;
        ++(friction.power < 0.0 ? drives : resists);
    }
    return drives > resists;
}

// The fault of all joints whose torque has the same factor; nothing where none has.
std::optional<SetupFault> factor_fault(const Chain& chain, const ArmLog& log, const ArmFit& fit,
                                       const Factors& found, double factor) {
    std::vector<std::string> names;
    for (std::size_t j = 0; j < found.of.size(); ++j)
        if (found.of[j] == factor) names.push_back(chain.joints[j].name);
    if (names.empty()) return {};
    const bool all = names.size() == fit.joints.size();
    SetupFault fault{factor < 0.0 ? SetupFaultKind::torque_sign : SetupFaultKind::torque_unit,
                     fmt::format("the torque of {} {} {}: {}", names.size() == 1 ? "joint" : "joints",
                                 fmt::join(names, ", "),
                                 factor < 0.0 ? "has its sign reversed" : "is in mNm where Nm are expected",
                                 all ? "friction would drive the arm"
                                     : "with that corrected the joints fit one arm on held-out fifths of the "
                                       "log"),
                     {},
                     factor};
    fault.explained_before = explained_by(fit, log);
    fault.explained_after = explained_by(found.fit, ScaledLog(log, found.of).log);
    return fault;
}

// Two joints of the log that are exchanged, where the arm fits clearly better so.
std::optional<SetupFault> exchanged_joints(const Chain& chain, const ArmLog& log, const ArmFit& fit,
                                           const ArmFitOptions& options, const ArmSetupLimits& limits) {
    std::optional<SetupFault> best;
    double least = limits.most_error * mean_error(fit, log);
    for (std::size_t i = 0; i < fit.joints.size(); ++i) {
        for (std::size_t k = i + 1; k < fit.joints.size(); ++k) {
            const std::size_t a = fit.joints[i].joint, b = fit.joints[k].joint;
            if (chain.joints[a].kind != chain.joints[b].kind) continue;
            ArmLog other = log;
            std::swap(other.joints[a], other.joints[b]);
            const ArmFit again = fit_arm(chain, other, options);
            const double error = mean_error(again, other);
            if (error >= least) continue;
            best = SetupFault{
                SetupFaultKind::wrong_joint,
                fmt::format("joints {} and {} are exchanged in the log: the other way round the "
                            "error on held-out fifths is {:.2g} of this",
                            chain.joints[a].name, chain.joints[b].name, error / mean_error(fit, log)),
                {}};
            best->explained_before = explained_by(fit, log);
            best->explained_after = explained_by(again, other);
            least = error;
        }
    }
    return best;
}

std::string gravity_text(const Vector3& gravity) {
    return fmt::format("gravity={:g}:{:g}:{:g}", gravity[0], gravity[1], gravity[2]);
}

// The directions along the axes of the base that the chain does not state.
std::vector<Vector3> other_directions(const Vector3& stated) {
    const double size = portable::hypot(stated[0], stated[1], stated[2]);
    std::vector<Vector3> others;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        for (const double sign : {-1.0, 1.0}) {
            Vector3 gravity{};
            gravity[axis] = sign * size;
            if (std::abs(gravity[axis] - stated[axis]) > 1e-6 * size) others.push_back(gravity);
        }
    }
    return others;
}

}  // namespace

std::vector<SetupFault> suspect_arm(const Chain& chain, const ArmLog& log, const ArmFit& fit,
                                    const ArmFitOptions& options, const ArmSetupLimits& limits) {
    std::vector<SetupFault> faults;
    ArmFitOptions alike = options;
    alike.smoothing = fit.smoothing;
    Factors factors{fit, std::vector<double>(log.joints.size(), 1.0)};
    while (auto better = one_more_changed(chain, log, factors, alike, limits)) factors = *std::move(better);
    // All signs reversed fit as well: friction decides.
    const ScaledLog as_found(log, factors.of);
    if (friction_drives(chain, as_found.log, factors.fit, limits)) {
        for (const ArmJointFit& joint : fit.joints) factors.of[joint.joint] *= -1.0;
        factors.fit = fit_arm(chain, ScaledLog(log, factors.of).log, alike);
    }
    for (const double factor : {-1.0, 1e-3})
        if (auto fault = factor_fault(chain, log, fit, factors, factor)) faults.push_back(*std::move(fault));
    const ArmFit& best = factors.fit;
    const ScaledLog corrected(log, factors.of);
    const Vector3& g = chain.gravity_m_s2;
    const double now = mean_error(best, corrected.log);
    double least = limits.most_error * now;
    std::optional<SetupFault> direction;
    if (portable::hypot(g[0], g[1], g[2]) > 0.0) {
        for (const Vector3& gravity : other_directions(g)) {
            Chain other = chain;
            other.gravity_m_s2 = gravity;
            const ArmFit again = fit_arm(other, corrected.log, alike);
            const double error = mean_error(again, corrected.log);
            if (error >= least) continue;
            least = error;
            direction = SetupFault{
                SetupFaultKind::gravity_direction,
                fmt::format(
                    "gravity acts along another axis of the base: with {} the error on held-out fifths "
                    "of the log is {:.2g} of that with {}",
                    gravity_text(gravity), error / now, gravity_text(g)),
                gravity_text(gravity)};
            direction->explained_before = explained_by(best, corrected.log);
            direction->explained_after = explained_by(again, corrected.log);
        }
    }
    if (direction) faults.push_back(*std::move(direction));
    if (!faults.empty()) return faults;
    if (auto fault = exchanged_joints(chain, log, fit, alike, limits)) faults.push_back(*std::move(fault));
    return faults;
}

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
