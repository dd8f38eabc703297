// SPDX-License-Identifier: MIT
// One cascade that starts again at every change, as if the present torque had been there for ever. Simple
// firmware does this; every change lets the ripple of that moment through and then decays.

#include <algorithm>
#include <utility>

#include "filter/kernels/serial_cascade.hpp"
#include "filter/run/transition.hpp"

namespace ripplenotch {
namespace {

class Reset final : public Transition {
  public:
    explicit Reset(Candidates candidates)
        : candidates_(std::move(candidates)), states_(candidates_.sections) {}

    void start(int candidate, double torque_nm) override {
        candidate_ = candidate;
        settle(torque_nm);
    }

    void run(std::span<const double> torque_nm, std::span<double> out) override {
        if (candidate_ == no_candidate) {
            std::copy(torque_nm.begin(), torque_nm.end(), out.begin());
            return;
        }
        run_serial(candidates_.cascades[static_cast<std::size_t>(candidate_)], states_, torque_nm, origin_nm_,
                   out);
    }

    Change change(int candidate, double torque_nm) override {
        auto unchanged_states = states_;
        const double unchanged =
            candidate_ == no_candidate ? torque_nm : advance(unchanged_states, torque_nm);
        const int before = std::exchange(candidate_, candidate);
        if (!candidates_.same(before, candidate)) settle(torque_nm);
        return {candidate == no_candidate ? torque_nm : advance(states_, torque_nm), unchanged};
    }

  private:
    // Zero state relative to the present torque is the settled state; see CascadeFilter.
    void settle(double torque_nm) {
        origin_nm_ = torque_nm;
        std::fill(states_.begin(), states_.end(), BiquadState{});
    }

    double advance(std::vector<BiquadState>& states, double torque_nm) const {
        const Cascade& cascade = candidates_.cascades[static_cast<std::size_t>(candidate_)];
        double signal = torque_nm - origin_nm_;
        for (std::size_t i = 0; i < cascade.size(); ++i) signal = step(cascade[i], states[i], signal);
        return origin_nm_ + signal;
    }

    Candidates candidates_;
    std::vector<BiquadState> states_;
    double origin_nm_ = 0.0;
    int candidate_ = no_candidate;
};

std::unique_ptr<Transition> make(Candidates candidates, std::size_t /*blend_samples*/) {
    return std::make_unique<Reset>(std::move(candidates));
}

}  // namespace

const TransitionKind transitions::reset{.name = "reset", .make = make};

}  // namespace ripplenotch
