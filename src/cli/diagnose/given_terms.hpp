// SPDX-License-Identifier: MIT
#pragma once
// Where the terms that a diagnosis is given come together: those of the log, and the same of the validation
// log. Each option that states one adds to both.

#include <optional>
#include <string>
#include <vector>

#include "cli/options/options.hpp"
#include "ripplenotch/arm/arm_account.hpp"
#include "ripplenotch/document/simulated_term.hpp"
#include "ripplenotch/log/log.hpp"
#include "ripplenotch/model/given_term.hpp"

namespace ripplenotch {

/// Options that state a given term.
struct GivenOptions {
    std::optional<std::string> simulated;  ///< "column,name=tau_model,scale=1"
    std::optional<std::string> arm;        ///< "urdf,file=robot.urdf"

    [[nodiscard]] bool any() const { return simulated || arm; }
};
void attach_given(Options& options, GivenOptions& given);

/// In the same order; `validation` is empty without a validation log.
struct GivenTerms {
    std::vector<GivenTerm> log, validation;
    std::optional<SimulatedTerm> simulated;  ///< as stated, for the improved model
    std::optional<ArmAccount> arm;
};

/// A log as a diagnosis reads it.
struct GivenLog {
    std::string path;
    Log& log;  ///< rows that a given term does not span are taken out
};

/// Reads what the options state, or the model: `stated`. `reading`: how the log is read, so that its further
/// columns are read alike. Throws UsageError, DataError, FileError.
[[nodiscard]] GivenTerms read_given(const GivenOptions& options, const std::optional<SimulatedTerm>& stated,
                                    const ReadOptions& reading, const GivenLog& log,
                                    const GivenLog* validation);

}  // namespace ripplenotch
