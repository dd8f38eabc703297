// SPDX-License-Identifier: MIT
// The control in every comparison: out = in.
#include <algorithm>

#include "filter/method.hpp"

namespace ripplenotch {
namespace {

class PassThrough final : public CausalFilter {
  public:
    void process(const Samples& in, std::span<double> out) override {
        std::copy(in.torque_nm.begin(), in.torque_nm.end(), out.begin());
    }
    void restart() override {}
};

std::unique_ptr<CausalFilter> start(const Settings&, Hertz, const CandidateTable*) {
    return std::make_unique<PassThrough>();
}

FrozenFilter frozen(const Settings&, Hertz, const CandidateTable*, DegPerSec) { return {{}, "passes"}; }

}  // namespace

const Method filter_methods::none = {
    .name = "none",
    .summary = "the torque as it is; the control in every comparison",
    .source = "",
    .noun = "no filter",
    .part = MethodPart::control,
    .keys = {},
    .start = start,
    .frozen = frozen,
};

}  // namespace ripplenotch
