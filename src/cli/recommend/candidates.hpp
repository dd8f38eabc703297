// SPDX-License-Identifier: MIT
#pragma once
// The methods that recommend tries, with the files that they need made in memory as the commands would make
// them.

#include <optional>
#include <string>
#include <vector>

#include "cli/options/options.hpp"
#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/evaluate/contender.hpp"
#include "ripplenotch/evaluate/recommendation.hpp"
#include "ripplenotch/export/map_target.hpp"
#include "ripplenotch/export/target.hpp"
#include "ripplenotch/log/log.hpp"
#include "ripplenotch/verdict/gear_choice.hpp"

namespace ripplenotch {

// --target: which methods an export target can hold.

struct TargetChoice {
    Spec spec;
    const Target* filters = nullptr;  ///< null where it holds none
    const MapTarget* maps = nullptr;  ///< the same

    [[nodiscard]] bool holds(const Contender& method) const;
    /// The map as the target has it, to be judged in place of the whole one; empty where it holds all of it.
    /// Throws what the target throws.
    [[nodiscard]] std::optional<RippleMap> held(const RippleMap& map) const;
    /// The command that makes the target's file of a method that it holds.
    [[nodiscard]] std::string command(const Contender& method, Hertz sample_rate) const;
};

/// A file that methods need, and the command line that makes it.
struct MadeFile {
    std::string name, command;
};

struct TriedMethods {
    std::vector<Contender> contenders;  ///< the control first
    std::vector<MadeFile> files;
    std::vector<std::string> left_out;  ///< what was not tried, and why, one sentence each
};

struct CandidateRequest {
    const Log& train;
    std::string train_words;  ///< the log's name, with the options that read this part of it
    const GearChoice& choice;
    GearAccount gear;  ///< that choice comes to
    std::optional<TargetChoice> target;
};

/// The same for every limit, so that looser limits never give a worse answer.
[[nodiscard]] TriedMethods candidates_for(const CandidateRequest& request);

// What recommend prints to be pasted, of the methods that it judged.

class CommandLines {
  public:
    /// What the lines are about; refers to what its maker holds.
    struct About {
        const std::string& log;
        std::string whole, judged;  ///< options that read the log, and the part that was judged
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
