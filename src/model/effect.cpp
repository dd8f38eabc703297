// SPDX-License-Identifier: MIT
#include "ripplenotch/model/effect.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "model/effects.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/spec.hpp"

namespace ripplenotch {

namespace {

constexpr const Effect* const all_effects[] = {
#define EFFECT(name) &effects::name,
#include "model/effects/effects.def"
#undef EFFECT
};

constexpr Dimension dimensions[] = {Dimension::time,    Dimension::frequency, Dimension::angle,
                                    Dimension::speed,   Dimension::torque,    Dimension::torque_rate,
                                    Dimension::inertia, Dimension::decibel,   Dimension::current};

}  // namespace

std::span<const Effect* const> catalogue() { return all_effects; }

std::string_view side_name(Side side) {
    constexpr std::string_view names[] = {"motion", "ripple", "joint", "sensor", "converter"};
    return names[static_cast<std::size_t>(side)];
}

const Effect& find_effect(std::string_view name) {
    std::vector<std::string> known;
    for (const Effect* effect : catalogue()) {
        if (effect->name == name) return *effect;
        known.emplace_back(effect->name);
    }
    // "friction" is part of several names, and near to none.
    constexpr std::size_t fewest_letters = 4;
    std::vector<std::string> within;
    std::copy_if(known.begin(), known.end(), std::back_inserter(within),
                 [&](const std::string& one) { return one.find(name) != std::string::npos; });
    if (name.size() >= fewest_letters && !within.empty())
        raise<UsageError>("there is no effect '{}'; there {} {}; 'ripplenotch diagnose --effects' lists all",
                          name, within.size() == 1 ? "is" : "are", fmt::join(within, ", "));
    raise<UsageError>("there is no effect '{}'{}; 'ripplenotch diagnose --effects' lists them", name,
                      did_you_mean(name, known));
}

bool needs_gear_ratio(const Effect& effect) {
    return effect.ripple_order || (effect.side == Side::ripple && !effect.whole) ||
           &effect == &effects::gear_ratio;
}

std::optional<std::size_t> find_parameter(const Effect& effect, std::string_view name) {
    const auto found = std::find_if(effect.parameters.begin(), effect.parameters.end(),
                                    [&](const Parameter& parameter) { return parameter.name == name; });
    if (found == effect.parameters.end()) return std::nullopt;
    return static_cast<std::size_t>(found - effect.parameters.begin());
}

Dimension dimension_of(const Parameter& parameter) {
    const auto found = std::find_if(std::begin(dimensions), std::end(dimensions), [&](Dimension dimension) {
        return base_unit(dimension) == parameter.unit;
    });
    return found == std::end(dimensions) ? Dimension::none : *found;
}

bool allows(const Parameter& parameter, double value) {
    return std::isfinite(value) && parameter.lower <= value && value <= parameter.upper;
}

}  // namespace ripplenotch
