// SPDX-License-Identifier: MIT
#include "diagnose/examined.hpp"

#include <algorithm>
#include <cmath>

#include "diagnose/case/case.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {

bool is_among(std::span<const std::string> names, std::string_view name) {
    return std::find(names.begin(), names.end(), name) != names.end();
}

std::vector<const Effect*> examined(std::span<const std::string> without, Examinable some) {
    std::vector<const Effect*> effects;
    for (const Effect* effect : catalogue()) {
        const bool left_out = is_among(without, effect->name);
        if (left_out || effect->side == Side::converter || (!some.of_position && needs_position(*effect)) ||
            (!some.of_motor && needs_gear_ratio(*effect)) || (!some.of_direction && effect->differs))
            continue;
        effects.push_back(effect);
    }
    return effects;
}

std::vector<ResidualRegion> nameless(std::vector<Fault>& faults, std::span<const std::string> without) {
    std::vector<ResidualRegion> left;
    for (const Fault& fault : faults) {
        if (is_among(without, fault.term.effect->name))
            left.push_back({RegionKind::time, {fault.time_s, {}, {}, {}, {}, {}}, 0.0, 0.0});
    }
    std::erase_if(faults, [&](const Fault& fault) { return is_among(without, fault.term.effect->name); });
    return left;
}

void measure_at_samples(std::vector<ResidualRegion>& nameless, const Case& c, const Model& stated) {
    std::vector<double> left = predict_nm(stated, c.motion);
    double all = 0.0;
    for (std::size_t k = 0; k < left.size(); ++k) {
        left[k] = c.torque_nm[k] - left[k];
        all += left[k] * left[k];
    }
    for (ResidualRegion& region : nameless) {
        double sum = 0.0, count = 0.0;
        for (const Span& span : region.where.time_s) {
            const auto first = std::lower_bound(c.motion.time_s.begin(), c.motion.time_s.end(), span.from);
            for (auto at = first; at != c.motion.time_s.end() && *at <= span.to; ++at, count += 1.0)
                sum += portable::pow(left[static_cast<std::size_t>(at - c.motion.time_s.begin())], 2);
        }
        region.rms_nm = std::sqrt(sum / std::max(count, 1.0));
        region.part = sum / std::max(all, 1e-300);
    }
}

}  // namespace ripplenotch
