// SPDX-License-Identifier: MIT
#include "filter/map/map_data.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "filter/ripple/ripple_windows.hpp"
#include "ripplenotch/core/phasor.hpp"

namespace ripplenotch {
namespace {

constexpr std::size_t most_blocks = 16;  // by hand: parts that are left out in turn
constexpr std::size_t least_block = 3;   ///< windows, of which the middle one shares none of its samples

// Amplitudes and mean of what `torque_nm` holds along the log.
std::vector<RippleWindow> windows_of(const TraceView& log, const GearAccount& gear,
                                     std::span<const double> torque_nm) {
    std::vector<double> orders;
    for (const Order order : gear.orders) orders.push_back(order.value());
    MotorPath path(MotorAngle(gear.ratio.value(), log.sample_rate.value(), MotorAngle::Source::best, 0.0));
    RippleWindows windows(orders, log.sample_rate.value(), {});
    for (std::size_t k = 0; k < log.size(); ++k) {
        if (k > 0 && log.starts_run(k)) {
            windows.split();
            path.restart();
        }
        path.next(log.velocity_deg_s[k], log.has_position() ? &log.position_deg[k] : nullptr);
        windows.add(path, torque_nm[k]);
    }
    return windows.finish();
}

MapWindow window_of(const RippleWindow& window, const GearAccount& gear, double zero_deg, std::size_t log) {
    const double ratio = gear.ratio.value();
    MapWindow one;
    one.log = log;
    one.middle = window.middle;
    one.length = window.length;
    one.state = {360.0 * window.speed_turns_s / ratio, 360.0 * window.middle_turns / ratio, window.torque_nm};
    for (std::size_t i = 0; i < gear.orders.size(); ++i) {
        const double cycles = gear.orders[i].value() * ratio * zero_deg / 360.0;
        const double turned = 2.0 * std::numbers::pi * (cycles - std::floor(cycles));
        one.value.push_back(window.amplitudes[i] * std::conj(portable::phasor(turned)));
        one.noise.push_back(std::max(window.background[i], 2.0 * window.variance));
    }
    return one;
}

template <typename Value>
MapRange range_seen(const std::vector<MapWindow>& windows, const Value& value) {
    if (windows.empty()) return {};
    MapRange range{value(windows.front().state), value(windows.front().state)};
    for (const MapWindow& window : windows)
        range = {std::min(range.from, value(window.state)), std::max(range.to, value(window.state))};
    return range;
}

// Blocks of a log are alike in size. Windows half overlap: those at the ends of a block may share samples
// with the next one.
void number_blocks(MapData& data) {
    std::vector<MapWindow>& windows = data.windows;
    const std::size_t size = std::max(least_block, (windows.size() + most_blocks - 1) / most_blocks);
    for (std::size_t from = 0, to = 0; from < windows.size(); from = to) {
        while (to < windows.size() && windows[to].log == windows[from].log) ++to;
        const std::size_t count = to - from, blocks = (count + size - 1) / size;
        for (std::size_t i = from; i < to; ++i) windows[i].block = data.blocks + (i - from) * blocks / count;
        data.blocks += blocks;
    }
    for (std::size_t i = 1; i < windows.size(); ++i) {
        MapWindow &before = windows[i - 1], &after = windows[i];
        const double apart = after.middle - before.middle, share = 1e-9;
        const bool overlap = apart < (0.5 - share) * (before.length + after.length);
        if (after.log == before.log && after.block != before.block && overlap)
            before.scored = after.scored = false;
    }
}

}  // namespace

MapData map_data(std::span<const TraceView> logs, const GearAccount& gear, double zero_deg,
                 std::span<const std::vector<double>> temperatures_degc) {
    MapData data;
    for (std::size_t l = 0; l < logs.size(); ++l) {
        for (const RippleWindow& window : windows_of(logs[l], gear, logs[l].torque_nm))
            data.windows.push_back(window_of(window, gear, zero_deg, l));
        if (temperatures_degc.empty()) continue;
        const auto warmth = windows_of(logs[l], gear, temperatures_degc[l]);
        for (std::size_t i = 0, from = data.windows.size() - warmth.size(); i < warmth.size(); ++i)
            data.windows[from + i].state.temperature_degc = warmth[i].torque_nm;
    }
    data.frame.gear_ratio = gear.ratio;
    data.frame.orders = gear.orders;
    data.frame.zero_deg = zero_deg;
    data.frame.speeds_deg_s =
        range_seen(data.windows, [](const MapState& at) { return std::abs(at.speed_deg_s); });
    data.frame.positions_deg = range_seen(data.windows, [](const MapState& at) { return at.position_deg; });
    data.frame.loads_nm = range_seen(data.windows, [](const MapState& at) { return at.load_nm; });
    data.frame.temperatures_degc =
        range_seen(data.windows, [](const MapState& at) { return at.temperature_degc.value_or(0.0); });
    number_blocks(data);
    return data;
}

}  // namespace ripplenotch
