// SPDX-License-Identifier: MIT
#include "model/catalogue.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "core/vectors/dot.hpp"
#include "model/effects.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/core/spec.hpp"

namespace ripplenotch {

namespace {

// Terms of a model, and those that a search changes: enough for a model of many ripples at a time; for long
// logs fewer.
std::size_t most_kept(std::size_t samples) { return samples < 200'000 ? 16 : 4; }

}  // namespace

const Carriers::Carrier& Carriers::carrier(const Term& term, const Situation& situation) {
    const Polar polar = *term.effect->polar;
    Term unit = term;
    unit.values[polar.size] = 1.0;
    unit.values[polar.phase] = 0.0;
    for (const Carrier& kept : kept_) {
        if (kept.term == unit && kept.ratio == situation.ratio) return kept;
    }
    Situation plain = situation;
    plain.ripple_gain = {};
    Carrier found{unit, situation.ratio, std::vector<double>(situation.motion.size(), 0.0), {}};
    found.across_nm = found.along_nm;
    unit.effect->apply(plain, values_of(unit), found.along_nm);
    unit.values[polar.phase] = 90.0;
    unit.effect->apply(plain, values_of(unit), found.across_nm);
    if (kept_.size() < most_kept(situation.motion.size())) return kept_.emplace_back(std::move(found));
    next_ = (next_ + 1) % kept_.size();
    return kept_[next_] = std::move(found);
}

bool Carriers::add_torque(const Term& term, const Situation& situation, const Gain& gain,
                          std::span<double> torque_nm) {
    const Effect& effect = *term.effect;
    if (!effect.polar || effect.side != Side::joint || effect.uses_load) return false;
    const std::vector<double> values = values_of(term);
    const Carrier& found = carrier(term, situation);
    const double size = values[effect.polar->size], phase_deg = values[effect.polar->phase];
    const double x = size * portable::cos_degrees(phase_deg), y = size * portable::sin_degrees(phase_deg);
    const double* const along = found.along_nm.data();
    const double* const across = found.across_nm.data();
    if (gain.empty()) {
        add_scaled(x, along, torque_nm.data(), torque_nm.size());
        add_scaled(y, across, torque_nm.data(), torque_nm.size());
        return true;
    }
    // A quarter turn leads from along to across, and from across to the reverse of along.
    for (std::size_t k = 0; k < torque_nm.size(); ++k) {
        const double real = x * gain[k].real() - y * gain[k].imag();
        const double imaginary = x * gain[k].imag() + y * gain[k].real();
        torque_nm[k] += real * along[k] + imaginary * across[k];
    }
    return true;
}

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
        raise<UsageError>("there is no effect '{}'; there {} {}; 'ripplenotch effects' lists all", name,
                          within.size() == 1 ? "is" : "are", fmt::join(within, ", "));
    raise<UsageError>("there is no effect '{}'{}; 'ripplenotch effects' lists them", name,
                      did_you_mean(name, known));
}

bool needs_gear_ratio(const Effect& effect) {
    return effect.ripple_order || (effect.side == Side::ripple && !effect.whole) ||
           std::ranges::any_of(effect.parameters, [](const Parameter& parameter) {
               return parameter.hint == Hint::gear_ratios;
           });
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
