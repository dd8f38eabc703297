// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>

#include "arm/fit/arm_fit.hpp"
#include "ripplenotch/arm/arm_setup.hpp"
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

}  // namespace ripplenotch
