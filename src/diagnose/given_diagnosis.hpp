// SPDX-License-Identifier: MIT
#pragma once
// A diagnosis of a log of which a part is given: an arm's rigid bodies, the user's own simulation.

#include "ripplenotch/diagnose/diagnosis.hpp"

namespace ripplenotch {

/// diagnose() with options.given. Names are found beside whatever the given terms leave. Throws UsageError: a
/// given term without a value for each row, or for the validation log none.
[[nodiscard]] Diagnosis diagnose_given(const Model& model, const TraceView& log, const TraceView* validation,
                                       const DiagnosisOptions& options);

}  // namespace ripplenotch
