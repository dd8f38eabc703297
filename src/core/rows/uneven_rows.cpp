// SPDX-License-Identifier: MIT
#include "core/rows/uneven_rows.hpp"

#include "ripplenotch/core/number.hpp"

namespace ripplenotch {

double usual_step_s(std::span<const double> time_s) {
    std::vector<double> steps;
    for (std::size_t k = 1; k < time_s.size(); ++k) steps.push_back(time_s[k] - time_s[k - 1]);
    return median_in(steps);
}

std::vector<double> interpolate(std::span<const double> known, std::span<const double> values,
                                std::span<const double> places) {
    std::vector<double> found(places.size());
    std::size_t next = 0;
    for (std::size_t k = 0; k < places.size(); ++k) {
        while (next < known.size() && known[next] <= places[k]) ++next;
        if (next == 0) {
            found[k] = values.front();
        } else if (next == known.size()) {
            found[k] = values.back();
        } else {
            const double share = (places[k] - known[next - 1]) / (known[next] - known[next - 1]);
            found[k] = values[next - 1] + share * (values[next] - values[next - 1]);
        }
    }
    return found;
}

}  // namespace ripplenotch
