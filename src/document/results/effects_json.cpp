// SPDX-License-Identifier: MIT
#include "ripplenotch/document/effects_json.hpp"

#include "document/fields/document_head.hpp"
#include "document/json/json.hpp"

namespace ripplenotch {
namespace {

std::string_view left_out_name(LeftOut left_out) {
    switch (left_out) {
        case LeftOut::fitted:
            return "fitted";
        case LeftOut::refused:
            return "refused";
        default:
            return "assumed";
    }
}

Json parameter_json(const Parameter& parameter) {
    return {{"name", parameter.name},       {"unit", parameter.unit},
            {"neutral", parameter.neutral}, {"first_guess", parameter.start},
            {"lower", parameter.lower},     {"upper", parameter.upper},
            {"linear", parameter.linear},   {"left_out", left_out_name(parameter.left_out)},
            {"meaning", parameter.help}};
}

Json effect_json(const Effect& effect) {
    Json json = {{"effect", effect.name},        {"side", side_name(effect.side)},
                 {"summary", effect.summary},    {"equation", effect.equation},
                 {"parameters", Json::array()},  {"symptom", effect.symptom},
                 {"look_alikes", Json::array()}, {"source", effect.source}};
    for (const Parameter& parameter : effect.parameters)
        list_in(json, "parameters").push_back(parameter_json(parameter));
    for (const LookAlike& other : effect.look_alikes) {
        list_in(json, "look_alikes")
            .push_back({{"name", other.name}, {"when", other.when}, {"told_by", other.told_by}});
    }
    return json;
}

}  // namespace

std::string write_catalogue(std::span<const Effect* const> effects, const Provenance& provenance) {
    Json json = document_head("effects", provenance);
    json["effects"] = Json::array();
    for (const Effect* effect : effects) list_in(json, "effects").push_back(effect_json(*effect));
    return to_text(json);
}

}  // namespace ripplenotch
