// SPDX-License-Identifier: MIT
#pragma once
// The log as names are weighed against it: what is left of torque and columns when they are whitened by the
// leftover's own colour and the always-on columns are taken out.

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "diagnose/beside/weighing/always_on.hpp"
#include "diagnose/beside/weighing/ground.hpp"
#include "diagnose/beside/weighing/ridge.hpp"
#include "diagnose/beside/weighing/shapes.hpp"
#include "ripplenotch/model/prediction.hpp"

namespace ripplenotch {

class Lens {
  public:
    /// `rules` and `work` must outlive it. `model`: the user's effects, fitted, with those that are
    /// believed already; they are always on. What gear and bearings carry of the given terms is fitted where
    /// the motion does not say it.
    Lens(const Case& looked_at, const Candidate& model, std::span<const GivenTerm> given,
         std::span<const Effect* const> effects, const DiagnosisRules& rules, Work& work);
    /// The same log made white as `like` does, so that what two models leave of it can be compared.
    Lens(const Lens& like, const Candidate& model, std::span<const GivenTerm> given,
         std::span<const Effect* const> effects);
    /// The log of `like` from the start, by other rules.
    Lens(const Lens& like, const Candidate& model, std::span<const GivenTerm> given,
         std::span<const Effect* const> effects, const DiagnosisRules& rules);
    struct OffsetIsOpen {};
    /// `like` with the model that it has, whose columns it shares, but that the offset is not always on.
    Lens(OffsetIsOpen, const Lens& like, const Candidate& model, std::span<const Effect* const> effects);
    Lens(const Lens&) = delete;
    Lens& operator=(const Lens&) = delete;

    [[nodiscard]] const std::vector<Shape>& shapes() const { return shapes_; }
    [[nodiscard]] const ScaleBounds& bounds() const { return bounds_; }
    [[nodiscard]] const Ground& ground() const { return ground_; }
    [[nodiscard]] const AlwaysOn& columns() const { return columns_->always; }
    [[nodiscard]] const DiagnosisRules& rules() const { return rules_; }
    [[nodiscard]] const Model& model() const { return prediction_->model(); }

    /// Torque of the shape over the samples of the case, a column each.
    [[nodiscard]] std::vector<std::vector<double>> torque_nm(const Shape& shape) const;
    struct Weighed {
        std::vector<std::vector<double>> columns;  ///< ground().rows() values each
        double part =
            0.0;  ///< of the whitened columns that the always-on ones leave, of the one of which most is left
    };
    [[nodiscard]] Weighed weighed(const Shape& shape) const;
    /// Its torque at the ground's samples.
    [[nodiscard]] std::vector<std::vector<double>> thinned_nm(const Shape& shape) const;
    /// `weighed` of what rings of a ripple: without the plain one, whose thinned_nm are `plain_nm`.
    [[nodiscard]] Weighed weighed_ringing(const Shape& shape,
                                          const std::vector<std::vector<double>>& plain_nm) const;
    [[nodiscard]] std::vector<double> weighed(std::span<const double> torque_nm) const;
    /// The measured torque less the model's own and the given terms' means, weighed.
    [[nodiscard]] const std::vector<double>& target() const { return target_; }
    /// The same, had the torque been logged so many samples of the case earlier; at the ends of a stretch its
    /// first or last sample stays.
    [[nodiscard]] std::vector<double> target_earlier(std::ptrdiff_t samples) const;
    /// rms of the whitened residual of a model of everything at once: the unit of gains.
    [[nodiscard]] double sigma() const { return sigma_; }

    /// Values of the always-on columns, by plain least squares beside these torques: of the measured torque
    /// less all of them.
    [[nodiscard]] std::vector<double> plain_values(std::span<const double> explained_nm) const;
    /// rms that plain least squares leaves of the torque beside these torques.
    [[nodiscard]] double plain_left_nm(std::span<const double> explained_nm) const;
    /// Sizes of shapes by plain least squares with everything always-on beside them, in their order.
    [[nodiscard]] std::vector<double> plain_sizes(std::span<const Shape> shapes) const;
    /// The measured torque less the model's own and the given terms' means.
    [[nodiscard]] const std::vector<double>& open_nm() const { return open_nm_; }
    /// The case with what the given terms carry in its motion.
    [[nodiscard]] const Case& looked_at() const { return case_; }

  private:
    using Columns = std::vector<std::vector<double>>;
    struct HeldColumns {
        AlwaysOn always;
        Columns bridged, white;
    };
    Lens(const Case& looked_at, const DiagnosisRules& rules, Work& work, const Candidate& model);
    [[nodiscard]] std::shared_ptr<HeldColumns> columns_of(const Candidate& model,
                                                          std::span<const GivenTerm> given) const;
    void begin(const Candidate& model, std::shared_ptr<HeldColumns> columns,
               std::span<const Effect* const> effects);
    void whiten();
    void carry(std::span<const GivenTerm> given, const Candidate& model);
    void take_color(const Lens& like);
    /// What everything at once leaves of the bridged torque.
    [[nodiscard]] std::vector<double> left_by_all() const;
    [[nodiscard]] Columns bridged(const Columns& columns) const;
    /// What rings of a ripple whose torque along the motion is this.
    [[nodiscard]] Columns ringing_nm(const Shape& shape, const Motion& motion, const Columns& plain_nm) const;
    [[nodiscard]] Weighed weighed(const Columns& bridged_nm) const;

    Case case_;  ///< with what the given terms carry
    const DiagnosisRules& rules_;
    Work& work_;
    Ground ground_;
    Motion thin_;  ///< at the ground's samples
    ScaleBounds bounds_;
    std::optional<Prediction> prediction_;
    std::vector<Shape> shapes_;
    std::vector<double> open_nm_, bridged_open_;
    std::shared_ptr<HeldColumns> columns_;  ///< of an arm they are most of what a diagnosis holds
    std::vector<double> deviation_;         ///< of the always-on values
    std::optional<Ridge> plain_, white_;
    std::vector<double> target_, color_;
    double sigma_ = 0.0, left_nm_ = 0.0;
};

}  // namespace ripplenotch
