// SPDX-License-Identifier: MIT
#pragma once
// Spectra as people and programs read them.

#include <string>
#include <vector>

#include "ripplenotch/document/spectrum_json.hpp"

namespace ripplenotch {

/// The bins as CSV; several spectra with their number and speed in front.
[[nodiscard]] std::string frequency_csv(const std::vector<StretchSpectrum>& spectra);
[[nodiscard]] std::string order_csv(const Stack& stack);

/// The lines as tables.
[[nodiscard]] std::string frequency_peaks(const std::vector<StretchSpectrum>& spectra);
[[nodiscard]] std::string order_peaks(const OrderSpectrum& spectrum);

}  // namespace ripplenotch
