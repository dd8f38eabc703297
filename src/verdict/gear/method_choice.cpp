// SPDX-License-Identifier: MIT
#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/verdict/gear_choice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/visible_text.hpp"
#include "ripplenotch/design/candidate_table.hpp"
#include "ripplenotch/document/results.hpp"
#include "ripplenotch/document/table_json.hpp"
#include "ripplenotch/filter/engine.hpp"
#include "ripplenotch/filter/map_fit.hpp"

namespace ripplenotch {

namespace {

constexpr double same_ratio_share = 0.005;  // 100 and 101 are two gears

bool has_key(const Method& method, std::string_view key) {
    return std::any_of(method.keys.begin(), method.keys.end(),
                       [key](const Key& entry) { return entry.name == key; });
}

auto entry_of(Spec& spec, std::string_view key) {
    return std::find_if(spec.values.begin(), spec.values.end(),
                        [key](const auto& entry) { return entry.first == key; });
}

bool given(Spec& spec, std::string_view key) { return entry_of(spec, key) != spec.values.end(); }

void fill_in(Spec& spec, const Method& method, std::string_view key, std::string value) {
    if (value.empty() || !has_key(method, key) || given(spec, key)) return;
    spec.values.emplace_back(key, std::move(value));
}

void fill_gear(Spec& spec, const Method& method, const GearAccount& gear) {
    if (gear.has_ratio()) fill_in(spec, method, "gear-ratio", shortest(gear.ratio.value()));
    if (given(spec, "orders")) return;  // amplitudes and phases would be those of other orders
    fill_in(spec, method, "orders", orders_text(gear.orders, gear.ratio, ":"));
    fill_in(spec, method, "amplitudes", joined(gear.amplitude_nm, ":"));
    fill_in(spec, method, "phases", joined(gear.phase_deg, ":"));
}

void refuse_other_map(const std::string& method, const std::string& path, const std::string& of_map,
                      const std::string& stated) {
    const auto ratio = parse_number(stated), own = parse_number(of_map);
    if (ratio && own && std::abs(*ratio / *own - 1.0) <= same_ratio_share) return;
    raise<UsageError>("method {}: {} is the map of a joint of gear ratio {}, not of {}", method, path, of_map,
                      stated);
}

// map=FILE goes, and the keys that it stands for come; those that are given must be those of the map.
std::shared_ptr<const RippleMap> use_map(Spec& spec, const Method& method, const MapSource& maps,
                                         const std::vector<StatedOrder>& asked,
                                         std::vector<std::string>& files) {
    if (!has_key(method, "map") || !given(spec, "map")) return nullptr;
    const auto entry = entry_of(spec, "map");
    const std::string path = entry->second;
    spec.values.erase(entry);
    auto map = std::make_shared<const RippleMap>(maps ? maps(path) : load_map(path).map);
    if (map->orders.empty())
        raise<DataError>("{}: the map is empty: method {} has no order to filter by it", path, spec.name);
    const auto is_mapped = [&map](const StatedOrder& order) {
        return std::any_of(map->orders.begin(), map->orders.end(), [&](Order one) {
            const double per_turn = one.value() * map->gear_ratio.value();
            if (!order.per_turn && map->gear_ratio != no_ratio) return one.value() == order.value;
            return !order.per_turn || std::abs(order.value / per_turn - 1.0) <= same_ratio_share;
        });
    };
    if (!asked.empty() && std::none_of(asked.begin(), asked.end(), is_mapped))
        raise<DataError>(
            "{}: the map holds none of the orders asked for; method {} has no order to filter by it", path,
            spec.name);
    for (auto& [key, value] : map_as_keys(*map)) {
        if (!given(spec, key)) {
            spec.values.emplace_back(key, std::move(value));
        } else if (key == "gear-ratio") {
            refuse_other_map(spec.name, path, value, entry_of(spec, key)->second);
        } else {
            raise<UsageError>("method {}: {}=... and map={} both state it; leave one out", spec.name, key,
                              path);
        }
    }
    files.push_back(path);
    return map;
}

// The method with a map that says 0 everywhere.
std::shared_ptr<const Contender> without_ripple(Spec spec) {
    std::erase_if(spec.values, [](const auto& entry) { return entry.first == "fastest"; });
    for (auto& [key, value] : spec.values) {
        if (key != "cosines" && key != "sines") continue;
        std::string zeros = "0";
        for (const char c : value) zeros += c == ':' ? ":0" : "";
        value = std::move(zeros);
    }
    return std::make_shared<const Contender>(make_contender(spec));
}

// What the text says about the gear, checked in the words in which all of it will be.
GearStatement stated_gear(Spec& spec, const Method& method) {
    GearStatement stated;
    stated.source = fmt::format("method {}", spec.name);
    Spec part{spec.name, {}};
    std::vector<Key> keys;
    for (Key key : method.keys) {
        if (key.name != "gear-ratio" && key.name != "orders") continue;
        key.required = false;
        keys.push_back(key);
        if (given(spec, key.name)) part.values.push_back(*entry_of(spec, key.name));
    }
    const Settings settings(stated.source, part, keys);
    if (settings.has("gear-ratio")) stated.ratio = GearRatio(settings.number("gear-ratio"));
    if (settings.has("orders"))
        stated.orders = parse_orders(settings.text("orders"), stated.source + ", orders");
    return stated;
}

// The method's own joint file; joint=FILE goes.
std::optional<JointFile> take_joint(Spec& spec, const Method& method, const GearChoice& choice) {
    if (!has_key(method, "joint") || !given(spec, "joint")) return std::nullopt;
    const auto entry = entry_of(spec, "joint");
    const std::string path = entry->second;
    spec.values.erase(entry);
    return choice.joint() && choice.joint()->path == path ? choice.joint() : load_joint(path);
}

GearStatement statement_of(const CandidateTable& table, const std::string& path) {
    const TableSpec& spec = table.spec();
    GearStatement stated{path, std::nullopt, {}, spec.amplitude_nm, {}};
    if (spec.gear_ratio != no_ratio) stated.ratio = spec.gear_ratio;
    for (const Order order : spec.orders) stated.orders.emplace_back(order.value(), !stated.ratio);
    return stated;
}

}  // namespace

Contender choose_method(const std::string& spec_text, const std::optional<std::string>& table,
                        const GearChoice& choice, const MapSource& source) {
    Spec spec = parse_spec(spec_text);
    const Method& method = find_method(spec.name);
    if (table) spec.values.insert(spec.values.begin(), {"table", *table});
    const std::string typed = spec.text();
    std::vector<std::string> maps;
    const auto map = use_map(spec, method, source, choice.asked_orders(), maps);
    const GearStatement stated = stated_gear(spec, method);
    const std::optional<JointFile> joint = take_joint(spec, method, choice);
    GearStatement of_table;
    std::shared_ptr<const CandidateTable> loaded;
    if (method.needs_table && given(spec, "table")) {
        const std::string& path = entry_of(spec, "table")->second;
        loaded = std::make_shared<const CandidateTable>(load_table(path));
        of_table = statement_of(*loaded, path);
    }
    std::optional<GearAccount> gear = choice.of(stated, joint ? &*joint : nullptr, of_table);
    if (gear && gear->has_ratio() && given(spec, "gear-ratio") && !maps.empty())
        refuse_other_map(spec.name, maps.front(), entry_of(spec, "gear-ratio")->second,
                         shortest(gear->ratio.value()));
    if (gear) fill_gear(spec, method, *gear);
    if (!gear && has_key(method, "orders")) raise_no_gear(stated.source);
    Contender chosen = make_contender(spec, std::move(loaded));
    chosen.gear = std::move(gear);
    chosen.files = maps;
    if (chosen.table) chosen.files.push_back(of_table.source);
    if (joint) chosen.files.push_back(joint->path);
    if (choice.joint() && (!joint || joint->path != choice.joint()->path))
        chosen.files.push_back(choice.joint()->path);
    if (!maps.empty()) {
        chosen.text = typed;  // all the values of a map are no name
        chosen.map = map;
        chosen.others = map->others;
        chosen.without_ripple = without_ripple(spec);
    }
    if (chosen.gear) refuse_other_gear(chosen, *chosen.gear);
    return chosen;
}

void refuse_other_joint(const Contender& method, const std::string& joint) {
    if (method.map == nullptr || method.map->joint.empty() || joint.empty() || method.map->joint == joint)
        return;
    raise<UsageError>("method {}: the map is of joint {}, and the log is of joint {}", method.text,
                      method.map->joint, joint);
}

void refuse_other_gear(const Contender& method, const GearAccount& measured) {
    const auto made_for = method.made_for();
    if (!made_for || *made_for == no_ratio || !measured.has_ratio()) return;
    const double doubt = method.table ? method.table->spec().ratio_error : 0.0;
    if (std::abs(measured.ratio / *made_for - 1.0) <= std::max(same_ratio_share, doubt)) return;
    raise<UsageError>(
        "method {}: its filter is for gear ratio {:.6g}{}, and the ripple would be measured for {:.6g} ({}); "
        "leave one of them out{}",
        method.method->name, made_for->value(),
        method.table ? fmt::format(" ({})", method.settings.text("table")) : "", measured.ratio.value(),
        measured.source, method.table ? ", or design a table for this gear" : "");
}

bool names_joint(std::string_view text) { return text.find(joint_mark) != std::string_view::npos; }

std::string with_joint(std::string text, const std::string& joint) {
    if (joint.empty() && names_joint(text)) {
        raise<UsageError>("{} stands for a joint's name, and the joint of this log has none; name the file",
                          joint_mark);
    }
    std::string name = joint;
    std::replace(name.begin(), name.end(), '/', '_');
    for (std::size_t at = text.find(joint_mark); at != std::string::npos;
         at = text.find(joint_mark, at + name.size()))
        text.replace(at, joint_mark.size(), name);
    return text;
}

JointMethods::JointMethods(MethodRequest request) : request_(std::move(request)) {
    const bool each = names_joint(request_.method) || names_joint(request_.gear.joint_file.value_or("")) ||
                      names_joint(request_.other_motors.value_or(""));
    if (!each) common_ = choose("");
}

std::shared_ptr<const Contender> JointMethods::of(const std::string& joint) const {
    if (common_) return common_;
    return choose(joint);
}

std::shared_ptr<const Contender> JointMethods::choose(const std::string& joint) const {
    const auto named = [&joint](const std::optional<std::string>& text) {
        return text ? std::optional(with_joint(*text, joint)) : std::nullopt;
    };
    GearOptions gear = request_.gear;
    gear.joint_file = named(gear.joint_file);
    Contender method = choose_method(with_joint(request_.method, joint), std::nullopt, GearChoice(gear));
    if (const auto path = named(request_.other_motors)) {
        method.others = load_map(*path).map.others;
        if (method.others.empty())
            raise<DataError>("--other-motors: {} holds no ripple of the motors of other joints", *path);
        method.files.push_back(*path);
    }
    if (!method.gear && request_.needs_gear) raise_no_gear("--min-attenuation");
    return std::make_shared<const Contender>(std::move(method));
}

std::optional<GearAccount> JointMethods::common_gear() const {
    return common_ ? common_->gear : std::nullopt;
}

const Method& JointMethods::method() const {
    return find_method(std::string_view(request_.method).substr(0, request_.method.find(',')));
}

bool JointMethods::needs_log_twice() const {
    return request_.other_motors || (common_ && !common_->others.empty());
}

bool JointMethods::follows_motion() const {
    return method().steady == nullptr && method().part != MethodPart::control;
}

}  // namespace ripplenotch
