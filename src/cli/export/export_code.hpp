// SPDX-License-Identifier: MIT
#pragma once
// `export` of a method whose coefficients change while it runs.

#include <string>

#include "cli/options/options.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/evaluate/contender.hpp"

namespace ripplenotch {

struct CodeExport {
    const Contender& method;
    Hertz sample_rate;
    std::string to;
    bool verify = false;
    CommonOptions common;
};

/// Writes its code; with verify reads it back and runs it beside the method itself over a million samples.
/// Throws UsageError for a target that takes coefficients only.
ExitCode export_code(const CodeExport& request, const std::string& command_line);

}  // namespace ripplenotch
