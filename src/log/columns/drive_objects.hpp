// SPDX-License-Identifier: MIT
#pragma once
// Names that drives give their quantities: object indices of CiA 402, and German names of one word.

#include <optional>
#include <string>
#include <string_view>

#include "ripplenotch/log/layout.hpp"

namespace ripplenotch {

/// An object of the CiA 402 drive profile. Its numbers are counts or per mille of a rated value: what these
/// are is set in the drive
/// (https://www.can-cia.org/can-knowledge/cia-402-series-canopen-device-profile-for-drives-and-motion-control).
struct DriveObject {
    unsigned index = 0;  ///< of the first axis
    Role role = Role::other;
    std::string_view unit;
    bool reference = false, current = false;
};

/// The object whose index a name holds ("velocity_actual_value_0x606C", "6064h", "16#6077:00"), and the name
/// without it. Objects of a drive's second axis stand 0x800 further, and so on.
struct NamedObject {
    const DriveObject* object = nullptr;  ///< null for a name without a known index
    std::string name;                     ///< "velocity_actual_value_", with "axis2" for a second axis
};
[[nodiscard]] NamedObject drive_object(std::string_view name);

/// The object that CiA 402 calls so: "Position actual value".
[[nodiscard]] const DriveObject* drive_object_named(std::string_view words);

/// "position" of "istposition" or "lageistwert"; with `reference` for "sollposition". Empty for other words.
struct GermanWord {
    std::string_view quantity;
    bool reference = false;
};
[[nodiscard]] std::optional<GermanWord> german_quantity(std::string_view word);

}  // namespace ripplenotch
