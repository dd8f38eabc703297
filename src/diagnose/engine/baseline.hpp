// SPDX-License-Identifier: MIT
#pragma once
// What every model of the search contains: the user's known torque and terms, and nuisance columns.

#include <complex>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "diagnose/engine/recorded_motion.hpp"
#include "diagnose/engine/terms.hpp"
#include "ripplenotch/model/model.hpp"

namespace ripplenotch::engine {

/// A column of every model, along the clock. Its factor is drawn towards 0 with this standard deviation.
struct BaseColumn {
    std::string name;  ///< the effect's; "simulated"; "nuisance"
    std::vector<double> torque_nm;
    double deviation = std::numeric_limits<double>::infinity();
    bool bears_load = false;
    [[nodiscard]] bool has_prior() const { return deviation < std::numeric_limits<double>::infinity(); }
};

/// The user's side of a diagnosis.
struct KnownSide {
    const Model* model = nullptr;  ///< its ripple orders, and its terms where nothing is simulated
    std::span<const GivenTerm> given_terms = {};  ///< columns with priors, an entry per row of the log
    bool is_simulated = false, is_scale_known = false;
};

struct Baseline {
    std::vector<BaseColumn> columns;
    std::vector<double> known_nm;  ///< torque at the prior means, subtracted; empty where it is 0
    std::size_t inertia_place = 0;
    double known_inertia_nm_per_deg_s2 = 0.0;      ///< that is part of known_nm
    double simulated_inertia_nm_per_deg_s2 = 0.0;  ///< of a simulation
    std::vector<double> orders;                    ///< of the model's ripple, in cycles per motor revolution
    GearRatio ratio;
    SearchedTerms stated;  ///< sensors, an elastic joint and errors of the position that the model states
    /// What the ripple changes that the model states make of each order; empty: it states none.
    std::vector<std::vector<std::complex<double>>> ripple_gain;
    bool is_simulated = false;      ///< a simulation holds what is not in the model
    bool is_scale_known = false;    ///< there is a simulation, and its torque is part of known_nm
    std::vector<double> direction;  ///< of the motion: -1 to 1, over 0.5 deg/s

    /// Cosine and sine columns of each order, with the changes that the model states.
    [[nodiscard]] std::vector<std::vector<double>> ripple_waves(const Motion& motion, GearRatio at) const;
    /// A free column of this effect.
    [[nodiscard]] bool has(std::string_view name) const;
    /// Its size is known within a prior: of a mass or of a scale.
    [[nodiscard]] bool is_known(std::string_view name) const;
    /// A column of this effect at the user's value.
    [[nodiscard]] bool states(std::string_view name) const;
};

/// `inertia_nm_per_deg_s2`, where an estimate is known, bounds what smoothing and an elastic gear make of the
/// inertia's torque.
[[nodiscard]] Baseline make_baseline(const RecordedMotion& recorded, const KnownSide& known,
                                     std::optional<double> inertia_nm_per_deg_s2);

/// Cosine and sine columns of each order at a gear ratio.
[[nodiscard]] std::vector<std::vector<double>> ripple_columns(const Motion& motion,
                                                              std::span<const double> orders,
                                                              GearRatio ratio);

}  // namespace ripplenotch::engine
