// SPDX-License-Identifier: MIT
#pragma once
// What the rules said of one finding or candidate.

#include <string_view>
#include <vector>

#include "ripplenotch/diagnose/diagnosis.hpp"

namespace ripplenotch {

/// Notes each rule that is asked, in the order in which they are.
class Hearing {
  public:
    /// Both must outlive it.
    Hearing(const DiagnosisRules& rules, std::vector<Decision>& decisions)
        : rules_(rules), decisions_(decisions) {}

    /// Notes that `rule` was asked about `number`; returns `against`, whether it spoke against the finding.
    bool asked(std::string_view rule, double number, bool against) {
        const DiagnosisRule& found = find_diagnosis_rule(rule);
        decisions_.push_back({found.name, number, found.get(rules_), std::string(found.unit), against});
        return against;
    }

    /// The price of a name follows from what was tried and is no rule of its own; see Evidence::price.
    bool asked_price(double gain, double price, bool against) {
        decisions_.push_back({"price", gain, price, "gain", against});
        return against;
    }

  private:
    const DiagnosisRules& rules_;
    std::vector<Decision>& decisions_;
};

}  // namespace ripplenotch
