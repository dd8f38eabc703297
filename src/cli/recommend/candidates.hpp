// SPDX-License-Identifier: MIT
#pragma once
// The methods that recommend tries, with the files that they need made in memory as the commands would make
// them, and the commands to be pasted.

#include <optional>
#include <string>
#include <vector>

#include "cli/export/target_choice.hpp"
#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/evaluate/contender.hpp"
#include "ripplenotch/evaluate/recommendation.hpp"
#include "ripplenotch/log/log.hpp"
#include "ripplenotch/verdict/gear_choice.hpp"

namespace ripplenotch {

/// A file that methods need, and the command line that makes it.
struct MadeFile {
    std::string name, command;
};

struct TriedMethods {
    std::vector<Contender> contenders;
    std::vector<MadeFile> files;
    std::vector<std::string> left_out;  ///< what was not tried, and why, one sentence each

    /// Adds a sentence, once.
    void leave_out(const std::string& sentence);
};

struct CandidateRequest {
    const Log& train;
    Hertz sample_rate;        ///< of the whole log, which the filters are designed for
    std::string train_words;  ///< the log's name, with the options that read this part of it
    const GearChoice& choice;
    GearAccount gear;  ///< that choice comes to
    std::optional<TargetChoice> target;
};

/// The settings that each method holds worth trying, of all methods. The same for every limit, so that looser
/// limits never give a worse answer.
[[nodiscard]] TriedMethods candidates_for(const CandidateRequest& request);

/// What the command lines are about; refers to what its maker holds.
struct CommandLines {
    const std::string& log;
    std::string whole, judged;  ///< options that read the log, and the part that was judged
    Hertz sample_rate;
    const TriedMethods& tried;
    const std::optional<TargetChoice>& target;  ///< empty: C code, where there is some
    const GearAccount& gear;

    /// What makes use of a method, one command after the other; its export comes last.
    [[nodiscard]] std::vector<std::string> of(const MethodFigures& figures) const;
    /// Measures methods as they were measured here; null ones are left out.
    [[nodiscard]] std::string check(const std::vector<const JudgedMethod*>& methods) const;
};

}  // namespace ripplenotch
