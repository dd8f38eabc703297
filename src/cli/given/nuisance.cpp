// SPDX-License-Identifier: MIT
#include "cli/given/nuisance.hpp"

#include <array>
#include <string>
#include <utility>

#include "ripplenotch/model/measured_motion.hpp"
#include "ripplenotch/model/model.hpp"

namespace ripplenotch {
namespace {

GivenTerm stated(std::vector<double> torque_nm, bool bears_load) {
    return {std::string(nuisance_name), {std::move(torque_nm)}, {1.0}, {stated_deviation}, bears_load};
}

}  // namespace

// The effects of size 1 that a diagnosis fits beside a simulation, times what it found.
void add_nuisance(std::vector<GivenTerm>& terms, const SimulatedTerm& simulated, const Log& log,
                  Seconds smoothing) {
    const std::array<std::pair<std::string_view, double>, 3> carried = {
        {{"inertia,inertia_kgm2=1", simulated.inertia_kgm2},
         {"gravity,amplitude_nm=1,phase_deg=0", simulated.gravity_cosine_nm},
         {"gravity,amplitude_nm=1,phase_deg=90", simulated.gravity_sine_nm}}};
    std::vector<double> sum(log.trace.size(), 0.0);
    bool any = false;
    Motion motion;
    for (const auto& [words, size] : carried) {
        if (size == 0.0) continue;
        if (!any) motion = motion_along(log.trace.view(), smoothing);
        any = true;
        const auto one = predict_nm({GearRatio(1.0), {parse_term(words)}}, motion);
        for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += size * one[k];
    }
    if (any) terms.push_back(stated(std::move(sum), true));
    if (simulated.offset_nm != 0.0)
        terms.push_back(stated(std::vector<double>(log.trace.size(), simulated.offset_nm), false));
}

}  // namespace ripplenotch
