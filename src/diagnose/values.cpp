// SPDX-License-Identifier: MIT
#include "diagnose/values.hpp"

#include <algorithm>
#include <cmath>

namespace ripplenotch {
namespace {

// A torque nearer to the end of the range than this is cut on one side only.
constexpr double from_the_limit = 4.0;
// A log of which not even one sample in so many is farther from it has to be taken as it is.
constexpr long least_inside = 10;

// Samples that are left out because they stand at the limit are those that noise has brought there; those
// that noise has kept below would stay, and the torque would come out too small. What counts is where the
// torque is expected to be.
void leave_out_limited(Case& looked_at, const Model& stated, const std::vector<Fault>& faults,
                       double noise_nm) {
    for (const Fault& fault : faults) {
        const auto place = find_parameter(*fault.term.effect, "limit_nm");
        if (!place) continue;
        const double most_nm = *fault.term.values[*place] - from_the_limit * noise_nm;
        const auto expected_nm = predict_nm(stated, looked_at.motion);
        std::vector<unsigned char> inside = looked_at.use;
        for (std::size_t k = 0; k < looked_at.size(); ++k) {
            if (std::abs(expected_nm[k]) > most_nm) inside[k] = 0;
        }
        const auto used = [](const std::vector<unsigned char>& use) {
            return std::count(use.begin(), use.end(), 1);
        };
        if (used(inside) * least_inside >= used(looked_at.use)) looked_at.use = inside;
    }
}

}  // namespace

Candidate told_values(Case looked_at, const NoiseFloor& noise, const Candidate& chosen,
                      const std::vector<Fault>& faults, Work& work) {
    leave_out_limited(looked_at, chosen.stated, faults, noise.rms_nm);
    ModelBench bench(looked_at, noise, work);
    bench.settle_on(chosen.stated);
    return bench.settled(chosen);
}

}  // namespace ripplenotch
