// SPDX-License-Identifier: MIT
#pragma once
// The methods that recommend tries, with the files that they need made in memory as the commands would make
// them.

#include <optional>
#include <string>
#include <vector>

#include "cli/gear/gear_choice.hpp"
#include "cli/recommend/targets.hpp"
#include "ripplenotch/evaluate/contender.hpp"
#include "ripplenotch/log/log.hpp"

namespace ripplenotch {

/// A file that methods need, and the command line that makes it.
struct MadeFile {
    std::string name, command;
};

struct TriedMethods {
    std::vector<Contender> contenders;  ///< the control first
    std::vector<MadeFile> files;
    std::vector<std::string> left_out;  ///< what was not tried, and why, one sentence each
};

/// A column of the log, at the rows of its two parts.
struct SidesOfLog {
    std::string column;
    std::vector<double> train_degc, judge_degc;
};

struct CandidateRequest {
    const Log& train;
    std::string train_words;  ///< the log's name, with the options that read this part of it
    const GearChoice& choice;
    GearAccount gear;  ///< that choice comes to
    bool offline = false;
    std::optional<TargetChoice> target;
    std::optional<SidesOfLog> temperature;  ///< of the joint, where the map may depend on it
};

/// The same for every limit, so that looser limits never give a worse answer.
[[nodiscard]] TriedMethods candidates_for(const CandidateRequest& request);

}  // namespace ripplenotch
