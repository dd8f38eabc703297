// SPDX-License-Identifier: MIT
#pragma once
// Methods whose coefficients change while they run, as C99: constants, a state, and one function a sample,
// without allocation, in bounded time.

#include <functional>
#include <span>
#include <string>
#include <string_view>

#include "ripplenotch/core/spec.hpp"
#include "ripplenotch/design/running_design.hpp"
#include "ripplenotch/export/target.hpp"

namespace ripplenotch {

/// Whether this export target takes such methods, and whether it has the code of this one.
[[nodiscard]] bool is_code_target(std::string_view target);
[[nodiscard]] bool has_code(std::string_view method);

/// name, precision.
[[nodiscard]] std::span<const Key> method_code_keys();

/// The header. `heading` says what made it, one line each. Throws UsageError.
[[nodiscard]] Written write_method_code(const RunningDesign& design, const Settings& settings,
                                        std::span<const std::string> heading);

/// A sample, as a controller has it.
struct CodeInput {
    double torque_nm = 0.0, speed_deg_s = 0.0;
    double motor_turns = 0.0;  ///< the motor's angle; its fraction is enough
    double joint_deg = 0.0;
    double temperature_degc = 0.0;  ///< for a map that depends on it
};

/// What was written, read back from the bytes alone and run in the target's arithmetic.
struct LoadedCode {
    std::string arithmetic;  ///< "float32"
    /// The next sample; gives the torque without ripple. Copies share their state.
    std::function<double(const CodeInput&)> step;
};
/// `design` says how many orders there are. Throws DataError that begins with `source`.
[[nodiscard]] LoadedCode read_method_code(std::string_view bytes, const std::string& source,
                                          const RunningDesign& design, const Settings& settings);

}  // namespace ripplenotch
