// SPDX-License-Identifier: MIT
#pragma once
// `export` of a ripple map.

#include <string>

#include "cli/options/options.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch {

/// What export does with a map: the options that a map has too.
struct MapExport {
    std::string map, to;
    bool verify = false;
    CommonOptions common;
};

/// Writes the map in the form of the target, reads it back and tells what came through. Throws UsageError,
/// DataError.
ExitCode export_map(const MapExport& request, const std::string& command_line);

}  // namespace ripplenotch
