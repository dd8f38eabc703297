// SPDX-License-Identifier: MIT
#include "diagnose/judging/wandering.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

// Square that a wave of `half_periods` over the log holds of a torque, a number per row.
double held_nm2(const ModelBench& bench, const std::vector<double>& torque_nm, std::size_t half_periods) {
    const auto& time_s = bench.looked_at().motion.time_s;
    const double begin_s = time_s.front(), log_s = time_s.back() - begin_s;
    double product = 0.0, square = 0.0;
    for (std::size_t r = 0; r < torque_nm.size(); ++r) {
        const double angle_rad = std::numbers::pi * static_cast<double>(half_periods) *
                                 (time_s[bench.rows()[r]] - begin_s) / log_s;
        const double wave = portable::cos(angle_rad);
        product += wave * torque_nm[r];
        square += wave * wave;
    }
    return product * product / std::max(square, 1e-300);
}

bool is_slow(const ModelBench& bench, const Model& stated, std::size_t term) {
    const auto added = bench.torque_of(stated, term);
    std::vector<double> torque_nm;
    double all_nm2 = 0.0, slow_nm2 = 0.0;
    for (const std::size_t k : bench.rows()) {
        torque_nm.push_back(added[k]);
        all_nm2 += added[k] * added[k];
    }
    const auto& rules = bench.rules().wandering;
    for (std::size_t wave = 0; wave < rules.slow_waves; ++wave) slow_nm2 += held_nm2(bench, torque_nm, wave);
    return slow_nm2 > rules.slow_part * all_nm2;
}

}  // namespace

std::optional<double> above_wandering(const ModelBench& bench, const Model& stated, std::size_t term,
                                      double raw_gain_nm2) {
    if (!is_slow(bench, stated, term)) return std::nullopt;
    const auto left_nm = bench.cleared_residual(stated);
    const auto& rules = bench.rules().wandering;
    double mean_nm2 = 0.0;
    for (std::size_t wave = 0; wave < rules.waves; ++wave)
        mean_nm2 += held_nm2(bench, left_nm, rules.slow_waves + wave) / static_cast<double>(rules.waves);
    return raw_gain_nm2 / std::max(mean_nm2, 1e-300);
}

}  // namespace ripplenotch
