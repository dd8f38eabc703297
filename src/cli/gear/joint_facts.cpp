// SPDX-License-Identifier: MIT
#include "cli/gear/joint_facts.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/files.hpp"
#include "ripplenotch/core/inputs_read.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/document/identification_json.hpp"
#include "ripplenotch/filter/engine.hpp"

namespace ripplenotch {
namespace {

constexpr double whole_order_share = 0.005;  // by hand

// Order per motor turn of a line that turns with the joint; empty for others. Under another ratio than the
// file's a line keeps its frequency, so its order follows from what was measured per output turn.
std::optional<double> order_of(const Line& line, const Identification& found,
                               std::optional<GearRatio> given) {
    const auto order_found = motor_order(line);
    if (line.kind != LineKind::order && !order_found) return std::nullopt;
    if (!given || (found.gear_ratio.value == given->value() && order_found)) return order_found;
    if (!line.order_output) return std::nullopt;
    const double order = *line.order_output / given->value();
    const double whole = std::round(2.0 * order) / 2.0;
    return std::abs(order - whole) <= whole_order_share * order ? whole : order;
}

// Six digits in per cent, so that --ratio-error says exactly the same.
double ratio_error(const GearRatioFit& fit) {
    const double off = std::max(fit.ci95_high - *fit.value, *fit.value - fit.ci95_low);
    if (!(off > 0.0) || !std::isfinite(off)) return 0.0;
    return *parse_number(fmt::format("{:.6g}", std::min(49.0, 100.0 * off / *fit.value))) / 100.0;
}

}  // namespace

JointFacts JointFile::facts(std::optional<GearRatio> given) const {
    JointFacts facts;
    facts.source = source;
    facts.sample_rate = nominal_rate(found.sample_rate);
    facts.gear_ratio = given;
    if (!given && found.gear_ratio.value) {
        facts.gear_ratio = GearRatio(*found.gear_ratio.value);
        facts.ratio_error = ratio_error(found.gear_ratio);
    }
    std::map<double, const Line*> strongest;
    for (const Line& line : found.lines) {
        const auto order = order_of(line, found, given);
        if (!order) continue;
        const double a = std::abs(line.speed_from_deg_s), b = std::abs(line.speed_to_deg_s);
        const DegPerSec low(std::min(a, b)), high(std::max(a, b));
        facts.slowest = strongest.empty() ? low : std::min(facts.slowest, low);
        facts.fastest = std::max(facts.fastest, high);
        const Line*& entry = strongest[*order];
        if (entry == nullptr || line.amplitude_nm > entry->amplitude_nm) entry = &line;
    }
    bool phases_known = true;
    for (const auto& [order, line] : strongest) {
        facts.orders.emplace_back(order);
        facts.amplitude_nm.push_back(line->amplitude_nm);
        facts.phase_deg.push_back(line->phase_deg);
        phases_known = phases_known && line->phase_known;
    }
    if (!phases_known) facts.phase_deg.clear();
    return facts;
}

JointFile load_joint(const std::string& path) {
    if (path.empty()) raise<UsageError>("--joint-file: the name is empty");
    return {path, path == "-" ? "standard input" : path, load_identification(path)};
}

InputRecord input_record(const std::string& path) {
    if (path == "-") return {"-", "", std::nullopt};
    return {path, sha256_as_read(path), std::nullopt};
}

}  // namespace ripplenotch
