// SPDX-License-Identifier: MIT
#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "cli/options/options.hpp"
#include "ripplenotch/analysis/order_map.hpp"
#include "ripplenotch/chart/spectrum_figure.hpp"
#include "ripplenotch/core/trace.hpp"
#include "ripplenotch/document/provenance.hpp"
#include "ripplenotch/document/spectrum_json.hpp"
#include "ripplenotch/log/log.hpp"

namespace ripplenotch {

// The spectrum in pieces of a log that is not held.

/// What torque_spectrum and whole_log say of the whole log. `tell` is called once, when the log's layout and
/// warnings are known, before anything is thrown that the spectrum has to say.
[[nodiscard]] LogSpectrum streamed_spectrum(LogPasses& log, const SpectrumOptions& options,
                                            const std::function<void()>& tell);

}  // namespace ripplenotch
