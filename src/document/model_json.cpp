// SPDX-License-Identifier: MIT
#include "ripplenotch/document/model_json.hpp"

#include "document/model_fields.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {
namespace {

Json term_json(const Term& term) {
    Json json;
    json["effect"] = term.effect->name;
    for (std::size_t p = 0; p < term.values.size(); ++p) {
        if (term.values[p]) json[std::string(term.effect->parameters[p].name)] = *term.values[p];
    }
    return json;
}

Term term_of(Fields& fields) {
    const Effect& effect = effect_of(fields);
    Term term{&effect, {}};
    for (const Parameter& parameter : effect.parameters) {
        if (!fields.has(parameter.name)) {
            term.values.emplace_back();
            continue;
        }
        const double value = fields.number(parameter.name);
        if (!allows(parameter, value)) {
            raise<DataError>("{} is {}, expected a number between {} and {} {}", fields.where(parameter.name),
                             shortest(value), shortest(parameter.lower), shortest(parameter.upper),
                             parameter.unit);
        }
        term.values.emplace_back(value);
    }
    return term;
}

}  // namespace

void put_model(Json& json, const Model& model) {
    json["gear_ratio"] = model.gear_ratio.value();
    json["effects"] = Json::array();
    for (const Term& term : model.terms) json["effects"].push_back(term_json(term));
}

std::string write_model(const Model& model, const Provenance& provenance) {
    Json json = document_head("model", provenance);
    put_model(json, model);
    return to_text(json);
}

// The catalogue answers an unknown name as a wrong request; in a file it is wrong data, and the file must be
// named.
const Effect& effect_of(Fields& fields) {
    try {
        return find_effect(fields.text("effect"));
    } catch (const UsageError& error) {
        raise<DataError>("{}: {}", fields.where("effect"), error.what());
    }
}

Model model_of(Fields& fields) {
    Model model;
    model.gear_ratio = GearRatio(fields.number("gear_ratio"));
    if (!(model.gear_ratio.value() > 0.0 && model.gear_ratio <= largest_gear_ratio)) {
        raise<DataError>("{} is {}, expected a number above 0 and at most {}", fields.where("gear_ratio"),
                         shortest(model.gear_ratio.value()), shortest(largest_gear_ratio.value()));
    }
    fields.each("effects", [&](Fields& entry) { model.terms.push_back(term_of(entry)); });
    return model;
}

Model read_model(std::string_view text, const std::string& source) {
    const Json json = parse_document(text, source, "model");
    Fields fields(json, source, "");
    fields.ignore_head();
    Model model = model_of(fields);
    fields.finish();
    return model;
}

}  // namespace ripplenotch
