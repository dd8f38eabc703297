// SPDX-License-Identifier: MIT
#include "document/fields/angle_fields.hpp"

namespace ripplenotch {

void put_angle(Json& json, const Diagnosis& diagnosis) {
    if (!diagnosis.angle) return;
    const auto& start = diagnosis.angle->validation_start_deg;
    json["angle"] = {{"walk_deg", six_digits(diagnosis.angle->walk_deg)},
                     {"validation_start_deg", start ? six_digits(*start) : Json(nullptr)}};
}

void read_angle(Fields& fields, Diagnosis& diagnosis) {
    if (!fields.has("angle")) return;
    Fields angle = fields.object("angle");
    AngleAccount& account = diagnosis.angle.emplace();
    account.walk_deg = angle.number("walk_deg");
    account.validation_start_deg = angle.number_if_any("validation_start_deg");
    angle.finish();
}

}  // namespace ripplenotch
