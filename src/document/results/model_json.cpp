// SPDX-License-Identifier: MIT
#include "ripplenotch/document/model_json.hpp"

#include <string_view>
#include <utility>

#include "document/fields/fields.hpp"
#include "document/fields/result_fields.hpp"

namespace ripplenotch {

void describe(auto& archive, Is<SimulatedTerm> auto& term) {
    archive("column", term.column);
    archive("scale", term.scale);
    archive("delay_s", term.delay_s, if_there);
}

template <class Archive>
void describe(Archive& archive, Is<ModelWithGiven> auto& given) {
    archive("simulated", given.simulated, if_any);
    archive("arm", given.arm, if_any);
    archive("ripple_map", given.ripple, if_any);
    if constexpr (Archive::reading) given.model.beside_simulation = given.simulated.has_value();
    describe(archive, given.model);
    if constexpr (Archive::reading) {
        for (const Term& term : given.model.terms)
            if (given.arm && (term.effect->name == "gravity" || term.effect->name == "inertia"))
                raise<DataError>("{}: {} is part of arm; remove one of the two", archive.source(),
                                 term.effect->name);
    }
}

std::string write_model(const ModelWithGiven& model, const Provenance& provenance) {
    return to_text(document_of("model", provenance, model));
}

std::string write_model(const Model& model, const Provenance& provenance) {
    return write_model(ModelWithGiven{model}, provenance);
}

ModelWithGiven read_model_with_given(std::string_view text, const std::string& source) {
    return result_of<ModelWithGiven>(text, source, "model");
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
