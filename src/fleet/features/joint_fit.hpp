// SPDX-License-Identifier: MIT
#pragma once
// Internal: the model of a joint, fitted to one log, with only the terms that are identifiable from its
// motion.

#include <span>
#include <string>
#include <vector>

#include "fleet/features/motion_facts.hpp"
#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/fleet/features.hpp"
#include "ripplenotch/model/fit.hpp"

namespace ripplenotch {

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
