// SPDX-License-Identifier: MIT
#include "ripplenotch/arm/arm_setup.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>
#include <string>

#include "arm/fit/arm_fit.hpp"
#include "core/matrices/least_squares.hpp"
#include "core/rows/row_facts.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

// Error on held-out fifths, geometric mean over the joints, with a hypothesis to that without: half the
// squares. Measured on arms of six joints: corrected gravity reduces the error to 0.05, no other direction or
// sign of a right one to less than 1.
constexpr double max_error = 0.7;

// How log and arm may have been put together: which joint of the log a joint's motion and torque are, the
// factor of its torque, and the direction of gravity.
struct Reading {
    std::vector<std::size_t> motion, torque;
    std::vector<double> factors;
    Vector3 gravity_m_s2;
};

// The fit of a reading. Its error is the geometric mean over the joints of that on held-out fifths, each
// relative to its torque, so that it does not depend on the unit; explained is the mean of the shares of the
// variance.
struct ReadArm {
    Reading reading;
    ArmFit fit;
    double error = 0.0, explained = 0.0;
    bool friction_drives = false;  // most of the joints whose friction is identifiable
};

class Readings {
  public:
    Readings(const Chain& chain, const ArmLog& log, const ArmFitOptions& options)
        : chain_(chain), log_(log), options_(options) {}

    // With a fit that is known, or a new one.
    [[nodiscard]] ReadArm read(Reading reading, const ArmFit* known = nullptr) const {
        ArmLog log = log_;
        std::vector<std::vector<double>> torques_nm(log.joints.size());
        for (std::size_t j = 0; j < torques_nm.size(); ++j) {
            const auto torque = log_.joints[reading.torque[j]].torque_nm;
            torques_nm[j].assign(torque.begin(), torque.end());
            for (double& each : torques_nm[j]) each *= reading.factors[j];
            log.joints[j] = log_.joints[reading.motion[j]];
            log.joints[j].torque_nm = torques_nm[j];
            log.has_torque[j] = log_.has_torque[reading.torque[j]];
        }
        Chain chain = chain_;
        chain.gravity_m_s2 = reading.gravity_m_s2;
        ReadArm found{std::move(reading), known != nullptr ? *known : fit_arm(chain, log, options_)};
        const auto count = static_cast<double>(found.fit.joints.size());
        double sum = 0.0;
        int drives = 0;
        for (const ArmJointFit& joint : found.fit.joints) {
            const TraceView& own = log.joints[joint.joint];
            const auto rows = static_cast<double>(own.size());
            double mean = 0.0, variance = 0.0;
            for (const double each : own.torque_nm) mean += each / rows;
            for (const double each : own.torque_nm) variance += (each - mean) * (each - mean) / rows;
            if (variance > 0.0) found.explained += (1.0 - joint.error_nm * joint.error_nm / variance) / count;
            sum +=
                portable::log(std::max(joint.smoothed_error_nm, 1e-12) / std::max(rms(own.torque_nm), 1e-12));
            drives += friction_sign(joint, own);
        }
        found.error = portable::exp(sum / count);
        found.friction_drives = drives < 0;
        return found;
    }

    // The best of these that fits clearly better, on held-out fifths of the log.
    [[nodiscard]] std::optional<ReadArm> better(const ReadArm& now,
                                                const std::vector<Reading>& others) const {
        std::optional<ReadArm> best;
        double least = max_error * now.error;
        for (const Reading& other : others) {
            ReadArm one = read(other);
            if (one.error >= least) continue;
            least = one.error;
            best = std::move(one);
        }
        return best;
    }

  private:
    // 1 where friction resists, -1 where it drives, 0 where it is part of the residual: below the fit's
    // error.
    [[nodiscard]] int friction_sign(const ArmJointFit& own, const TraceView& log) const {
        const double unit = deg_s_of(chain_.joints[own.joint].kind);
        const auto value = [&](BesideArm which) { return own.beside_nm[static_cast<std::size_t>(which)]; };
        double squares = 0.0, power = 0.0;
        for (const double each : log.velocity_deg_s) {
            const double v_deg_s = unit * each;
            const FrictionBeside shapes = friction_beside(v_deg_s);
            const double torque_nm = value(BesideArm::coulomb) * shapes.side +
                                     value(BesideArm::viscous) * v_deg_s * std::numbers::pi / 180.0 +
                                     value(BesideArm::stribeck) * shapes.stribeck;
            squares += torque_nm * torque_nm;
            power += torque_nm * v_deg_s;
        }
        const double least_nm = own.smoothed_error_nm;
        if (squares < least_nm * least_nm * static_cast<double>(log.size())) return 0;
        return power < 0.0 ? -1 : 1;
    }

    const Chain& chain_;
    const ArmLog& log_;
    const ArmFitOptions& options_;
};

constexpr double of_milli = 1e-3;  // mNm for Nm, by the definition of the unit

// The fault of all joints whose torque has the same factor; nothing where none has.
std::optional<SetupFault> factor_fault(const Chain& chain, const ReadArm& before, const ReadArm& after,
                                       double factor) {
    std::vector<std::string> names;
    for (std::size_t j = 0; j < chain.size(); ++j)
        if (after.reading.factors[j] == factor) names.push_back(chain.joints[j].name);
    if (names.empty()) return {};
    const bool all = names.size() == before.fit.joints.size();
    return SetupFault{
        factor < 0.0 ? SetupFaultKind::torque_sign : SetupFaultKind::torque_unit,
        fmt::format("the torque of {} {} {}: {}", names.size() == 1 ? "joint" : "joints",
                    fmt::join(names, ", "),
                    factor < 0.0 ? "has its sign reversed" : "is in mNm where Nm are expected",
                    all ? "friction would drive the arm"
                        : "with that corrected the joints fit one arm on held-out fifths of the log"),
        {},
        factor,
        before.explained,
        after.explained};
}

std::string gravity_text(const Vector3& gravity) {
    return fmt::format("gravity={:g}:{:g}:{:g}", gravity[0], gravity[1], gravity[2]);
}

// With gravity along the axes of the base that the chain does not state.
std::vector<Reading> other_directions(const Reading& now) {
    const Vector3& stated = now.gravity_m_s2;
    const double size = portable::hypot(stated[0], stated[1], stated[2]);
    std::vector<Reading> others;
    for (std::size_t axis = 0; axis < 3 && size > 0.0; ++axis) {
        for (const double way : {-size, size}) {
            if (std::abs(way - stated[axis]) <= 1e-6 * size) continue;
            others.push_back(now);
            others.back().gravity_m_s2 = {};
            others.back().gravity_m_s2[axis] = way;
        }
    }
    return others;
}

// With the torque of one more joint reversed or in another unit.
std::vector<Reading> other_factors(const ReadArm& now) {
    std::vector<Reading> others;
    for (const ArmJointFit& joint : now.fit.joints) {
        if (now.reading.factors[joint.joint] != 1.0 || now.fit.joints.size() < 2) continue;
        for (const double factor : {-1.0, of_milli}) {
            others.push_back(now.reading);
            others.back().factors[joint.joint] = factor;
        }
    }
    return others;
}

// With two joints exchanged, or their torques alone.
std::vector<Reading> exchanged(const Chain& chain, const ReadArm& now) {
    std::vector<Reading> others;
    for (const ArmJointFit& one : now.fit.joints) {
        for (const ArmJointFit& other : now.fit.joints) {
            const std::size_t a = one.joint, b = other.joint;
            if (a >= b || chain.joints[a].kind != chain.joints[b].kind) continue;
            others.push_back(now.reading);
            std::swap(others.back().torque[a], others.back().torque[b]);
            others.push_back(others.back());
            std::swap(others.back().motion[a], others.back().motion[b]);
        }
    }
    return others;
}

}  // namespace

std::vector<SetupFault> suspect_arm(const Chain& chain, const ArmLog& log, const ArmFit& fit,
                                    const ArmFitOptions& options) {
    ArmFitOptions alike = options;
    alike.smoothing = fit.smoothing;
    const Readings readings(chain, log, alike);
    std::vector<std::size_t> places(log.joints.size());
    std::iota(places.begin(), places.end(), std::size_t{0});
    const ReadArm stated =
        readings.read({places, places, std::vector<double>(places.size(), 1.0), chain.gravity_m_s2}, &fit);
    ReadArm now = stated;
    while (auto better = readings.better(now, other_factors(now))) now = *std::move(better);
    // All signs reversed fit as well: friction decides.
    if (now.friction_drives) {
        for (const ArmJointFit& joint : fit.joints) now.reading.factors[joint.joint] *= -1.0;
        now = readings.read(now.reading);
    }
    std::vector<SetupFault> faults;
    for (const double factor : {-1.0, of_milli})
        if (auto fault = factor_fault(chain, stated, now, factor)) faults.push_back(*std::move(fault));
    if (const auto turned = readings.better(now, other_directions(now.reading))) {
        const std::string option = gravity_text(turned->reading.gravity_m_s2);
        faults.push_back({SetupFaultKind::gravity_direction,
                          fmt::format("gravity acts along another axis of the base: with {} the error on "
                                      "held-out fifths of the log is {:.2g} of that with {}",
                                      option, turned->error / now.error, gravity_text(chain.gravity_m_s2)),
                          option, 1.0, now.explained, turned->explained});
    }
    if (!faults.empty()) return faults;
    const auto better = readings.better(now, exchanged(chain, now));
    if (!better) return faults;
    std::vector<std::string> names;
    for (const std::size_t j : places)
        if (better->reading.torque[j] != j) names.push_back(chain.joints[j].name);
    faults.push_back({SetupFaultKind::wrong_joint,
                      fmt::format("{} {} are exchanged in the log: the other way round the error on held-out "
                                  "fifths is {:.2g} of this",
                                  better->reading.motion == places ? "the torques of joints" : "joints",
                                  fmt::join(names, " and "), better->error / now.error),
                      {},
                      1.0,
                      now.explained,
                      better->explained});
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
        std::vector<double> at_s(joint.time_s.begin(), joint.time_s.end());
        for (double& t : at_s) t += delay_s;
        torques_nm[j] = interpolate(joint.time_s, joint.torque_nm, at_s);
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
    constexpr int max_looks = 3;
    for (int look = 0; look < max_looks; ++look) {
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
