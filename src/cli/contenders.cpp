// SPDX-License-Identifier: MIT
#include "cli/contenders.hpp"

#include <algorithm>

#include "cli/chosen_method.hpp"
#include "cli/joint_facts.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/filter/engine.hpp"

namespace ripplenotch {

Field load_contenders(const std::vector<std::string>& methods, const LinesRequest& gear,
                      Provenance& provenance) {
    if (methods.empty()) {
        raise<UsageError>(
            "nothing to compare; give --method, for example --method fixed,centers=25Hz:50Hz,q=0.25 "
            "--method lowpass,cutoff=13rad/s");
    }
    Field field;
    std::vector<std::string> recorded;
    // The joint file of the options is recorded with the lines.
    if (gear.joint_file) recorded.push_back(*gear.joint_file);
    const auto record = [&](const std::string& path) {
        if (path.empty() || std::find(recorded.begin(), recorded.end(), path) != recorded.end()) return;
        recorded.push_back(path);
        provenance.inputs.push_back(input_record(path));
    };
    const auto add = [&](const std::string& text) {
        const ChosenMethod chosen =
            choose_method(text, std::nullopt, {gear.gear_ratio, gear.orders, gear.joint_file});
        field.contenders.push_back({chosen.text, chosen.method, *chosen.settings, chosen.table});
        record(chosen.joint_path);
        if (!chosen.table) return;
        if (!field.table) field.table = chosen.table;
        record(chosen.table_path);
    };
    const auto is_control = [](const std::string& text) { return parse_spec(text).name == "none"; };
    if (std::none_of(methods.begin(), methods.end(), is_control)) add("none");
    for (const std::string& text : methods) add(text);
    return field;
}

std::optional<RippleLines> lines_of(const LinesRequest& request, const Field& field, Provenance& provenance) {
    std::optional<GearRatio> asked;
    if (request.gear_ratio) asked = GearRatio(*request.gear_ratio);
    std::optional<JointFacts> joint;
    if (request.joint_file) {
        joint = load_joint_facts(*request.joint_file, asked);
        provenance.inputs.push_back(input_record(*request.joint_file));
    }
    RippleLines lines;
    const auto follows =
        std::find_if(field.contenders.begin(), field.contenders.end(),
                     [](const Contender& contender) { return contender.settings.has("gear-ratio"); });
    const bool one_follows = follows != field.contenders.end();
    if (request.gear_ratio) {
        if (!(*request.gear_ratio > 0.0))
            raise<UsageError>("gear ratio {} is not above 0", *request.gear_ratio);
        lines.gear_ratio = GearRatio(*request.gear_ratio);
    } else if (joint) {
        lines.gear_ratio = gear_ratio_of(*joint);
    } else if (field.table) {
        lines.gear_ratio = field.table->spec().gear_ratio;
    } else if (one_follows) {
        lines.gear_ratio = GearRatio(follows->settings.number("gear-ratio"));
    }
    if (!request.orders.empty()) {
        for (const double order : request.orders) {
            if (!(order > 0.0)) raise<UsageError>("order {} is not above 0", shortest(order));
            lines.orders.emplace_back(order);
        }
        std::sort(lines.orders.begin(), lines.orders.end());
    } else if (joint) {
        lines.orders = joint->orders;
        lines.amplitude_nm = joint->amplitude_nm;
    } else if (field.table) {
        lines.orders = field.table->spec().orders;
    } else if (one_follows) {
        for (const double order : follows->settings.list("orders")) lines.orders.emplace_back(order);
        std::sort(lines.orders.begin(), lines.orders.end());
    }
    const bool has_ratio = lines.gear_ratio.value() > 0.0;
    if (has_ratio == lines.orders.empty()) {
        raise<UsageError>("{}; it takes both to know where the ripple is",
                          has_ratio ? "a gear ratio without orders: add --orders, for example 1,2"
                                    : "orders without a gear ratio: add --gear-ratio, for example 100");
    }
    if (!has_ratio) return std::nullopt;
    return lines;
}

void check_table_rates(const Field& field, Hertz sample_rate, const std::string& source,
                       const CommonOptions& common) {
    for (const Contender& contender : field.contenders) {
        if (!contender.table) continue;
        const auto warning = compare_table_rate(contender.table->spec().sample_rate, sample_rate, source);
        if (warning) say_warnings(common, {&*warning, 1});
    }
}

}  // namespace ripplenotch
