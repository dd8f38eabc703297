// SPDX-License-Identifier: MIT
// Cogging compensation of Beckhoff AX8000 and AMP8000: ten slots of order, phase and torque in a CoE object.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "export/map/map_table.hpp"
#include "export/map/map_target.hpp"
#include "export/text.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

constexpr std::size_t slots = 10;
constexpr double highest_order = 200.0;
constexpr int first_slot = 7;  // subindex of n of slot 0; phi and r follow, and the next slot

constexpr std::array keys = {
    flat_speed_key, flat_direction_key,
    Key{.name = "channel", .default_text = "a", .choices = "a b", .help = "a: object 0x32CB; b: 0x36CB"},
    Key{.name = "form",
        .default_text = "cosine",
        .choices = "cosine sine",
        .help = "r cos(n theta + phi) or r sin(n theta + phi)"},
    Key{.name = "side",
        .default_text = "motor",
        .choices = "motor joint",
        .help = "motor: r is the joint's torque over the gear ratio; joint: as it is"}};

double side_factor(const RippleMap& map, const Settings& settings) {
    return settings.text("side") == "motor" ? 1.0 / map.gear_ratio.value() : 1.0;
}

double form_turn_deg(const Settings& settings) { return settings.text("form") == "sine" ? 90.0 : 0.0; }

std::string_view object_of(const Settings& settings) {
    return settings.text("channel") == "a" ? "0x32CB" : "0x36CB";
}

// The strongest of what fits, in rising order.
std::vector<std::size_t> fitting(const RippleMap& flat, std::vector<std::string>& warnings) {
    std::vector<std::size_t> found;
    for (std::size_t i = 0; i < flat.orders.size(); ++i) {
        const double n = flat.orders[i].value();
        if (n != std::floor(n)) continue;  // flattened() has said so
        if (n <= highest_order)
            found.push_back(i);
        else
            warnings.push_back(fmt::format("order {} is left out: n is at most 200", shortest(n)));
    }
    const auto size = [&](std::size_t i) { return std::norm(flat.values[i][0]); };
    std::stable_sort(found.begin(), found.end(),
                     [&](std::size_t a, std::size_t b) { return size(a) > size(b); });
    while (found.size() > slots) {
        warnings.push_back(
            fmt::format("order {} is left out: there are 10 slots, and it is weaker than those in them",
                        shortest(flat.orders[found.back()].value())));
        found.pop_back();
    }
    std::sort(found.begin(), found.end());
    return found;
}

RippleMap held_by(const RippleMap& map, const Settings& settings, std::vector<std::string>& warnings) {
    const RippleMap flat = flat_map(map, settings);
    RippleMap held = flat;
    held.orders.clear();
    held.values.clear();
    for (const std::size_t i : fitting(flat, warnings)) {
        held.orders.push_back(flat.orders[i]);
        held.values.push_back(flat.values[i]);
    }
    return held;
}

std::string entry(const Settings& settings, int subindex, std::string_view type, const std::string& value,
                  std::string_view comment) {
    return fmt::format("{}:{:02X},{},{},{}\n", object_of(settings), subindex, type, value, comment);
}

Written write(const RippleMap& map, const Settings& settings, std::span<const std::string> heading) {
    std::vector<std::string> warnings = flattened(map, "beckhoff-ax8000");
    const RippleMap held = held_by(map, settings, warnings);
    std::string text = comment_lines(heading, "# ");
    text += fmt::format(
        "# ripple = sum of r {}(n theta + phi), theta the motor's angle, 0 where the joint is at {} deg; "
        "torque at the {}\n",
        settings.text("form") == "sine" ? "sin" : "cos", shortest(map.zero_deg), settings.text("side"));
    text += "index:subindex,type,value,name\n" + entry(settings, 2, "REAL32", "1.0", "gain");
    for (std::size_t k = 0; k < slots; ++k) {
        AmplitudePhase one;
        double n = 0.0;
        if (k < held.orders.size()) {
            n = held.orders[k].value();
            one = amplitude_phase(side_factor(map, settings) * held.values[k][0]);
            one.phase_deg = std::fmod(one.phase_deg + form_turn_deg(settings), 360.0);
        }
        const int at = first_slot + 3 * static_cast<int>(k);
        const auto single = [](double value) {
            return shortest(static_cast<double>(static_cast<float>(value)));
        };
        text += entry(settings, at, "UINT32", shortest(n), fmt::format("Coef {} n", k));
        text += entry(settings, at + 1, "REAL32", single(one.phase_deg), fmt::format("Coef {} phi", k));
        text += entry(settings, at + 2, "REAL32", single(one.amplitude_nm), fmt::format("Coef {} r", k));
    }
    return {text, warnings};
}

float number_at(TextReader& reader, const Settings& settings, int subindex, std::string_view type) {
    reader.expect(fmt::format("{}:{:02X},{}", object_of(settings), subindex, type));
    return static_cast<float>(reader.number());
}

// In the drive's numbers: REAL32 throughout.
LoadedMap read(std::string_view bytes, const std::string& source, const RippleMap& map,
               const Settings& settings) {
    struct Slot {
        float n, phi, r;
    };
    TextReader reader(bytes, source, Comments::hash, Precision::float32);
    std::array<Slot, slots> held{};
    for (std::size_t k = 0; k < slots; ++k) {
        const int at = first_slot + 3 * static_cast<int>(k);
        held[k].n = number_at(reader, settings, at, "UINT32");
        held[k].phi = number_at(reader, settings, at + 1, "REAL32");
        held[k].r = number_at(reader, settings, at + 2, "REAL32");
    }
    std::vector<std::string> ignored;
    const double to_joint = 1.0 / side_factor(map, settings), turned = form_turn_deg(settings);
    const double ratio = map.gear_ratio.value(), zero = map.zero_deg;
    const auto torque = [=](const MapState& state) {
        const double turns = ratio * (state.position_deg - zero) / 360.0;
        const auto angle_deg = static_cast<float>(360.0 * (turns - std::floor(turns)));
        float sum = 0.0F;
        for (const Slot& slot : held) {
            const float phase = slot.n * angle_deg + slot.phi - static_cast<float>(turned);
            sum += slot.r * static_cast<float>(portable::cos_degrees(static_cast<double>(phase)));
        }
        return to_joint * static_cast<double>(sum);
    };
    return {"float32, ten harmonics", held_by(map, settings, ignored), torque};
}

}  // namespace

const MapTarget map_target_list::beckhoff_ax8000 = {
    .name = "beckhoff-ax8000",
    .summary = "start-up list of the cogging compensation of AX8000 and AMP8000 drives: ten harmonics",
    .source = "Beckhoff Information System, AX8000 object description, 0x32CB and 0x36CB",
    .endings = ".csv .txt",
    .keys = keys,
    .write = write,
    .read = read,
};

}  // namespace ripplenotch
