// SPDX-License-Identifier: MIT
#pragma once
// What recommend prints to be pasted, of the methods that it judged.

#include <optional>
#include <string>
#include <vector>

#include "cli/options/options.hpp"
#include "cli/recommend/candidates.hpp"
#include "cli/recommend/targets.hpp"
#include "ripplenotch/evaluate/recommendation.hpp"

namespace ripplenotch {

class CommandLines {
  public:
    /// What the lines are about; refers to what its maker holds.
    struct About {
        const std::string& log;
        const LogOptions &whole, &judged;  ///< options that read the log, and the part that was judged
        Hertz sample_rate;
        const TriedMethods& tried;
        const std::optional<TargetChoice>& target;
        const GearAccount& gear;
    };
    explicit CommandLines(const About& about) : about_(about) {}

    /// What makes use of a method, one command after the other.
    [[nodiscard]] std::vector<std::string> of(const MethodFigures& figures) const;
    /// Measures methods as they were measured here; null ones are left out.
    [[nodiscard]] std::string check(const std::vector<const JudgedMethod*>& methods) const;

  private:
    About about_;
};

}  // namespace ripplenotch
