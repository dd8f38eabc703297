// SPDX-License-Identifier: MIT
#include "cli/joint_facts.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "ripplenotch/artifact/identification.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/files.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/filter/engine.hpp"

namespace ripplenotch {

namespace {

constexpr double whole_order_share = 0.005;

// Order per motor turn of a line that turns with the joint; empty for others. Under another ratio than the
// file's a line keeps its frequency, so its order follows from what was measured per output turn.
std::optional<double> order_of(const Line& line, const Identification& found,
                               std::optional<GearRatio> asked) {
    // A line that was seen at one speed only is unknown; identify gives it an order when its gear ratio rests
    // on it.
    if (line.kind != LineKind::order && !(line.kind == LineKind::unknown && line.order)) return std::nullopt;
    if (!asked || (found.gear_ratio.value == asked->value() && line.order)) return line.order;
    if (!line.order_output) return std::nullopt;
    const double order = *line.order_output / asked->value();
    const double whole = std::round(2.0 * order) / 2.0;
    return std::abs(order - whole) <= whole_order_share * order ? whole : order;
}

}  // namespace

JointFacts load_joint_facts(const std::string& path, std::optional<GearRatio> gear_ratio) {
    if (gear_ratio && !(gear_ratio->value() > 0.0)) {
        raise<UsageError>("gear ratio {} is not above 0", gear_ratio->value());
    }
    const Identification found = load_identification(path);
    JointFacts facts;
    facts.source = path == "-" ? "standard input" : path;
    facts.gear_ratio = gear_ratio;
    if (!gear_ratio && found.gear_ratio.value) {
        const double value = *found.gear_ratio.value;
        facts.gear_ratio = GearRatio(value);
        const double off = std::max(found.gear_ratio.ci95_high - value, value - found.gear_ratio.ci95_low);
        // Six digits in per cent, so that --ratio-error says exactly the same.
        if (off > 0.0 && std::isfinite(off))
            facts.ratio_error =
                *parse_number(fmt::format("{:.6g}", std::min(49.0, 100.0 * off / value))) / 100.0;
    }
    facts.sample_rate = nominal_rate(found.sample_rate);
    std::map<double, double> amplitude_of;
    for (const Line& line : found.lines) {
        const auto order = order_of(line, found, gear_ratio);
        if (!order) continue;
        double& amplitude = amplitude_of[*order];
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
        raise<DataError>("{}: its gear ratio is null, because identify found none; give --gear-ratio",
                         joint.source);
    }
    return *joint.gear_ratio;
}

InputRecord input_record(const std::string& path) {
    if (path == "-") return {"-", "", std::nullopt};
    return {path, sha256_of_file(path), std::nullopt};
}

}  // namespace ripplenotch
