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
constexpr std::size_t least_block = 5;      ///< windows
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

// Windows half overlap: those at the ends of a block share samples with the next one.
void number_blocks(MapData& data) {
    const std::size_t size = std::max(least_block, (data.windows.size() + most_blocks - 1) / most_blocks);
    std::size_t in_block = 0;
    for (std::size_t i = 0; i < data.windows.size(); ++i, ++in_block) {
        const bool first = i == 0, other_log = !first && data.windows[i].log != data.windows[i - 1].log;
        if (other_log || in_block >= size) {
            ++data.blocks;
            in_block = 0;
            if (!other_log) data.windows[i].scored = data.windows[i - 1].scored = false;
        }
        data.windows[i].block = data.blocks;
    }
    if (!data.windows.empty()) ++data.blocks;
}

void sum_up(MapData& data) {
    data.mean_noise.assign(data.orders, 0.0);
    data.energy.assign(data.orders, 0.0);
    const double each = data.windows.empty() ? 0.0 : 1.0 / static_cast<double>(data.windows.size());
    for (const MapWindow& window : data.windows) {
        for (std::size_t i = 0; i < data.orders; ++i) {
            data.mean_noise[i] += each * window.noise[i];
            data.energy[i] += each * std::norm(window.value[i]);
        }
    }
    for (std::size_t i = 0; i < data.orders; ++i)
        data.mean_noise[i] = std::max(data.mean_noise[i], least_noise_share * data.energy[i]);
}

}  // namespace

MapData map_data(std::span<const TraceView> logs, const GearAccount& gear, double zero_deg,
                 std::span<const std::vector<double>> temperatures_degc) {
    MapData data;
    data.orders = gear.orders.size();
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
    sum_up(data);
    return data;
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
    map.form = form;
    map.zero_deg = zero_deg;
    map.speeds_deg_s = data.speeds_deg_s;
    map.positions_deg = data.positions_deg;
    map.loads_nm = data.loads_nm;
    map.temperatures_degc = data.temperatures_degc;
    return map;
}

}  // namespace ripplenotch
