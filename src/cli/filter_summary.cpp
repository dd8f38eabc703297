// SPDX-License-Identifier: MIT
#include "cli/filter_summary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "ripplenotch/core/number.hpp"

namespace ripplenotch {
namespace {

std::string ripple_line(const OrderLevel& level) {
    const auto attenuation = attenuation_db(level);
    return fmt::format("order {:g} (mean {:.4g} Hz): {:.3g} Nm before, {:.3g} Nm after{}", level.order,
                       level.mean_hz, level.amplitude_nm[0], level.amplitude_nm[1],
                       attenuation ? fmt::format(", {:.1f} dB", *attenuation) : "");
}

std::string delay_line(const std::vector<FilterDelay>& delays) {
    const auto by_delay = [](const FilterDelay& a, const FilterDelay& b) { return a.dc_delay < b.dc_delay; };
    const auto [least, most] = std::minmax_element(delays.begin(), delays.end(), by_delay);
    const auto milliseconds = [](const FilterDelay& delay) { return rounded(1e3 * delay.dc_delay.value(), 1); };
    if (delays.size() == 1) return fmt::format("delay at 0 Hz: {} ms", milliseconds(*least));
    const auto where = [](const FilterDelay& delay) {
        return delay.band > 0 ? fmt::format("band {}", delay.band)
                              : fmt::format("at {:g} deg/s", delay.from.value());
    };
    return fmt::format("delay at 0 Hz: {} ms ({}) to {} ms ({})", milliseconds(*least), where(*least),
                       milliseconds(*most), where(*most));
}

}  // namespace

std::vector<std::string> filter_warnings(const FilterMetrics& metrics) {
    const StreamReport& stream = metrics.stream;
    std::vector<std::string> warnings;
    if (stream.gap_count > 0) {
        const Gap& first = stream.gaps.front();
        warnings.push_back(fmt::format(
            "{}: {} in time, the first from {:g} to {:g} s after data row {}; the filter started anew after "
            "{}",
            metrics.source, stream.gap_count == 1 ? "one gap" : fmt::format("{} gaps", stream.gap_count),
            first.from_s, first.to_s, first.row + 1, stream.gap_count == 1 ? "it" : "each"));
    }
    const double measured = stream.measured_rate.value(), used = metrics.sample_rate.value();
    // A table's notches are where its own rate puts them; what counts is the rate of the whole log.
    if (metrics.table_rate && measured > 0.0) {
        const auto warning =
            table_rate_warning(*metrics.table_rate, nominal_rate(stream.measured_rate), metrics.source);
        if (warning) warnings.push_back(*warning);
    } else if (measured > 0.0 && std::abs(measured / used - 1.0) > rate_worth_a_word) {
        warnings.push_back(
            fmt::format("{}: the first rows run at {:.6g} Hz, which the filter was started with, the whole "
                        "log at {:.6g} Hz; its clock "
                        "changes on the way, or state the true rate with --sample-rate",
                        metrics.source, used, measured));
    }
    if (metrics.levels && metrics.levels->windows == 0) {
        warnings.push_back(fmt::format(
            "{}: ripple could not be measured: no stretch of four motor turns within two seconds with three "
            "samples a "
            "period ({} too slow, {} with too few samples)",
            metrics.source, metrics.levels->windows_too_slow, metrics.levels->windows_too_few_samples));
    }
    return warnings;
}

std::vector<std::string> filter_summary(const FilterMetrics& metrics) {
    const StreamReport& stream = metrics.stream;
    std::vector<std::string> lines;
    lines.push_back(fmt::format("{}: {}, {} rows at {:.6g} Hz (measured {:.6g} Hz), {} gaps, {} held samples",
                                metrics.source, metrics.method, stream.rows, metrics.sample_rate.value(),
                                stream.measured_rate.value(), stream.gap_count, stream.held_samples));
    if (metrics.levels && metrics.levels->windows > 0) {
        const RippleLevels& levels = *metrics.levels;
        for (const OrderLevel& level : levels.orders) lines.push_back(ripple_line(level));
        lines.push_back(fmt::format(
            "ripple at most {:.3g} Nm peak to peak before, {:.3g} Nm after; residual {:.3g} Nm rms before, "
            "{:.3g} Nm "
            "after ({} windows, {:.0f} % of the log)",
            levels.ripple_peak_to_peak_nm[0], levels.ripple_peak_to_peak_nm[1], levels.residual_rms_nm[0],
            levels.residual_rms_nm[1], levels.windows, 100.0 * levels.measured_share));
    }
    if (!metrics.delays.empty()) lines.push_back(delay_line(metrics.delays));
    if (metrics.table_rate) lines.push_back(fmt::format("{} changes of filter", stream.switch_count));
    return lines;
}

}  // namespace ripplenotch
