// SPDX-License-Identifier: MIT
#include "ripplenotch/evaluate/filter_metrics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "ripplenotch/analysis/ripple_estimate.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {

std::optional<double> attenuation_db(const OrderLevel& level) {
    const double raw = level.amplitude_nm[0], filtered = level.amplitude_nm[1];
    if (!(raw > 0.0) || !(filtered > 0.0)) return std::nullopt;
    return 20.0 * portable::log10(raw / filtered);
}

double ripple_rms_nm(const RippleLevels& levels, std::size_t signal) {
    double power = 0.0;
    for (const OrderLevel& level : levels.orders) {
        const double a = level.amplitude_nm[signal];
        if (level.windows > 0) power += 0.5 * a * a;
    }
    return std::sqrt(power);
}

std::optional<double> predicted_nm(const FilterMetrics& metrics, std::size_t order) {
    if (metrics.lines() == nullptr) return std::nullopt;
    const OrderLevel& level = metrics.lines()->orders[order];
    if (!level.expected_gain) return std::nullopt;
    const std::vector<double>& known_nm = metrics.gear->amplitude_nm;
    const double before = known_nm.empty() ? level.amplitude_nm[0] : known_nm[order];
    return before * *level.expected_gain;
}

LogLevels measure_kept(const Contender& contender, const KeptRows& kept, const GearAccount& lines) {
    const TraceView log = kept.trace.view();
    LogLevels found = measure_on_log({&contender, 1}, {.trace = log, .out_nm = kept.out_nm}, &lines,
                                     estimate_ripple({&log, 1}, lines.ratio, lines.orders), std::nullopt);
    if (kept.rows > 0)
        found.lines.measured_share *= static_cast<double>(log.size()) / static_cast<double>(kept.rows);
    return found;
}

namespace {

constexpr double growth_db = 1.0;  // chosen, not derived: less is within what noise does to two estimates
// Chosen, not derived: three times the prediction, and at least a tenth of what there was, since the noise of
// the log is in what is measured and not in what is predicted.
constexpr double far_from_predicted = 3.0, share_that_counts = 0.1;

const TimedSwitch* largest_jump(const StreamReport& stream) {
    const auto by_jump = [](const TimedSwitch& a, const TimedSwitch& b) {
        return std::abs(a.change.jump_nm) < std::abs(b.change.jump_nm);
    };
    const auto largest = std::max_element(stream.switches.begin(), stream.switches.end(), by_jump);
    return largest == stream.switches.end() ? nullptr : &*largest;
}

std::string band_text(int band) { return band == 0 ? "no filter" : fmt::format("band {}", band); }

}  // namespace

std::vector<std::string> harm_done(const FilterMetrics& metrics) {
    std::vector<std::string> found;
    if (metrics.lines() == nullptr) return found;
    const RippleLevels& levels = *metrics.lines();
    const MethodFigures& figures = metrics.measured->methods.front();
    for (const OrderLevel& level : levels.orders) {
        const auto db = level.windows > 0 ? attenuation_db(level) : std::nullopt;
        if (!db || *db > -growth_db) continue;
        found.push_back(
            fmt::format("{} grew from {:.3g} to {:.3g} Nm; see other methods with "
                        "'ripplenotch recommend'",
                        order_in_words(Order(level.order), metrics.gear->ratio), level.amplitude_nm[0],
                        level.amplitude_nm[1]));
    }
    const double before = ripple_rms_nm(levels, 0), after = ripple_rms_nm(levels, 1);
    const double taken = std::sqrt(std::max(before * before - after * after, 0.0));
    if (const double moved = figures.moved_nm.value_or(0.0);
        moved > taken && moved > share_that_counts * before) {
        found.push_back(fmt::format(
            "its delay moves the torque itself by {:.3g} Nm rms, more than the {:.3g} Nm rms of ripple that "
            "it removes; narrower notches (--q) delay less, and 'ripplenotch recommend' tries other methods",
            moved, taken));
    } else if (figures.start_ratio.value_or(0.0) > start_worth_a_word) {
        found.push_back(fmt::format(
            "in the first {:g} s of motion the error of the output is up to {:.2g} times that of the torque "
            "before the filter; see other methods with 'ripplenotch recommend --max-start-error {:g}'",
            start_seconds, *figures.start_ratio, start_worth_a_word));
    }
    const TimedSwitch* const jump = largest_jump(metrics.stream);
    const double ripple = levels.ripple_peak_to_peak_nm[0];
    if (jump != nullptr && std::abs(jump->change.jump_nm) > ripple) {
        const Switch& change = jump->change;
        const bool outside = change.from_band == 0 || change.to_band == 0;
        found.push_back(fmt::format(
            "the switch from {} to {} at {:.6g} s moves the output by {:.3g} Nm, more than the ripple "
            "({:.3g} Nm "
            "peak to peak); try {}",
            band_text(change.from_band), band_text(change.to_band), jump->time_s, std::abs(change.jump_nm),
            ripple, outside ? "below=fade" : "transition=keep-state-variable or hysteresis=1deg/s"));
    }
    return found;
}

std::vector<std::string> short_of_prediction(const FilterMetrics& metrics) {
    std::vector<std::string> found;
    if (metrics.lines() == nullptr) return found;
    for (std::size_t i = 0; i < metrics.lines()->orders.size(); ++i) {
        const OrderLevel& level = metrics.lines()->orders[i];
        const auto predicted = level.windows > 0 ? predicted_nm(metrics, i) : std::nullopt;
        if (!predicted) continue;
        const double before = level.amplitude_nm[0], after = level.amplitude_nm[1];
        if (!(after > far_from_predicted * *predicted && after > share_that_counts * before)) continue;
        found.push_back(
            fmt::format("{}: remaining ripple {:.3g} Nm, predicted {:.3g} Nm; the gear ratio may be "
                        "wrong, or the speed changes faster than the filter settles",
                        order_in_words(Order(level.order), metrics.gear->ratio), after, *predicted));
    }
    return found;
}

}  // namespace ripplenotch
