// SPDX-License-Identifier: MIT
#include "ripplenotch/evaluate/switch_ledger.hpp"

#include <algorithm>
#include <cmath>

#include "ripplenotch/evaluate/bench.hpp"

namespace ripplenotch {

SwitchLedger::SwitchLedger(std::span<const double> truth_nm) : truth_nm_(truth_nm) {
    if (truth_nm.empty()) return;
    const auto [low, high] = std::minmax_element(truth_nm.begin(), truth_nm.end());
    for (std::size_t b = 0; b < bands_nm_.size(); ++b)
        bands_nm_[b] = 0.01 * settle_bands_percent[b] * (*high - *low);
}

void SwitchLedger::add(std::span<const double> time_s, std::span<const double> out_nm,
                       std::span<const Switch> changes) {
    for (std::size_t k = 0; k < out_nm.size(); ++k, ++done_) {
        if (entries_.size() < changes.size() && changes[entries_.size()].sample == done_) {
            SwitchEntry entry{changes[entries_.size()],
                              Seconds(time_s[k]),
                              Seconds(0.0),
                              last_error_nm_,
                              std::nullopt,
                              std::nullopt,
                              {}};
            entries_.push_back(entry);
            watched_ = true;
            outside_.fill(false);
        }
        if (watched_) entries_.back().stretch = Seconds(time_s[k]) - entries_.back().time;
        if (truth_nm_.empty()) continue;
        const double error_nm = std::abs(out_nm[k] - truth_nm_[done_]);
        if (watched_) follow(Seconds(time_s[k]), error_nm);
        last_error_nm_ = error_nm;
    }
}

void SwitchLedger::follow(Seconds time, double error_nm) {
    SwitchEntry& entry = entries_.back();
    const Seconds after = time - entry.time;
    if (!entry.peak_error_nm || error_nm > *entry.peak_error_nm) {
        entry.peak_error_nm = error_nm;
        entry.peak_after = after;
    }
    for (std::size_t b = 0; b < bands_nm_.size(); ++b) {
        const bool outside = error_nm > bands_nm_[b];
        if (outside) {
            entry.settle[b].reset();
        } else if (outside_[b] || after == Seconds(0.0)) {
            entry.settle[b] = after;  // until it goes out again
        }
        outside_[b] = outside;
    }
}

void SwitchLedger::split() {
    watched_ = false;
    last_error_nm_.reset();
}

}  // namespace ripplenotch
