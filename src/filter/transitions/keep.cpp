// SPDX-License-Identifier: MIT
// One cascade whose coefficients are exchanged while its memory stays. The memory is direct form I, past
// inputs and past outputs, because these mean the same whatever the coefficients are; a transposed form would
// carry sums weighted by the old coefficients into the new filter, and its peak error at a change is four
// times larger.

#include <algorithm>
#include <array>
#include <utility>

#include "filter/transitions/transition.hpp"

namespace ripplenotch {
namespace {

using Past = std::array<double, 2>;  ///< one and two samples ago

class Keep final : public Transition {
  public:
    explicit Keep(Candidates candidates)
        : candidates_(std::move(candidates)), past_(candidates_.sections + 1) {}

    void start(int candidate, double torque_nm) override {
        candidate_ = candidate;
        settle(torque_nm);
    }

    void run(std::span<const double> torque_nm, std::span<double> out) override {
        if (candidate_ == no_candidate) {
            std::copy(torque_nm.begin(), torque_nm.end(), out.begin());
            return;
        }
        for (std::size_t k = 0; k < out.size(); ++k) out[k] = advance(torque_nm[k]);
    }

    Change change(int candidate, double torque_nm) override {
        const double unchanged = candidate_ == no_candidate ? torque_nm : peek(torque_nm);
        // While no filter is in force there is no past worth keeping: its outputs were never made.
        if (candidate_ == no_candidate) settle(torque_nm);
        candidate_ = candidate;
        return {candidate == no_candidate ? torque_nm : advance(torque_nm), unchanged};
    }

  private:
    // All signals are relative to the torque at which the cascade was settled; see CascadeFilter.
    void settle(double torque_nm) {
        origin_nm_ = torque_nm;
        for (Past& past : past_) past = {0.0, 0.0};
    }

    double advance(double torque_nm) {
        double signal = torque_nm - origin_nm_;
        const Cascade& cascade = candidates_.cascades[static_cast<std::size_t>(candidate_)];
        for (std::size_t i = 0; i < cascade.size(); ++i) {
            const double result = next(cascade[i], signal, past_[i], past_[i + 1]);
            past_[i] = {signal, past_[i][0]};
            signal = result;
        }
        past_.back() = {signal, past_.back()[0]};
        return origin_nm_ + signal;
    }

    [[nodiscard]] double peek(double torque_nm) const {
        double signal = torque_nm - origin_nm_;
        const Cascade& cascade = candidates_.cascades[static_cast<std::size_t>(candidate_)];
        for (std::size_t i = 0; i < cascade.size(); ++i)
            signal = next(cascade[i], signal, past_[i], past_[i + 1]);
        return origin_nm_ + signal;
    }

    static double next(const Biquad& f, double x, const Past& inputs, const Past& outputs) {
        return f.b0 * x + f.b1 * inputs[0] + f.b2 * inputs[1] - f.a1 * outputs[0] - f.a2 * outputs[1];
    }

    Candidates candidates_;
    std::vector<Past> past_;  ///< of the input and of each section's output
    double origin_nm_ = 0.0;
    int candidate_ = no_candidate;
};

}  // namespace

std::unique_ptr<Transition> make_keep(Candidates candidates) {
    return std::make_unique<Keep>(std::move(candidates));
}

}  // namespace ripplenotch
