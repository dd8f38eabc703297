// SPDX-License-Identifier: MIT
#include "filter/transitions/filter_bank.hpp"

namespace ripplenotch {

FilterBank::FilterBank(const Candidates& candidates) {
    const std::size_t count = (candidates.cascades.size() + lanes - 1) / lanes;
    groups_.resize(count);
    outputs_.resize(count);
    for (std::size_t g = 0; g < count; ++g) {
        groups_[g].resize(candidates.sections);
        for (std::size_t s = 0; s < candidates.sections; ++s) {
            Section& section = groups_[g][s];
            for (std::size_t lane = 0; lane < lanes; ++lane) {
                const std::size_t candidate = g * lanes + lane;
                const Biquad f =
                    candidate < candidates.cascades.size() ? candidates.cascades[candidate][s] : Biquad{};
                section.b0[lane] = f.b0;
                section.b1[lane] = f.b1;
                section.b2[lane] = f.b2;
                section.a1[lane] = f.a1;
                section.a2[lane] = f.a2;
            }
        }
    }
}

void FilterBank::start(double torque_nm) {
    origin_nm_ = torque_nm;
    for (Group& group : groups_) {
        for (Section& section : group) section.s1 = section.s2 = Lanes{};
    }
}

void FilterBank::run(std::span<const double> torque_nm) {
    for (std::size_t g = 0; g < groups_.size(); ++g) {
        auto& outputs = outputs_[g];
        for (std::size_t k = 0; k < torque_nm.size(); ++k) outputs[k].fill(torque_nm[k] - origin_nm_);
        for (Section& stored : groups_[g]) {
            Section f = stored;
            for (std::size_t k = 0; k < torque_nm.size(); ++k) {
                Lanes& value = outputs[k];
                for (std::size_t lane = 0; lane < lanes; ++lane) {
                    const double x = value[lane];
                    const double y = f.b0[lane] * x + f.s1[lane];
                    f.s1[lane] = f.b1[lane] * x - f.a1[lane] * y + f.s2[lane];
                    f.s2[lane] = f.b2[lane] * x - f.a2[lane] * y;
                    value[lane] = y;
                }
            }
            stored.s1 = f.s1;
            stored.s2 = f.s2;
        }
    }
}

}  // namespace ripplenotch
