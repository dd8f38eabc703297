// SPDX-License-Identifier: MIT
#pragma once
// --residual and --simulated of commands that look for ripple: in measured less predicted torque, where what
// the model knows is gone.

#include <optional>
#include <string>

#include "cli/given/given_terms.hpp"

namespace ripplenotch {

struct ResidualOptions {
    std::optional<std::string> model;  ///< --residual: a model.json; {joint} stands for a joint's name
    std::optional<std::string> simulated;

    [[nodiscard]] bool any() const { return model || simulated; }
};
void attach_residual(Options& options, ResidualOptions& residual);

/// Takes what model and simulation predict out of the torque of the log at `path`, which was read by
/// `reading` for one joint. `logs`: how many logs there are, of which a simulation in a file of its own fits
/// one only. Throws UsageError, DataError, FileError.
void take_residual(const ResidualOptions& residual, ReadOptions reading, std::size_t logs,
                   const GivenLog& log, const CommonOptions& common, Provenance& provenance);

/// The joint that the model of --residual is for, where the user names none.
void take_joint_of(const ResidualOptions& residual, std::optional<std::string>& joint);

}  // namespace ripplenotch
