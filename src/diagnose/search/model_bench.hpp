// SPDX-License-Identifier: MIT
#pragma once
// A case with its noise, on which models are fitted and compared.

#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "diagnose/case/case.hpp"
#include "diagnose/case/noise_floor.hpp"
#include "diagnose/search/kept_screenings.hpp"
#include "diagnose/search/work.hpp"
#include "model/catalogue.hpp"
#include "ripplenotch/model/fit.hpp"

namespace ripplenotch {

/// Share of the noise floor below which a torque does not matter. Steps coarser than the noise bend whatever
/// is in the torque into shapes of their own, which are no effects.
[[nodiscard]] double material_sigma(const Case& looked_at, const DiagnosisRules& rules);
/// The name of the rule that says so.
[[nodiscard]] std::string_view material_rule(const Case& looked_at);

/// A model in hand: the terms of the user's model first, then those that were added.
struct Candidate {
    Model open;    ///< values to be fitted are empty
    Model stated;  ///< with them
    std::vector<FittedValue> values;
    std::vector<double> prices;  ///< one a term; 0 for the user's own
    double gain_left = 0.0;      ///< sum of squares in units of the noise's variance
    bool converged = true;

    [[nodiscard]] double criterion() const;
};

class KnownFit;

class ModelBench {
  public:
    /// `looked_at`, `work` and `rules` must outlive it. `kept`: of other benches on the same case.
    ModelBench(const Case& looked_at, const NoiseFloor& noise, Work& work, const DiagnosisRules& rules,
               std::shared_ptr<KeptScreenings> kept = std::make_shared<KeptScreenings>());

    /// Takes up the motion errors of this model: what can be blamed on them is no gap.
    void settle_on(const Model& model);

    [[nodiscard]] Candidate fitted(const Model& open, const Model& first_guess, std::vector<double> prices,
                                   int most_iterations = 8, double settled = 1e-7) const;
    /// The same model with the errors of its values, which a search does not ask for.
    [[nodiscard]] Candidate with_errors(Candidate model) const;
    /// The same model at its very best, with errors that do not take the noise for white.
    [[nodiscard]] Candidate settled(const Candidate& model) const;
    /// Weighed measured less predicted torque, in units of the noise, a number per row().
    [[nodiscard]] std::vector<double> residual(const Model& stated) const;
    /// Measured less predicted torque; what is uncertain of the known torque has its best values.
    [[nodiscard]] std::vector<double> raw_residual(const Model& stated) const;
    /// A torque whitened, in units of the noise, a number per row().
    [[nodiscard]] std::vector<double> whitened(std::span<const double> torque_nm) const;
    /// The same without what errors of the measured motion can explain; an entry per row().
    [[nodiscard]] std::vector<double> cleared_residual(const Model& stated) const;
    /// What this term of the model adds to all its others, in Nm; an entry per sample, counted or not.
    [[nodiscard]] std::vector<double> torque_of(const Model& stated, std::size_t term) const;

    /// rms torque that `with` explains beyond `without`, in units of the noise's rms.
    [[nodiscard]] double share(const Candidate& with, const Candidate& without) const;
    /// rms of the residual that the noise and the errors of the measured motion leave.
    [[nodiscard]] double floor_nm(const Model& stated) const;

    [[nodiscard]] const Case& looked_at() const { return case_; }
    [[nodiscard]] const DiagnosisRules& rules() const { return rules_; }
    /// Share of the noise floor below which a torque does not matter in `looked_at`.
    [[nodiscard]] double material_sigma() const { return ripplenotch::material_sigma(case_, rules_); }
    [[nodiscard]] Work& work() const { return work_; }
    /// Whether what no effect explains is part of the noise.
    [[nodiscard]] bool noise_holds_residual() const { return noise_.material_nm < noise_.rms_nm; }
    [[nodiscard]] const NoiseFloor& noise() const { return noise_; }
    [[nodiscard]] const std::vector<std::size_t>& rows() const { return weighing_.rows(); }
    [[nodiscard]] double samples() const { return static_cast<double>(weighing_.rows().size()); }

    /// What screenings along this case found, whichever bench they were made on.
    [[nodiscard]] const std::shared_ptr<KeptScreenings>& kept() const { return kept_; }
    /// Sum of squares by which two models may differ for what was found beside one to hold beside the other.
    [[nodiscard]] double same_model_nm2() const;

  private:
    [[nodiscard]] Candidate fitted(const Model& open, std::vector<double> prices,
                                   const FitOptions& options) const;
    /// The weighing of a model whose sensors are not those that were settled on.
    struct OwnWeighing {
        std::vector<Term> beside;  ///< the sensors
        std::optional<Weighing> other;
    };
    [[nodiscard]] OwnWeighing weighing_of(const Model& model) const;
    [[nodiscard]] std::vector<Nuisance> errors_of(const Model& model) const;

    mutable Carriers carriers_;
    const Case& case_;
    NoiseFloor noise_;
    Work& work_;
    const DiagnosisRules& rules_;
    Weighing weighing_;
    bool is_settled_ = false;
    std::vector<Term> sensors_;    ///< of the model settled on
    std::vector<Nuisance> walks_;  ///< and what its angle's walk would leave
    double walks_beside_nm_ = 1.0;
    std::shared_ptr<KeptScreenings> kept_;
    std::shared_ptr<const KnownFit> known_;  ///< behind the sensors of the model settled on
};

}  // namespace ripplenotch
