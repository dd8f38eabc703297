// SPDX-License-Identifier: MIT
// As keep, but the memory is that of the trapezoidal state-variable form: two integrators a section, which
// mean the same whatever the centre is, as the notch that is retuned at every sample has them.

#include <cmath>

#include "filter/kernels/in_series.hpp"
#include "filter/run/engine.hpp"
#include "ripplenotch/core/biquad.hpp"

namespace ripplenotch {
namespace {

// Any stable section in state-variable form: y = high x + band v1 + low v2, with the integrators of
// BandPassTuning.
struct Section {
    BandPassTuning tuning;
    double high = 1.0, band = 0.0, low = 0.0;
};

// The bilinear transform read backward: the denominator at z = 1 and z = -1 gives the warped centre and the
// damping, the numerator there the gains at 0 Hz and at half the sample rate. Both denominators are above 0
// for every stable section.
Section section_of(const Biquad& f) {
    const double at_zero = 1.0 + f.a1 + f.a2, at_half = 1.0 - f.a1 + f.a2;
    const double warped = std::sqrt(at_zero / at_half);
    const double damping = 2.0 * (1.0 - f.a2) / (at_half * warped);
    const double high = (f.b0 - f.b1 + f.b2) / at_half, low = (f.b0 + f.b1 + f.b2) / at_zero;
    const double band = 2.0 * (f.b0 - f.b2) / (at_half * warped);
    return {BandPassTuning::at({.warped = warped, .q = 1.0 / damping}), high, band - high * damping,
            low - high};
}

double advance(const Section& f, BandPassState& s, double x) noexcept {
    const double low_now = s.s2, band_now = s.s1;
    static_cast<void>(step(f.tuning, s, x));
    // step() sets each integrator to 2 v - s.
    const double v1 = 0.5 * (s.s1 + band_now), v2 = 0.5 * (s.s2 + low_now);
    return f.high * x + f.band * v1 + f.low * v2;
}

std::vector<std::vector<Section>> sections_of(const Candidates& candidates) {
    std::vector<std::vector<Section>> sections;
    for (const Cascade& cascade : candidates.cascades) {
        sections.emplace_back();
        for (const Biquad& f : cascade) sections.back().push_back(section_of(f));
    }
    return sections;
}

class KeepStateVariable final : public OneCascade<Section, BandPassState> {
  public:
    explicit KeepStateVariable(const Candidates& candidates)
        : OneCascade(sections_of(candidates), candidates.sections) {}

  private:
    void run_through(std::span<const Section> sections, std::span<BandPassState> states,
                     std::span<const double> torque_nm, double origin_nm, std::span<double> out) override {
        run_in_series(sections, states, torque_nm, origin_nm, out,
                      [](const Section& f, BandPassState& s, double x) { return advance(f, s, x); });
    }
    [[nodiscard]] double one_step(const Section& section, BandPassState& state,
                                  double signal) const override {
        return advance(section, state, signal);
    }
};

std::unique_ptr<Transition> make(Candidates candidates, std::size_t /*blend_samples*/) {
    return std::make_unique<KeepStateVariable>(candidates);
}

}  // namespace

const TransitionKind transitions::keep_state_variable{.name = "keep-state-variable", .make = make};

}  // namespace ripplenotch
