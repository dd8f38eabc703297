// SPDX-License-Identifier: MIT
// What the methods take out of two joints of a real robot. The logs are not part of the project: without them
// these cases say so and do nothing. With RIPPLENOTCH_TABLE set in the environment they print the table of
// docs/methods/README.md.

#include <fmt/format.h>

#include <algorithm>
#include <complex>
#include <cstdlib>
#include <filesystem>
#include <numbers>
#include <optional>

#include "core/matrices/least_squares.hpp"
#include "filter/tables.hpp"
#include "ripplenotch/analysis/sweeps.hpp"
#include "ripplenotch/filter/engine.hpp"
#include "ripplenotch/log/log.hpp"
#include "support/catch.hpp"
#include "support/places.hpp"
#include "support/skipped.hpp"

using namespace ripplenotch;
using namespace ripplenotch::testing;

namespace {

struct LineLevel {
    double amplitude_nm = 0.0, floor_nm = 0.0;
};

// Amplitude of an order (cycles per joint turn) over all sweeps: the highest within 2.5 orders, rms over
// sweeps; the floor is the median of 6 to 30 orders away.
LineLevel level(const std::vector<Sweep>& sweeps, double order) {
    const auto amplitude = [&](double at) {
        double sum = 0.0, turns = 0.0;
        for (const Sweep& sweep : sweeps) {
            std::complex<double> s = 0.0;
            for (std::size_t k = 0; k < sweep.turns.size(); ++k)
                s += sweep.value[k] * std::polar(1.0, -2.0 * std::numbers::pi * at * sweep.turns[k]);
            sum += sweep.length_turns * std::norm(2.0 * s / sweep.weight_sum);
            turns += sweep.length_turns;
        }
        return std::sqrt(sum / turns);
    };
    LineLevel found;
    for (double off = -2.5; off <= 2.5; off += 0.5)
        found.amplitude_nm = std::max(found.amplitude_nm, amplitude(order + off));
    std::vector<double> around;
    for (double off = 6.0; off <= 30.0; off += 1.5) {
        around.push_back(amplitude(order - off));
        around.push_back(amplitude(order + off));
    }
    std::nth_element(around.begin(), around.begin() + static_cast<std::ptrdiff_t>(around.size() / 2),
                     around.end());
    found.floor_nm = around[around.size() / 2];
    return found;
}

// With their torque less its trend.
std::vector<Sweep> sweeps_of(const Trace& trace, const std::vector<double>& torque) {
    Trace other = trace;
    other.torque_nm = torque;
    const TraceView view = other.view();
    // Short sweeps would smear the lines over what is taken for the floor.
    std::vector<Sweep> sweeps = cut_sweeps({&view, 1}, {.shortest_turns = 0.06}).pieces;
    for (Sweep& sweep : sweeps) {
        std::vector<std::vector<double>> columns(6);  // cosines up to 2.5 cycles in the sweep
        sweep.value.clear();
        for (std::size_t k = 0; k < sweep.weight.size(); ++k) {
            const double root = std::sqrt(sweep.weight[k]);
            for (std::size_t m = 0; m < columns.size(); ++m)
                columns[m].push_back(root *
                                     std::cos(std::numbers::pi * static_cast<double>(m) * sweep.progress(k)));
            sweep.value.push_back(root * sweep.measured_nm[k]);
        }
        const std::vector<double> values = least_squares(columns, sweep.value);
        for (std::size_t k = 0; k < sweep.value.size(); ++k) {
            for (std::size_t m = 0; m < columns.size(); ++m) sweep.value[k] -= values[m] * columns[m][k];
            sweep.value[k] *= std::sqrt(sweep.weight[k]);
        }
    }
    return sweeps;
}

// Forward and backward through a low-pass: no delay, 5 Hz.
std::vector<double> slow_part(std::vector<double> torque, Hertz rate) {
    for (int pass = 0; pass < 2; ++pass) {
        const auto filter = start("lowpass,cutoff=5Hz,order=2", nullptr, rate);
        std::vector<double> out(torque.size());
        filter->process({torque, torque, {}}, out);
        torque.assign(out.rbegin(), out.rend());
    }
    return torque;
}

double change_below_5hz(const std::vector<double>& raw, const std::vector<double>& out, Hertz rate) {
    const auto a = slow_part(raw, rate), b = slow_part(out, rate);
    double mean = 0.0, difference = 0.0, spread = 0.0;
    for (const double x : a) mean += x / static_cast<double>(a.size());
    for (std::size_t k = 0; k < a.size(); ++k) {
        difference += std::pow(b[k] - a[k], 2);
        spread += std::pow(a[k] - mean, 2);
    }
    return std::sqrt(difference / spread);
}

double fall_db(const LineLevel& raw, const LineLevel& left) {
    return 20.0 * std::log10(raw.amplitude_nm / left.amplitude_nm);
}

struct Tried {
    std::string method;
    std::optional<double> promised_db;  ///< what each line falls by, or to the floor; without it only shown
};

const std::vector<Tried> tried = {{"tracking", 12.0},
                                  {"oscillator", 18.0},
                                  {"oscillator,output=minus-ripple", 12.0},
                                  {"oscillator,memory=2", 12.0},
                                  {"tracking,q=2.5", {}}};

void check_log(const std::string& name, const std::string& orders, const std::vector<double>& lines) {
    const std::filesystem::path path = std::filesystem::path(logs_folder()) / "gpl3" / name;
    if (!std::filesystem::exists(path)) {
        test::skipped("no log " + name + " in the folder of real logs");
        return;
    }
    const Log log = read_log(path.string(), {});
    const Hertz rate = nominal_rate(log.trace.sample_rate);
    const auto before = sweeps_of(log.trace, log.trace.torque_nm);
    std::vector<LineLevel> raw;
    for (const double line : lines) {
        raw.push_back(level(before, 120.0 * line));
        INFO(name << " order " << line << ": " << raw.back().amplitude_nm << " Nm, floor "
                  << raw.back().floor_nm);
        CHECK(raw.back().amplitude_nm > 4.0 * raw.back().floor_nm);
    }
    const bool prints = std::getenv("RIPPLENOTCH_TABLE") != nullptr;
    for (const Tried& entry : tried) {
        const std::string text = fmt::format("{},gear-ratio=120,orders={}", entry.method, orders);
        const auto out = filtered(*start(text, nullptr, rate),
                                  {log.trace.velocity_deg_s, log.trace.torque_nm, log.trace.position_deg});
        const auto after = sweeps_of(log.trace, out);
        const double changed = change_below_5hz(log.trace.torque_nm, out, rate);
        INFO(name << ' ' << text << " changes " << changed);
        if (entry.promised_db) CHECK(changed < 0.03);
        std::string row = fmt::format("| {} |", entry.method);
        for (std::size_t i = 0; i < lines.size(); ++i) {
            const LineLevel left = level(after, 120.0 * lines[i]);
            INFO("order " << lines[i] << ": " << fall_db(raw[i], left) << " dB, left " << left.amplitude_nm);
            if (entry.promised_db)
                CHECK((fall_db(raw[i], left) >= *entry.promised_db || left.amplitude_nm <= raw[i].floor_nm));
            row += fmt::format(" {:.1f} dB ({:.3f} Nm) |", fall_db(raw[i], left), left.amplitude_nm);
        }
        if (prints) fmt::print("{} {:.1f} % |\n", row, 100.0 * changed);
    }
    if (prints) {
        for (const LineLevel& line : raw)
            fmt::print("raw {:.3f} Nm, floor {:.3f} Nm, {:.1f}\n", line.amplitude_nm, line.floor_nm,
                       line.amplitude_nm / line.floor_nm);
    }
}

}  // namespace

TEST_CASE(
    "the lines of a robot's joint 1 fall by 12 dB or to the floor, the torque below 5 Hz changes by less "
    "than 3 %") {
    check_log("panda_gaz_j1.csv", "1:2", {1.0, 2.0});
}

TEST_CASE(
    "the lines of a robot's joint 4 fall by 12 dB or to the floor, the torque below 5 Hz changes by less "
    "than 3 %") {
    check_log("panda_gaz_j4.csv", "2:4", {2.0, 4.0});
}
