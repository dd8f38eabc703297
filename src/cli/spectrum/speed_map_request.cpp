// SPDX-License-Identifier: MIT
#include "cli/spectrum/speed_map_request.hpp"

#include <fmt/format.h>

#include <array>

#include "ripplenotch/analysis/motion_runs.hpp"
#include "ripplenotch/analysis/order_map.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/document/speed_map_json.hpp"

namespace ripplenotch {
namespace {

constexpr std::array<std::string_view, 2> map_names = {"campbell", "order"};

std::string map_csv(const SpeedMap& map, std::string_view axis_name) {
    std::string text = fmt::format("speed_deg_s,{},amplitude_nm\n", axis_name);
    for (std::size_t row = 0; row < map.speed_deg_s.size(); ++row) {
        const std::string speed = fmt::format("{:.6g}", map.speed_deg_s[row]);
        for (std::size_t k = 0; k < map.axis.size(); ++k) {
            text += fmt::format("{},{:.6g},{:.6g}\n", speed, map.axis[k], map.amplitude_nm[row][k]);
        }
    }
    return text;
}

std::string in_words(const SpeedMap& map, std::string_view unit, std::optional<double> asked) {
    std::string text =
        fmt::format("{} speeds in steps of {} deg/s, resolution {:.3g} {}", map.speed_deg_s.size(),
                    shortest(map.speed_step_deg_s), map.resolution, unit);
    if (asked && map.resolution > 1.001 * *asked)
        text += fmt::format(" instead of {}: no run of motion is long enough", shortest(*asked));
    return text;
}

}  // namespace

void attach_speed_map(Options& options, SpeedMapRequest& request) {
    options.text("--map", request.map, "campbell|order",
                 "over speed: frequency against speed, or order against speed");
    attach_gear(options, request.gear,
                {.ratio = "--map order: count orders per motor turn instead of per output turn",
                 .orders = "--map: orders whose lines are drawn, in cycles per motor turn (default: 1,2)",
                 .joint_file = "--map: joint.json with gear ratio and orders"});
    options.number("--resolution", request.resolution, Dimension::none, "of the map, in Hz or orders");
    options.number("--highest", request.highest, Dimension::none, "frequency or order where the map ends");
    options.quantity("--speed-step", request.speed_step, Dimension::speed, "width of a row of the map");
}

void check_speed_map(const SpeedMapRequest& request) {
    if (!request.map) {
        if (request.gear.any() || request.resolution || request.highest || request.speed_step) {
            raise<UsageError>(
                "--joint-file, --gear-ratio, --orders, --resolution, --highest and --speed-step belong to "
                "--map");
        }
        return;
    }
    if (*request.map != map_names[0] && *request.map != map_names[1])
        raise<UsageError>("--map: '{}' is none of campbell, order", *request.map);
    const auto positive = [](std::string_view option, std::optional<double> value) {
        if (value && !(*value > 0.0)) raise<UsageError>("{} {} is not above 0", option, shortest(*value));
    };
    check_gear(request.gear);
    positive("--resolution", request.resolution);
    positive("--highest", request.highest);
    if (request.speed_step) positive("--speed-step", request.speed_step->value());
}

MapLines map_lines(const SpeedMapRequest& request, Provenance& provenance) {
    const GearChoice choice(request.gear);
    if (choice.joint()) provenance.inputs.push_back(input_record(choice.joint()->path));
    MapLines lines{choice.of(), false};
    if (!lines.gear && !request.gear.orders.empty()) raise_no_gear("--orders");
    lines.axis_per_motor_turn = lines.gear && *request.map == "order";
    return lines;
}

SpeedMapResult speed_map_result(const SpeedMapRequest& request, const MapLines& lines, const Trace& trace,
                                const CommonOptions& common, const Provenance& provenance) {
    const bool campbell = *request.map == "campbell";
    const TraceView view = trace.view();
    OutputAngle angle = output_angle(view);
    for (double& turns : angle.turns) turns *= lines.gear ? lines.gear->ratio.value() : 1.0;
    const std::vector<double> speed = smoothed_speed(view);
    SpeedMap map = speed_map(view, angle.turns, speed,
                             {.axis = campbell ? Axis::time : Axis::angle,
                              .resolution = request.resolution,
                              .highest = request.highest,
                              .speed_step = request.speed_step.value_or(DegPerSec(0.0))});
    const std::string_view axis = campbell ? "frequency_hz" : lines.gear ? "order" : "order_output";
    const std::string words = in_words(map, campbell ? "Hz" : "orders", request.resolution);
    if (request.resolution && map.resolution > 1.001 * *request.resolution) {
        say_warnings(common, std::vector{words});
    } else {
        say(common, words);
    }
    std::string text =
        common.json ? speed_map_text(trace.joint, map, axis, lines.gear, provenance) : map_csv(map, axis);
    return {std::move(text), std::move(map)};
}

}  // namespace ripplenotch
