// SPDX-License-Identifier: MIT
#pragma once
// A model along a motion, ready to compute how its torque changes with one of its terms: the operation that a
// fit and a screening need again and again.

#include <memory>
#include <optional>
#include <vector>

#include "ripplenotch/model/model.hpp"

namespace ripplenotch {

class Carriers;

class Prediction {
  public:
    /// `motion` must outlive it, and so must `carriers`, where there are any: they keep what many predictions
    /// along the same motion have in common, and leave their torques as they are but for rounding. Throws
    /// UsageError where predict_nm does.
    Prediction(Model model, const Motion& motion, Carriers* carriers = nullptr);
    ~Prediction();
    Prediction(Prediction&&) noexcept;
    Prediction& operator=(Prediction&&) noexcept;

    [[nodiscard]] const Model& model() const;
    /// predict_nm of the model, to the last bit where there are no carriers.
    [[nodiscard]] const std::vector<double>& torque_nm() const;
    /// predict_nm with the term appended, less torque_nm(). A joint effect is evaluated alone and taken
    /// through the sensors; any other costs a whole prediction.
    [[nodiscard]] std::vector<double> added(const Term& term) const;
    /// predict_nm with term `place` replaced by `term`, of the same effect, less torque_nm().
    [[nodiscard]] std::vector<double> changed(std::size_t place, const Term& term) const;

    /// The prediction of the model with the term appended, except for rounding. For a term that changes
    /// ripple alone (a change of the ripple, another gear ratio) only the ripple is recomputed; for any other
    /// the whole prediction. The motion and the carriers have to outlive it as well.
    [[nodiscard]] Prediction with(const Term& term) const;
    /// Made by with(), and every joint term that is no ripple has the very torque that it had before.
    [[nodiscard]] bool has_only_ripple_anew() const;
    /// The response of a further sensor to a torque behind this model's sensors: to torque_nm(), or to a
    /// slope of it. The motion that the torques see stays as it is, though the sensor may change it. Empty
    /// where the effect is no such sensor, or a converter comes after it.
    [[nodiscard]] std::optional<std::vector<double>> behind(const Term& sensor,
                                                            std::vector<double> torque_nm) const;

    /// How often an effect was run along the motion so far: what this has cost.
    [[nodiscard]] std::size_t applied() const;

  private:
    struct State;
    explicit Prediction(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

}  // namespace ripplenotch
