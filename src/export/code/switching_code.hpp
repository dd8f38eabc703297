// SPDX-License-Identifier: MIT
#pragma once
// The fixed parts of a header with a table's filters, with @fields@ to fill in. Its arithmetic is that of
// export/run/switching_run.cpp, operation by operation.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "ripplenotch/export/filter_set.hpp"
#include "ripplenotch/export/target.hpp"

namespace ripplenotch {

/// Declarations that identify the form of a header to a reader.
inline constexpr std::string_view svf_fields = "a1, a2, a3, m0, m1, m2;";
inline constexpr std::string_view df1_memory = "x1, x2, y1, y2;";

class SwitchingCode {
  public:
    SwitchingCode(const Arithmetic& arithmetic, const FilterSet& filters);

    [[nodiscard]] std::string declarations() const;
    [[nodiscard]] std::string regions_open() const;
    [[nodiscard]] std::string section_functions() const;
    [[nodiscard]] std::string step_function() const;
    [[nodiscard]] std::string self_test_open() const;
    [[nodiscard]] std::string self_test_function() const;

  private:
    [[nodiscard]] std::string product(std::string_view coefficient, std::string_view signal) const;
    [[nodiscard]] std::string supervisor() const;
    [[nodiscard]] std::string blend_functions() const;
    [[nodiscard]] std::string filter_code() const;

    Arithmetic arithmetic_;
    bool fixed_, by_speed_, all_bands_, blends_;
};

// A table's filters as exported code runs them, over float, double or fixed point: the same operations in the
// same order as the C (src/export/code/switching_code.cpp), so that both give the same bits where nothing is
// contracted.

inline constexpr int region_passes = -1;  ///< no filter: the torque passes
inline constexpr int region_holds = -2;   ///< the active filter stays

/// Active while |v| <= to and above the region before. With full and none apart, the share of the filtered
/// signal in the output falls linearly from 1 at `full` to 0 at `none`.
struct SwitchingRegion {
    double to_deg_s = 0.0;  ///< infinite in the last
    int band = region_passes;
    double full_deg_s = 0.0, none_deg_s = 0.0;
};

/// The same regions as the method `switching` runs (docs/methods/switching.md), slowest first.
[[nodiscard]] std::vector<SwitchingRegion> switching_regions(const FilterSet& filters);

/// Last bits of a signal that its product does without: it has 64 bits, 31 of a coefficient and the upper 32
/// of a signal.
inline constexpr int unused_bits = 16;

/// Whether every band runs all the time, not only the one in force.
[[nodiscard]] bool runs_all_bands(const SwitchingDesign& design);

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
