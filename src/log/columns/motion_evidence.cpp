// SPDX-License-Identifier: MIT
#include "log/columns/motion_evidence.hpp"

#include <algorithm>
#include <cmath>

#include "log/account/unwrap.hpp"
#include "ripplenotch/core/median.hpp"

namespace ripplenotch::layout_detail {
namespace {

// The largest but a thousandth: one wild value decides no unit.
double nearly_largest(std::vector<double> values) {
    if (values.empty()) return 0.0;
    for (double& value : values) value = std::abs(value);
    const auto at = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) * 999 / 1000);
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

// Over stretches of rows: from one row to the next it would be the noise that is fastest.
std::vector<double> slopes(const std::vector<double>& time_s, const std::vector<double>& position) {
    const std::size_t stride = std::max<std::size_t>(1, time_s.size() / 200);
    std::vector<double> found;
    for (std::size_t i = stride; i < time_s.size(); i += stride) {
        const double passed = time_s[i] - time_s[i - stride];
        if (passed > 0.0) found.push_back((position[i] - position[i - stride]) / passed);
    }
    return found;
}

// Change of position and velocity times time, piece by piece: long enough to average noise, many enough for a
// median. A step of ten usual ones ends a piece: nobody knows the velocity within.
struct Moves {
    std::vector<double> position, velocity;
};
Moves moves_of(const std::vector<double>& t, const std::vector<double>& v, const std::vector<double>& q) {
    constexpr std::size_t most_pieces = 64, shortest_piece = 4;  // by hand
    std::vector<double> steps;
    for (std::size_t i = 1; i < t.size(); ++i) steps.push_back(t[i] - t[i - 1]);
    const double gap = 10.0 * std::max(median_of(steps), 0.0);
    const std::size_t rows = std::max(shortest_piece, t.size() / most_pieces);
    Moves moves;
    double position = 0.0, velocity = 0.0;
    std::size_t taken = 0;
    for (std::size_t i = 0; i < steps.size(); ++i) {
        const bool broken = gap > 0.0 && steps[i] > gap;
        if (!broken) {
            position += q[i + 1] - q[i];
            velocity += 0.5 * (v[i] + v[i + 1]) * steps[i];
            ++taken;
        }
        if (!broken && taken < rows) continue;
        if (taken >= shortest_piece) {
            moves.position.push_back(position);
            moves.velocity.push_back(velocity);
        }
        position = velocity = 0.0;
        taken = 0;
    }
    return moves;
}

// The median of the pieces' ratios, where most of them say the same: neither spikes nor jumps move it.
std::optional<double> scale_of(const Moves& moves) {
    constexpr std::size_t fewest = 6;          // by hand
    constexpr double alike = 0.1, most = 0.7;  // by hand: of the ratio, and of the pieces
    if (moves.velocity.size() < fewest) return std::nullopt;
    const double usual = nearly_largest(moves.velocity);
    std::vector<double> ratios;
    for (std::size_t i = 0; i < moves.velocity.size(); ++i) {
        if (std::abs(moves.velocity[i]) > 0.2 * usual)
            ratios.push_back(moves.position[i] / moves.velocity[i]);
    }
    if (!(usual > 0.0) || ratios.size() < fewest) return std::nullopt;
    const double middle = median_of(ratios);
    const auto same = std::count_if(ratios.begin(), ratios.end(), [middle](double ratio) {
        return std::abs(ratio - middle) < alike * std::abs(middle);
    });
    if (static_cast<double>(same) < most * static_cast<double>(ratios.size())) return std::nullopt;
    return std::abs(middle);
}

}  // namespace

MotionEvidence motion_evidence(const std::vector<double>& time_s, const std::vector<double>& velocity,
                               const std::vector<double>& position) {
    std::vector<double> t, v, q;
    for (std::size_t i = 0; i < std::max(velocity.size(), position.size()); ++i) {
        const bool good = (time_s.empty() || std::isfinite(time_s[i])) &&
                          (velocity.empty() || std::isfinite(velocity[i])) &&
                          (position.empty() || std::isfinite(position[i]));
        if (!good) continue;
        if (!time_s.empty()) t.push_back(time_s[i]);
        if (!velocity.empty()) v.push_back(velocity[i]);
        if (!position.empty()) q.push_back(position[i]);
    }
    MotionEvidence evidence;
    evidence.farthest = nearly_largest(q);
    evidence.wrap = wrap_period(q);
    if (evidence.wrap) Unwrapper(*evidence.wrap).apply(q);
    evidence.fastest = nearly_largest(velocity.empty() && !t.empty() ? slopes(t, q) : v);
    if (t.size() < 2 || v.empty() || q.empty()) return evidence;
    evidence.scale = scale_of(moves_of(t, v, q));
    return evidence;
}

}  // namespace ripplenotch::layout_detail
