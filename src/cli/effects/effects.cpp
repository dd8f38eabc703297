// SPDX-License-Identifier: MIT
// ripplenotch effects: the catalogue that models are made of.

#include <fmt/format.h>

#include <memory>

#include "cli/command.hpp"
#include "cli/talk.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/document/simulation_json.hpp"

namespace ripplenotch {
namespace {

struct EffectsRequest {
    CommonOptions common;
    std::string name;
    std::function<std::string()> command_line;
};

std::string list_text() {
    std::vector<std::vector<std::string>> rows = {{"effect", "acts on", "summary"}};
    for (const Effect* effect : catalogue()) {
        rows.push_back(
            {std::string(effect->name), std::string(side_name(effect->side)), std::string(effect->summary)});
    }
    return text_table(rows, "l");
}

std::string parameters_text(const Effect& effect) {
    std::vector<std::vector<std::string>> rows = {
        {"parameter", "unit", "neutral", "from", "to", "left out", "meaning"}};
    for (const Parameter& p : effect.parameters) {
        const std::string left_out = p.left_out == LeftOut::fitted    ? "is fitted"
                                     : p.left_out == LeftOut::refused ? "is refused"
                                                                      : "is " + shortest(p.start);
        rows.push_back({std::string(p.name), p.unit.empty() ? "-" : std::string(p.unit), shortest(p.neutral),
                        shortest(p.lower), shortest(p.upper), left_out, std::string(p.help)});
    }
    return text_table(rows, "llrrrll");
}

std::string effect_text(const Effect& effect) {
    std::string text = fmt::format("{}: {}\n\n  {}\n\n{}\nacts on: {}\nsymptom: {}\nlook-alikes:\n",
                                   effect.name, effect.summary, effect.equation, parameters_text(effect),
                                   side_name(effect.side), effect.symptom);
    for (const LookAlike& other : effect.look_alikes)
        text +=
            fmt::format("  {}, when: {}\n    to distinguish: {}\n", other.name, other.when, other.told_by);
    return text + fmt::format("source: {}\n", effect.source);
}

ExitCode explain(const EffectsRequest& request) {
    const Effect* only = request.name.empty() ? nullptr : &find_effect(request.name);
    std::string text = only != nullptr ? effect_text(*only) : list_text();
    if (request.common.json) {
        const auto effects = only != nullptr ? std::span<const Effect* const>(&only, 1) : catalogue();
        text = write_catalogue(effects, {.inputs = {}, .command = request.command_line()});
    }
    write_text(request.common.output, text, request.common.overwrite());
    return ExitCode::done;
}

std::function<ExitCode()> attach_effects(Options& options) {
    auto request = std::make_shared<EffectsRequest>();
    options.argument("NAME", request->name, false, "effect to explain; without it, the list");
    attach_common(options, request->common, {"a list of effects", ".txt .json", true});
    request->command_line = [&options] { return options.command_line(); };
    return [request] { return explain(*request); };
}

}  // namespace

const Command commands::effects{
    .name = "effects",
    .summary = "the effects that models are made of: equation, parameters, symptom, look-alikes",
    .description =
        "Lists the catalogue, or explains one effect of it.\n"
        "Example: ripplenotch effects stribeck-friction",
    .attach = attach_effects,
};

}  // namespace ripplenotch
