// SPDX-License-Identifier: MIT
#include "diagnose/telling/unused_rows.hpp"

#include <algorithm>
#include <cmath>

namespace ripplenotch {

void add_unused_rows(std::vector<UnusedRows>& listed, const Case& whole, std::string_view reason) {
    std::size_t rows = whole.size() - whole.used();
    for (const UnusedRows& before : listed) rows -= before.rows;
    if (rows > 0) listed.push_back({std::string(reason), rows});
}

std::vector<EffectOfUnusedRows> mainly_unused(std::span<const Effect* const> effects, const Case& whole,
                                              const Model& model) {
    std::vector<EffectOfUnusedRows> found;
    Motion motion = whole.motion;
    motion.known_nm.clear();
    for (const Effect* effect : effects) {
        Model alone{model.gear_ratio, {{effect, {}}}};
        for (const Parameter& parameter : effect->parameters)
            alone.terms[0].values.emplace_back(parameter.start);
        // A sensor shows what others bring, and acts by itself nowhere.
        if (side_of(alone.terms[0]) != Side::joint) continue;
        const std::vector<double> torque_nm = predict_nm(alone, motion);
        double largest = 0.0;
        for (const double each : torque_nm) largest = std::max(largest, std::abs(each));
        EffectOfUnusedRows acts{std::string(effect->name), 0, 0};
        for (std::size_t k = 0; k < torque_nm.size() && largest > 0.0; ++k) {
            if (std::abs(torque_nm[k]) < 0.5 * largest) continue;
            ++acts.rows;
            if (whole.use[k] == 0) ++acts.unused;
        }
        if (2 * acts.unused > acts.rows) found.push_back(std::move(acts));
    }
    return found;
}

}  // namespace ripplenotch
