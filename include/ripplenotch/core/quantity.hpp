// SPDX-License-Identifier: MIT
#pragma once
// Numbers with a unit, as people write them on a command line or in a log's header: "13rad/s", "1kHz",
// "rad_s".

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace ripplenotch {

/// What a number measures. Each dimension has one unit inside the tool (see units.hpp), named by base_unit().
enum class Dimension {
    none,         ///< a plain number
    time,         ///< s
    frequency,    ///< Hz; rad/s is read as an angular frequency
    angle,        ///< deg
    speed,        ///< deg/s; rpm and Hz are turns of the joint
    torque,       ///< Nm
    torque_rate,  ///< Nm/s
    inertia,      ///< kg m^2
    decibel,      ///< dB
    current,      ///< A
};

[[nodiscard]] std::string_view base_unit(Dimension dimension);

/// Unit names that a dimension understands, the base unit first; for error messages and help.
[[nodiscard]] std::vector<std::string_view> unit_names(Dimension dimension);

/// Factor that turns a value in `unit` into the base unit, e.g. (speed, "rad/s") -> 57.29...; empty when the
/// unit does not belong to the dimension. Exact case, because mHz and MHz differ; "rad_s" and "rad/s" are the
/// same.
[[nodiscard]] std::optional<double> unit_factor(Dimension dimension, std::string_view unit);

/// Reads "12.5", "12.5Hz", "12.5 Hz" into the base unit; a bare number is already in the base unit.
/// Throws UsageError that names `what`, the text, and the units understood. Refuses nan and inf.
[[nodiscard]] double parse_quantity(std::string_view text, Dimension dimension, std::string_view what);

}  // namespace ripplenotch
