// SPDX-License-Identifier: MIT
// One cascade whose coefficients are exchanged while its memory stays. The memory is direct form I, past
// inputs and past outputs, because these mean the same whatever the coefficients are; a transposed form would
// carry sums weighted by the old coefficients into the new filter, and its peak error at a change is four
// times larger.

#include "filter/kernels/bank_sections.hpp"
#include "filter/run/engine.hpp"

namespace ripplenotch {
namespace {

class Keep final : public OneCascade<Biquad, Past> {
  public:
    explicit Keep(const Candidates& candidates) : OneCascade(candidates.cascades, candidates.sections) {}

  private:
    void run_through(std::span<const Biquad> sections, std::span<Past> past,
                     std::span<const double> torque_nm, double origin_nm, std::span<double> out) override {
        run_direct_form(sections, past, torque_nm, origin_nm, out);
    }
    [[nodiscard]] double one_step(const Biquad& section, Past& past, double signal) const override {
        return advance(section, past, signal);
    }
};

std::unique_ptr<Transition> make(Candidates candidates, std::size_t /*blend_samples*/) {
    return std::make_unique<Keep>(candidates);
}

}  // namespace

const TransitionKind transitions::keep{.name = "keep", .make = make};

}  // namespace ripplenotch
