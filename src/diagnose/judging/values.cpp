// SPDX-License-Identifier: MIT
#include "diagnose/judging/values.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "diagnose/judging/doubt.hpp"
#include "diagnose/search/search.hpp"

namespace ripplenotch {
namespace {

// Samples that are left out because they stand at the limit are those that noise has brought there; those
// that noise has kept below would stay, and the torque would come out too small. What counts is where the
// torque is expected to be.
void leave_out_limited(Case& looked_at, const Model& stated, const std::vector<Fault>& faults,
                       double noise_nm, const DiagnosisRules::ValueRules& rules) {
    for (const Fault& fault : faults) {
        const auto place = fault.term.effect->range_limit;
        if (!place) continue;
        const double most_nm = *fault.term.values[*place] - rules.limit_deviations * noise_nm;
        const auto expected_nm = predict_nm(stated, looked_at.motion);
        std::vector<unsigned char> inside = looked_at.use;
        for (std::size_t k = 0; k < looked_at.size(); ++k) {
            if (std::abs(expected_nm[k]) > most_nm) inside[k] = 0;
        }
        const auto used = [](const std::vector<unsigned char>& use) {
            return static_cast<std::size_t>(std::count(use.begin(), use.end(), 1));
        };
        if (used(inside) * rules.least_inside >= used(looked_at.use)) looked_at.use = inside;
    }
}

// The first of the findings whose size the settled values do not tell after all: it was judged beside terms
// that have come to other values since, or are gone.
std::optional<std::size_t> untold(const Candidate& told, const ToldOf& of, const DiagnosisRules& rules) {
    std::size_t term = of.own_terms;
    for (Finding& finding : of.findings) {
        if (is_doubtful(finding)) continue;
        if (is_trusted(finding) && doubt_size(finding, told, term, rules)) return term;
        ++term;
    }
    return std::nullopt;
}

}  // namespace

Candidate final_values(Case looked_at, const NoiseFloor& noise, const Candidate& chosen, const ToldOf& of,
                       Work& work, const DiagnosisRules& rules) {
    leave_out_limited(looked_at, chosen.stated, of.faults, noise.rms_nm, rules.values);
    ModelBench bench(looked_at, noise, work, rules);
    bench.settle_on(chosen.stated);
    Candidate told = bench.settled(chosen);
    while (const auto term = untold(told, of, rules)) told = bench.settled(without_term(bench, told, *term));
    return told;
}

}  // namespace ripplenotch
