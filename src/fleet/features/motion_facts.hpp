// SPDX-License-Identifier: MIT
#pragma once
// Internal: in which rows of a log the joint's motion is known, and what it lets be determined of the joint.
// Where the speed jumps, the acceleration is unknown, and a speed smoothed over the jump is none that the
// joint had.

#include <span>
#include <string>
#include <vector>

#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/core/trace.hpp"
#include "ripplenotch/fleet/features.hpp"
#include "ripplenotch/model/effect.hpp"
#include "ripplenotch/model/fit.hpp"

namespace ripplenotch {

/// A 1 for each row within whose smoothing window the logged speed is that of `motion`, to 8 deviations of
/// its noise or a fiftieth of the usual speed; else 0. `motion` is motion_along(log).
[[nodiscard]] std::vector<unsigned char> rows_of_known_motion(const TraceView& log, const Motion& motion);

/// The identifiability of inertia from the acceleration in the rows of known motion.
struct Accelerations {
    bool known = false;          ///< separable from direction and speed, and above the noise
    bool like_friction = false;  ///< known only along with direction and speed: inertia and friction alike
};
[[nodiscard]] Accelerations accelerations_of(const TraceView& log, const Motion& motion,
                                             const std::vector<unsigned char>& rows);

struct MotionFacts {
    MotionMix mix;
    double moving_deg_s = 0.0;     ///< slower samples count as resting
    double speed_rms_deg_s = 0.0;  ///< rms speed of all samples
    double acceleration_rms_rad_s2 = 0.0;
    bool has_position = false;
    Accelerations accelerations;

    [[nodiscard]] bool both_directions() const;
    [[nodiscard]] bool several_speeds() const;
};

/// The input of a fit: a motion, its torque, and a 1 for each sample that counts.
struct FittedSamples {
    Motion motion;
    std::vector<double> torque_nm;
    std::vector<unsigned char> use;
};

/// At most so many samples, evenly spread.
[[nodiscard]] FittedSamples thinned(const Motion& motion, std::span<const double> torque_nm,
                                    std::span<const unsigned char> use, std::size_t most);

[[nodiscard]] MotionFacts motion_facts(const Motion& motion, std::span<const double> torque_nm,
                                       bool has_position);

/// Samples that count, of less way than that since the joint last reversed.
[[nodiscard]] std::size_t samples_after_reversals(const Motion& motion, std::span<const unsigned char> use,
                                                  double max_deg);

/// At standstill, presliding friction without a fitted angle may have any value: only samples that move
/// count. All samples count where too few move for a fit.
[[nodiscard]] std::vector<unsigned char> moving_samples(const Motion& motion, std::vector<unsigned char> use,
                                                        double moving_deg_s);

/// Before the joint has moved, its friction may stand anywhere: the samples of its first way do not count.
void leave_out_start(const Motion& motion, double way_deg, std::vector<unsigned char>& use);

// Internal: the model of a joint, fitted to one log, with only the terms that are identifiable from its
// motion.

class JointFit {
  public:
    /// All must outlive it. The ripple at the orders of the gear is fitted along and not reported: see
    /// estimate_ripple(). Throws DataError for too few samples.
    JointFit(const FittedSamples& samples, const MotionFacts& facts, std::optional<GearAccount> gear);

    // Each gives its descriptor value and interval, or the reason why it has none.
    void coulomb_friction(Descriptor& one) const;
    void viscous_friction(Descriptor& one) const;
    void load_friction(Descriptor& one) const;
    void lost_motion(Descriptor& one) const;
    void inertia(Descriptor& one) const;
    void gravity(Descriptor& one) const;
    void sensor_zero(Descriptor& one) const;
    /// rms torque of inertia and gravity; empty where neither is fitted.
    [[nodiscard]] std::optional<double> load_rms_nm() const;

    /// rms of the white noise, from second differences of the residual.
    [[nodiscard]] double noise_nm() const;

  private:
    void add_term(const std::string& spec);
    void build();
    void refine();
    [[nodiscard]] bool winds(std::size_t place, double friction_nm, FitOptions options);
    [[nodiscard]] std::vector<unsigned char> near_samples() const;
    [[nodiscard]] std::string one_way() const;
    [[nodiscard]] std::string one_speed() const;
    /// `carrier`: rms torque in Nm of a value of 1.
    void estimate(Descriptor& one, const std::string& effect, const std::string& parameter, double carrier,
                  std::string reason) const;
    [[nodiscard]] const FittedValue* fitted(const std::string& effect, const std::string& parameter) const;

    const Motion& motion_;
    const std::vector<double>& torque_nm_;
    const std::vector<unsigned char>& known_;
    const MotionFacts& facts_;
    std::optional<GearAccount> gear_;
    std::string no_wind_;  ///< why the presliding angle of friction is not identifiable; empty: it is
    Model model_;
    Fit fit_;
};

}  // namespace ripplenotch
