// SPDX-License-Identifier: MIT
#include "cli/identify/amplitude_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/matrices/least_squares.hpp"
#include "ripplenotch/core/gear_account.hpp"

namespace ripplenotch {

namespace {

std::string amplitude_cell(const RippleAtSpeed& at) {
    const RippleEstimate& ripple = at.ripple;
    return ripple.present() ? fmt::format("{:.3g} +/- {:.1g}", ripple.amplitude_nm,
                                          normal_95_errors * ripple.standard_error_nm)
                            : fmt::format("none above {:.2g}", ripple.detectable_nm);
}

std::string speed_cell(const RippleAtSpeed& at) {
    const std::string from = fmt::format("{:.3g}", at.speed_from_deg_s),
                      to = fmt::format("{:.3g}", at.speed_to_deg_s);
    return from == to ? from : from + "-" + to;
}

}  // namespace

std::string amplitude_table(const AmplitudeBySpeed& found) {
    const auto goes = [&](int direction) {
        return std::any_of(found.ripple.begin(), found.ripple.end(),
                           [&](const RippleAtSpeed& at) { return at.direction == direction; });
    };
    std::vector<int> directions;
    for (const int direction : {1, -1})
        if (goes(direction)) directions.push_back(direction);
    const auto row = [&](const std::string& order, const std::string& speed, const auto& cell) {
        std::string text = fmt::format("{:>5} {:>12}", order, speed);
        for (const int direction : directions) text += fmt::format(" {:>18}", cell(direction));
        return text.substr(0, text.find_last_not_of(' ') + 1) + "\n";
    };
    if (found.changes.empty()) return "";
    std::string text = "\namplitude by speed and direction, zero to peak, +/- 95 %\n";
    if (!found.ripple.empty()) {
        text += row("order", "speed", [](int direction) { return direction < 0 ? "backward" : "forward"; });
        text += row("", "deg/s", [](int) { return "Nm"; });
    }
    const auto& all = found.ripple;
    for (std::size_t i = 0; i < all.size();) {
        std::size_t end = i + 1;
        while (end < all.size() && all[end].ripple.order == all[i].ripple.order &&
               all[end].speed_from_deg_s == all[i].speed_from_deg_s)
            ++end;
        text += row(fmt::format("{:.4g}", all[i].ripple.order), speed_cell(all[i]), [&](int direction) {
            for (std::size_t k = i; k < end; ++k)
                if (all[k].direction == direction) return amplitude_cell(all[k]);
            return std::string("-");
        });
        i = end;
    }
    for (const AmplitudeChange& change : found.changes) text += change.sentence + "\n";
    return text;
}

}  // namespace ripplenotch
