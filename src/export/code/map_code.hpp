// SPDX-License-Identifier: MIT
#pragma once
// The amplitudes of a map as C.

#include <string>
#include <vector>

#include "export/code/method_code.hpp"
#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/design/ripple_map.hpp"

namespace ripplenotch {

/// The numbers of a map, as C holds them.
class MapTables {
  public:
    std::vector<double> speeds;
    /// Between each speed and the next: 1 / gap, and less the middle times that.
    std::vector<double> slopes, offsets;
    /// Speed below which the directions blend; the joint's angle from which it is counted, in negative turns.
    std::vector<double> limits;
    /// By direction and column, in it by order, cosine before sine; those of a second comb as orders of their
    /// own behind the first comb's, counted from where the joint's angle is counted. Instead of the speeds'
    /// columns, for each gap the value in its middle and the increment across it.
    std::vector<double> amplitudes;

    explicit MapTables(const RippleMap& map);
    /// Those of a header; `map` gives their number.
    MapTables(TextReader& reader, const RippleMap& map, const CodeStyle& style);
    MapTables() = default;
    [[nodiscard]] static std::size_t columns_a_direction(const MapForm& form);

  private:
    template <class Of>
    void add(const RippleMap& map, const Of& of);
};

/// The tables of a map and its functions.
[[nodiscard]] std::string map_code(const RippleMap& map, const CodeStyle& style);

/// The table of the orders, and of each the place of an earlier one that it is twice of; -1 where there is
/// none.
[[nodiscard]] std::string angles_code(const std::vector<double>& orders, const CodeStyle& style);
[[nodiscard]] std::vector<int> halves_of(const std::vector<double>& orders);

/// Code whose argument motor_turns is the angle by which these orders count: joint_turns under no_ratio. Says
/// whether a fraction of the turn is enough.
[[nodiscard]] std::string by_shaft(std::string code, const std::vector<double>& orders, GearRatio ratio);

}  // namespace ripplenotch
