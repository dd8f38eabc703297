// SPDX-License-Identifier: MIT
#pragma once
// A table's filters as exported code runs them: the C of design/runtime/switching.h over float, double or
// fixed point.

#include <cstdint>
#include <vector>

#include "ripplenotch/design/candidate_table.hpp"
#include "ripplenotch/export/filter_set.hpp"
#include "ripplenotch/export/target.hpp"

namespace ripplenotch {

/// The same regions as the method `switching` runs (docs/methods/switching.md), slowest first.
[[nodiscard]] std::vector<SpeedRegion> switching_regions(const FilterSet& filters);

/// In fixed point a coefficient is mantissa / 2^shift, its mantissa as long as the word: 31 bits.
struct FixedCoefficient {
    std::int32_t mantissa = 0;
    int shift = 31;

    [[nodiscard]] static FixedCoefficient of(double value);
    [[nodiscard]] double value() const;
};
/// What a section has beyond x itself: a1, a2, a3, m0 - 1, m1, m2. So a notch passes a constant bit for bit.
[[nodiscard]] std::vector<FixedCoefficient> fixed_coefficients(const SvfSection& section);

/// Speeds are whole thousandths of their unit.
inline constexpr double fixed_speed_steps = 1000.0;
/// Bits that a signal has below the last one of a word of torque.
[[nodiscard]] int fraction_bits(const Arithmetic& arithmetic);
/// The word of a torque, and back; saturated.
[[nodiscard]] std::int64_t fixed_word(double torque_nm, const Arithmetic& arithmetic);
[[nodiscard]] double fixed_torque_nm(std::int64_t word, const Arithmetic& arithmetic);
/// Enough that no signal inside of the filters overflows: from the sums of the magnitudes of their impulse
/// responses, and one bit more for switches.
[[nodiscard]] int headroom_bits(const FilterSet& filters);

struct GoldenVector {
    std::vector<double> torque_nm, speed_deg_s, expected_nm;
    double rounding_rms_nm = 0.0;  ///< in fixed point: rms difference from the same filters in double
};

/// Torque and speed that float holds exactly, going through the regions up and down, and the output of the
/// filters in their own arithmetic.
[[nodiscard]] GoldenVector golden_vector(const FilterSet& filters, const LoadedFilters& loaded);

}  // namespace ripplenotch
