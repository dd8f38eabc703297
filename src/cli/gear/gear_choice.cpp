// SPDX-License-Identifier: MIT
#include "cli/gear/gear_choice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/files.hpp"
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

namespace {

constexpr double largest_ratio = 1e5;  // by hand

/// What one source states; empty is not stated.
struct Statement {
    std::string source;
    std::optional<GearRatio> ratio;
    std::vector<Order> orders;
    std::vector<double> amplitude_nm, phase_deg;  ///< one per order, or empty
};

std::vector<Order> sorted_orders(const std::vector<double>& values) {
    std::vector<Order> orders;
    for (const double value : values) orders.emplace_back(value);
    std::sort(orders.begin(), orders.end());
    return orders;
}

std::string reason_for_none(const Identification& found) {
    if (!found.doubts.empty()) return "cannot tell: " + found.doubts.front().because;
    std::string ratios;
    for (const double ratio : undecided_ratios(found.gear_ratio))
        ratios += fmt::format("{}{:.5g}", ratios.empty() ? "" : " or ", ratio);
    return ratios.empty() ? "found none" : "could not decide between " + ratios;
}

// What the file says where `before` comes first. A file that is asked and knows nothing is refused: it was
// measured, and nothing was found.
Statement statement_of(const JointFile& file, const std::vector<Statement>& before) {
    std::optional<GearRatio> given;
    bool orders_given = false;
    for (const Statement& one : before) {
        if (!given) given = one.ratio;
        orders_given = orders_given || !one.orders.empty();
    }
    JointFacts facts = file.facts(given);
    if (!facts.gear_ratio)
        raise<DataError>("{}: its gear ratio is null, because identify {}; give --gear-ratio", file.source,
                         reason_for_none(file.found));
    if (facts.orders.empty() && !orders_given)
        raise<DataError>("{}: it has no line that follows the motor; give --orders", file.source);
    return {file.source, facts.gear_ratio, std::move(facts.orders), std::move(facts.amplitude_nm),
            std::move(facts.phase_deg)};
}

std::vector<Statement> statements_of(const GearOptions& options, const MethodGear& method,
                                     const JointFile* file) {
    const auto ratio = [](std::optional<double> value) {
        return value ? std::optional(GearRatio(*value)) : std::nullopt;
    };
    std::vector<Statement> all = {{"", ratio(options.ratio), sorted_orders(options.orders), {}, {}},
                                  {method.name, ratio(method.ratio), sorted_orders(method.orders), {}, {}}};
    if (file != nullptr) all.push_back(statement_of(*file, all));
    if (method.table != nullptr)
        all.push_back({method.table_path,
                       method.table->gear_ratio,
                       method.table->orders,
                       method.table->amplitude_nm,
                       {}});
    return all;
}

// Of each order what the first source says that knows it; nothing unless all are known.
std::vector<double> known_values(const std::vector<Statement>& all, const std::vector<Order>& orders,
                                 std::vector<double> Statement::*member) {
    std::map<Order, double> known;
    for (const Statement& one : all) {
        const std::vector<double>& values = one.*member;
        for (std::size_t i = 0; i < std::min(values.size(), one.orders.size()); ++i)
            known.try_emplace(one.orders[i], values[i]);
    }
    std::vector<double> found;
    for (const Order order : orders) {
        const auto entry = known.find(order);
        if (entry == known.end()) return {};
        found.push_back(entry->second);
    }
    return found;
}

}  // namespace

void attach_gear(Options& options, GearOptions& gear, const GearHelp& help) {
    options.number("--gear-ratio", gear.ratio, Dimension::none, help.ratio);
    if (!help.orders.empty()) options.numbers("--orders", gear.orders, Dimension::none, help.orders);
    if (!help.joint_file.empty()) options.text("--joint-file", gear.joint_file, "FILE", help.joint_file);
}

void check_gear(const GearOptions& gear) {
    if (gear.ratio && !(*gear.ratio > 0.0 && *gear.ratio <= largest_ratio)) {
        raise<UsageError>("--gear-ratio {} is not above 0 and at most {}", shortest(*gear.ratio),
                          shortest(largest_ratio));
    }
    const std::vector<Order> orders = sorted_orders(gear.orders);
    if (!orders.empty() && !(orders.front() > Order(0.0)))
        raise<UsageError>("--orders: {} is not above 0", shortest(orders.front().value()));
    const auto twice = std::adjacent_find(orders.begin(), orders.end());
    if (twice != orders.end()) raise<UsageError>("--orders: {} is listed twice", shortest(twice->value()));
}

GearChoice::GearChoice(GearOptions options) : options_(std::move(options)) {
    check_gear(options_);
    if (options_.joint_file) joint_ = load_joint(*options_.joint_file);
}

std::optional<GearAccount> GearChoice::of(const MethodGear& method) const {
    const JointFile* file = method.joint ? &*method.joint : joint_ ? &*joint_ : nullptr;
    const std::vector<Statement> all = statements_of(options_, method, file);
    const auto with_ratio =
        std::find_if(all.begin(), all.end(), [](const Statement& one) { return one.ratio.has_value(); });
    if (with_ratio == all.end()) return std::nullopt;
    const auto with_orders =
        std::find_if(all.begin(), all.end(), [](const Statement& one) { return !one.orders.empty(); });
    const auto said_by = [&](auto found, std::string_view option) {
        return found == all.begin() ? std::string(option) : found->source;
    };
    GearAccount gear{*with_ratio->ratio, default_orders(), {}, {}, said_by(with_ratio, "--gear-ratio")};
    if (with_orders == all.end()) {
        gear.source += ", orders by default";
        return gear;
    }
    gear.orders = with_orders->orders;
    gear.amplitude_nm = known_values(all, gear.orders, &Statement::amplitude_nm);
    gear.phase_deg = known_values(all, gear.orders, &Statement::phase_deg);
    if (with_orders == all.begin() && with_ratio == all.begin()) {
        gear.source = "--gear-ratio, --orders";
    } else if (with_orders != with_ratio) {
        gear.source += ", orders from " + said_by(with_orders, "--orders");
    }
    return gear;
}

std::optional<JointFacts> GearChoice::facts() const {
    if (!joint_) return std::nullopt;
    return joint_->facts(options_.ratio ? std::optional(GearRatio(*options_.ratio)) : std::nullopt);
}

void raise_no_gear(std::string_view who) {
    raise<UsageError>(
        "{} needs to know the gear: give --gear-ratio, for example 100, or --joint-file joint.json", who);
}

ReadOptions read_options(const LogOptions& log, const std::optional<GearAccount>& gear) {
    ReadOptions read = log.resolve();
    if (gear) read.gear_ratio = gear->ratio.value();
    return read;
}

std::string gear_in_words(const GearAccount& gear) {
    std::string orders;
    for (const Order order : gear.orders)
        orders += (orders.empty() ? ", orders " : ", ") + shortest(order.value());
    return fmt::format("gear ratio {:.6g}{} ({})", gear.ratio.value(), orders, gear.source);
}

}  // namespace ripplenotch
