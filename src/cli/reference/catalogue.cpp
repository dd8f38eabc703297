// SPDX-License-Identifier: MIT
// Everything that has a name on a command line as one JSON document, for programs that build command lines.

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "cli/reference/reference.hpp"
#include "document/json/json.hpp"
#include "ripplenotch/core/progress.hpp"
#include "ripplenotch/core/quantity.hpp"
#include "ripplenotch/core/spec.hpp"
#include "ripplenotch/export/target.hpp"
#include "ripplenotch/filter/method.hpp"
#include "ripplenotch/log/format.hpp"
#include "ripplenotch/model/effect.hpp"

namespace ripplenotch {
namespace {

Json command_json(const CommandEntry& command) {
    Json options = Json::array();
    for (const OptionEntry& option : command.options) {
        Json one{{"names", option.names}};
        one["kind"] = option.is_argument ? "argument" : option.takes_value() ? "value" : "flag";
        if (!option.type.empty()) one["type"] = option.type;
        if (!option.default_text.empty()) one["default"] = option.default_text;
        if (const auto choices = option.choices(); !choices.empty()) one["choices"] = choices;
        one["required"] = option.required;
        one["repeats"] = option.repeats;
        one["help"] = option.help;
        options.push_back(std::move(one));
    }
    return {{"name", command.name},
            {"summary", command.summary},
            {"description", command.description},
            {"options", std::move(options)}};
}

Json keys_json(std::span<const Key> keys) {
    Json all = Json::array();
    for (const Key& key : keys) {
        Json one{{"name", key.name}, {"required", key.required}};
        if (const auto unit = base_unit(key.dimension); !unit.empty()) one["unit"] = unit;
        if (!key.default_text.empty()) one["default"] = key.default_text;
        if (!key.choices.empty()) one["choices"] = split(key.choices, ' ');
        one["help"] = key.help;
        all.push_back(std::move(one));
    }
    return all;
}

/// Methods and export targets: what is written as NAME,KEY=VALUE.
template <class Entry>
Json entry_json(const Entry& entry) {
    return {{"name", entry.name},
            {"summary", entry.summary},
            {"source", entry.source},
            {"keys", keys_json(entry.keys)}};
}

Json effect_json(const Effect& effect) {
    Json parameters = Json::array();
    for (const Parameter& parameter : effect.parameters)
        parameters.push_back({{"name", parameter.name},
                              {"unit", parameter.unit},
                              {"lower", parameter.lower},
                              {"upper", parameter.upper},
                              {"help", parameter.help}});
    Json look_alikes = Json::array();
    for (const LookAlike& other : effect.look_alikes)
        look_alikes.push_back({{"name", other.name}, {"when", other.when}, {"told_by", other.told_by}});
    return {{"name", effect.name},
            {"summary", effect.summary},
            {"equation", effect.equation},
            {"symptom", effect.symptom},
            {"source", effect.source},
            {"parameters", std::move(parameters)},
            {"look_alikes", std::move(look_alikes)}};
}

Json units_json() {
    constexpr std::array<std::pair<std::string_view, Dimension>, 12> dimensions = {
        {{"time", Dimension::time},
         {"frequency", Dimension::frequency},
         {"angle", Dimension::angle},
         {"speed", Dimension::speed},
         {"torque", Dimension::torque},
         {"torque rate", Dimension::torque_rate},
         {"inertia", Dimension::inertia},
         {"level", Dimension::decibel},
         {"current", Dimension::current},
         {"length", Dimension::length},
         {"linear speed", Dimension::linear_speed},
         {"force", Dimension::force}}};
    Json all = Json::array();
    for (const auto& [name, dimension] : dimensions)
        all.push_back({{"quantity", name}, {"units", unit_names(dimension)}});
    return all;
}

}  // namespace

std::string catalogue_text(const Reference& reference) {
    Json commands = Json::array();
    for (const CommandEntry& command : reference.commands) commands.push_back(command_json(command));
    Json all_methods = Json::array(), targets = Json::array(), effects = Json::array(),
         formats = Json::array();
    for (const Method* method : methods()) all_methods.push_back(entry_json(*method));
    for (const Target* target : export_targets()) {
        targets.push_back(entry_json(*target));
        targets.back()["of"] = "filters";
    }
    for (const MapTarget* target : map_targets()) {
        targets.push_back(entry_json(*target));
        targets.back()["of"] = "map";
    }
    for (const Effect* effect : catalogue()) effects.push_back(effect_json(*effect));
    for (const LogFormat* format : log_formats())
        formats.push_back({{"name", format->name},
                           {"extensions", format->extensions},
                           {"written", format->is_written()},
                           {"summary", format->summary}});
    const Json whole{{"schema", "ripplenotch/catalogue/1"},
                     {"tool", tool_name},
                     {"version", version()},
                     {"commands", std::move(commands)},
                     {"methods", std::move(all_methods)},
                     {"targets", std::move(targets)},
                     {"effects", std::move(effects)},
                     {"formats", std::move(formats)},
                     {"units", units_json()}};
    return whole.dump(2) + "\n";
}

}  // namespace ripplenotch
