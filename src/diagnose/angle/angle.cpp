// SPDX-License-Identifier: MIT
#include "diagnose/angle/angle.hpp"

#include <algorithm>
#include <cmath>

#include "diagnose/search/search.hpp"
#include "ripplenotch/model/prediction.hpp"

namespace ripplenotch {
namespace {

struct Moved {
    double mean_deg = 0.0, rms_deg = 0.0;  ///< rms: about the mean
};

Moved moved_by(const std::vector<double>& before, const std::vector<double>& after) {
    Moved moved;
    double squares = 0.0;
    const auto n = static_cast<double>(before.size());
    for (std::size_t k = 0; k < before.size(); ++k) {
        const double by = after[k] - before[k];
        moved.mean_deg += by / n;
        squares += by * by / n;
    }
    moved.rms_deg = std::sqrt(std::max(squares - moved.mean_deg * moved.mean_deg, 0.0));
    return moved;
}

}  // namespace

void straighten(Case& whole, const Model& model, const DiagnosisRules& rules) {
    for (int step = 0; step < walk_steps; ++step) {
        Work free(rules.search.most_evaluations);
        ModelBench rough(whole, {1.0, 1.0, {}}, free, rules);
        const Candidate fitted = baseline(rough, model);
        step_of_walk(whole, fitted.open, fitted.stated, WalkOf::log, rules.recording);
    }
}

bool straightened_by(Case& whole, const Candidate& found, double floor_nm, const DiagnosisRules& rules) {
    std::vector<double> change = predict_nm(found.stated, whole.motion);
    take_out_walk(whole, found.open, found.stated, WalkOf::log, rules.recording);
    const std::vector<double> now = predict_nm(found.stated, whole.motion);
    for (std::size_t k = 0; k < now.size(); ++k) change[k] -= now[k];
    return rms(change) > material_sigma(whole, rules) * floor_nm;
}

AngleBefore::AngleBefore(const Case& log, bool has_position) {
    if (!has_position) log_ = log.motion.position_deg;
}

std::optional<AngleAccount> AngleBefore::account(const Case& log, const Case* other) const {
    if (log_.empty() && other_.empty()) return std::nullopt;
    AngleAccount account;
    if (!log_.empty()) account.walk_deg = moved_by(log_, log.motion.position_deg).rms_deg;
    if (!other_.empty() && other->motion.position_deg != other_)
        account.validation_start_deg = other->motion.position_deg.front();
    return account;
}

}  // namespace ripplenotch
