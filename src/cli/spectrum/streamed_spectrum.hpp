// SPDX-License-Identifier: MIT
#pragma once
// The spectrum in pieces of a log that is not held.

#include <functional>

#include "ripplenotch/document/spectrum_json.hpp"
#include "ripplenotch/log/passes.hpp"

namespace ripplenotch {

/// What torque_spectrum and whole_log say of the whole log. `tell` is called once, when the log's layout and
/// warnings are known, before anything is thrown that the spectrum has to say.
[[nodiscard]] StretchSpectrum streamed_spectrum(LogPasses& log, const SpectrumOptions& options,
                                                const std::function<void()>& tell);

}  // namespace ripplenotch
