// SPDX-License-Identifier: MIT
#include "document/fields/beside_fields.hpp"

namespace ripplenotch {
namespace {

constexpr std::string_view simulated = "simulated";

}  // namespace

void put_beside(Json& json, const Diagnosis& diagnosis) {
    for (const GivenValue& value : diagnosis.given) {
        // An arm's values are of combinations of links, which nobody reads one by one.
        if (value.name == simulated) json["simulated"] = {{"scale", six_digits(value.value)}};
    }
    if (diagnosis.residual_in_noise) json["residual_in_noise"] = true;
}

void read_beside(Fields& fields, Diagnosis& diagnosis) {
    if (fields.has("residual_in_noise")) diagnosis.residual_in_noise = fields.flag("residual_in_noise");
    if (!fields.has("simulated")) return;
    Fields given = fields.object("simulated");
    diagnosis.given.push_back({std::string(simulated), given.number("scale"), std::nullopt});
    given.finish();
}

}  // namespace ripplenotch
