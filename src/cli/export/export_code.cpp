// SPDX-License-Identifier: MIT
#include "cli/export/export_code.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "cli/export/written_file.hpp"
#include "ripplenotch/core/output_name.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/core/version.hpp"
#include "ripplenotch/export/method_code.hpp"
#include "ripplenotch/filter/running_design.hpp"

namespace ripplenotch {
namespace {

constexpr std::size_t samples = 1'000'000, block = 10'000;
constexpr double swing_s = 5.0, fastest_deg_s = 80.0 * 2.0 * std::numbers::pi / swing_s;

// A joint that swings under a slow torque, with ripple of every order and noise: the same on every machine.
// With a map it swings where the map was made, no faster than there.
class Swing {
  public:
    explicit Swing(const CodeExport& request)
        : gear_(*request.method.gear), rate_hz_(request.sample_rate.value()) {
        if (request.method.map == nullptr) return;
        const RippleMap& map = *request.method.map;
        if (map.speeds_deg_s.to > 0.0) fastest_deg_s_ = std::min(fastest_deg_s_, map.speeds_deg_s.to);
        position_ = map.positions_deg.middle();
    }

    struct Sample {
        double torque_nm, velocity_deg_s, position_deg, motor_turns;
    };
    Sample at(std::size_t k) {
        const double phase = 2.0 * std::numbers::pi * static_cast<double>(k) / rate_hz_ / swing_s;
        const double velocity = fastest_deg_s_ * portable::cos(phase);
        // By trapezoids, as the tool adds a velocity up: while the motor is slow it may take that way.
        if (k > 0) position_ += 0.5 * (before_ + velocity) / rate_hz_;
        before_ = velocity;
        const double turns = gear_.ratio.value() * position_ / 360.0;
        double torque = 6.0 * portable::sin(0.3 * phase) + 0.05 * noise();
        for (const Order order : gear_.orders)
            torque += 0.5 * portable::cos(2.0 * std::numbers::pi * order.value() * turns + order.value());
        return {torque, velocity, position_, turns};
    }

  private:
    // Sum of four even numbers from -1 to 1, about the variance of a normal one.
    double noise() {
        double sum = 0.0;
        for (int i = 0; i < 4; ++i) {
            state_ = state_ * 6364136223846793005ULL + 1442695040888963407ULL;
            sum += static_cast<double>(state_ >> 40U) / static_cast<double>(1U << 23U) - 1.0;
        }
        return sum;
    }

    const GearAccount& gear_;
    double rate_hz_, fastest_deg_s_ = fastest_deg_s;
    double position_ = 0.0, before_ = 0.0;
    std::uint64_t state_ = 20;
};

struct CodeCheck {
    double largest_error_nm = 0.0, largest_nm = 0.0;
};

CodeCheck run_beside(const CodeExport& request, const LoadedCode& code) {
    CodeCheck check;
    Swing swing(request);
    const auto filter = request.method.start(request.sample_rate);
    std::vector<double> torque(block), velocity(block), position(block), out(block), coded(block);
    for (std::size_t first = 0; first < samples; first += block) {
        for (std::size_t k = 0; k < block; ++k) {
            const Swing::Sample now = swing.at(first + k);
            torque[k] = now.torque_nm;
            velocity[k] = now.velocity_deg_s;
            position[k] = now.position_deg;
            const double angle = now.motor_turns - std::floor(now.motor_turns);
            coded[k] = code.step({now.torque_nm, now.velocity_deg_s, angle, now.position_deg});
        }
        filter->process({velocity, torque, position}, out);
        for (std::size_t k = 0; k < block; ++k) {
            check.largest_error_nm = std::max(check.largest_error_nm, std::abs(coded[k] - out[k]));
            check.largest_nm = std::max(check.largest_nm, std::abs(out[k]));
        }
    }
    return check;
}

}  // namespace

ExitCode export_code(const CodeExport& request, const std::string& command_line) {
    if (request.common.json) raise<UsageError>("--json: of a method as code nothing is told as JSON yet");
    const Spec spec = parse_spec(request.to);
    if (!is_code_target(spec.name)) {
        raise<UsageError>("target {} takes coefficients, and those of {} change while it runs; use c-header",
                          spec.name, request.method.method->name);
    }
    const Settings settings(fmt::format("target {}", spec.name), spec, method_code_keys());
    check_output_name(request.common.output, spec.name, ".h .hpp");
    const auto design = running_design(*request.method.method, request.method.settings, request.sample_rate);
    const std::array<std::string, 2> heading = {fmt::format("Made by {} {}:", tool_name, version()),
                                                command_line};
    const Written written = write_method_code(*design, settings, heading);
    write_export(written, request.common);
    if (!request.verify) return ExitCode::done;
    const ReadBack again = read_back(written, request.common);
    const LoadedCode code = read_method_code(again.bytes, again.source, *design, settings);
    const CodeCheck check = run_beside(request, code);
    tell_check(fmt::format("{}: {}, read back and run beside the method over {} samples in {}.\n"
                           "largest output          {:.4g} Nm\n"
                           "largest difference      {:.1e} Nm\n",
                           again.source, spec.text(), samples, code.arithmetic, check.largest_nm,
                           check.largest_error_nm),
               request.common);
    return ExitCode::done;
}

}  // namespace ripplenotch
