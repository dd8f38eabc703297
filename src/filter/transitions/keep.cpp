// SPDX-License-Identifier: MIT
// One cascade whose coefficients are exchanged while its memory stays. The memory is direct form I, past
// inputs and past outputs, because these mean the same whatever the coefficients are; a transposed form would
// carry sums weighted by the old coefficients into the new filter, and its peak error at a change is four
// times larger.

#include <algorithm>
#include <utility>

#include "filter/kernels/direct_form.hpp"
#include "filter/run/transition.hpp"

namespace ripplenotch {
namespace {

class Keep final : public Transition {
  public:
    explicit Keep(Candidates candidates) : candidates_(std::move(candidates)), past_(candidates_.sections) {}

    void start(int candidate, double torque_nm) override {
        candidate_ = candidate;
        settle(torque_nm);
    }

    void run(std::span<const double> torque_nm, std::span<double> out) override {
        if (candidate_ == no_candidate) {
            std::copy(torque_nm.begin(), torque_nm.end(), out.begin());
            return;
        }
        run_direct_form(cascade(), past_, torque_nm, origin_nm_, out);
    }

    Change change(int candidate, double torque_nm) override {
        std::vector<Past> unchanged_past = past_;
        const double unchanged = candidate_ == no_candidate ? torque_nm : through(unchanged_past, torque_nm);
        // While no filter is in force there is no past worth keeping: its outputs were never made.
        if (candidate_ == no_candidate) settle(torque_nm);
        candidate_ = candidate;
        return {candidate == no_candidate ? torque_nm : through(past_, torque_nm), unchanged};
    }

  private:
    // All signals are relative to the torque at which the cascade was settled; see CascadeFilter.
    void settle(double torque_nm) {
        origin_nm_ = torque_nm;
        std::fill(past_.begin(), past_.end(), Past{});
    }

    [[nodiscard]] const Cascade& cascade() const {
        return candidates_.cascades[static_cast<std::size_t>(candidate_)];
    }

    double through(std::vector<Past>& past, double torque_nm) const {
        double signal = torque_nm - origin_nm_;
        for (std::size_t i = 0; i < past.size(); ++i) signal = advance(cascade()[i], past[i], signal);
        return origin_nm_ + signal;
    }

    Candidates candidates_;
    std::vector<Past> past_;  ///< by section
    double origin_nm_ = 0.0;
    int candidate_ = no_candidate;
};

std::unique_ptr<Transition> make(Candidates candidates, std::size_t /*blend_samples*/) {
    return std::make_unique<Keep>(std::move(candidates));
}

}  // namespace

const TransitionKind transitions::keep{.name = "keep", .make = make};

}  // namespace ripplenotch
