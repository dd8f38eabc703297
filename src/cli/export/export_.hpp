// SPDX-License-Identifier: MIT
#pragma once
#include <string>

#include "cli/options/options.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/document/simulation_json.hpp"
#include "ripplenotch/evaluate/contender.hpp"
#include "ripplenotch/export/target.hpp"

namespace ripplenotch {

// What every export does with the file that it made: writes it, reads it again, tells what came through.

/// Writes the bytes where they were asked for, and says the warnings.
void write_export(const Written& written, const CommonOptions& common, bool binary = false);

/// What was written, as it stands in the file; that of a pipe or a device, which cannot be read again, as it
/// was in memory.
struct ReadBack {
    std::string bytes, source;  ///< source: "notch.h", "standard output"
};

[[nodiscard]] ReadBack read_back(const Written& written, const CommonOptions& common);

}  // namespace ripplenotch
