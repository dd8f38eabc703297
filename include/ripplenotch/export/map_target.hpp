// SPDX-License-Identifier: MIT
#pragma once
// An export target of a ripple map is a record in a file of src/export/map_targets, and a line in
// map_targets.def. Law tests run over the list.

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ripplenotch/core/spec.hpp"
#include "ripplenotch/design/ripple_map.hpp"
#include "ripplenotch/export/target.hpp"

namespace ripplenotch {

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

}  // namespace ripplenotch
