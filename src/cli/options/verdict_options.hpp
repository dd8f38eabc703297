// SPDX-License-Identifier: MIT
#pragma once
// Options of what the library decides by: the gear, what is given of a torque, and what is subtracted from
// it.

#include <optional>
#include <string_view>

#include "cli/options/options.hpp"
#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/verdict/gear_choice.hpp"
#include "ripplenotch/verdict/given_terms.hpp"

namespace ripplenotch {

/// What an option is for in a command, where that differs; a command has no option whose help is empty.
struct GearHelp {
    std::string_view ratio = "motor turns per joint turn";
    std::string_view orders =
        "ripple lines in cycles per motor turn, or per turn of the joint, 200/turn,400/turn (default: where "
        "a gear ratio is known, 1,2)";
    std::string_view joint_file = "joint.json of identify: gear ratio, orders and amplitudes from there";
};

void attach_gear(Options& options, GearOptions& gear, const GearHelp& help = {});

/// How a log is read beside this gear: motion that is measured before the gear is told by its ratio, and
/// divided by it.
[[nodiscard]] ReadOptions read_options(ReadOptions log, const std::optional<GearAccount>& gear);

/// --simulated and --arm.
void attach_given(Options& options, GivenOptions& given);

/// --residual and --simulated.
void attach_residual(Options& options, ResidualOptions& residual);

/// subtract_predicted(), with what it left on standard error (-v) and the model among the inputs.
void take_residual(const ResidualOptions& residual, const ReadOptions& reading, std::size_t logs,
                   const GivenLog& log, const CommonOptions& common, Provenance& provenance);

}  // namespace ripplenotch
