// SPDX-License-Identifier: MIT
#include "cli/joint_facts.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "ripplenotch/artifact/identification.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/files.hpp"
#include "ripplenotch/filter/engine.hpp"

namespace ripplenotch {

JointFacts load_joint_facts(const std::string& path) {
    const Identification found = load_identification(path);
    JointFacts facts;
    facts.source = path == "-" ? "standard input" : path;
    if (found.gear_ratio.value) facts.gear_ratio = GearRatio(*found.gear_ratio.value);
    facts.sample_rate = nominal_rate(found.sample_rate);
    std::map<double, double> amplitude_of;
    for (const Line& line : found.lines) {
        if (line.kind != LineKind::order || !line.order) continue;
        double& amplitude = amplitude_of[*line.order];
        amplitude = std::max(amplitude, line.amplitude_nm);
        const double a = std::abs(line.speed_from_deg_s), b = std::abs(line.speed_to_deg_s);
        const DegPerSec low(std::min(a, b)), high(std::max(a, b));
        facts.slowest = amplitude_of.size() == 1 ? low : std::min(facts.slowest, low);
        facts.fastest = std::max(facts.fastest, high);
    }
    for (const auto& [order, amplitude] : amplitude_of) {
        facts.orders.emplace_back(order);
        facts.amplitude_nm.push_back(amplitude);
    }
    return facts;
}

GearRatio gear_ratio_of(const JointFacts& joint) {
    if (!joint.gear_ratio) {
        raise<DataError>(
            "{}: its gear ratio is null, because identify found none; give --gear-ratio and --orders",
            joint.source);
    }
    return *joint.gear_ratio;
}

InputRecord input_record(const std::string& path) {
    if (path == "-") return {"-", "", std::nullopt};
    return {path, sha256_of_file(path), std::nullopt};
}

}  // namespace ripplenotch
