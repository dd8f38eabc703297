// SPDX-License-Identifier: MIT
#include "filter/bank/filter_bank.hpp"

#include <algorithm>
#include <array>

namespace ripplenotch {

FilterBank::FilterBank(const Candidates& candidates)
    : groups_((candidates.cascades.size() + lanes - 1) / lanes),
      sections_(groups_ * candidates.sections),
      outputs_(groups_ * stride) {
    for (std::size_t filter = 0; filter < groups_ * lanes; ++filter) {
        for (std::size_t s = 0; s < candidates.sections; ++s) {
            // Lanes without a candidate run the last one once more.
            const Biquad& f = candidates.cascades[std::min(filter, candidates.cascades.size() - 1)][s];
            mirrored_ = mirrored_ && f.b0 == f.b2;
            BankSection& section = sections_[filter / lanes * candidates.sections + s];
            const std::size_t lane = filter % lanes;
            section.b0[lane] = f.b0;
            section.b1[lane] = f.b1;
            section.b2[lane] = f.b2;
            section.a1[lane] = f.a1;
            section.a2[lane] = f.a2;
        }
    }
}

void FilterBank::start(double torque_nm) {
    origin_nm_ = torque_nm;
    for (BankSection& section : sections_) section.s1 = section.s2 = {};
}

void FilterBank::run(std::span<const double> torque_nm) {
    std::array<double, capacity()> signal;
    for (std::size_t k = 0; k < torque_nm.size(); ++k) signal[k] = torque_nm[k] - origin_nm_;
    const BankRun bank{sections_, groups_, outputs_, stride, mirrored_};
    run_bank(bank, std::span(signal).first(torque_nm.size()));
}

void FilterBank::outputs(int candidate, std::span<const double> torque_nm,
                         std::span<double> out) const noexcept {
    if (candidate == no_candidate) {
        std::copy(torque_nm.begin(), torque_nm.end(), out.begin());
        return;
    }
    const auto filter = static_cast<std::size_t>(candidate);
    const BankOutput* from = &outputs_[filter / lanes * stride];
    const std::size_t lane = filter % lanes;
    const double origin = origin_nm_;  // a copy, which `out` cannot change
    for (double& value : out) value = origin + (from++)->lanes[lane];
}

}  // namespace ripplenotch
