// SPDX-License-Identifier: MIT
#include "ripplenotch/document/model_json.hpp"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>
#include <vector>

#include "document/fields/fields.hpp"
#include "document/fields/result_fields.hpp"

namespace ripplenotch {

namespace {

constexpr Rounded no_minus_zero{[](double value) { return finite_or_null(value + 0.0); }};

std::string_view joint_kind_name(JointKind kind) {
    return kind == JointKind::prismatic ? "prismatic" : "revolute";
}

// The ten values of a link, in the order of ArmValues::links.
struct LinkValues {
    double mass = 0.0;
    Vector3 first_moment{};
    std::array<double, 6> inertia{};
};

}  // namespace

void describe(auto& archive, Is<LinkValues> auto& link) {
    archive("mass_kg", link.mass, no_minus_zero);
    archive("first_moment_kgm", link.first_moment, no_minus_zero);
    archive("inertia_kgm2", link.inertia, no_minus_zero);
}

namespace {

// By joint, the ten values of its link.
template <class Archive>
void describe_links(Archive& archive, auto& arm) {
    std::vector<LinkValues> links;
    if constexpr (!Archive::reading) {
        for (auto at = arm.values->links.begin(); at != arm.values->links.end(); at += values_of_a_link) {
            LinkValues& link = links.emplace_back();
            link.mass = *at;
            std::copy_n(at + 1, 3, link.first_moment.begin());
            std::copy_n(at + 4, 6, link.inertia.begin());
        }
    }
    archive("links", links);
    if constexpr (Archive::reading) {
        if (links.size() != arm.chain.size())
            raise<DataError>("{} holds {} links for {} joints", archive.where("links"), links.size(),
                             arm.chain.size());
        for (const LinkValues& link : links) {
            auto& values = arm.values->links;
            values.push_back(link.mass);
            values.insert(values.end(), link.first_moment.begin(), link.first_moment.end());
            values.insert(values.end(), link.inertia.begin(), link.inertia.end());
        }
    }
}

template <class Archive>
void describe_joints(Archive& archive, auto& arm) {
    archive.each("joints", arm.chain.joints, [&](Archive& entry, auto& joint) {
        entry("name", joint.name);
        if constexpr (Archive::reading) arm.log_joints.push_back(joint.name);
        entry("log", arm.log_joints[static_cast<std::size_t>(&joint - arm.chain.joints.data())], if_there);
        if (entry.holds("kind", joint.kind != JointKind::revolute))
            entry("kind", joint.kind, Names{joint_kind_name, JointKind::prismatic});
        entry("xyz_m", joint.origin_m, no_minus_zero);
        Vector3 rpy_deg = rpy_of_rotation(joint.rotation);
        entry("rpy_deg", rpy_deg, no_minus_zero);
        if constexpr (Archive::reading) joint.rotation = rotation_of_rpy(rpy_deg);
        entry("axis", joint.axis, no_minus_zero);
    });
}

}  // namespace

// DataError as well for a joint that the chain has not, and for links of another number of joints.
template <class Archive>
void describe(Archive& archive, Is<StatedArm> auto& arm) {
    if constexpr (Archive::reading) arm.chain.source = archive.source();
    archive("source", arm.chain.source, if_there);
    archive("joint", arm.joint);
    archive("gravity_m_s2", arm.chain.gravity_m_s2, no_minus_zero, if_there);
    describe_joints(archive, arm);
    archive("lengths_are_guessed", arm.chain.lengths_are_guessed, if_any);
    if constexpr (Archive::reading) {
        settle_chain(arm.chain);
        if (!arm.chain.find(arm.joint))
            raise<DataError>("{} is '{}', expected one of joints", archive.where("joint"), arm.joint);
    }
    archive("smoothing_s", arm.smoothing, if_any, above_zero_up_to(10.0));
    std::string identified = arm.values ? "torque" : "";
    archive("identified", identified, if_any);
    double rotor = arm.values ? arm.values->rotor_inertia_kgm2 : 0.0;
    const bool known = archive.holds("links", arm.values.has_value());
    if constexpr (Archive::reading)
        if (known) arm.values.emplace();
    if (known) describe_links(archive, arm);
    if (archive.holds("rotor_inertia_kgm2", known)) archive("rotor_inertia_kgm2", rotor);
    if constexpr (Archive::reading)
        if (known) arm.values->rotor_inertia_kgm2 = rotor;
}

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
