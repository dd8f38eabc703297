// SPDX-License-Identifier: MIT
#include "diagnose/angle/angle.hpp"

#include "diagnose/search.hpp"
#include "ripplenotch/model/prediction.hpp"

namespace ripplenotch {
namespace {

constexpr int steps = 3;  // each from where the one before has led

}  // namespace

void straighten(Case& whole, const Model& model, const DiagnosisRules& rules) {
    for (int step = 0; step < steps; ++step) {
        Work free(rules.search.most_evaluations);
        ModelBench rough(whole, {1.0, 1.0, {}}, free, rules);
        const Candidate fitted = baseline(rough, model);
        (void)take_out_walk(whole, fitted.open, fitted.stated, WalkOf::log, rules.recording);
    }
}

bool straightened_by(Case& whole, const Candidate& found, double floor_nm, const DiagnosisRules& rules) {
    std::vector<double> change = predict_nm(found.stated, whole.motion);
    for (int step = 0; step < steps; ++step)
        (void)take_out_walk(whole, found.open, found.stated, WalkOf::log, rules.recording);
    const std::vector<double> now = predict_nm(found.stated, whole.motion);
    for (std::size_t k = 0; k < now.size(); ++k) change[k] -= now[k];
    return rms(change) > material_sigma(whole, rules) * floor_nm;
}

}  // namespace ripplenotch
