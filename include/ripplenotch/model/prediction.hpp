// SPDX-License-Identifier: MIT
#pragma once
// A model along a motion, ready to answer how its torque changes with one of its terms: what a fit and a
// screening ask for again and again.

#include <memory>
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

    /// How often an effect was run along the motion so far: what this has cost.
    [[nodiscard]] std::size_t applied() const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace ripplenotch
