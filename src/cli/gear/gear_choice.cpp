// SPDX-License-Identifier: MIT
#include "cli/gear/gear_choice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cli/options/options.hpp"
#include "ripplenotch/analysis/identification.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/files.hpp"
#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/quantity.hpp"
#include "ripplenotch/design/candidate_table.hpp"
#include "ripplenotch/document/identification_json.hpp"
#include "ripplenotch/document/map_json.hpp"
#include "ripplenotch/document/provenance.hpp"
#include "ripplenotch/document/table_json.hpp"
#include "ripplenotch/filter/engine.hpp"
#include "ripplenotch/filter/map_fit.hpp"

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

namespace {

// Reads joint.json, or standard input when the path is "-". Throws DataError, FileError, and UsageError for
// an empty path.
JointFile load_joint(const std::string& path) {
    if (path.empty()) raise<UsageError>("--joint-file: the name is empty");
    return {path, path == "-" ? "standard input" : path, load_identification(path)};
}

}  // namespace

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

void fill_in(Spec& spec, const Method& method, std::string_view key, const std::vector<double>& values) {
    if (values.empty() || !has_key(method, key) || given(spec, key)) return;
    std::string text;
    for (const double value : values) text += (text.empty() ? "" : ":") + shortest(value);
    spec.values.emplace_back(key, std::move(text));
}

void fill_gear(Spec& spec, const Method& method, const GearAccount& gear) {
    fill_in(spec, method, "gear-ratio", {gear.ratio.value()});
    if (given(spec, "orders")) return;  // amplitudes and phases would be those of other orders
    std::vector<double> orders;
    for (const Order order : gear.orders) orders.push_back(order.value());
    fill_in(spec, method, "orders", orders);
    fill_in(spec, method, "amplitudes", gear.amplitude_nm);
    fill_in(spec, method, "phases", gear.phase_deg);
}

void refuse_other_map(const std::string& method, const std::string& path, const std::string& of_map,
                      const std::string& stated) {
    const auto ratio = parse_number(stated), own = parse_number(of_map);
    if (ratio && own && std::abs(*ratio / *own - 1.0) <= same_ratio_share) return;
    raise<UsageError>("method {}: {} is the map of a joint of gear ratio {}, not of {}", method, path, of_map,
                      stated);
}

void use_table(Spec& spec, const Method& method, const std::optional<std::string>& table) {
    if (!table) return;
    if (!method.needs_table) {
        raise<UsageError>("--table is for methods that switch between bands; method {} has no table",
                          spec.name);
    }
    if (given(spec, "table")) raise<UsageError>("--table and table=... in --method: give one of them");
    spec.values.insert(spec.values.begin(), {"table", *table});
}

// map=FILE goes, and the keys that it stands for come; those that are given must be those of the map.
std::shared_ptr<const RippleMap> use_map(Spec& spec, const Method& method, const MapSource& maps,
                                         const std::vector<double>& asked, std::vector<std::string>& files) {
    if (!has_key(method, "map") || !given(spec, "map")) return nullptr;
    const auto entry = entry_of(spec, "map");
    const std::string path = entry->second;
    spec.values.erase(entry);
    auto map = std::make_shared<const RippleMap>(maps ? maps(path) : load_map(path).map);
    if (map->orders.empty())
        raise<DataError>("{}: the map is empty: method {} has no order to filter by it", path, spec.name);
    const auto is_mapped = [&map](double order) {
        return std::any_of(map->orders.begin(), map->orders.end(),
                           [order](Order one) { return one.value() == order; });
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
            raise<UsageError>("method {}: {}=... and map={} both say it; leave one out", spec.name, key,
                              path);
        }
    }
    files.push_back(path);
    return map;
}

// The method with a map that says 0 everywhere.
std::shared_ptr<const Contender> without_ripple(Spec spec) {
    std::erase_if(spec.values, [](const auto& entry) { return entry.first == "fastest"; });
    if (given(spec, "by-temperature") && !given(spec, "temperature"))
        spec.values.emplace_back("temperature", "0");
    for (auto& [key, value] : spec.values) {
        if (key != "cosines" && key != "sines") continue;
        std::string zeros = "0";
        for (const char c : value) zeros += c == ':' ? ":0" : "";
        value = std::move(zeros);
    }
    return std::make_shared<const Contender>(make_contender(spec));
}

// What the text says about the gear, checked in the words in which all of it will be; joint=FILE goes.
MethodGear stated_gear(Spec& spec, const Method& method, const GearChoice& choice) {
    MethodGear stated;
    stated.name = fmt::format("method {}", spec.name);
    Spec part{spec.name, {}};
    std::vector<Key> keys;
    for (Key key : method.keys) {
        if (key.name != "gear-ratio" && key.name != "orders") continue;
        key.required = false;
        keys.push_back(key);
        if (given(spec, key.name)) part.values.push_back(*entry_of(spec, key.name));
    }
    const Settings settings(stated.name, part, keys);
    if (settings.has("gear-ratio")) stated.ratio = settings.number("gear-ratio");
    if (settings.has("orders")) stated.orders = settings.list("orders");
    if (has_key(method, "joint") && given(spec, "joint")) {
        const auto entry = entry_of(spec, "joint");
        const bool same = choice.joint() && choice.joint()->path == entry->second;
        stated.joint = same ? choice.joint() : load_joint(entry->second);
        spec.values.erase(entry);
    }
    return stated;
}

std::vector<std::string> files_of(const MethodGear& gear, const GearChoice& choice) {
    std::vector<std::string> files;
    if (gear.table != nullptr) files.push_back(gear.table_path);
    if (gear.joint) files.push_back(gear.joint->path);
    if (choice.joint() && (!gear.joint || gear.joint->path != choice.joint()->path))
        files.push_back(choice.joint()->path);
    return files;
}

}  // namespace

Contender choose_method(const std::string& spec_text, const std::optional<std::string>& table,
                        const GearChoice& choice, const MapSource& source) {
    Spec spec = parse_spec(spec_text);
    const Method& method = find_method(spec.name);
    use_table(spec, method, table);
    const std::string typed = spec.text();
    std::vector<std::string> maps;
    const auto map = use_map(spec, method, source, choice.asked_orders(), maps);
    MethodGear stated = stated_gear(spec, method, choice);
    std::shared_ptr<const CandidateTable> loaded;
    if (method.needs_table && given(spec, "table")) {
        stated.table_path = entry_of(spec, "table")->second;
        loaded = std::make_shared<const CandidateTable>(load_table(stated.table_path));
        stated.table = &loaded->spec();
    }
    std::optional<GearAccount> gear = choice.of(stated);
    if (gear && !maps.empty())
        refuse_other_map(spec.name, maps.front(), entry_of(spec, "gear-ratio")->second,
                         shortest(gear->ratio.value()));
    if (gear) fill_gear(spec, method, *gear);
    if (!gear && has_key(method, "gear-ratio")) raise_no_gear(stated.name);
    Contender chosen = make_contender(spec, std::move(loaded));
    chosen.gear = std::move(gear);
    chosen.files = files_of(stated, choice);
    if (!maps.empty()) {
        chosen.text = typed;  // all the values of a map are no name
        chosen.map = map;
        chosen.without_ripple = without_ripple(spec);
    }
    chosen.files.insert(chosen.files.begin(), maps.begin(), maps.end());
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
    if (!made_for) return;
    const double doubt = method.table ? method.table->spec().ratio_error : 0.0;
    if (std::abs(measured.ratio / *made_for - 1.0) <= std::max(same_ratio_share, doubt)) return;
    raise<UsageError>(
        "method {}: its filter is for gear ratio {:.6g}{}, and the ripple would be measured for {:.6g} ({}); "
        "leave "
        "one of them out{}",
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
    const bool each = names_joint(request_.method) || names_joint(request_.table.value_or("")) ||
                      names_joint(request_.gear.joint_file.value_or(""));
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
    Contender method =
        choose_method(with_joint(request_.method, joint), named(request_.table), GearChoice(gear));
    if (!method.gear && request_.needs_gear) raise_no_gear("--min-attenuation");
    if (!method.gear && !gear.orders.empty()) raise_no_gear("--orders");
    return std::make_shared<const Contender>(std::move(method));
}

std::optional<GearAccount> JointMethods::common_gear() const {
    return common_ ? common_->gear : std::nullopt;
}

const Method& JointMethods::method() const {
    return find_method(std::string_view(request_.method).substr(0, request_.method.find(',')));
}

bool JointMethods::learns() const { return method().learner != nullptr; }

bool JointMethods::follows_motion() const {
    return method().steady == nullptr && method().part != MethodPart::control;
}

}  // namespace ripplenotch
