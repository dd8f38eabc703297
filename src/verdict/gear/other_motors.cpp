// SPDX-License-Identifier: MIT
#include "ripplenotch/verdict/other_motors.hpp"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "ripplenotch/analysis/identification.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/verdict/readings.hpp"

namespace ripplenotch {

namespace {

bool same_rows(const Log& one, const Log& other) {
    return one.trace.time_s == other.trace.time_s && one.trace.run_starts == other.trace.run_starts;
}

std::optional<GearAccount> gear_of(const JointLogs& joint, const StatedMotors& stated) {
    if (stated.of_file)
        if (auto of_file = stated.of_file(joint.joint)) return of_file;
    return gear_of_motor(identify_readings(joint.logs, {}), stated);
}

}  // namespace

std::optional<GearAccount> gear_of_motor(const Identification& found, const StatedMotors& stated) {
    std::optional<GearAccount> gear = found_gear(found);
    const GearRatioFit& fit = found.gear_ratio;
    if (stated.ratio &&
        (!gear || (fit.ci95_low <= stated.ratio->value() && stated.ratio->value() <= fit.ci95_high))) {
        if (!gear) gear.emplace();
        gear->ratio = *stated.ratio;
        gear->source = "--gear-ratio";
    }
    if (!gear) return std::nullopt;
    gear->amplitude_nm.clear();
    gear->phase_deg.clear();
    if (!stated.orders.empty()) gear->orders = stated.orders;
    if (gear->orders.empty()) gear->orders = default_orders();
    return gear;
}

std::vector<JointLogs> read_other_joints(std::span<const std::string> paths, std::span<const Log> own,
                                         const ReadOptions& options, std::size_t most_rows) {
    std::vector<JointLogs> joints;
    if (own.empty() || own.front().layout.joints.size() < 2 ||
        std::find(paths.begin(), paths.end(), "-") != paths.end())
        return joints;
    for (std::size_t l = 0; l < paths.size(); ++l) {
        std::vector<Log> all;
        try {
            all = read_joints_at_once_in_part(paths[l], options, most_rows);
        } catch (const DataError&) {
            return {};  // the joint that is looked at could be read, and its answer does not need the others
        }
        for (Log& log : all) {
            if (log.trace.joint == own[l].trace.joint || !log.trace.view().has_position() ||
                !same_rows(log, own[l]))
                continue;
            const auto same = std::find_if(joints.begin(), joints.end(), [&](const JointLogs& one) {
                return one.joint == log.trace.joint;
            });
            if (same != joints.end())
                same->logs.push_back(std::move(log));
            else if (l == 0)
                joints.push_back({log.trace.joint, {std::move(log)}});
        }
    }
    std::erase_if(joints, [&](const JointLogs& one) { return one.logs.size() != paths.size(); });
    return joints;
}

OtherMotors motors_of(std::span<const JointLogs> joints, std::span<const std::optional<GearAccount>> gears) {
    OtherMotors others;
    others.pairs = std::max<std::size_t>(joints.size() * (joints.size() + 1), 1);
    for (std::size_t j = 0; j < joints.size(); ++j) {
        if (!gears[j]) {
            others.not_known.push_back(joints[j].joint);
            continue;
        }
        OtherMotor& motor = others.motors.emplace_back(OtherMotor{joints[j].joint, *gears[j], {}});
        for (const Log& log : joints[j].logs) motor.motion.push_back(log.trace.view());
    }
    return others;
}

OtherMotors motors_of(std::span<const JointLogs> joints, const StatedMotors& stated) {
    std::vector<std::optional<GearAccount>> gears;
    for (const JointLogs& joint : joints) gears.push_back(gear_of(joint, stated));
    return motors_of(joints, gears);
}

}  // namespace ripplenotch
