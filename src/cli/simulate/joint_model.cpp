// SPDX-License-Identifier: MIT
#include "cli/simulate/joint_model.hpp"

#include <fmt/format.h>

#include <sstream>
#include <utility>

#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {
namespace {

// "1:0.8Nm:0deg" is order, amplitude, phase; the phase may be left out.
Term parse_ripple(const std::string& text) {
    std::vector<std::string> pieces;
    std::istringstream stream(text);
    for (std::string piece; std::getline(stream, piece, ':');) pieces.push_back(piece);
    if (pieces.size() == 2) pieces.emplace_back("0deg");
    if (pieces.size() != 3) {
        raise<UsageError>(
            "--ripple: '{}' is not ORDER:AMPLITUDE or ORDER:AMPLITUDE:PHASE, for example 1:0.8Nm:0deg", text);
    }
    return parse_term(
        fmt::format("ripple,order={},amplitude_nm={},phase_deg={}", pieces[0], pieces[1], pieces[2]));
}

}  // namespace

ModelWithGiven assemble_model(const JointModelOptions& options, bool takes_given) {
    ModelWithGiven whole;
    Model& model = whole.model;
    check_gear(options.gear);
    if (options.model) {
        const std::string source = *options.model == "-" ? "standard input" : *options.model;
        if (options.gear.ratio) {
            raise<UsageError>("--gear-ratio: the model of {} states the gear ratio; change it there", source);
        }
        const std::string text = read_all(*options.model);
        if (takes_given)
            whole = read_model_with_given(text, source);
        else
            model = read_model(text, source);
    } else {
        if (!options.gear.ratio)
            raise<UsageError>("--gear-ratio is missing; give it, or --model FILE, which states it");
        model.gear_ratio = GearRatio(*options.gear.ratio);
    }
    if (options.inertia_kgm2) {
        model.terms.push_back(
            parse_term(fmt::format("inertia,inertia_kgm2={}", shortest(*options.inertia_kgm2))));
    }
    for (const std::string& ripple : options.ripples) model.terms.push_back(parse_ripple(ripple));
    for (const std::string& effect : options.effects) model.terms.push_back(parse_term(effect));
    return whole;
}

GearAccount assembled_gear(const JointModelOptions& joint, const Model& model) {
    std::string source = !joint.model          ? "--gear-ratio"
                         : *joint.model == "-" ? "standard input"
                                               : *joint.model;
    if (!joint.ripples.empty()) source += ", --ripple";
    return gear_of(model, std::move(source));
}

void attach_joint_model(Options& options, JointModelOptions& joint) {
    options.text("--model", joint.model, "FILE", "model.json of the joint; - is standard input");
    attach_gear(options, joint.gear, {.orders = "", .joint_file = ""});
    options.number("--inertia", joint.inertia_kgm2, Dimension::inertia, "adds the effect inertia");
    options.texts("--ripple", joint.ripples, "ORDER:AMPLITUDE[:PHASE]",
                  "adds the effect ripple: 1:0.8Nm:0deg; repeatable");
    options.texts("--effect", joint.effects, "NAME,KEY=VALUE,...",
                  "adds any effect: offset,torque_nm=0.2; repeatable; 'ripplenotch effects' lists them");
}

}  // namespace ripplenotch
