// SPDX-License-Identifier: MIT
// As parallel, but the output moves from the old candidate to the new one linearly over a stated time. A
// change during a blend starts a new blend from the current mixture.

#include <algorithm>
#include <utility>
#include <vector>

#include "filter/bank/filter_bank.hpp"

namespace ripplenotch {
namespace {

class Crossfade final : public Transition {
  public:
    Crossfade(const Candidates& candidates, std::size_t blend_samples)
        : bank_(candidates), blend_samples_(blend_samples) {}

    void start(int candidate, double torque_nm) override {
        candidate_ = candidate;
        leaving_.clear();
        bank_.start(torque_nm);
    }

    void run(std::span<const double> torque_nm, std::span<double> out) override {
        for (std::size_t first = 0; first < out.size(); first += FilterBank::capacity()) {
            const std::size_t count = std::min(FilterBank::capacity(), out.size() - first);
            const auto in = torque_nm.subspan(first, count);
            bank_.run(in);
            if (leaving_.empty()) {
                bank_.outputs(candidate_, in, out.subspan(first, count));
                continue;
            }
            for (std::size_t k = 0; k < count; ++k) out[first + k] = mixture(k, in[k]);
        }
    }

    Change change(int candidate, double torque_nm) override {
        bank_.run({&torque_nm, 1});
        // The current mixture, as of the sample before, becomes the start of the new blend.
        std::vector<Share> mixed;
        double rest = 1.0;
        for (const Share& share : leaving_) {
            const double weight = share.weight * (1.0 - done());
            rest -= weight;
            if (share.candidate != candidate) mixed.push_back({share.candidate, weight});
        }
        mixed.push_back({candidate_, rest});

        Change result;
        result.unchanged_nm = mixture(0, torque_nm);
        leaving_ = std::move(mixed);
        candidate_ = candidate;
        step_ = 0;
        result.now_nm = mixture(0, torque_nm);
        return result;
    }

  private:
    struct Share {
        int candidate;
        double weight;
    };

    [[nodiscard]] double done() const {
        return static_cast<double>(step_) / static_cast<double>(blend_samples_);
    }

    // Differences from the active candidate are added, so that equal candidates give exactly its output.
    double mixture(std::size_t sample, double torque_nm) {
        const auto output = [&](int candidate) {
            return candidate == no_candidate ? torque_nm : bank_.output(candidate, sample);
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

    FilterBank bank_;
    std::size_t blend_samples_;
    std::size_t step_ = 0;
    int candidate_ = no_candidate;
    std::vector<Share> leaving_;  ///< the start of the current blend; never more entries than candidates + 1
};

std::unique_ptr<Transition> make(Candidates candidates, std::size_t blend_samples) {
    if (blend_samples == 0) return transitions::parallel.make(std::move(candidates), 0);
    return std::make_unique<Crossfade>(candidates, blend_samples);
}

}  // namespace

const TransitionKind transitions::crossfade{.name = "crossfade", .make = make};

}  // namespace ripplenotch
