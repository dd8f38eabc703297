// SPDX-License-Identifier: MIT
// All candidates run on the same torque all the time; a change only selects another output. No filter ever
// starts cold, and the output may step by as much as two candidates differ.

#include <algorithm>
#include <utility>

#include "filter/bank/filter_bank.hpp"

namespace ripplenotch {
namespace {

class Parallel final : public Transition {
  public:
    explicit Parallel(const Candidates& candidates) : bank_(candidates) {}

    void start(int candidate, double torque_nm) override {
        candidate_ = candidate;
        bank_.start(torque_nm);
    }

    void run(std::span<const double> torque_nm, std::span<double> out) override {
        for (std::size_t first = 0; first < out.size(); first += FilterBank::capacity()) {
            const std::size_t count = std::min(FilterBank::capacity(), out.size() - first);
            const auto in = torque_nm.subspan(first, count);
            bank_.run(in);
            bank_.outputs(candidate_, in, out.subspan(first, count));
        }
    }

    Change change(int candidate, double torque_nm) override {
        bank_.run({&torque_nm, 1});
        const int before = std::exchange(candidate_, candidate);
        return {output(candidate_, 0, torque_nm), output(before, 0, torque_nm)};
    }

  private:
    [[nodiscard]] double output(int candidate, std::size_t sample, double torque_nm) const {
        return candidate == no_candidate ? torque_nm : bank_.output(candidate, sample);
    }

    FilterBank bank_;
    int candidate_ = no_candidate;
};

std::unique_ptr<Transition> make(Candidates candidates, std::size_t /*blend_samples*/) {
    return std::make_unique<Parallel>(candidates);
}

}  // namespace

const TransitionKind transitions::parallel{.name = "parallel", .make = make};

}  // namespace ripplenotch
