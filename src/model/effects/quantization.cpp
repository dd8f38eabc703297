// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <cmath>
#include <set>

#include "model/effects.hpp"
#include "ripplenotch/model/fit.hpp"

namespace ripplenotch {
namespace {

constexpr Parameter parameters[] = {
    {.name = "step_nm",
     .unit = "Nm",
     .help = "difference of neighbouring values that can be logged; 0 is continuous",
     .start = 0.1,
     .upper = 1e5},
};

constexpr LookAlike look_alikes[] = {
    {"dropout", "the torque hardly changes, so that neighbouring samples are equal by nature",
     "counting the distinct values of the log"},
    {"ripple", "the steps are coarser than the noise, which makes harmonics",
     "a log with more noise or a finer converter"},
};

void apply(const Situation&, std::span<const double> values, std::span<double> torque_nm) {
    if (values[0] == 0.0) return;
    for (std::size_t k = 0; k < torque_nm.size(); ++k)
        torque_nm[k] = std::round(torque_nm[k] / values[0]) * values[0] + 0.0;
}

std::optional<DetectedFault> detect(const LoggedTorque& log, const FaultRules& rules) {
    if (log.step_nm == 0.0 || log.step_nm < rules.step_of_noise * log.noise_nm) return std::nullopt;
    const std::set<double> levels(log.torque_nm.begin(), log.torque_nm.end());
    return DetectedFault{
        .values = {log.step_nm},
        .spoiled = {},
        .words = fmt::format("the log holds {} distinct values, {:.3g} Nm apart", levels.size(), log.step_nm),
        .bends_nm = log.step_nm};
}

}  // namespace

const Effect effects::quantization{
    .name = "quantization",
    .summary = "the converter logs whole steps",
    .equation = "logged torque = step_nm * round(torque / step_nm)",
    .symptom = "few distinct values in the log, at equal distances",
    .look_alikes = look_alikes,
    .source = "Widrow, 1956",
    .side = Side::converter,
    .domain = Domain::time,
    .parameters = parameters,
    .linear_in_torque = false,
    .apply = apply,
    .detect = detect,
};

}  // namespace ripplenotch
