// SPDX-License-Identifier: MIT
#pragma once
// --model auto: the model that identify gives of the log itself.

#include "cli/diagnose/diagnose_request.hpp"
#include "ripplenotch/model/model.hpp"

namespace ripplenotch {

/// What --model says for it.
inline constexpr std::string_view model_from_log = "auto";

/// Gear ratio and ripple orders as identify finds them in the log of the request (--gear-ratio goes before
/// what it finds), and an inertia where the speed changes. All values are left out, to be fitted. Throws
/// DataError, with identify's own verdict, where the log tells no gear ratio.
[[nodiscard]] Model identified_model(const DiagnoseRequest& request, const LogOptions& words);

/// "gear ratio 100, inertia, ripple of orders 1 and 2".
[[nodiscard]] std::string model_in_words(const Model& model);

}  // namespace ripplenotch
