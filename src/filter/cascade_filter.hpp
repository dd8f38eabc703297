// SPDX-License-Identifier: MIT
#pragma once
// Sections in series, and the filter that is one cascade for the whole log.

#include <cstddef>
#include <span>
#include <vector>

#include "ripplenotch/core/biquad.hpp"
#include "ripplenotch/filter/method.hpp"

namespace ripplenotch {

/// out = origin + F(in - origin), sample by sample. `states` has one entry a section; `in` may be `out`.
/// `advance(section, state, input)` returns the section's output.
template <class Section, class State, class Advance>
void run_cascade(std::span<const Section> sections, std::span<State> states, std::span<const double> in,
                 double origin, std::span<double> out, const Advance& advance) {
    for (std::size_t k = 0; k < out.size(); ++k) {
        double signal = in[k] - origin;
        for (std::size_t i = 0; i < sections.size(); ++i) signal = advance(sections[i], states[i], signal);
        out[k] = origin + signal;
    }
}

/// The same for second-order sections in transposed direct form II.
void run_cascade(std::span<const Biquad> sections, std::span<BiquadState> states, std::span<const double> in,
                 double origin, std::span<double> out);

/// A cascade of unity gain at 0 Hz, which runs relative to the first sample of each run: out = x0 + F(x - x0)
/// from zero state. This is the steady-state start of F, and a constant torque passes bit for bit, which
/// settled states give only to rounding.
class CascadeFilter final : public CausalFilter {
  public:
    explicit CascadeFilter(Cascade cascade) : cascade_(std::move(cascade)), states_(cascade_.size()) {}
    void process(const Samples& in, std::span<double> out) override;
    void restart() override { started_ = false; }

  private:
    Cascade cascade_;
    std::vector<BiquadState> states_;
    double origin_nm_ = 0.0;
    bool started_ = false;
};

}  // namespace ripplenotch
