// SPDX-License-Identifier: MIT
#include "filter/map/map_data.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "filter/ripple/ripple_windows.hpp"
#include "ripplenotch/core/phasor.hpp"

namespace ripplenotch {
namespace {

constexpr std::size_t most_blocks = 16;     // by hand: parts that are left out in turn
constexpr std::size_t least_block = 3;      ///< windows, of which the middle one shares none of its samples
constexpr double least_noise_share = 1e-8;  ///< of the energy: a simulation without noise has rounding

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

MapWindow window_of(const RippleWindow& window, const GearAccount& gear, double zero_deg) {
    const double ratio = gear.ratio.value();
    MapWindow one;
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

void widen_span(MapRange& range, double value, bool first) {
    range.from = first ? value : std::min(range.from, value);
    range.to = first ? value : std::max(range.to, value);
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

void summarise(MapData& data) {
    data.mean_noise.assign(data.orders.size(), 0.0);
    data.energy.assign(data.orders.size(), 0.0);
    const double each = data.windows.empty() ? 0.0 : 1.0 / static_cast<double>(data.windows.size());
    for (const MapWindow& window : data.windows) {
        for (std::size_t i = 0; i < data.orders.size(); ++i) {
            data.mean_noise[i] += each * window.noise[i];
            data.energy[i] += each * std::norm(window.value[i]);
        }
    }
    for (std::size_t i = 0; i < data.orders.size(); ++i)
        data.mean_noise[i] = std::max(data.mean_noise[i], least_noise_share * data.energy[i]);
}

MapData map_data(std::span<const TraceView> logs, const GearAccount& gear, double zero_deg,
                 std::span<const std::vector<double>> temperatures_degc) {
    MapData data;
    data.gear_ratio = gear.ratio;
    data.orders = gear.orders;
    for (std::size_t l = 0; l < logs.size(); ++l) {
        const bool warms = !temperatures_degc.empty();
        const auto windows = windows_of(logs[l], gear, logs[l].torque_nm);
        const auto warmth =
            warms ? windows_of(logs[l], gear, temperatures_degc[l]) : std::vector<RippleWindow>();
        for (std::size_t i = 0; i < windows.size(); ++i) {
            MapWindow one = window_of(windows[i], gear, zero_deg);
            one.log = l;
            if (warms) one.state.temperature_degc = warmth[i].torque_nm;
            const bool first = data.windows.empty();
            widen_span(data.speeds_deg_s, std::abs(one.state.speed_deg_s), first);
            widen_span(data.positions_deg, one.state.position_deg, first);
            widen_span(data.loads_nm, one.state.load_nm, first);
            if (warms) widen_span(data.temperatures_degc, *one.state.temperature_degc, first);
            data.windows.push_back(std::move(one));
        }
    }
    number_blocks(data);
    summarise(data);
    return data;
}

MapData of_order(const MapData& data, std::size_t order) {
    MapData part = data;
    part.orders = {data.orders[order]};
    for (MapWindow& window : part.windows) {
        window.value = {window.value[order]};
        window.noise = {window.noise[order]};
    }
    summarise(part);
    return part;
}

MapData of_log(const MapData& data, std::size_t log, bool is) {
    MapData part = data;
    part.windows.clear();
    for (const MapWindow& window : data.windows)
        if ((window.log == log) == is) part.windows.push_back(window);
    return part;
}

RippleMap frame_of(const MapData& data, const MapForm& form, double zero_deg) {
    RippleMap map;
    map.gear_ratio = data.gear_ratio;
    map.orders = data.orders;
    map.form = form;
    map.zero_deg = zero_deg;
    map.speeds_deg_s = data.speeds_deg_s;
    map.positions_deg = data.positions_deg;
    map.loads_nm = data.loads_nm;
    map.temperatures_degc = data.temperatures_degc;
    return map;
}

}  // namespace ripplenotch
