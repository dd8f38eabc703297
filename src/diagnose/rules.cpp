// SPDX-License-Identifier: MIT
#include "ripplenotch/diagnose/rules.hpp"

#include <cmath>
#include <type_traits>
#include <vector>

#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/spec.hpp"

namespace ripplenotch {
namespace {

template <auto group, auto member>
DiagnosisRule rule_of(std::string_view group_name, std::string_view name, double lowest, double highest,
                      std::string_view unit, std::string_view why) {
    using Value = std::remove_reference_t<decltype((DiagnosisRules{}.*group).*member)>;
    DiagnosisRule rule{.name = fmt::format("{}.{}", group_name, name),
                       .lowest = lowest,
                       .highest = highest,
                       .unit = unit,
                       .why = why,
                       .whole = std::is_integral_v<Value>};
    rule.get = [](const DiagnosisRules& rules) { return static_cast<double>((rules.*group).*member); };
    rule.set = [](DiagnosisRules& rules, double value) {
        (rules.*group).*member = static_cast<Value>(value);
    };
    rule.standard = rule.get({});
    return rule;
}

std::vector<DiagnosisRule> listed() {
    std::vector<DiagnosisRule> rules;
#define GROUP(Type, group)                              \
    {                                                   \
        constexpr auto place = &DiagnosisRules::group;  \
        constexpr std::string_view group_name = #group; \
        using Rules = DiagnosisRules::Type;
#define NUMBER(name, value, lowest, highest, unit, why) \
    rules.push_back(rule_of<place, &Rules::name>(group_name, #name, lowest, highest, unit, why));
#define WHOLE NUMBER
#define END_GROUP(group) }
#include "ripplenotch/diagnose/rules.def"
    constexpr auto place = &DiagnosisRules::faults;
    constexpr std::string_view group_name = "faults";
    using Rules = FaultRules;
#include "ripplenotch/model/fault_rules.def"
#undef GROUP
#undef NUMBER
#undef WHOLE
#undef END_GROUP
    return rules;
}

// Why not, or nothing.
std::string refusal(const DiagnosisRule& rule, double value) {
    if (!(value >= rule.lowest && value <= rule.highest))
        return fmt::format("{} {} is not within {} to {}", shortest(value), rule.unit, shortest(rule.lowest),
                           shortest(rule.highest));
    if (rule.whole && value != std::floor(value))
        return fmt::format("{} is no whole number", shortest(value));
    return {};
}

}  // namespace

std::span<const DiagnosisRule> diagnosis_rules() {
    static const std::vector<DiagnosisRule> rules = listed();
    return rules;
}

const DiagnosisRule& find_diagnosis_rule(std::string_view name) {
    std::vector<std::string> names;
    for (const DiagnosisRule& rule : diagnosis_rules()) {
        if (rule.name == name) return rule;
        names.push_back(rule.name);
    }
    const auto nearest = nearest_name(name, names);
    raise<UsageError>("a diagnosis has no rule '{}'{}", name,
                      nearest ? fmt::format("; '{}' is near", *nearest)
                              : std::string("; 'ripplenotch diagnose --rules' lists them"));
}

void check(const DiagnosisRules& rules) {
    for (const DiagnosisRule& rule : diagnosis_rules()) {
        if (const std::string reason = refusal(rule, rule.get(rules)); !reason.empty())
            raise<UsageError>("rule {}: {}", rule.name, reason);
    }
}

void set_rule(DiagnosisRules& rules, std::string_view assignment) {
    const std::size_t equals = assignment.find('=');
    if (equals == std::string_view::npos)
        raise<UsageError>("a rule is set by NAME=VALUE; '{}' has no '='", assignment);
    const DiagnosisRule& rule = find_diagnosis_rule(assignment.substr(0, equals));
    const auto value = parse_number(assignment.substr(equals + 1));
    if (!value) raise<UsageError>("rule {}: '{}' is no number", rule.name, assignment.substr(equals + 1));
    // Before it is set: a number below 0 is no count.
    if (const std::string reason = refusal(rule, *value); !reason.empty())
        raise<UsageError>("rule {}: {}", rule.name, reason);
    rule.set(rules, *value);
}

}  // namespace ripplenotch
