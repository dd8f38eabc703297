// SPDX-License-Identifier: MIT
#include "cli/compare/contenders.hpp"

#include <algorithm>
#include <set>

#include "cli/readings/side_column.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/filter/engine.hpp"

namespace ripplenotch {
namespace {

// The nearer to what the user typed outside the methods, the better.
int rank_of(const Contender& contender) {
    if (!contender.gear) return 3;
    if (contender.table) return 2;
    return contender.made_for() ? 1 : 0;
}

const Method& control_method() {
    const auto all = ripplenotch::methods();
    return **std::find_if(all.begin(), all.end(),
                          [](const Method* method) { return method->part == MethodPart::control; });
}

std::optional<GearAccount> common_gear(const std::vector<Contender>& contenders) {
    const auto best =
        std::min_element(contenders.begin(), contenders.end(),
                         [](const Contender& a, const Contender& b) { return rank_of(a) < rank_of(b); });
    if (!best->gear) return std::nullopt;
    for (const Contender& contender : contenders) refuse_other_gear(contender, *best->gear);
    return best->gear;
}

}  // namespace

std::vector<std::string> methods_at(const std::string& log, std::vector<std::string> methods,
                                    const LogOptions& options) {
    if (log.empty()) return methods;
    ReadOptions read = read_options(options, std::nullopt);
    read.takes_motor_units = true;
    for (std::string& method : methods) method = at_log_temperature(method, log, read);
    return methods;
}

std::vector<std::vector<double>> temperatures_for(std::span<const Contender> contenders,
                                                  const std::string& log, const ReadOptions& read,
                                                  const CommonOptions& common) {
    std::vector<std::vector<double>> all;
    std::vector<std::string> notes;
    for (const Contender& contender : contenders) all.push_back(followed_values(contender, log, read, notes));
    notes.erase(std::unique(notes.begin(), notes.end()), notes.end());
    say_warnings(common, notes);
    return all;
}

Field load_contenders(const std::vector<std::string>& methods, const GearOptions& gear,
                      Provenance& provenance) {
    if (methods.empty()) {
        raise<UsageError>(
            "nothing to compare; give --method, for example --method fixed,centers=25Hz:50Hz,q=0.25 "
            "--method lowpass,cutoff=13rad/s");
    }
    const GearChoice choice(gear);
    Field field;
    std::set<std::string> recorded;
    const auto add = [&](const std::string& text) {
        const Contender& added = field.contenders.emplace_back(choose_method(text, std::nullopt, choice));
        if (!field.table) field.table = added.table;
        for (const std::string& file : added.files)
            if (recorded.insert(file).second) provenance.inputs.push_back(input_record(file));
    };
    const auto is_control = [](const std::string& text) {
        return find_method(parse_spec(text).name).part == MethodPart::control;
    };
    if (std::none_of(methods.begin(), methods.end(), is_control)) add(std::string(control_method().name));
    for (const std::string& text : methods) add(text);
    field.gear = common_gear(field.contenders);
    if (!field.gear && !gear.orders.empty()) raise_no_gear("--orders");
    return field;
}

void check_table_rates(const Field& field, Hertz sample_rate, const std::string& source,
                       const CommonOptions& common) {
    for (const Contender& contender : field.contenders) {
        if (!contender.table) continue;
        const auto warning =
            compare_table_rate({.table = contender.table->spec().sample_rate, .log = sample_rate}, source);
        if (warning) say_warnings(common, {&*warning, 1});
    }
}

}  // namespace ripplenotch
