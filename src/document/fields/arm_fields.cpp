// SPDX-License-Identifier: MIT
#include "document/fields/arm_fields.hpp"

#include <algorithm>
#include <array>
#include <span>
#include <utility>

#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {
namespace {

constexpr std::string_view prismatic = "prismatic";

// Of the ten values of a link: which field, from where on, how many.
struct LinkField {
    std::string_view name;
    std::size_t first, count;
};
constexpr std::array link_fields = {LinkField{"mass_kg", 0, 1}, LinkField{"first_moment_kgm", 1, 3},
                                    LinkField{"inertia_kgm2", 4, 6}};

template <class Nuisance>
auto nuisance_fields(Nuisance& nuisance) {
    return std::array{std::pair(std::string_view("offset_nm"), &nuisance.offset_nm),
                      std::pair(std::string_view("coulomb_nm"), &nuisance.coulomb_nm),
                      std::pair(std::string_view("viscous_nm_per_deg_s"), &nuisance.viscous_nm_per_deg_s),
                      std::pair(std::string_view("stribeck_nm"), &nuisance.stribeck_nm)};
}

Json vector_json(const Vector3& vector) { return {vector[0] + 0.0, vector[1] + 0.0, vector[2] + 0.0}; }

Json joint_json(const ChainJoint& joint, const std::string& log) {
    Json json{{"name", joint.name}, {"log", log}};
    if (joint.kind == JointKind::prismatic) json["kind"] = prismatic;
    json["xyz_m"] = vector_json(joint.origin_m);
    json["rpy_deg"] = vector_json(rpy_of_rotation(joint.rotation));
    json["axis"] = vector_json(joint.axis);
    return json;
}

Json link_json(std::span<const double> values) {
    Json json = Json::object();
    for (const LinkField& field : link_fields) {
        Json list = Json::array();
        for (const double value : values.subspan(field.first, field.count)) list.push_back(value + 0.0);
        json[std::string(field.name)] = field.count == 1 ? list[0] : list;
    }
    return json;
}

std::vector<double> numbers_of(Fields& fields, std::string_view name, std::size_t count) {
    const std::vector<double> numbers = fields.numbers(name);
    if (numbers.size() != count)
        raise<DataError>("{} holds {} numbers, expected {}", fields.where(name), numbers.size(), count);
    return numbers;
}

Vector3 vector_of(Fields& fields, std::string_view name) {
    const auto numbers = numbers_of(fields, name, 3);
    return {numbers[0], numbers[1], numbers[2]};
}

void read_joint(Fields& entry, StatedArm& arm) {
    ChainJoint joint;
    joint.name = entry.text("name");
    arm.log_joints.push_back(entry.has("log") ? entry.text("log") : joint.name);
    if (entry.has("kind")) {
        const std::string kind = entry.text("kind");
        if (kind != prismatic && kind != "revolute")
            raise<DataError>("{} is '{}', expected revolute or prismatic", entry.where("kind"), kind);
        joint.kind = kind == prismatic ? JointKind::prismatic : JointKind::revolute;
    }
    joint.origin_m = vector_of(entry, "xyz_m");
    joint.rotation = rotation_of_rpy(vector_of(entry, "rpy_deg"));
    joint.axis = vector_of(entry, "axis");
    arm.chain.joints.push_back(std::move(joint));
}

void read_values(Fields& fields, StatedArm& arm) {
    const auto rotor = fields.number_if_any("rotor_inertia_kgm2");
    if (fields.has("identified")) (void)fields.text("identified");
    if (!fields.has("links")) return;
    ArmValues values{{}, rotor.value_or(0.0)};
    fields.each("links", [&](Fields& entry) {
        for (const LinkField& field : link_fields) {
            if (field.count == 1) {
                values.links.push_back(entry.number(field.name));
                continue;
            }
            const auto numbers = numbers_of(entry, field.name, field.count);
            values.links.insert(values.links.end(), numbers.begin(), numbers.end());
        }
    });
    if (values.links.size() != values_of_a_link * arm.chain.size())
        raise<DataError>("{} holds {} links for {} joints", fields.where("links"),
                         values.links.size() / values_of_a_link, arm.chain.size());
    arm.values = std::move(values);
}

}  // namespace

Json stated_arm_json(const StatedArm& arm) {
    Json json{{"source", arm.chain.source}, {"joint", arm.joint}};
    json["gravity_m_s2"] = vector_json(arm.chain.gravity_m_s2);
    json["joints"] = Json::array();
    for (std::size_t j = 0; j < arm.chain.size(); ++j)
        list_in(json, "joints").push_back(joint_json(arm.chain.joints[j], arm.log_joints[j]));
    if (arm.chain.lengths_are_guessed) json["lengths_are_guessed"] = true;
    if (arm.smoothing) json["smoothing_s"] = arm.smoothing->value();
    if (arm.values) {
        json["identified"] = "torque";
        json["links"] = Json::array();
        for (std::size_t j = 0; j < arm.chain.size(); ++j)
            list_in(json, "links")
                .push_back(
                    link_json(std::span(arm.values->links).subspan(j * values_of_a_link, values_of_a_link)));
        json["rotor_inertia_kgm2"] = arm.values->rotor_inertia_kgm2;
    }
    Json nuisance = Json::object();
    for (const auto& [name, value] : nuisance_fields(arm.nuisance))
        if (*value != 0.0) nuisance[std::string(name)] = *value;
    if (!nuisance.empty()) json["nuisance"] = nuisance;
    return json;
}

StatedArm stated_arm_of(Fields& fields, const std::string& source) {
    StatedArm arm;
    arm.chain.source = fields.has("source") ? fields.text("source") : source;
    arm.joint = fields.text("joint");
    if (fields.has("gravity_m_s2")) arm.chain.gravity_m_s2 = vector_of(fields, "gravity_m_s2");
    fields.each("joints", [&](Fields& entry) { read_joint(entry, arm); });
    if (fields.has("lengths_are_guessed")) arm.chain.lengths_are_guessed = fields.flag("lengths_are_guessed");
    settle_chain(arm.chain);
    if (!arm.chain.find(arm.joint))
        raise<DataError>("{} is '{}', expected one of joints", fields.where("joint"), arm.joint);
    if (const auto smoothing = fields.number_if_any("smoothing_s")) {
        if (!(*smoothing > 0.0 && *smoothing <= 10.0))
            raise<DataError>("{} is {}, expected a number above 0 and at most 10",
                             fields.where("smoothing_s"), shortest(*smoothing));
        arm.smoothing = Seconds(*smoothing);
    }
    read_values(fields, arm);
    if (fields.has("nuisance")) {
        Fields nuisance = fields.object("nuisance");
        for (const auto& [name, value] : nuisance_fields(arm.nuisance))
            *value = nuisance.number_if_any(name).value_or(0.0);
        nuisance.finish();
    }
    fields.finish();
    return arm;
}

}  // namespace ripplenotch
