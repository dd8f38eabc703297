// SPDX-License-Identifier: MIT
#include "cli/design/design_request.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "cli/design/speed_bands.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {
namespace {

OutsideRule rule_of(const std::string& name) {
    if (name == "hold") return OutsideRule::hold;
    return name == "fade" ? OutsideRule::fade : OutsideRule::pass;
}

// --spacing is that of the lowest order's centres, which is how the paper states its table: 5 Hz is 18 deg/s
// at 1:100.
DegPerSec width_of_spacing(Hertz spacing, const TableSpec& spec) {
    if (!(spacing.value() > 0.0))
        raise<UsageError>("--spacing {} Hz is not above 0", shortest(spacing.value()));
    return DegPerSec(360.0 * spacing.value() / (spec.orders.front().value() * spec.gear_ratio.value()));
}

// Nobody wants bands of 17.9993 deg/s because the gear ratio is known to five digits.
DegPerSec two_digits(DegPerSec width) {
    return DegPerSec(*parse_number(fmt::format("{:.1e}", width.value())));
}

// Bands about 5 Hz apart in the lowest order, as the paper's, over the speeds at which the lines were seen.
std::vector<std::pair<DegPerSec, DegPerSec>> bands_seen(const DesignRequest& request, const TableSpec& spec,
                                                        const JointFacts& joint) {
    if (!(joint.fastest.value() > 0.0)) {
        raise<UsageError>("{} has no line that follows the speed; give --speed FROM:TO:WIDTH", joint.source);
    }
    const double width = request.spacing ? width_of_spacing(*request.spacing, spec).value()
                                         : two_digits(width_of_spacing(Hertz(5.0), spec)).value();
    double from = std::floor(joint.slowest.value());
    double to = joint.fastest.value();
    // A joint seen at one speed only gets one band around it.
    if (to - from < width) from = std::max(0.0, 0.5 * (from + to) - 0.5 * width);
    const double limit_deg_s =
        180.0 * spec.sample_rate.value() / (spec.orders.back().value() * spec.gear_ratio.value());
    const double wanted = std::max(1.0, std::ceil((to - from) / width - 1e-9));
    double count = wanted;
    while (count > 0.0 && from + (count - 0.5) * width >= limit_deg_s) count -= 1.0;
    if (count < 1.0) {
        raise<UsageError>(
            "{}: order {} is not below half the sample rate, {} Hz, at {:.6g} deg/s, the slowest speed "
            "seen; choose lower --orders or --speed",
            joint.source, shortest(spec.orders.back().value()), shortest(0.5 * spec.sample_rate.value()),
            from + 0.5 * width);
    }
    if (count < wanted) {
        say_warnings(
            request.common,
            std::vector{fmt::format(
                "{}: lines were seen up to {:.6g} deg/s, but from {:.6g} deg/s on order {} "
                "is not below half the sample rate; the bands end at {:.6g} deg/s",
                joint.source, to, limit_deg_s, shortest(spec.orders.back().value()), from + count * width)});
    }
    to = from + count * width;
    return bands_by_spacing({DegPerSec(from), DegPerSec(to)}, DegPerSec(width));
}

std::vector<std::pair<DegPerSec, DegPerSec>> bands_of(const DesignRequest& request, const TableSpec& spec,
                                                      const std::optional<JointFacts>& joint) {
    if (request.bands) {
        if (request.speed || request.spacing) {
            raise<UsageError>("--bands lists the bands; it cannot be combined with --speed or --spacing");
        }
        return parse_speed_bands(*request.bands, "--bands");
    }
    if (!request.speed) {
        if (joint) return bands_seen(request, spec, *joint);
        raise<UsageError>(
            "no speeds to design for; give --speed FROM:TO:WIDTH (18:180:18) or --bands FROM:TO,FROM:TO");
    }
    const SpeedRange range = parse_speed_range(*request.speed, "--speed");
    if (range.width && request.spacing) {
        raise<UsageError>(
            "--speed {} already says how wide a band is; leave out its third number or --spacing",
            *request.speed);
    }
    if (!range.width && !request.spacing) {
        raise<UsageError>(
            "--speed {} does not say how wide a band is; write FROM:TO:WIDTH, add --spacing 5Hz, or say what "
            "the "
            "table has to hold with --min-attenuation or --max-delay",
            *request.speed);
    }
    return bands_by_spacing({range.from, range.to},
                            range.width ? *range.width : width_of_spacing(*request.spacing, spec));
}

void fill_gear_of_table(TableSpec& spec, const DesignRequest& request, const GearChoice& choice,
                        const std::optional<JointFacts>& joint) {
    const auto gear = choice.of();
    if (!gear) raise_no_gear("a table");
    say(request.common, gear_in_words(*gear));
    spec.gear_ratio = gear->ratio;
    spec.orders = gear->orders;
    spec.amplitude_nm = gear->amplitude_nm;
    if (!request.amplitudes_nm.empty()) {
        if (!std::is_sorted(request.gear.orders.begin(), request.gear.orders.end()))
            raise<UsageError>(
                "--amplitudes: one per order, lowest order first; write --orders in that sequence");
        spec.amplitude_nm = request.amplitudes_nm;
    }
    if (!request.sample_rate && !joint)
        raise<UsageError>("the sample rate is missing; give --sample-rate, for example 1kHz");
    spec.sample_rate = request.sample_rate ? *request.sample_rate : joint->sample_rate;
    if (request.ratio_error_percent) {
        if (!(*request.ratio_error_percent >= 0.0))
            raise<UsageError>("--ratio-error {} % is negative", shortest(*request.ratio_error_percent));
        spec.ratio_error = *request.ratio_error_percent / 100.0;
    } else if (joint) {
        spec.ratio_error = joint->ratio_error;  // none of a ratio that was given
    }
}

// FROM:TO alone, or nothing: then the goal decides how many bands there are.
bool leaves_bands(const DesignRequest& request) {
    if (!request.has_goal() || request.bands || request.spacing) return false;
    return !request.speed || !parse_speed_range(*request.speed, "--speed").width;
}

}  // namespace

TableSpec design_spec(const DesignRequest& request, const GearChoice& gear) {
    const auto joint = gear.facts();
    TableSpec spec;
    fill_gear_of_table(spec, request, gear, joint);
    spec.q = request.q.value_or(spec.q);
    if (request.depth_db) spec.depth_db = *request.depth_db;
    spec.width = request.width == "digital" ? WidthRule::digital : WidthRule::analog;
    spec.settle_band_percent = request.settle_band_percent;
    spec.below = rule_of(request.below);
    spec.above = rule_of(request.above);
    if (!leaves_bands(request)) spec.bands = bands_of(request, spec, joint);
    return spec;
}

namespace {

// All speeds at which lines were seen, as far as the highest order stays below half the sample rate.
std::pair<DegPerSec, DegPerSec> speeds_seen(const TableSpec& spec, const JointFacts& joint) {
    if (!(joint.fastest.value() > 0.0))
        raise<UsageError>("{} has no line that follows the speed; give --speed FROM:TO", joint.source);
    const double limit_deg_s =
        180.0 * spec.sample_rate.value() /
        (spec.orders.back().value() * spec.gear_ratio.value() * (1.0 + spec.ratio_error));
    double from = std::floor(joint.slowest.value()), to = std::ceil(joint.fastest.value());
    // A joint seen at one speed only gets a tenth to either side.
    if (to - from < 2.0) {
        from = *parse_number(fmt::format("{:.3g}", 0.9 * joint.slowest.value()));
        to = *parse_number(fmt::format("{:.3g}", 1.1 * joint.fastest.value()));
    }
    return {DegPerSec(std::max(from, 1.0)), DegPerSec(std::min(to, std::floor(0.99 * limit_deg_s)))};
}

}  // namespace

DesignGoal design_goal(const DesignRequest& request, const TableSpec& spec, const GearChoice& gear) {
    const auto joint = gear.facts();
    DesignGoal goal;
    goal.min_attenuation_db = request.min_attenuation_db;
    goal.max_delay = request.max_delay;
    goal.q = request.q;
    if (request.max_bands) {
        if (!(*request.max_bands >= 1.0 && *request.max_bands <= 1000.0) ||
            *request.max_bands != std::floor(*request.max_bands)) {
            raise<UsageError>("--max-bands {} is not a whole number from 1 to 1000",
                              shortest(*request.max_bands));
        }
        if (!spec.bands.empty())
            raise<UsageError>("--max-bands is for bands that the tool chooses; these are listed");
        goal.most_bands = static_cast<int>(*request.max_bands);
    }
    if (!spec.bands.empty()) return goal;
    if (request.speed) {
        const SpeedRange range = parse_speed_range(*request.speed, "--speed");
        goal.from = range.from;
        goal.to = range.to;
    } else if (joint) {
        std::tie(goal.from, goal.to) = speeds_seen(spec, *joint);
    } else {
        raise<UsageError>(
            "no speeds to design for; give --speed FROM:TO (18:180) or --bands FROM:TO,FROM:TO");
    }
    return goal;
}

}  // namespace ripplenotch
