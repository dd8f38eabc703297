// SPDX-License-Identifier: MIT
#pragma once
// Command lines that people paste.

#include <string>

#include "cli/options/options.hpp"
#include "ripplenotch/core/gear_account.hpp"

namespace ripplenotch {

/// " --from 2s --unit velocity=rad/s": the options that read a log in this way, each with a blank before it.
[[nodiscard]] std::string log_words(const LogOptions& log);

/// " --gear-ratio 100 --orders 1,2"
[[nodiscard]] std::string gear_words(const GearAccount& gear);

/// A name for the filtered log beside this one: "filtered.csv".
[[nodiscard]] std::string filtered_name(const std::string& log);

}  // namespace ripplenotch
