// SPDX-License-Identifier: MIT
#include <algorithm>

#include "analysis/motion/motion_search.hpp"
#include "analysis/motion/velocity_error.hpp"
#include "ripplenotch/analysis/motion_lines.hpp"

namespace ripplenotch {
namespace {

// By hand: of a cycle of the highest order. A line moved by less loses less than a hundredth of its height.
constexpr double unseen_cycles = 0.02;

/// The orders among the lines, the one that explains most first.
std::vector<MotionLine*> orders_among(std::vector<MotionLine>& lines) {
    std::vector<MotionLine*> orders;
    for (MotionLine& line : lines) {
        if (line.kind == LineKind::order) orders.push_back(&line);
    }
    std::stable_sort(orders.begin(), orders.end(),
                     [](const MotionLine* a, const MotionLine* b) { return a->gain_angle > b->gain_angle; });
    return orders;
}

}  // namespace

MotionLines find_motion_lines(std::span<const TraceView> logs, const MotionLinesOptions& options) {
    MotionSearch search = search_sweeps(cut_sweeps(logs, options.sweeps), logs, options);
    MotionLines& found = search.found;
    if (found.absolute_angle) return std::move(found);
    const std::vector<MotionLine*> lines = orders_among(found.lines);
    std::vector<double> orders;
    for (const MotionLine* line : lines) orders.push_back(line->order_output);
    const auto fit = fit_velocity_error(logs, search.sweeps, search.angle, orders);
    if (!fit) return std::move(found);
    MotionLines again;
    if (fit->most_cycles > unseen_cycles)
        again = search_sweeps(cut_sweeps(logs, options.sweeps, fit->error), logs, options).found;
    if (orders_among(again.lines).empty()) {
        for (std::size_t i = 0; i < fit->order_shares.size(); ++i)
            lines[i]->order_output *= 1.0 + fit->order_shares[i];
        again = std::move(found);
    }
    again.velocity_error = fit->error;
    again.order_share_error = fit->order_share_error;
    return again;
}

}  // namespace ripplenotch
