// SPDX-License-Identifier: MIT
#pragma once
// model.json: a model of a joint as people and commands write it; docs/formats/model.md describes it.

#include <optional>
#include <string>
#include <string_view>

#include "ripplenotch/arm/arm_fit.hpp"
#include "ripplenotch/document/provenance.hpp"
#include "ripplenotch/filter/map_fit.hpp"
#include "ripplenotch/model/model.hpp"

namespace ripplenotch {

// The member `simulated` of a model.json: the torque of the user's own simulation as a part of the model.

struct SimulatedTerm {
    std::string column;           ///< of the log, or of the simulation's own
    std::optional<double> scale;  ///< empty: 1, and whether it is another is one of a diagnosis' questions
    double delay_s = 0.0;         ///< by which the column is later than the log
};

/// A model with what is given beside its effects.
struct ModelWithGiven {
    Model model;
    std::optional<SimulatedTerm> simulated = {};
    std::optional<StatedArm> arm = {};
    std::optional<MapFit> ripple = {};  ///< of the joint's own motor and of others

    [[nodiscard]] bool any_given() const { return simulated || arm; }
};

/// Text of model.json. Values that the model does not state are left out.
[[nodiscard]] std::string write_model(const Model& model, const Provenance& provenance);
[[nodiscard]] std::string write_model(const ModelWithGiven& model, const Provenance& provenance);

/// Reads model.json; `source` is its name in messages. A parameter left out is to be fitted. Throws
/// DataError: not JSON, another schema, an unknown effect, parameter or field, a value out of its bounds, no
/// gear ratio.
[[nodiscard]] Model read_model(std::string_view text, const std::string& source);

/// The same for commands that know what to do with a `simulated` or an `arm`; read_model refuses both. Throws
/// DataError for an arm beside gravity or inertia, too, which are part of it.
[[nodiscard]] ModelWithGiven read_model_with_given(std::string_view text, const std::string& source);

}  // namespace ripplenotch
