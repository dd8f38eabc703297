// SPDX-License-Identifier: MIT
#include "ripplenotch/verdict/gear_choice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "ripplenotch/analysis/identification.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/files.hpp"
#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/quantity.hpp"
#include "ripplenotch/core/visible_text.hpp"
#include "ripplenotch/document/results.hpp"

namespace ripplenotch {

namespace {

constexpr double whole_order_share = 0.005;  // by hand
/// Gravity turns once per turn of the joint and what it carries twice: slower lines are no ripple of a drive.
constexpr double fewest_per_turn = 3.0;

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

// Of a line that turns with the joint, under no ratio; whole where it may be. At one speed a line may be a
// fixed tone; it counts as one that turns.
std::optional<double> per_turn_of(const Line& line) {
    std::optional<double> order = line.order_output;
    if (!order && line.kind == LineKind::unknown && line.by_speed.size() == 1)
        order = 360.0 * line.by_speed.front().hz / std::abs(line.by_speed.front().speed_deg_s);
    if (line.kind == LineKind::tone || !order || !(*order >= fewest_per_turn)) return std::nullopt;
    const double whole = std::round(*order);
    if (std::abs(*order - whole) <= 2.0 * line.order_output_stderr.value_or(0.0)) return whole;
    return parse_number(fmt::format("{:.6g}", *order));
}

// Six digits in per cent, as table.json holds it.
double ratio_error(const GearRatioFit& fit) {
    const double off = std::max(fit.ci95_high - *fit.value, *fit.value - fit.ci95_low);
    if (!(off > 0.0) || !std::isfinite(off)) return 0.0;
    return *parse_number(fmt::format("{:.6g}", std::min(49.0, 100.0 * off / *fit.value))) / 100.0;
}

}  // namespace

GearStatement JointFile::facts(std::optional<GearRatio> given) const {
    GearStatement facts;
    facts.source = source;
    facts.sample_rate = nominal_rate(found.sample_rate);
    facts.velocity_noise = found.velocity_noise;
    facts.ratio = given;
    if (!given && found.gear_ratio.value) {
        facts.ratio = GearRatio(*found.gear_ratio.value);
        facts.ratio_error = ratio_error(found.gear_ratio);
    }
    std::map<double, const Line*> strongest;
    for (const Line& line : found.lines) {
        const auto order = facts.ratio ? order_of(line, found, given) : per_turn_of(line);
        if (!order || !found.doubts.empty()) continue;
        const double a = std::abs(line.speed_from_deg_s), b = std::abs(line.speed_to_deg_s);
        const DegPerSec low(std::min(a, b)), high(std::max(a, b));
        facts.slowest = strongest.empty() ? low : std::min(facts.slowest, low);
        facts.fastest = std::max(facts.fastest, high);
        const Line*& entry = strongest[*order];
        if (entry == nullptr || line.amplitude_nm > entry->amplitude_nm) entry = &line;
    }
    bool phases_known = true;
    for (const auto& [order, line] : strongest) {
        facts.orders.emplace_back(order, !facts.ratio);
        facts.amplitude_nm.push_back(line->amplitude_nm);
        facts.phase_deg.push_back(line->phase_deg);
        phases_known = phases_known && line->phase_known;
    }
    if (!phases_known) facts.phase_deg.clear();
    return facts;
}

JointFile load_joint(const std::string& path) {
    if (path.empty()) raise<UsageError>("--joint-file: the name is empty");
    return {path, input_name(path), load_identification(path)};
}

namespace {

constexpr double largest_ratio = 1e5;  // by hand

std::optional<GearRatio> ratio_of(const GearOptions& options) {
    return options.ratio ? std::optional(GearRatio(*options.ratio)) : std::nullopt;
}

std::string reason_for_none(const Identification& found) {
    if (!found.doubts.empty()) return "cannot tell: " + found.doubts.front().because;
    const std::string ratios = joined(undecided_ratios(found.gear_ratio), " or ",
                                      [](double ratio) { return fmt::format("{:.5g}", ratio); });
    return ratios.empty() ? "found none" : "could not decide between " + ratios;
}

// The statement of the file, after those that take precedence. A file that is asked and knows nothing is
// refused: it was measured, and nothing was found.
GearStatement statement_of(const JointFile& file, const GearStatement& options, const GearStatement& method) {
    GearStatement facts = file.facts(options.ratio ? options.ratio : method.ratio);
    const std::vector<StatedOrder>& stated = options.orders.empty() ? method.orders : options.orders;
    const bool by_motor = std::any_of(stated.begin(), stated.end(), std::not_fn(&StatedOrder::per_turn));
    if (!facts.ratio && (by_motor || (stated.empty() && facts.orders.empty())))
        raise<DataError>(
            "{}: its gear ratio is null, because identify {}; give --gear-ratio, or lines per turn of the "
            "joint, for example --orders 200/turn",
            file.source, reason_for_none(file.found));
    if (facts.orders.empty() && stated.empty())
        raise<DataError>("{}: it has no line that follows the motor; give --orders", file.source);
    return facts;
}

// Of each order what the first source says that knows it; nothing unless all are known.
std::vector<double> known_values(const std::vector<GearStatement>& all, const GearAccount& gear,
                                 std::optional<GearRatio> ratio, std::vector<double> GearStatement::*member) {
    std::map<Order, double> known;
    for (const GearStatement& one : all) {
        const std::vector<double>& values = one.*member;
        if (values.empty()) continue;
        const std::vector<Order> orders = orders_under(one.orders, ratio, one.source);
        for (std::size_t i = 0; i < std::min(values.size(), orders.size()); ++i)
            known.try_emplace(orders[i], values[i]);
    }
    std::vector<double> found;
    for (const Order order : gear.orders) {
        const auto entry = known.find(order);
        if (entry == known.end()) return {};
        found.push_back(entry->second);
    }
    return found;
}

}  // namespace

void check_gear(const GearOptions& gear) {
    if (gear.ratio && !(*gear.ratio > 0.0 && *gear.ratio <= largest_ratio)) {
        raise<UsageError>("--gear-ratio {} is not above 0 and at most {}", shortest(*gear.ratio),
                          shortest(largest_ratio));
    }
    std::vector<StatedOrder> orders = gear.orders;
    std::sort(orders.begin(), orders.end());
    if (!orders.empty() && !(orders.front().value > 0.0))
        raise<UsageError>("--orders: {} is not above 0", shortest(orders.front().value));
    const auto twice = std::adjacent_find(orders.begin(), orders.end());
    if (twice != orders.end()) raise<UsageError>("--orders: {} is listed twice", shortest(twice->value));
}

GearChoice::GearChoice(GearOptions options) : options_(std::move(options)) {
    check_gear(options_);
    if (options_.joint_file) joint_ = load_joint(*options_.joint_file);
}

std::optional<GearAccount> GearChoice::of(const GearStatement& method, const JointFile* joint,
                                          const GearStatement& table) const {
    std::vector<GearStatement> all = {{"--gear-ratio", ratio_of(options_), options_.orders, {}, {}}, method};
    if (joint == nullptr && joint_) joint = &*joint_;
    if (joint != nullptr) all.push_back(statement_of(*joint, all[0], all[1]));
    all.push_back(table);
    const auto with_ratio =
        std::find_if(all.begin(), all.end(), [](const GearStatement& one) { return one.ratio.has_value(); });
    const auto with_orders =
        std::find_if(all.begin(), all.end(), [](const GearStatement& one) { return !one.orders.empty(); });
    if (with_ratio == all.end() && with_orders == all.end()) return std::nullopt;
    const auto ratio = with_ratio == all.end() ? std::nullopt : with_ratio->ratio;
    const auto source_of_orders = [&] {
        return with_orders == all.begin() ? "--orders" : with_orders->source;
    };
    GearAccount gear{ratio.value_or(no_ratio), default_orders(), {}, {}, {}, !ratio};
    if (with_orders == all.end()) {
        gear.source = with_ratio->source + ", orders by default";
        return gear;
    }
    gear.orders = orders_under(with_orders->orders, ratio, source_of_orders());
    std::sort(gear.orders.begin(), gear.orders.end());
    gear.amplitude_nm = known_values(all, gear, ratio, &GearStatement::amplitude_nm);
    gear.phase_deg = known_values(all, gear, ratio, &GearStatement::phase_deg);
    if (!ratio) {
        gear.source = source_of_orders();
    } else if (with_orders == all.begin() && with_ratio == all.begin()) {
        gear.source = "--gear-ratio, --orders";
    } else {
        gear.source = with_ratio->source;
        if (with_orders != with_ratio) gear.source += ", orders from " + source_of_orders();
    }
    return gear;
}

std::optional<GearStatement> GearChoice::facts() const {
    if (!joint_) return std::nullopt;
    return joint_->facts(ratio_of(options_));
}

void raise_no_gear(std::string_view who) {
    raise<UsageError>(
        "{} needs to know where the ripple is: give --gear-ratio, for example 100, lines per turn of the "
        "joint, for example --orders 200/turn, or --joint-file joint.json",
        who);
}

std::string gear_in_words(const GearAccount& gear) {
    const std::string orders = orders_text(gear.orders, gear.ratio, ", ");
    if (gear.per_turn) return fmt::format("orders {} of the joint ({})", orders, gear.source);
    if (!gear.has_ratio()) return fmt::format("gear ratio not known ({})", gear.source);
    return fmt::format("gear ratio {:.6g}{}{} ({})", gear.ratio.value(), orders.empty() ? "" : ", orders ",
                       orders, gear.source);
}

}  // namespace ripplenotch
