// SPDX-License-Identifier: MIT
#include "filter/kernels/block_cascade.hpp"

#include <algorithm>

namespace ripplenotch {
namespace {
constexpr std::size_t sections_a_pass = BlockForm::memory / 2;
constexpr std::size_t most_at_once = 1024;  // samples that stay in the first cache between passes
}  // namespace

BlockCascade::BlockCascade(std::span<const Biquad> sections) {
    for (std::size_t i = 0; i < sections.size(); i += sections_a_pass) {
        passes_.push_back({BlockForm(sections.subspan(i, std::min(sections_a_pass, sections.size() - i)))});
    }
    before_.resize(passes_.size());
}

void BlockCascade::start(double origin) {
    origin_ =
        origin + 0.0;  // +0 for -0: then a zero's sign, which a sum may lose, does not show in the output
    known_ = 0;
    for (BlockPass& pass : passes_) pass.memory = {};
}

void BlockCascade::run(std::span<const double> in, std::span<double> out) {
    std::size_t at = 0;
    while (at < in.size()) {
        const std::size_t left = in.size() - at;
        if (known_ == 0 && left >= group) {
            const std::size_t count = std::min(left, most_at_once) / group * group;
            if (!run_whole(in.subspan(at, count), out.subspan(at, count))) {
                for (std::size_t k = at; k < at + count; k += group) {
                    std::copy_n(in.begin() + static_cast<std::ptrdiff_t>(k), group, inputs_.begin());
                    run_group_by_output(out.subspan(k, group), 0, group);
                }
            }
            at += count;
            continue;
        }
        const std::size_t count = std::min(left, group - known_);
        std::copy_n(in.begin() + static_cast<std::ptrdiff_t>(at), count,
                    inputs_.begin() + static_cast<std::ptrdiff_t>(known_));
        run_group_by_output(out.subspan(at, count), known_, known_ + count);
        known_ = (known_ + count) % group;
        at += count;
    }
}

bool BlockCascade::run_whole(std::span<const double> in, std::span<double> out, bool whatever) {
    return run_groups(passes_, in, origin_, out, whatever);
}

// Each output from the inputs that it may know; those that follow count as settled, and their coefficients
// are zero.
void BlockCascade::run_group_by_output(std::span<double> out, std::size_t from, std::size_t to) {
    for (std::size_t k = from; k < to; ++k) {
        std::array<double, group> in, result;
        const auto next = static_cast<std::ptrdiff_t>(k) + 1;
        std::fill(std::copy(inputs_.begin(), inputs_.begin() + next, in.begin()), in.end(), origin_);
        std::transform(passes_.begin(), passes_.end(), before_.begin(),
                       [](const BlockPass& pass) { return pass.memory; });
        static_cast<void>(run_whole(in, result, true));
        out[k - from] = result[k];
        if (k + 1 == group) return;  // the memory after the whole group stays
        for (std::size_t i = 0; i < passes_.size(); ++i) passes_[i].memory = before_[i];
    }
}

}  // namespace ripplenotch
