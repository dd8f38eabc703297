// SPDX-License-Identifier: MIT
#pragma once
// Parts that several documents have.

#include <vector>

#include "document/archive/json_reader.hpp"
#include "document/archive/json_writer.hpp"
#include "ripplenotch/analysis/ripple_estimate.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/diagnose/diagnosis.hpp"
#include "ripplenotch/evaluate/contender.hpp"
#include "ripplenotch/filter/map_fit.hpp"
#include "ripplenotch/model/model.hpp"

namespace ripplenotch {

/// The gear whose ripple a result is about: {"ratio", "orders", "source"}.
void describe(JsonWriter& json, const GearAccount& gear);

void describe(JsonWriter& json, const RippleEstimate& one);

/// An entry of a delay ledger.
void describe(JsonWriter& json, const LedgerEntry& entry);

/// A change of filter at this time.
void describe_switch(JsonWriter& json, const Switch& change, Seconds time);
/// The change, and what it did to the output.
void describe(JsonWriter& json, const SwitchEntry& entry);

template <class Archive>
void describe_term(Archive& archive, Is<Term> auto& term, const Model& model) {
    if constexpr (Archive::reading) {
        // The catalogue answers an unknown name as a wrong request; in a file it is wrong data.
        try {
            term.effect = &find_effect(archive.text("effect"));
        } catch (const UsageError& error) {
            raise<DataError>("{}: {}", archive.where("effect"), error.what());
        }
        term.values.resize(term.effect->parameters.size());
    } else {
        archive("effect", term.effect->name);
    }
    for (std::size_t p = 0; p < term.values.size(); ++p) {
        const Parameter& parameter = term.effect->parameters[p];
        archive(parameter.name, term.values[p], if_any);
        if constexpr (Archive::reading) {
            const double least = min_in(model, *term.effect, p);
            if (term.values[p] && !(least <= *term.values[p] && *term.values[p] <= parameter.upper))
                raise<DataError>("{} is {}, expected a number between {} and {} {}",
                                 archive.where(parameter.name), shortest(*term.values[p]), shortest(least),
                                 shortest(parameter.upper), parameter.unit);
        }
    }
}

/// The gear ratio of a table or a map: null where its orders count by turns of the joint.
template <class Archive>
void describe_ratio(Archive& archive, auto& ratio) {
    if (archive.known("gear_ratio", ratio != no_ratio, ratio, above_zero)) return;
    if constexpr (Archive::reading) ratio = no_ratio;
}

/// What stands for the ratio of a model that has none, and no effect that needs one.
inline constexpr const char* unknown_gear_ratio = "unknown";

/// "gear_ratio" and "effects"; the caller knows whether the model has a simulation.
template <class Archive>
void describe(Archive& archive, Is<Model> auto& model) {
    // "unknown" is said and not left out, so that a ratio that was forgotten is still asked for.
    bool is_known = model.has_gear_ratio();
    if constexpr (Archive::reading) {
        const Json* ratio = archive.find("gear_ratio");
        is_known = ratio == nullptr || *ratio != unknown_gear_ratio;
    } else if (!is_known) {
        archive.put("gear_ratio", unknown_gear_ratio);
    }
    if (is_known) archive("gear_ratio", model.gear_ratio, above_zero_up_to(largest_gear_ratio.value()));
    archive.each(
        "effects", model.terms, [&](Archive& entry, auto& term) { describe_term(entry, term, model); },
        AtMost{max_effects});
    if constexpr (Archive::reading) {
        for (const Term& term : model.terms)
            if (!is_known && needs_gear_ratio(*term.effect))
                raise<DataError>("{} is \"{}\", and {} needs it; state the ratio",
                                 archive.where("gear_ratio"), unknown_gear_ratio, term.effect->name);
    }
}

/// The member `ripple_map` of a model.json.
void describe(JsonWriter& json, const MapFit& fit);
void describe(JsonReader& reader, MapFit& fit);

}  // namespace ripplenotch
