// SPDX-License-Identifier: MIT
#include "document/fields/result_fields.hpp"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {

void describe(JsonWriter& json, const GearAccount& gear) {
    json.known("ratio", gear.has_ratio(), gear.ratio);
    json("orders", gear.orders);
    json("source", gear.source);
}

void describe(JsonWriter& json, const RippleEstimate& one) {
    json("order", one.order);
    json.known("amplitude_nm", one.searched(), one.amplitude_nm);
    json.known("standard_error_nm", one.searched(), one.standard_error_nm);
    json.known("detectable_nm", one.searched(), one.detectable_nm);
    json.known("false_alarm", one.searched(), one.false_alarm);
    json("phase_deg", one.phase_deg);
    json.known("present", one.searched(), one.present());
    json.known("slowest_deg_s", one.searched(), one.slowest_deg_s);
    json.known("fastest_deg_s", one.searched(), one.fastest_deg_s);
    json("cycles", one.cycles);
    json("insufficient", one.insufficient, null_if_empty);
}

void describe_switch(JsonWriter& json, const Switch& change, Seconds time) {
    json("time_s", time);
    json("sample", change.sample);
    json("from_band", change.from_band);
    json("to_band", change.to_band);
    json("speed_deg_s", change.speed_deg_s);
    json("jump_nm", change.jump_nm);
}

namespace {

// {"0.5": ms, "1": ms, ...}
template <class Times>
auto by_settle_band(const Times& settle) {
    return [&settle](JsonWriter& json) {
        for (std::size_t i = 0; i < settle_bands_percent.size(); ++i)
            json(shortest(settle_bands_percent[i]), settle[i], in_ms);
    };
}

}  // namespace

void describe(JsonWriter& json, const SwitchEntry& entry) {
    describe_switch(json, entry.change, entry.time);
    json("stretch_ms", entry.stretch, in_ms);
    json("error_before_nm", entry.error_before_nm);
    json("peak_error_nm", entry.peak_error_nm);
    json("peak_after_ms", entry.peak_after, in_ms);
    json.group("settle_ms", by_settle_band(entry.settle));
}

void describe(JsonWriter& json, const LedgerEntry& entry) {
    json("band", entry.band, if_any);
    if (entry.to.value() > 0.0) {
        json("speed_from_deg_s", entry.from);
        json("speed_to_deg_s", entry.to);
    }
    json("filter", entry.filter);
    json("dc_delay_ms", entry.dc_delay, in_ms);
    json("ramp_delay_ms", entry.ramp_delay, in_ms);
    json.group_if("settle_ms", entry.step, [](JsonWriter& settle, const StepMeasurement& step) {
        by_settle_band(step.settle)(settle);
    });
    json.known("overshoot_percent", entry.step.has_value(), entry.step ? entry.step->overshoot_percent : 0.0);
    json("phase_lag_deg", entry.phase_lag_deg);
    json("crossover_db", entry.crossover_db);
}

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

template <class Archive>
void describe_arm(Archive& archive, auto& arm) {
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

}  // namespace

void describe(JsonWriter& json, const StatedArm& arm) { describe_arm(json, arm); }

void describe(JsonReader& reader, StatedArm& arm) { describe_arm(reader, arm); }

}  // namespace ripplenotch
