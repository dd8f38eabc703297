// SPDX-License-Identifier: MIT
#include "diagnose/beside/weighing/ringing_torque.hpp"

#include <algorithm>

#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

std::size_t parameter_named(const Effect& effect, std::string_view name) {
    const auto found = std::find_if(effect.parameters.begin(), effect.parameters.end(),
                                    [&](const Parameter& parameter) { return parameter.name == name; });
    return static_cast<std::size_t>(found - effect.parameters.begin());
}

}  // namespace

std::vector<std::complex<double>> ringing_gain(const Shape& shape, const Motion& motion, GearRatio ratio) {
    std::vector<double> values;
    for (const auto& value : shape.ringing->values) values.push_back(*value);
    const Order order(*shape.term.values[*shape.term.effect->ripple_order]);
    std::vector<std::complex<double>> gain(motion.size(), 1.0);
    shape.ringing->effect->change_ripple({motion, ratio}, order, values, gain);
    return gain;
}

Polar direct_of(const Effect& effect) {
    return {parameter_named(effect, "direct"), parameter_named(effect, "direct_phase_deg")};
}

Term ringing_term(const Shape& shape, std::complex<double> direct) {
    Term term = *shape.ringing;
    const Polar polar = direct_of(*term.effect);
    term.values[polar.size] = portable::hypot(direct.real(), direct.imag());
    term.values[polar.phase] = portable::arg(direct) * degrees_per_radian;
    return term;
}

}  // namespace ripplenotch
