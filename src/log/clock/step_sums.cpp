// SPDX-License-Identifier: MIT
#include "log/clock/step_sums.hpp"

#include <algorithm>

#include "core/vectors/lanes.hpp"

namespace ripplenotch {

namespace {

struct SumUp {
    template <class Lanes>
    RIPPLENOTCH_INLINED static StepSums run(std::span<const double> time_s, double usual_s) {
        const std::size_t steps = time_s.size() - 1, even = steps - steps % lane_count;
        const double first = time_s[1] - time_s[0];
        Lanes before, now, usual, shortest, longest, squares;
        fill(usual, usual_s);
        fill(shortest, first);
        fill(longest, first);
        fill(squares, 0.0);
        for (std::size_t k = 0; k < even; k += lane_count) {
            load(before, time_s.data() + k);
            load(now, time_s.data() + k + 1);
            const Lanes step = now - before, off = step - usual;
            squares += off * off;
            lower(shortest, step);
            raise(longest, step);
        }
        StepSums sums{first, first, sum(squares)};
        double least[lane_count], most[lane_count];
        store(least, shortest);
        store(most, longest);
        for (std::size_t i = 0; i < lane_count; ++i) {
            sums.shortest_s = std::min(sums.shortest_s, least[i]);
            sums.longest_s = std::max(sums.longest_s, most[i]);
        }
        for (std::size_t k = even; k < steps; ++k) {
            const double step = time_s[k + 1] - time_s[k];
            sums.squares += (step - usual_s) * (step - usual_s);
            sums.shortest_s = std::min(sums.shortest_s, step);
            sums.longest_s = std::max(sums.longest_s, step);
        }
        return sums;
    }
};

}  // namespace

StepSums sum_up_steps(std::span<const double> time_s, double usual_s) noexcept {
    return in_lanes<SumUp>(time_s, usual_s);
}

}  // namespace ripplenotch
