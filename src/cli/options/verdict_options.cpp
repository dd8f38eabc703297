// SPDX-License-Identifier: MIT
#include "cli/options/verdict_options.hpp"

#include <fmt/format.h>

namespace ripplenotch {

namespace {

constexpr std::string_view simulated_option_help =
    "torque of your own simulation, as a known part of the model: a column of the log, tau_model, or of "
    "another file, log,file=sim.csv,column=torque; scale=1 states that its size is right, delay=2ms how much "
    "later it is";

constexpr std::string_view arm_option_help =
    "rigid bodies of the whole arm: urdf,file=FILE[,tip=LINK], mjcf,file=FILE[,tip=BODY], mdh,file=FILE, "
    "dh,file=FILE, or axes,word=zyyzyz (which way each axis points); each with [,gravity=0:0:-9.81] and "
    "[,joints=NAME:NAME IN THE LOG|NAME:=0deg]";

}  // namespace

void attach_gear(Options& options, GearOptions& gear, const GearHelp& help) {
    const Options::Group group(options, gear_group);
    options.number("--gear-ratio", gear.ratio, Dimension::none, help.ratio);
    if (!help.orders.empty()) options.orders("--orders", gear.orders, help.orders);
    if (!help.joint_file.empty()) options.text("--joint-file", gear.joint_file, "FILE", help.joint_file);
}

ReadOptions read_options(ReadOptions log, const std::optional<GearAccount>& gear) {
    if (gear && gear->has_ratio()) log.gear_ratio = gear->ratio.value();
    return log;
}

void attach_given(Options& options, GivenOptions& given) {
    options.text("--simulated", given.simulated, "SPEC", simulated_option_help);
    options.text("--arm", given.arm, "SPEC", arm_option_help);
}

void attach_residual(Options& options, ResidualOptions& residual) {
    options.text("--residual", residual.model, "FILE",
                 "look into measured less predicted torque: of this model.json, along the log");
    options.text("--simulated", residual.simulated, "SPEC",
                 "the same of your own simulation: tau_model (a column) or log,file=sim.csv,column=torque; "
                 "its scale is fitted unless scale=1 keeps it");
}

void take_residual(const ResidualOptions& residual, const ReadOptions& reading, std::size_t logs,
                   const GivenLog& log, const CommonOptions& common, Provenance& provenance) {
    if (!residual.any()) return;
    const Residual left = subtract_predicted(residual, reading, logs, log);
    if (left.model) provenance.inputs.push_back(input_record(*left.model));
    say(common, fmt::format("{}: {:.4g} Nm rms of torque, {:.4g} less what is predicted", log.path,
                            left.before_nm, left.after_nm));
}

}  // namespace ripplenotch
