// SPDX-License-Identifier: MIT
#include "diagnose/case/undecidable.hpp"

#include <algorithm>
#include <cmath>

#include "ripplenotch/model/model.hpp"
#include "ripplenotch/model/motion.hpp"

namespace ripplenotch {
namespace {

Model joint_with(const Effect& effect, bool with) {
    Model model{GearRatio(100.0), {}};
    model.terms.push_back(parse_term("ripple,order=1,amplitude_nm=1,phase_deg=0"));
    if (!with) return model;
    model.terms.push_back({&effect, {}});
    for (const Parameter& parameter : effect.parameters) {
        const bool nothing_yet = parameter.linear && parameter.start == parameter.neutral;
        model.terms.back().values.emplace_back(nothing_yet ? parameter.neutral + 1.0 : parameter.start);
    }
    return model;
}

}  // namespace

bool needs_position(const Effect& effect) {
    // Another ratio or a bias shows in how the phase goes on, not in where it begins.
    if (effect.side == Side::converter || effect.side == Side::motion) return false;
    const Motion here = make_motion("poly6,from=0deg,to=200deg,duration=2s", Hertz(200.0));
    Motion there = here;
    const double turn_deg = 360.0 / 100.0;  // of the motor
    for (double& position : there.position_deg) position += turn_deg;
    const Model with = joint_with(effect, true), without = joint_with(effect, false);
    const auto at_here = predict_nm(with, here), at_there = predict_nm(with, there);
    const auto plain_here = predict_nm(without, here), plain_there = predict_nm(without, there);
    double moved = 0.0, size = 0.0;
    for (std::size_t k = 0; k < here.size(); ++k) {
        const double one = at_here[k] - plain_here[k], other = at_there[k] - plain_there[k];
        moved = std::max(moved, std::abs(one - other));
        size = std::max(size, std::abs(one));
    }
    return moved > 1e-3 * size;
}

}  // namespace ripplenotch
