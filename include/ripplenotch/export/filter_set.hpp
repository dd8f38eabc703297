// SPDX-License-Identifier: MIT
#pragma once
// The input of an export: sections with their design values, band by band, whether they come from a candidate
// table or from one filter that runs at every speed.

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ripplenotch/core/biquad.hpp"
#include "ripplenotch/core/quantity.hpp"
#include "ripplenotch/design/candidate_table.hpp"
#include "ripplenotch/design/notch.hpp"
#include "ripplenotch/design/running_design.hpp"

namespace ripplenotch {

struct ExportSection {
    std::optional<Order> order;      ///< the line that a table's notch stands for
    std::optional<NotchSpec> notch;  ///< empty for a section of a low-pass
    Hertz center;                    ///< the notch's centre, else the natural frequency of the poles
    Biquad section;
    GearRatio gear_ratio{};  ///< under which the order counts; no_ratio: by turns of the joint
};

struct ExportBand {
    int number = 0;      ///< from 1; 0 for a filter without bands
    DegPerSec from, to;  ///< active while from < |v| <= to; both 0 without bands
    std::vector<ExportSection> sections;

    [[nodiscard]] DegPerSec middle() const { return 0.5 * (from + to); }
};

/// At least one band of at least one section; all bands have the same number of sections; every section has
/// gain 1 at 0 Hz and is stable.
struct FilterSet {
    Hertz sample_rate;
    std::optional<GearRatio> gear_ratio;  ///< there exactly when the bands are chosen by joint speed
    std::vector<ExportBand> bands;
    SwitchingDesign switching = {};  ///< how the bands take turns

    [[nodiscard]] bool by_speed() const { return gear_ratio.has_value(); }
    [[nodiscard]] std::size_t sections_per_band() const { return bands.front().sections.size(); }
};

[[nodiscard]] FilterSet filter_set(const CandidateTable& table, const SwitchingDesign& switching);
/// With the rules that the table itself holds.
[[nodiscard]] FilterSet filter_set(const CandidateTable& table);
/// One band of a table, to run at every speed. Throws UsageError when there is no band of that number.
[[nodiscard]] FilterSet only_band(const FilterSet& table, int number);
/// One filter for all speeds. Throws what design_notch throws, UsageError when there is no notch.
[[nodiscard]] FilterSet filter_set(std::span<const NotchSpec> notches, Hertz sample_rate);
/// Throws what design_low_pass throws.
[[nodiscard]] FilterSet filter_set(const LowPassSpec& low_pass, Hertz sample_rate);

// How a target computes: the structure of a section and the width of its numbers. The same loops run here, in
// float where the target has float, so that the measured filter is the one that will run.

enum class Form {
    df1,   ///< direct form I: past inputs and outputs
    df2t,  ///< transposed direct form II: two sums
    svf,   ///< state-variable filter of two trapezoidal integrators
};
/// q31: torques and coefficients of 32 bits, sums and memories of 64.
enum class Precision { float32, float64, q31 };
[[nodiscard]] constexpr bool is_fixed(Precision precision) { return precision == Precision::q31; }

struct Arithmetic {
    Form form = Form::df2t;
    Precision precision = Precision::float64;
    /// In fixed point: the torque of the largest word, and the bits of a signal above it, for what is larger
    /// than the torque inside of a filter.
    double full_scale_nm = 0.0;
    int headroom_bits = 0;
};
[[nodiscard]] std::string arithmetic_name(Arithmetic arithmetic);  ///< "float32, state-variable form"

/// From the notch's own figures where there are any, else from the poles and zeros of the section.
[[nodiscard]] SvfSection svf_of(const ExportSection& section, Hertz sample_rate);
/// The transfer function of what stands in `section`, consistent or not.
[[nodiscard]] Biquad biquad_of(const SvfSection& section);

/// A section as it was read back. Values are those that the target holds: exact floats in a float32 target.
struct LoadedSection {
    Arithmetic arithmetic;
    Biquad biquad;   ///< its transfer function, a1 and a2 in the sign of core/biquad.hpp
    SvfSection svf;  ///< used when the form is svf
};
[[nodiscard]] LoadedSection loaded(const Biquad& section, Arithmetic arithmetic);
[[nodiscard]] LoadedSection loaded(const SvfSection& section, Precision precision);

/// Runs one section over `in` from zero state, in its own arithmetic. Spans of equal length.
void run_section(const LoadedSection& section, std::span<const double> in, std::span<double> out);

}  // namespace ripplenotch
