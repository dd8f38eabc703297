// SPDX-License-Identifier: MIT
#include "filter/cascade_filter.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "filter/kernels/block_difference.hpp"
#include "filter/kernels/serial_cascade.hpp"

namespace ripplenotch {
namespace {
constexpr std::size_t most_at_once = 1024;  // samples that stay in the first cache
}

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
    for (std::size_t at = 0; at < out.size(); at += most_at_once) {
        const std::size_t count = std::min(most_at_once, out.size() - at);
        run_recursion(in.torque_nm.subspan(at, count), out.subspan(at, count));
    }
}

void CascadeFilter::run_recursion(std::span<const double> torque_nm, std::span<double> out) {
    const double origin = origin_nm_;
    for (std::size_t k = 0; k < out.size(); ++k) out[k] = torque_nm[k] - origin;
    run_serial(cascade_, states_, out);
    for (double& value : out) value += origin;
}

}  // namespace ripplenotch
