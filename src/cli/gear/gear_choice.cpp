// SPDX-License-Identifier: MIT
#include "cli/gear/gear_choice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {
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
