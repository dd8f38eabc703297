// SPDX-License-Identifier: MIT
// As keep, but the memory is that of the trapezoidal state-variable form: two integrators a section, which
// mean the same whatever the centre is, as the notch that is retuned at every sample has them.

#include <algorithm>
#include <cmath>
#include <utility>

#include "filter/kernels/in_series.hpp"
#include "filter/run/transition.hpp"
#include "ripplenotch/core/state_variable.hpp"

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
    // step() leaves 2 v - s in each integrator.
    const double v1 = 0.5 * (s.s1 + band_now), v2 = 0.5 * (s.s2 + low_now);
    return f.high * x + f.band * v1 + f.low * v2;
}

class KeepStateVariable final : public Transition {
  public:
    explicit KeepStateVariable(const Candidates& candidates) : states_(candidates.sections) {
        for (const Cascade& cascade : candidates.cascades) {
            sections_.emplace_back();
            for (const Biquad& f : cascade) sections_.back().push_back(section_of(f));
        }
    }

    void start(int candidate, double torque_nm) override {
        candidate_ = candidate;
        settle(torque_nm);
    }

    void run(std::span<const double> torque_nm, std::span<double> out) override {
        if (candidate_ == no_candidate) {
            std::copy(torque_nm.begin(), torque_nm.end(), out.begin());
            return;
        }
        run_in_series(std::span<const Section>(sections_[static_cast<std::size_t>(candidate_)]),
                      std::span(states_), torque_nm, origin_nm_, out,
                      [](const Section& f, BandPassState& s, double x) { return advance(f, s, x); });
    }

    Change change(int candidate, double torque_nm) override {
        auto unchanged_states = states_;
        const double unchanged =
            candidate_ == no_candidate ? torque_nm : through(unchanged_states, torque_nm);
        // While no filter is in force there is no past worth keeping.
        if (candidate_ == no_candidate) settle(torque_nm);
        candidate_ = candidate;
        return {candidate == no_candidate ? torque_nm : through(states_, torque_nm), unchanged};
    }

  private:
    // All signals are relative to the torque at which the cascade was settled; see CascadeFilter.
    void settle(double torque_nm) {
        origin_nm_ = torque_nm;
        std::fill(states_.begin(), states_.end(), BandPassState{});
    }

    double through(std::vector<BandPassState>& states, double torque_nm) const {
        const std::vector<Section>& cascade = sections_[static_cast<std::size_t>(candidate_)];
        double signal = torque_nm - origin_nm_;
        for (std::size_t i = 0; i < cascade.size(); ++i) signal = advance(cascade[i], states[i], signal);
        return origin_nm_ + signal;
    }

    std::vector<std::vector<Section>> sections_;  ///< by candidate
    std::vector<BandPassState> states_;
    double origin_nm_ = 0.0;
    int candidate_ = no_candidate;
};

std::unique_ptr<Transition> make(Candidates candidates, std::size_t /*blend_samples*/) {
    return std::make_unique<KeepStateVariable>(candidates);
}

}  // namespace

const TransitionKind transitions::keep_state_variable{.name = "keep-state-variable", .make = make};

}  // namespace ripplenotch
