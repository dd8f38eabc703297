// SPDX-License-Identifier: MIT
#pragma once
// An export target is a record in a file of src/export/targets, a line in targets.def, and a page in
// docs/export. Law tests run over the list.

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ripplenotch/core/spec.hpp"
#include "ripplenotch/design/running_design.hpp"
#include "ripplenotch/export/filter_set.hpp"

namespace ripplenotch {

struct Written {
    std::string bytes;
    /// Parts that the target cannot hold exactly and how they were rounded.
    std::vector<std::string> warnings;
};

/// Bands and sections in the order of the file.
struct LoadedFilters {
    std::vector<std::vector<LoadedSection>> bands;
};

struct Target {
    std::string_view name, summary, source;
    std::string_view endings;  ///< file name endings, separated by blanks
    bool binary = false;
    bool notches_only = false;     ///< it cannot hold a low-pass
    bool switches = false;         ///< it holds the bands of a table, one for each range of speed
    bool runs_supervisor = false;  ///< it holds hysteresis, dwell and transition, too
    std::span<const Key> keys = {};
    /// `heading` describes the origin of the file, one line each, for a comment; it may be empty. Throws
    /// UsageError, naming value, limit and remedy, when the target cannot hold the filters.
    Written (*write)(const FilterSet& filters, const Settings& settings,
                     std::span<const std::string> heading) = nullptr;
    /// Reads the output of write(), from the bytes alone; `filters` gives the rate and speeds at which
    /// parameters become filters. Throws DataError that begins with `source`.
    LoadedFilters (*read)(std::string_view bytes, const std::string& source, const FilterSet& filters,
                          const Settings& settings) = nullptr;
    /// One line to paste where the file is used, with `path` in it; may be empty.
    std::string (*usage)(const FilterSet& filters, const Settings& settings,
                         const std::string& path) = nullptr;
};

[[nodiscard]] std::span<const Target* const> export_targets();
/// Throws UsageError with the nearest name.
[[nodiscard]] const Target& find_target(std::string_view name);

// Methods whose coefficients change while they run, as C99: constants, a state, and one function a sample,
// without allocation, in bounded time.

/// Whether this export target takes such methods.
[[nodiscard]] bool is_code_target(std::string_view target);

/// name, precision.
[[nodiscard]] std::span<const Key> method_code_keys();

/// The header. `heading` describes its origin, one line each. Throws UsageError.
[[nodiscard]] Written write_method_code(const RunningDesign& design, const Settings& settings,
                                        std::span<const std::string> heading);

/// A sample, as a controller has it.
struct CodeInput {
    double torque_nm = 0.0, speed_deg_s = 0.0;
    double motor_turns = 0.0;  ///< the motor's angle; its fraction is enough
    double joint_deg = 0.0;
};

/// The written file, read back from the bytes alone and run in the target's arithmetic.
struct LoadedCode {
    std::string arithmetic;  ///< "float32"
    /// The next sample; gives the torque without ripple. Copies share their state.
    std::function<double(const CodeInput&)> step;
};
/// `design` gives the number of orders. Throws DataError that begins with `source`.
[[nodiscard]] LoadedCode read_method_code(std::string_view bytes, const std::string& source,
                                          const RunningDesign& design, const Settings& settings);

}  // namespace ripplenotch
