// SPDX-License-Identifier: MIT
#include "filter/transitions.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "filter/cascade_filter.hpp"
#include "ripplenotch/core/biquad.hpp"

namespace ripplenotch {
namespace {

// The bands' sections, padded with neutral ones to equal length.
std::vector<Cascade> candidates_of(std::span<const Band> bands) {
    std::vector<Cascade> candidates;
    std::size_t sections = 0;
    for (const Band& band : bands) {
        candidates.push_back(band.cascade());
        sections = std::max(sections, candidates.back().size());
    }
    for (Cascade& cascade : candidates) cascade.resize(sections);  // a default Biquad is neutral
    return candidates;
}

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

// One cascade whose coefficients are exchanged while its memory stays. The memory is that of the trapezoidal
// state-variable form: two integrators a section, which mean the same whatever the centre is, as the notch
// that is retuned at every sample has them.
class KeepStateVariable final : public Transition {
  public:
    explicit KeepStateVariable(std::span<const Band> bands) {
        for (const Cascade& cascade : candidates_of(bands)) {
            std::vector<Section>& sections = sections_.emplace_back();
            for (const Biquad& f : cascade) sections.push_back(section_of(f));
            states_.resize(sections.size());
        }
    }

    void start(int candidate, double torque_nm) override {
        candidate_ = candidate;
        settle(torque_nm);
    }

    void run(std::span<const double> torque_nm, std::span<double> out) override {
        run_through(states_, torque_nm, out);
    }

    Change change(int candidate, double torque_nm) override {
        std::vector<BandPassState> unchanged_states = states_;
        const double unchanged = through(unchanged_states, torque_nm);
        // While no filter is active there is no state to keep: its outputs were never computed.
        if (std::exchange(candidate_, candidate) == no_candidate) settle(torque_nm);
        return {through(states_, torque_nm), unchanged};
    }

  private:
    void settle(double torque_nm) {
        origin_nm_ = torque_nm;
        std::fill(states_.begin(), states_.end(), BandPassState{});
    }

    void run_through(std::vector<BandPassState>& states, std::span<const double> torque_nm,
                     std::span<double> out) const {
        if (candidate_ == no_candidate) {
            std::copy(torque_nm.begin(), torque_nm.end(), out.begin());
            return;
        }
        const std::vector<Section>& sections = sections_[static_cast<std::size_t>(candidate_)];
        run_cascade(std::span(sections), std::span(states), torque_nm, origin_nm_, out,
                    [](const Section& f, BandPassState& s, double x) { return advance(f, s, x); });
    }

    double through(std::vector<BandPassState>& states, double torque_nm) const {
        double out = 0.0;
        run_through(states, {&torque_nm, 1}, {&out, 1});
        return out;
    }

    std::vector<std::vector<Section>> sections_;  ///< by candidate
    std::vector<BandPassState> states_;           ///< by section
    double origin_nm_ = 0.0;                      ///< all signals are relative to it
    int candidate_ = no_candidate;
};

// All candidates run on the same torque all the time; a change selects another output, at once or linearly
// over a stated time. No filter ever starts cold. At once the output may step by as much as two candidates
// differ. A change during a blend starts a new blend from the current mixture.
class AllWarm final : public Transition {
  public:
    AllWarm(std::span<const Band> bands, std::size_t blend_samples)
        : candidates_(candidates_of(bands)), outputs_(candidates_.size()), blend_samples_(blend_samples) {
        for (const Cascade& cascade : candidates_) states_.emplace_back(cascade.size());
    }

    void start(int candidate, double torque_nm) override {
        candidate_ = candidate;
        leaving_.clear();
        origin_nm_ = torque_nm;
        for (auto& states : states_) std::fill(states.begin(), states.end(), BiquadState{});
    }

    void run(std::span<const double> torque_nm, std::span<double> out) override {
        run_all(torque_nm);
        for (std::size_t k = 0; k < out.size(); ++k) out[k] = mixture(k, torque_nm[k]);
    }

    Change change(int candidate, double torque_nm) override {
        run_all({&torque_nm, 1});
        // The current mixture, as of the sample before, becomes the start of the new blend.
        std::vector<Share> mixed;
        double rest = 1.0;
        for (const Share& share : leaving_) {
            const double weight = share.weight * (1.0 - done());
            rest -= weight;
            if (share.candidate != candidate) mixed.push_back({share.candidate, weight});
        }
        mixed.push_back({candidate_, rest});
        const double unchanged = mixture(0, torque_nm);
        candidate_ = candidate;
        step_ = 0;
        leaving_.clear();
        if (blend_samples_ > 0) leaving_ = std::move(mixed);
        return {mixture(0, torque_nm), unchanged};
    }

  private:
    struct Share {
        int candidate;
        double weight;
    };

    void run_all(std::span<const double> torque_nm) {
        for (std::size_t i = 0; i < candidates_.size(); ++i) {
            outputs_[i].resize(torque_nm.size());
            run_cascade(candidates_[i], states_[i], torque_nm, origin_nm_, outputs_[i]);
        }
    }

    [[nodiscard]] double done() const {
        return static_cast<double>(step_) / static_cast<double>(blend_samples_);
    }

    // Differences from the active candidate are added, so that equal candidates give exactly its output.
    double mixture(std::size_t sample, double torque_nm) {
        const auto output = [&](int candidate) {
            return candidate == no_candidate ? torque_nm
                                             : outputs_[static_cast<std::size_t>(candidate)][sample];
        };
        const double target = output(candidate_);
        if (leaving_.empty()) return target;
        ++step_;
        const double remaining = 1.0 - done();
        double sum = 0.0;
        for (const Share& share : leaving_) sum += share.weight * (output(share.candidate) - target);
        if (step_ >= blend_samples_) leaving_.clear();
        return target + remaining * sum;
    }

    std::vector<Cascade> candidates_;
    std::vector<std::vector<BiquadState>> states_;
    std::vector<std::vector<double>> outputs_;  ///< of the latest samples, by candidate
    std::size_t blend_samples_;
    std::size_t step_ = 0;
    double origin_nm_ = 0.0;
    int candidate_ = no_candidate;
    std::vector<Share> leaving_;  ///< the start of the current blend; never more entries than candidates + 1
};

}  // namespace

std::unique_ptr<Transition> make_transition(std::string_view name, std::span<const Band> bands,
                                            std::size_t crossfade_samples) {
    if (name == "keep-state-variable") return std::make_unique<KeepStateVariable>(bands);
    return std::make_unique<AllWarm>(bands, name == "crossfade" ? crossfade_samples : 0);
}

}  // namespace ripplenotch
