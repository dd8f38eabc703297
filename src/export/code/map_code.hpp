// SPDX-License-Identifier: MIT
#pragma once
// The amplitudes of a map as C: what its form needs, written out.

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
    /// By direction and column, in it by order, cosine before sine. Instead of the speeds' columns, for each
    /// gap the value in its middle and the increment across it.
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

/// The same amplitudes with the second comb's columns as orders of their own behind the first comb's, counted
/// from where the joint's angle is counted in C. The map itself where it has no second comb.
[[nodiscard]] RippleMap with_combs_apart(const RippleMap& map);

/// The C code of one map. Functions have only the parameters that the form needs, so that a compiler has
/// nothing to warn of.
class MapCode {
  public:
    MapCode(const RippleMap& map, const CodeStyle& style)
        : map_(map), apart_(with_combs_apart(map)), style_(style) {}

    /// Tables, and the function NAME_at where amplitudes are not the same everywhere.
    [[nodiscard]] std::string definitions() const;
    /// Lines that declare z[], the amplitudes here, cosine before sine.
    [[nodiscard]] std::string amplitudes_here() const;

  private:
    [[nodiscard]] bool is_constant() const { return map_.form.columns() == 1; }
    [[nodiscard]] std::string arguments(bool with_types) const;
    [[nodiscard]] bool by_joint() const { return map_.form.second_comb != 0; }
    [[nodiscard]] std::string sum(std::size_t part) const;
    [[nodiscard]] std::string side(std::size_t direction, std::string_view indent,
                                   std::string_view form) const;
    [[nodiscard]] std::string combined() const;

    const RippleMap& map_;
    RippleMap apart_;
    const CodeStyle& style_;
};

/// How the orders show at an angle, as lines that set c0, s0, c1, ...; an order twice an earlier one is its
/// double angle. `turns` is the angle's expression.
[[nodiscard]] std::string order_angles_code(const std::vector<double>& orders, std::string_view turns);

/// Code whose argument motor_turns is the angle by which these orders count: joint_turns under no_ratio.
/// Fills in @shaft@ and @fraction@.
[[nodiscard]] std::string by_shaft(std::string code, const std::vector<double>& orders, GearRatio ratio);

}  // namespace ripplenotch
