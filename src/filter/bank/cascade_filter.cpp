// SPDX-License-Identifier: MIT
#include "filter/bank/cascade_filter.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "filter/kernels/block_difference.hpp"
#include "filter/kernels/serial_cascade.hpp"

namespace ripplenotch {
CascadeFilter::CascadeFilter(Cascade cascade) : cascade_(std::move(cascade)), states_(cascade_.size()) {}

std::string CascadeFilter::hurry() {
    if (!block_form_serves(cascade_)) {
        return fmt::format(
            "sample by sample: in blocks of eight the output could differ by more than {} of the largest "
            "torque",
            most_block_difference);
    }
    blocks_.emplace(cascade_);
    return fmt::format(
        "in blocks of eight samples, within {} of the largest torque; --exact goes sample by sample",
        most_block_difference);
}

void CascadeFilter::process(const Samples& in, std::span<double> out) {
    if (out.empty()) return;
    if (!started_) {
        origin_nm_ = in.torque_nm.front();
        std::fill(states_.begin(), states_.end(), BiquadState{});
        if (blocks_) blocks_->start(origin_nm_);
        started_ = true;
    }
    if (blocks_) {
        blocks_->run(in.torque_nm, out);
        return;
    }
    run_serial(cascade_, states_, in.torque_nm, origin_nm_, out);
}

}  // namespace ripplenotch
