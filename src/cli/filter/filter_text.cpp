// SPDX-License-Identifier: MIT
#include "cli/filter/filter_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/visible_text.hpp"
#include "ripplenotch/filter/engine.hpp"

namespace ripplenotch {

namespace {

std::string ripple_line(const FilterMetrics& metrics, std::size_t order) {
    const OrderLevel& level = metrics.lines()->orders[order];
    const std::string name = order_in_words(Order(level.order), metrics.gear->ratio);
    if (level.windows == 0) return name + ": not measured, nowhere four periods in one direction";
    const auto attenuation = attenuation_db(level), predicted = predicted_nm(metrics, order);
    return fmt::format("{} (mean {:.4g} Hz): {:.3g} Nm before, {:.3g} Nm after{}{}", name, level.mean_hz,
                       level.amplitude_nm[0], level.amplitude_nm[1],
                       attenuation ? fmt::format(", {:.1f} dB", *attenuation) : "",
                       predicted ? fmt::format("; predicted {:.3g} Nm", *predicted) : "");
}

std::string where(const LedgerEntry& entry) {
    return entry.band > 0 ? fmt::format("band {}", entry.band)
                          : fmt::format("at {:g} deg/s", entry.from.value());
}

std::string crossover_line(const std::vector<LedgerEntry>& entries, Hertz crossover) {
    const auto by_lag = [](const LedgerEntry& a, const LedgerEntry& b) {
        return a.phase_lag_deg.value_or(0.0) < b.phase_lag_deg.value_or(0.0);
    };
    const auto [least, most] = std::minmax_element(entries.begin(), entries.end(), by_lag);
    const std::string at = fmt::format("phase lag at {:g} Hz: ", crossover.value());
    const auto degrees = [](const LedgerEntry& entry) {
        return rounded(entry.phase_lag_deg.value_or(0.0), 1);
    };
    if (entries.size() == 1) return fmt::format("{}{} deg", at, degrees(*least));
    return fmt::format("{}{} deg ({}) to {} deg ({})", at, degrees(*least), where(*least), degrees(*most),
                       where(*most));
}

// A joint that crosses a band's edge back and forth on the noise of its speed switches for nothing; two
// changes a second is more than a motion through the bands makes.
constexpr double many_switches_a_second = 2.0;

std::string switches_line(const StreamReport& stream) {
    std::string text = how_many(stream.switch_count, "change of filter", "changes of filter");
    std::size_t back = 0;
    for (std::size_t i = 1; i < stream.switches.size(); ++i)
        back += stream.switches[i].change.to_band == stream.switches[i - 1].change.from_band ? 1 : 0;
    const double rate = stream.recording.clock.mean_rate.value();
    const double seconds = rate > 0.0 ? static_cast<double>(stream.recording.rows()) / rate : 0.0;
    if (2 * back > stream.switches.size() &&
        static_cast<double>(stream.switch_count) > many_switches_a_second * seconds) {
        text += fmt::format(
            ", {:.3g} a second, {:.0f} % of them straight back: the speed is noisy at a band's edge; try "
            "hysteresis=1deg/s",
            static_cast<double>(stream.switch_count) / seconds,
            100.0 * static_cast<double>(back) / static_cast<double>(stream.switches.size() - 1));
    }
    return text;
}

std::string delay_line(const std::vector<LedgerEntry>& delays) {
    const auto by_delay = [](const LedgerEntry& a, const LedgerEntry& b) { return a.dc_delay < b.dc_delay; };
    const auto [least, most] = std::minmax_element(delays.begin(), delays.end(), by_delay);
    const auto milliseconds = [](const LedgerEntry& delay) {
        return rounded(1e3 * delay.dc_delay.value(), 1);
    };
    if (delays.size() == 1) return fmt::format("delay at 0 Hz: {} ms", milliseconds(*least));
    return fmt::format("delay at 0 Hz: {} ms ({}) to {} ms ({})", milliseconds(*least), where(*least),
                       milliseconds(*most), where(*most));
}

}  // namespace

std::vector<std::string> filter_warnings(const FilterMetrics& metrics) {
    std::vector<std::string> warnings;
    for (const LogWarning& warning : metrics.stream.recording.warnings)
        warnings.push_back(fmt::format("{}: {}", metrics.source, warning.text));
    if (metrics.table_rate) {
        const auto warning =
            table_rate_warning({.table = *metrics.table_rate, .log = metrics.sample_rate}, metrics.source);
        if (warning) warnings.push_back(*warning);
    }
    for (const auto& sentences : {harm_done(metrics), short_of_prediction(metrics)})
        for (const std::string& sentence : sentences)
            warnings.push_back(fmt::format("{}: {}", metrics.source, sentence));
    if (metrics.measured && metrics.lines() == nullptr) {
        warnings.push_back(fmt::format(
            "{}: ripple could not be measured: no four periods of an order in one direction, slow enough for "
            "two samples a period ({} too few samples)",
            metrics.source,
            how_many(metrics.measured->lines.windows_too_few_samples, "window with", "windows with")));
    }
    return warnings;
}

std::vector<std::string> filter_summary(const FilterMetrics& metrics) {
    const StreamReport& stream = metrics.stream;
    std::vector<std::string> lines;
    const Recording& recording = stream.recording;
    lines.push_back(
        fmt::format("{}: {}, {} at {:.6g} Hz (measured {:.6g} Hz), {}, {}, angle from {}", metrics.source,
                    metrics.method, how_many(recording.rows(), "row"), metrics.sample_rate.value(),
                    recording.clock.mean_rate.value(), how_many(recording.clock.gap_count, "gap"),
                    how_many(recording.held.count, "held sample"), source_name(recording.angle.source())));
    if (recording.outside) {
        lines.push_back(fmt::format("{}: {} rows before and {} after are left out, by --from and --to",
                                    metrics.source, recording.outside->before, recording.outside->after));
    }
    if (metrics.lines() != nullptr) {
        const RippleLevels& levels = *metrics.lines();
        for (std::size_t i = 0; i < levels.orders.size(); ++i) lines.push_back(ripple_line(metrics, i));
        lines.push_back(fmt::format(
            "ripple at most {:.3g} Nm peak to peak before, {:.3g} Nm after; residual {:.3g} Nm rms before, "
            "{:.3g} Nm "
            "after ({}, {:.0f} % of the log)",
            levels.ripple_peak_to_peak_nm[0], levels.ripple_peak_to_peak_nm[1], levels.residual_rms_nm[0],
            levels.residual_rms_nm[1], how_many(levels.windows, "window"), 100.0 * levels.measured_share));
    }
    if (const MethodFigures* const figures = metrics.measured ? &metrics.measured->methods.front() : nullptr;
        figures != nullptr && figures->error_nm) {
        lines.push_back(fmt::format(
            "the torque itself is moved by {:.3g} Nm rms, {:.3g} Nm rms is added to it; the output's error "
            "is "
            "{:.3g} Nm rms, in the first {:g} s of motion up to {:.2g} times that of the raw torque",
            figures->moved_nm.value_or(0.0), figures->added_nm.value_or(0.0), *figures->error_nm,
            start_seconds, figures->start_ratio.value_or(0.0)));
    }
    if (!metrics.delays.empty()) lines.push_back(delay_line(metrics.delays));
    if (metrics.crossover && !metrics.delays.empty())
        lines.push_back(crossover_line(metrics.delays, *metrics.crossover));
    if (metrics.table_rate) lines.push_back(switches_line(stream));
    return lines;
}

}  // namespace ripplenotch
