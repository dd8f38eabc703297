// SPDX-License-Identifier: MIT
#include "ripplenotch/document/model_json.hpp"

#include <string_view>
#include <utility>

#include "document/fields/arm_fields.hpp"
#include "document/fields/fields.hpp"
#include "document/fields/result_fields.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {
namespace {

Json term_json(const Term& term) {
    Json json = Json::object();
    json["effect"] = term.effect->name;
    for (std::size_t p = 0; p < term.values.size(); ++p) {
        if (term.values[p]) json[std::string(term.effect->parameters[p].name)] = *term.values[p];
    }
    return json;
}

Term term_of(Fields& fields, const Model& model) {
    const Effect& effect = effect_of(fields);
    Term term{&effect, {}};
    for (std::size_t p = 0; p < effect.parameters.size(); ++p) {
        const Parameter& parameter = effect.parameters[p];
        if (!fields.has(parameter.name)) {
            term.values.emplace_back();
            continue;
        }
        const double value = fields.number(parameter.name);
        const double least = least_in(model, effect, p);
        if (!(least <= value && value <= parameter.upper)) {
            raise<DataError>("{} is {}, expected a number between {} and {} {}", fields.where(parameter.name),
                             shortest(value), shortest(least), shortest(parameter.upper), parameter.unit);
        }
        term.values.emplace_back(value);
    }
    return term;
}

Json simulated_json(const SimulatedTerm& term) {
    Json json{{"column", term.column}};
    json["scale"] = term.scale ? Json(*term.scale) : Json(nullptr);
    json["delay_s"] = term.delay_s;
    return json;
}

SimulatedTerm simulated_of(Fields& fields) {
    SimulatedTerm term;
    term.column = fields.text("column");
    term.scale = fields.number_if_any("scale");
    term.delay_s = fields.number_if_any("delay_s").value_or(0.0);
    fields.finish();
    return term;
}

void refuse_twice(const Model& model, const std::string& source) {
    for (const Term& term : model.terms) {
        if (term.effect->name == "gravity" || term.effect->name == "inertia")
            raise<DataError>("{}: {} is part of arm; remove one of the two", source, term.effect->name);
    }
}

}  // namespace

void put_model(Json& json, const Model& model) {
    json["gear_ratio"] = model.gear_ratio.value();
    json["effects"] = Json::array();
    for (const Term& term : model.terms) list_in(json, "effects").push_back(term_json(term));
}

std::string write_model(const ModelWithGiven& model, const Provenance& provenance) {
    Json json = document_head("model", provenance);
    if (model.simulated) json["simulated"] = simulated_json(*model.simulated);
    if (model.arm) json["arm"] = stated_arm_json(*model.arm);
    put_model(json, model.model);
    return to_text(json);
}

std::string write_model(const Model& model, const Provenance& provenance) {
    return write_model(ModelWithGiven{model}, provenance);
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

Model model_of(Fields& fields, bool beside_simulation) {
    Model model;
    model.beside_simulation = beside_simulation;
    model.gear_ratio = GearRatio(fields.number("gear_ratio"));
    if (!(model.gear_ratio.value() > 0.0 && model.gear_ratio <= largest_gear_ratio)) {
        raise<DataError>("{} is {}, expected a number above 0 and at most {}", fields.where("gear_ratio"),
                         shortest(model.gear_ratio.value()), shortest(largest_gear_ratio.value()));
    }
    fields.each(
        "effects", [&](Fields& entry) { model.terms.push_back(term_of(entry, model)); }, most_effects);
    return model;
}

ModelWithGiven read_model_with_given(std::string_view text, const std::string& source) {
    const Json json = parse_document(text, source, "model");
    Fields fields(json, source, "");
    fields.ignore_head();
    ModelWithGiven found;
    found.model = model_of(fields, fields.has("simulated"));
    if (fields.has("simulated")) {
        Fields simulated = fields.object("simulated");
        found.simulated = simulated_of(simulated);
    }
    if (fields.has("arm")) {
        Fields arm = fields.object("arm");
        found.arm = stated_arm_of(arm, source);
        refuse_twice(found.model, source);
    }
    fields.finish();
    return found;
}

Model read_model(std::string_view text, const std::string& source) {
    ModelWithGiven found = read_model_with_given(text, source);
    if (found.simulated)
        raise<DataError>("{}: simulated is part of the model; this command has no log to read '{}' from",
                         source, found.simulated->column);
    if (found.arm)
        raise<DataError>("{}: an arm is part of the model; this command has no log of its joints", source);
    return std::move(found.model);
}

}  // namespace ripplenotch
