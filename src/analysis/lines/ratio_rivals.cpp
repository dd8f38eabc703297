// SPDX-License-Identifier: MIT
#include "analysis/lines/ratio_rivals.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <string_view>

namespace ripplenotch {
namespace {

constexpr double least_scale_error = 0.0005;  // by hand
constexpr double near_hint = 0.01;            // by hand
// How much rarer each mistake is than a log that is what it says, in nats. A clock may be off by any factor,
// so that one always fits.
constexpr double unit_nats = -4.0, clock_nats = -12.0, scale_nats = -0.5;

struct Slip {
    double factor;  // the apparent ratio times this is the true one
    std::string_view what;
};
constexpr std::array slips{Slip{1.0 / degrees_per_radian, "the speed is in rad/s, not deg/s"},
                           Slip{degrees_per_radian, "the speed is in deg/s, not rad/s"},
                           Slip{1.0 / 6.0, "the speed is in rpm, not deg/s"},
                           Slip{6.0, "the speed is in deg/s, not rpm"},
                           Slip{1.0 / 60.0, "the speed is off by 60"},
                           Slip{60.0, "the speed is off by 60"},
                           Slip{1.0 / 360.0, "the speed is in turns/s, not deg/s"},
                           Slip{360.0, "the speed is in deg/s, not turns/s"}};

/// What the lines say for a comb, without what its ratio as such makes of it.
double nats_of_lines(const Comb& comb) {
    return comb.nats - (usual_ratio(comb.ratio) ? 0.0 : unusual_nats) - (comb.listed ? catalogue_nats : 0.0) -
           (comb.hinted ? hint_nats : 0.0);
}

}  // namespace

std::vector<RatioRival> unit_rivals(const Comb& best, std::optional<GearRatio> hint) {
    std::vector<RatioRival> rivals;
    for (const Slip& slip : slips) {
        const double ratio = best.ratio * slip.factor;
        const bool hinted = hint && std::abs(ratio - hint->value()) < near_hint * hint->value();
        const bool listed = listed_ratio(ratio).has_value();
        if (!hinted && !(!usual_ratio(best.ratio) && listed)) continue;
        const double nats = nats_of_lines(best) + unit_nats + (hinted ? hint_nats : 0.0) +
                            (listed ? catalogue_nats : 0.0) + (usual_ratio(ratio) ? 0.0 : unusual_nats);
        rivals.push_back(
            {ratio, nats, fmt::format("if {}", slip.what),
             fmt::format("a ratio of {:.4g} would be {:.4g} if {}", best.ratio, ratio, slip.what)});
    }
    return rivals;
}

std::vector<RatioRival> fold_rivals(std::span<const OrderLine> lines, std::optional<GearRatio> hint,
                                    std::span<const int> hinted_orders) {
    std::vector<RatioRival> rivals;
    if (lines.size() != 1) return rivals;
    for (const double order : lines[0].could_be) {
        OrderLine image = lines[0];
        image.order_output = order;
        image.observations.clear();
        for (const Comb& comb : all_combs(std::span(&image, 1), hint, hinted_orders)) {
            if (!usual_ratio(comb.ratio)) continue;
            rivals.push_back({comb.ratio, comb.nats,
                              fmt::format("if folded from order {:.4g}; {}", order, comb.reason), ""});
        }
    }
    return rivals;
}

std::optional<RatioRival> clock_rival(const Comb& best, GearRatio hint) {
    const double factor = best.ratio / hint.value();
    if (std::abs(factor - 1.0) < hint_share) return std::nullopt;
    const std::string what =
        fmt::format("the clock (the nominal sample rate) runs {:.3g} times too {}",
                    factor > 1.0 ? factor : 1.0 / factor, factor > 1.0 ? "fast" : "slow");
    const double nats =
        nats_of_lines(best) + clock_nats + hint_nats + (listed_ratio(hint.value()) ? catalogue_nats : 0.0);
    return RatioRival{hint.value(), nats, "if " + what,
                      fmt::format("the log has no position: if {}, the lines at {:.4g} are those of {:.6g}",
                                  what, best.ratio, hint.value())};
}

std::optional<RatioRival> scale_rival(const Comb& best, const GearRatioFit& fit, GearRatio hint) {
    if (!fit.value) return std::nullopt;
    const double share = *fit.value / hint.value() - 1.0;
    const double doubt = 0.5 * (fit.ci95_high - fit.ci95_low) / hint.value();
    if (std::abs(share) < least_scale_error || std::abs(share) < 1.5 * doubt || std::abs(share) > hint_share)
        return std::nullopt;
    const std::string what = fmt::format("the velocity's or position's scale reads {:.2f} % {}",
                                         100.0 * std::abs(share), share < 0.0 ? "high" : "low");
    // 100 and 101 are both sold.
    const bool another_gear = best.listed && *best.listed != listed_ratio(hint.value());
    const std::string cause =
        another_gear
            ? fmt::format("either the gear is one of {:.6g}, or {}, or a time column runs off by that much",
                          *best.listed, what)
            : fmt::format(
                  "the likely cause is that {}, or that a time column runs off by that much; a gear "
                  "ratio that odd is unlikely",
                  what);
    return RatioRival{
        hint.value(), best.nats + scale_nats, "if " + what,
        fmt::format("the ratio {:.6g} is {:+.2f} % from the hint {:.6g}, more than its error of "
                    "{:.2f} %: {}",
                    *fit.value, 100.0 * share, hint.value(), 100.0 * doubt, cause)};
}

}  // namespace ripplenotch
