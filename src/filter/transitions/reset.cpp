// SPDX-License-Identifier: MIT
// One cascade that is re-initialized at every change in the steady state of the present torque. Simple
// firmware does this; every change lets the ripple of that moment through and then decays.

#include "filter/kernels/bank_sections.hpp"
#include "filter/run/engine.hpp"

namespace ripplenotch {
namespace {

class Reset final : public OneCascade<Biquad, BiquadState> {
  public:
    explicit Reset(const Candidates& candidates)
        : OneCascade(candidates.cascades, candidates.sections), candidates_(candidates) {}

  private:
    void run_through(std::span<const Biquad> sections, std::span<BiquadState> states,
                     std::span<const double> torque_nm, double origin_nm, std::span<double> out) override {
        run_serial(sections, states, torque_nm, origin_nm, out);
    }
    [[nodiscard]] double one_step(const Biquad& section, BiquadState& state, double signal) const override {
        return step(section, state, signal);
    }
    [[nodiscard]] bool begins_again(int before, int now) const override {
        return !candidates_.same(before, now);
    }

    Candidates candidates_;
};

std::unique_ptr<Transition> make(Candidates candidates, std::size_t /*blend_samples*/) {
    return std::make_unique<Reset>(candidates);
}

}  // namespace

const TransitionKind transitions::reset{.name = "reset", .make = make};

}  // namespace ripplenotch
