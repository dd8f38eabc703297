// SPDX-License-Identifier: MIT
#pragma once
// Every limit that a diagnosis decides by, so that a test or a study can move any one of them.

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "ripplenotch/model/fault_rules.hpp"

namespace ripplenotch {

/// The limits, grouped by the test that uses them: `rules.doubt.least_elsewhere`. Each line of rules.def is
/// one: its value, the bounds within which it may be changed, its unit, and its reason. Numbers that only
/// control the accuracy of a computation are not among them.
struct DiagnosisRules {
#define GROUP(Type, group) struct Type {
#define NUMBER(name, value, lowest, highest, unit, why) double name = value;
#define WHOLE(name, value, lowest, highest, unit, why) std::size_t name = value;
#define END_GROUP(group) \
    }                    \
    group;
#include "ripplenotch/diagnose/rules.def"
#undef GROUP
#undef NUMBER
#undef WHOLE
#undef END_GROUP
    FaultRules faults;
};

/// One rule and how to get at it.
struct DiagnosisRule {
    std::string name;                                    ///< "doubt.least_elsewhere"
    double standard = 0.0, lowest = 0.0, highest = 0.0;  ///< both bounds allowed
    std::string_view unit, why;
    bool whole = false;  ///< it holds whole numbers alone
    double (*get)(const DiagnosisRules& rules) = nullptr;
    void (*set)(DiagnosisRules& rules, double value) = nullptr;
};

/// All of them, in the order of rules.def, those of faults last.
[[nodiscard]] std::span<const DiagnosisRule> diagnosis_rules();
/// Throws UsageError with the nearest name.
[[nodiscard]] const DiagnosisRule& find_diagnosis_rule(std::string_view name);

/// Throws UsageError for a rule outside its bounds, with its name and its bounds.
void check(const DiagnosisRules& rules);
/// Sets one rule by "NAME=VALUE". Throws UsageError: no such rule, no number, not whole, outside its bounds.
void set_rule(DiagnosisRules& rules, std::string_view assignment);

}  // namespace ripplenotch
