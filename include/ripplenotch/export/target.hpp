// SPDX-License-Identifier: MIT
#pragma once
// An export target is a record in a file of src/export/targets, a line in targets.def, and a page in
// docs/export. Law tests run over the list.

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ripplenotch/core/spec.hpp"
#include "ripplenotch/design/ripple_map.hpp"
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

// An export target of a ripple map is a record in a file of src/export/map_targets, and a line in
// map_targets.def. Law tests run over the list.

/// A map as it was read back.
struct LoadedMap {
    std::string arithmetic;  ///< "float32", "table of 1024 int8 values"
    RippleMap held;          ///< the map that the target holds, in full precision
    /// The ripple there, computed as the target computes; in Nm at the joint.
    std::function<double(const MapState&)> torque_nm;
};

struct MapTarget {
    std::string_view name, summary, source;
    std::string_view endings;  ///< file name endings, separated by blanks
    std::span<const Key> keys = {};
    /// `heading` describes the origin of the file, one line each. Throws UsageError, naming value, limit and
    /// remedy, when the target cannot hold the map; omitted parts are reported as a warning.
    Written (*write)(const RippleMap& map, const Settings& settings,
                     std::span<const std::string> heading) = nullptr;
    /// Reads the output of write(); `map` gives the gear and the map that was to be held. Throws DataError
    /// that begins with `source`.
    LoadedMap (*read)(std::string_view bytes, const std::string& source, const RippleMap& map,
                      const Settings& settings) = nullptr;
};

[[nodiscard]] std::span<const MapTarget* const> map_targets();
/// Throws UsageError with the nearest name.
[[nodiscard]] const MapTarget& find_map_target(std::string_view name);

/// The accuracy of the written map, over states within the range of the map.
struct MapCheck {
    std::size_t states = 0;
    double ripple_nm = 0.0;  ///< rms of the map
    /// Rms of the parts that the target cannot hold: other speeds, the joint's turn.
    double not_held_nm = 0.0;
    /// Error of the target's arithmetic, relative to the map that it was to hold.
    double largest_error_nm = 0.0;
};
[[nodiscard]] MapCheck verify_map_export(const RippleMap& map, const LoadedMap& loaded);

// Verification of an export: every section that was read back, run in the target's arithmetic and measured
// against its design.

/// A deeper notch than this is given as this: below it one would measure the test signal's own rounding.
inline constexpr double deepest_measured_db = 120.0;

/// The torque on which a section is run: a steady load with 1 Nm of ripple at the designed centre.
inline constexpr double verify_load_nm = 8.0;

struct SectionCheck {
    int band = 0;  ///< number, 0 without bands
    DegPerSec from, to;
    int section = 1;  ///< from 1
    std::optional<Order> order;
    GearRatio gear_ratio;                 ///< under which it counts
    Hertz center;                         ///< as designed
    bool is_notch = true;                 ///< false: a section of a low-pass, which has no depth
    std::optional<double> shift_percent;  ///< shift of the centre, from the values read; empty: it has none
    double designed_gain = 0.0;           ///< at the centre of a notch
    double q = 0.0;                       ///< Q of the poles read
    double response_depth_db = 0.0;       ///< at the designed centre, from the coefficients read
    std::optional<double> depth_db;       ///< the same, from running it; empty when it cannot be run
    std::optional<double> dc_error_db;    ///< error of the gain at 0 Hz, from running it
    std::optional<double> mean_error_nm;  ///< on the load of 8 Nm, from running it
    double pole_radius = 0.0;             ///< below 1 is stable
};

/// Centre (where the zeros are, or the poles of a low-pass), Q, depth and largest pole radius of a transfer
/// function; everything but what takes running.
[[nodiscard]] SectionCheck check_response(const Biquad& section, const ExportSection& designed,
                                          Hertz sample_rate);

/// Throws DataError when bands or sections are not as many as in `filters`.
[[nodiscard]] std::vector<SectionCheck> verify_export(const FilterSet& filters, const LoadedFilters& loaded,
                                                      const std::string& source);

/// One sentence for each section that is not stable, and with a tolerance for each whose centre has moved by
/// more per cent of its frequency, or whose gain there or at 0 Hz is off by more per cent of the input.
[[nodiscard]] std::vector<std::string> export_violations(const std::vector<SectionCheck>& checks,
                                                         std::optional<double> tolerance_percent);

}  // namespace ripplenotch
