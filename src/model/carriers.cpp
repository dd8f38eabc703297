// SPDX-License-Identifier: MIT
#include "model/carriers.hpp"

#include "core/vectors/dot.hpp"
#include "ripplenotch/core/portable_math.hpp"

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

}  // namespace ripplenotch
