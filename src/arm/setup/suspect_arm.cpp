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

// A log of an arm whose torques are its own, so that signs can be turned.
struct TurnedLog {
    ArmLog log;
    std::vector<std::vector<double>> torques_nm;

    TurnedLog(const ArmLog& of, const std::vector<bool>& turned) : log(of), torques_nm(of.joints.size()) {
        for (std::size_t j = 0; j < torques_nm.size(); ++j) {
            if (!turned[j]) continue;
            torques_nm[j].assign(of.joints[j].torque_nm.begin(), of.joints[j].torque_nm.end());
            for (double& each : torques_nm[j]) each = -each;
            log.joints[j].torque_nm = torques_nm[j];
        }
    }
};

// Torque and power of the friction beside the arm, along the log.
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

// Geometric mean over the joints, on fifths left out.
double mean_error_nm(const ArmFit& fit) {
    double sum = 0.0;
    for (const ArmJointFit& joint : fit.joints)
        sum += portable::log(std::max(joint.smoothed_error_nm, 1e-12));
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

// Which torques are taken with the other sign, and the fit of that.
struct Signs {
    ArmFit fit;
    std::vector<bool> turned;
};

// The same with the sign of one more joint turned, where that fits clearly better; of several the best.
std::optional<Signs> one_more_turned(const Chain& chain, const ArmLog& log, const Signs& signs,
                                     const ArmFitOptions& options, const ArmSetupLimits& limits) {
    std::optional<Signs> best;
    if (signs.fit.joints.size() < 2) return best;
    double least_nm = limits.most_error * mean_error_nm(signs.fit);
    for (const ArmJointFit& joint : signs.fit.joints) {
        if (signs.turned[joint.joint]) continue;
        Signs one{{}, signs.turned};
        one.turned[joint.joint] = true;
        one.fit = fit_arm(chain, TurnedLog(log, one.turned).log, options);
        if (mean_error_nm(one.fit) >= least_nm) continue;
        least_nm = mean_error_nm(one.fit);
        best = std::move(one);
    }
    return best;
}

// Whether most joints of those whose friction is told have one that drives them.
bool friction_drives(const Chain& chain, const ArmLog& log, const ArmFit& fit, const ArmSetupLimits& limits) {
    int drives = 0, resists = 0;
    for (const ArmJointFit& joint : fit.joints) {
        const FrictionOfJoint friction = friction_along(chain, log, joint);
        if (friction.rms_nm < limits.least_friction * joint.smoothed_error_nm) continue;
        ++(friction.power < 0.0 ? drives : resists);
    }
    return drives > resists;
}

SetupFault sign_fault(const Chain& chain, const ArmLog& log, const ArmFit& fit, const Signs& signs) {
    std::vector<std::string> names;
    for (std::size_t j = 0; j < signs.turned.size(); ++j)
        if (signs.turned[j]) names.push_back(chain.joints[j].name);
    const bool all = names.size() == fit.joints.size();
    SetupFault fault{SetupFaultKind::torque_sign,
                     fmt::format("the torque of {} {} has its sign reversed: {}",
                                 names.size() == 1 ? "joint" : "joints", fmt::join(names, ", "),
                                 all ? "friction would drive the arm"
                                     : "with it turned the joints fit one arm on fifths of the log left out"),
                     {},
                     -1.0};
    fault.explained_before = explained_by(fit, log);
    fault.explained_after = explained_by(signs.fit, TurnedLog(log, signs.turned).log);
    return fault;
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
    Signs signs{fit, std::vector<bool>(log.joints.size(), false)};
    while (auto better = one_more_turned(chain, log, signs, alike, limits)) signs = *std::move(better);
    // All signs turned fit as well: friction says which.
    const TurnedLog as_found(log, signs.turned);
    if (friction_drives(chain, as_found.log, signs.fit, limits)) {
        for (const ArmJointFit& joint : fit.joints) signs.turned[joint.joint] = !signs.turned[joint.joint];
        signs.fit = fit_arm(chain, TurnedLog(log, signs.turned).log, alike);
    }
    const ArmFit& best = signs.fit;
    const std::vector<bool>& turned = signs.turned;
    if (std::find(turned.begin(), turned.end(), true) != turned.end())
        faults.push_back(sign_fault(chain, log, fit, signs));
    const Vector3& g = chain.gravity_m_s2;
    if (!(portable::hypot(g[0], g[1], g[2]) > 0.0)) return faults;
    const TurnedLog judged(log, turned);
    double least = limits.most_error * mean_error_nm(best);
    std::optional<SetupFault> direction;
    for (const Vector3& gravity : other_directions(g)) {
        Chain other = chain;
        other.gravity_m_s2 = gravity;
        const ArmFit again = fit_arm(other, judged.log, alike);
        if (mean_error_nm(again) >= least) continue;
        least = mean_error_nm(again);
        direction = SetupFault{
            SetupFaultKind::gravity_direction,
            fmt::format("gravity acts along another axis of the base: {} leaves {:.2g} of the error that {} "
                        "leaves on fifths of the log left out",
                        gravity_text(gravity), least / mean_error_nm(best), gravity_text(g)),
            gravity_text(gravity)};
        direction->explained_before = explained_by(best, judged.log);
        direction->explained_after = explained_by(again, judged.log);
    }
    if (direction) faults.push_back(*std::move(direction));
    return faults;
}

}  // namespace ripplenotch
