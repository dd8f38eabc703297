// SPDX-License-Identifier: MIT
#include "export/parameters.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "export/targets.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {

double q_from_cutoff(double center_hz, double cutoff_hz) {
    return center_hz * cutoff_hz / (center_hz * center_hz - cutoff_hz * cutoff_hz);
}

double cutoff_from_q(double center_hz, double q) {
    // The positive root of Q fc^2 + f fc - Q f^2 = 0, in the form that keeps its digits for small Q.
    return center_hz * 2.0 * q / (1.0 + std::sqrt(1.0 + 4.0 * q * q));
}

double q_from_bandwidth(double center_hz, double bandwidth_hz) {
    const double octaves = 2.0 * portable::log2(center_hz / (center_hz - bandwidth_hz / 2.0));
    return std::sqrt(portable::exp2(octaves)) / (portable::exp2(octaves) - 1.0);
}

double bandwidth_from_q(double center_hz, double q) {
    return 2.0 * (center_hz - cutoff_from_q(center_hz, q));
}

SharedShape shared_shape(const FilterSet& filters, std::string_view target) {
    std::optional<NotchSpec> first;
    for (const ExportBand& band : filters.bands) {
        for (const ExportSection& section : band.sections) {
            if (!section.notch) {
                const auto both = targets_that(&Target::notches_only, false);
                const auto last = both.end() - 1;
                raise<UsageError>("target {} holds notches only, not a low-pass; {} and {} hold both", target,
                                  fmt::join(both.begin(), last, ", "), *last);
            }
            const NotchSpec& notch = *section.notch;
            if (notch.width == WidthRule::digital) {
                raise<UsageError>(
                    "target {} makes the analogue prototype's Q, and these notches have the "
                    "digital width rule; design them with width analog",
                    target);
            }
            if (!first) first = notch;
            if (notch.q != first->q || notch.depth_db != first->depth_db) {
                raise<UsageError>(
                    "target {} has one width and one depth for all notches, and these differ: "
                    "Q {} and {}; export json or c-header instead",
                    target, shortest(first->q), shortest(notch.q));
            }
        }
    }
    return {first->q,
            first->depth_db >= infinite_depth_db ? 0.0 : portable::pow(10.0, -first->depth_db / 20.0)};
}

std::vector<int> whole_orders(const FilterSet& filters, int highest, std::string_view target) {
    std::vector<int> orders;
    for (const ExportSection& section : filters.bands.front().sections) {
        const double order = section.order->value();
        if (order != std::floor(order) || order < 1.0 || order > highest) {
            raise<UsageError>(
                "target {} has harmonics 1 to {} of the motor's turning, and this table has order {}", target,
                highest, shortest(order));
        }
        orders.push_back(static_cast<int>(order));
    }
    return orders;
}

void check_range(const Settings& settings, std::string_view parameter, double value, double lowest,
                 double highest, std::string_view remedy) {
    if (settings.text("limits") == "none" || (value >= lowest && value <= highest)) return;
    raise<UsageError>(
        "{} would be {:.4g}, and the firmware takes {} to {}; {}, or say limits=none for other "
        "firmware in this style",
        parameter, value, shortest(lowest), shortest(highest), remedy);
}

}  // namespace ripplenotch
