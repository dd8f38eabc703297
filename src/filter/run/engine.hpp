// SPDX-License-Identifier: MIT
#pragma once
#include <algorithm>
#include <cstddef>
#include <memory>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "log/account/account.hpp"
#include "ripplenotch/core/biquad.hpp"
#include "ripplenotch/core/quantity.hpp"
#include "ripplenotch/filter/engine.hpp"

namespace ripplenotch {

// What happens to the filters' memories when the supervisor activates another candidate.

/// Output at the sample of a change, and the output without the change.
struct Change {
    double now_nm = 0.0;
    double unchanged_nm = 0.0;
};

/// Candidates are counted from 0; no_candidate passes the torque. Every call takes the next samples in order.
class Transition {
  public:
    virtual ~Transition() = default;
    /// Before the first sample of a run: settled at a constant input of `torque_nm`.
    virtual void start(int candidate, double torque_nm) = 0;
    /// Samples without a change. `out` has as many entries as `torque_nm`.
    virtual void run(std::span<const double> torque_nm, std::span<double> out) = 0;
    /// One sample, at which `candidate` comes into force.
    virtual Change change(int candidate, double torque_nm) = 0;
};

/// The candidates' sections, padded with neutral ones to equal length, and which of them are the same filter:
/// changing to an equal filter must not disturb anything.
struct Candidates {
    explicit Candidates(std::span<const Band> bands);

    std::vector<Cascade> cascades;
    std::size_t sections = 0;  ///< sections of each cascade
    std::vector<int> same_as;  ///< lowest candidate with equal coefficients

    [[nodiscard]] bool same(int a, int b) const noexcept;
};

/// A way is a record: one file in src/filter/transitions, one line in transitions.def.
struct TransitionKind {
    std::string_view name;
    /// `blend_samples`: over which outputs are blended, for ways that blend.
    std::unique_ptr<Transition> (*make)(Candidates candidates, std::size_t blend_samples) = nullptr;
};

namespace transitions {
#define TRANSITION(name) extern const TransitionKind name;
#include "filter/transitions/transitions.def"
#undef TRANSITION
}  // namespace transitions

// Ways that run one cascade, whose coefficients are exchanged at a change; they differ in the memory, and in
// what stays of it.

template <class Section, class State>
class OneCascade : public Transition {
  public:
    void start(int candidate, double torque_nm) final {
        candidate_ = candidate;
        settle(torque_nm);
    }

    void run(std::span<const double> torque_nm, std::span<double> out) final {
        if (candidate_ == no_candidate)
            std::copy(torque_nm.begin(), torque_nm.end(), out.begin());
        else
            run_through(sections_[static_cast<std::size_t>(candidate_)], states_, torque_nm, origin_nm_, out);
    }

    Change change(int candidate, double torque_nm) final {
        std::vector<State> unchanged_states = states_;
        const double unchanged = through(unchanged_states, torque_nm);
        const int before = std::exchange(candidate_, candidate);
        if (begins_again(before, candidate)) settle(torque_nm);
        return {through(states_, torque_nm), unchanged};
    }

  protected:
    /// `sections` by candidate, all of them equally many.
    OneCascade(std::vector<std::vector<Section>> sections, std::size_t count)
        : sections_(std::move(sections)), states_(count) {}

    /// All signals are relative to `origin_nm`, at which the cascade was settled; see CascadeFilter.
    virtual void run_through(std::span<const Section> sections, std::span<State> states,
                             std::span<const double> torque_nm, double origin_nm, std::span<double> out) = 0;
    [[nodiscard]] virtual double one_step(const Section& section, State& state, double signal) const = 0;
    /// While no filter is active there is no state to keep: its outputs were never computed.
    [[nodiscard]] virtual bool begins_again(int before, int /*now*/) const { return before == no_candidate; }

  private:
    void settle(double torque_nm) {
        origin_nm_ = torque_nm;
        std::fill(states_.begin(), states_.end(), State{});
    }

    double through(std::vector<State>& states, double torque_nm) const {
        if (candidate_ == no_candidate) return torque_nm;
        const std::vector<Section>& cascade = sections_[static_cast<std::size_t>(candidate_)];
        double signal = torque_nm - origin_nm_;
        for (std::size_t i = 0; i < cascade.size(); ++i) signal = one_step(cascade[i], states[i], signal);
        return origin_nm_ + signal;
    }

    std::vector<std::vector<Section>> sections_;
    std::vector<State> states_;  ///< by section
    double origin_nm_ = 0.0;
    int candidate_ = no_candidate;
};

}  // namespace ripplenotch
