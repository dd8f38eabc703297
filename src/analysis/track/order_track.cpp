// SPDX-License-Identifier: MIT
#include "analysis/track/order_track.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <map>
#include <numbers>
#include <utility>

#include "core/functions/many_numbers.hpp"
#include "core/vectors/dot.hpp"
#include "ripplenotch/analysis/order_track.hpp"
#include "ripplenotch/analysis/track_report.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {

namespace {

struct WrittenKind {
    double factor;
    std::string_view name, words;
};

const WrittenKind& written(AmplitudeKind kind) {
    static constexpr std::array kinds = {WrittenKind{1.0, "amplitude_nm", "zero to peak"},
                                         WrittenKind{1.0 / std::numbers::sqrt2, "rms_nm", "rms"},
                                         WrittenKind{2.0, "peak_to_peak_nm", "peak to peak"}};
    return kinds[static_cast<std::size_t>(kind)];
}

// Six significant digits, and no negative zero: more would be rounding noise of the fit.
std::vector<double> rounded_to_factor(std::vector<double> values, double factor) {
    for (double& value : values) {
        if (std::isfinite(value)) value = *parse_number(fmt::format("{:.6g}", factor * value)) + 0.0;
    }
    return values;
}

std::vector<double> as_numbers(const std::vector<std::size_t>& counts) {
    return {counts.begin(), counts.end()};
}

const std::vector<double>& amplitudes(const TrackReport& report, std::size_t line) {
    return report.by_speed ? report.by_speed->lines[line].amplitude_nm
                           : report.tracks.lines[line].amplitude_nm;
}

// Where an envelope has as much log before as after it. Within one response time of an end it depends on one
// side alone, and is not reliable.
struct Settled {
    bool any = false;  ///< false: all rows count
    double from_s = 0.0, to_s = 0.0;
    [[nodiscard]] bool holds(double time_s) const { return time_s >= from_s && time_s <= to_s; }
};

Settled settled_of(const TrackReport& report, const std::vector<double>& amplitude) {
    const std::vector<double>& time_s = report.tracks.time_s;
    const auto bandwidth = report.bandwidth_obtained ? report.bandwidth_obtained : report.bandwidth;
    if (report.by_speed || !bandwidth || !(bandwidth->value() > 0.0) || time_s.empty()) return {};
    const double response_s = 1.0 / bandwidth->value();
    Settled settled{false, time_s.front() + response_s, time_s.back() - response_s};
    for (std::size_t row = 0; row < time_s.size() && !settled.any; ++row)
        settled.any = std::isfinite(amplitude[row]) && settled.holds(time_s[row]);
    return settled;
}

const std::vector<double>& speeds_of(const TrackReport& report) {
    return report.by_speed ? report.by_speed->speed_deg_s : report.tracks.speed_deg_s;
}

}  // namespace

double amplitude_factor(AmplitudeKind kind) { return written(kind).factor; }

std::string_view amplitude_name(AmplitudeKind kind) { return written(kind).name; }

std::string_view amplitude_words(AmplitudeKind kind) { return written(kind).words; }

std::string TrackLabel::column() const {
    if (kind == Kind::tone) return fmt::format("tone_{}hz", shortest(value));
    return (kind == Kind::order ? "order_" : "order_output_") + shortest(value);
}

std::string TrackLabel::words() const {
    if (kind == Kind::tone) return fmt::format("{} Hz", shortest(value));
    return (kind == Kind::order ? "order " : "output order ") + shortest(value);
}

std::vector<TrackColumn> track_columns(const TrackReport& report) {
    const double factor = amplitude_factor(report.kind);
    std::vector<TrackColumn> columns;
    if (report.by_speed) {
        columns.push_back({"speed_deg_s", rounded_to_factor(report.by_speed->speed_deg_s, 1.0)});
        columns.push_back({"rows", as_numbers(report.by_speed->rows)});
    } else {
        columns.push_back({"time_s", report.tracks.time_s});
        // Time may be large: microseconds, not digits.
        for (double& time : columns.back().values) time = std::round(time * 1e6) / 1e6 + 0.0;
        columns.push_back({"speed_deg_s", rounded_to_factor(report.tracks.speed_deg_s, 1.0)});
    }
    for (std::size_t i = 0; i < report.labels.size(); ++i) {
        const std::string prefix = report.labels[i].column() + "_";
        const auto add = [&](std::string_view name, const std::vector<double>& values, double scale) {
            columns.push_back({prefix + std::string(name), rounded_to_factor(values, scale)});
        };
        add(amplitude_name(report.kind), amplitudes(report, i), factor);
        if (report.by_speed) {
            add("phase_deg", report.by_speed->lines[i].phase_deg, 1.0);
            add("spread_nm", report.by_speed->lines[i].spread_nm, factor);
        } else {
            add("phase_deg", report.tracks.lines[i].phase_deg, 1.0);
            add("standard_error_nm", report.tracks.lines[i].standard_error_nm, factor);
        }
    }
    return columns;
}

TrackSummary track_summary(const TrackReport& report, std::size_t line) {
    const std::vector<double>& amplitude = amplitudes(report, line);
    const Settled settled = settled_of(report, amplitude);
    std::vector<std::pair<double, std::size_t>> sorted;
    std::size_t rows = 0;
    for (std::size_t row = 0; row < amplitude.size(); ++row) {
        if (!std::isfinite(amplitude[row])) continue;
        ++rows;
        if (!settled.any || settled.holds(report.tracks.time_s[row]))
            sorted.emplace_back(amplitude[row], row);
    }
    if (sorted.empty()) return {};
    std::sort(sorted.begin(), sorted.end());
    const std::size_t n = sorted.size();
    const double median = 0.5 * (sorted[(n - 1) / 2].first + sorted[n / 2].first);
    const double factor = amplitude_factor(report.kind);
    return {rows,
            factor * median,
            factor * sorted.front().first,
            factor * sorted.back().first,
            speeds_of(report)[sorted.front().second],
            speeds_of(report)[sorted.back().second]};
}

std::string track_verdict(const TrackReport& report) {
    std::string text;
    for (std::size_t i = 0; i < report.labels.size(); ++i) {
        const TrackSummary line = track_summary(report, i);
        if (!text.empty()) text += "; ";
        text += report.labels[i].words();
        if (line.rows == 0) {
            text += ": measured nowhere";
            continue;
        }
        const auto& ripple = report.ripple[i];
        const double factor = amplitude_factor(report.kind);
        if (ripple && ripple->searched() && !ripple->present())
            text += fmt::format(": not above the noise, where {:.2g} Nm {} would be seen",
                                factor * ripple->detectable_nm, amplitude_words(report.kind));
        else if (ripple && ripple->searched())
            text += fmt::format(": {:.3g} +/- {:.1g} Nm {}", factor * ripple->amplitude_nm,
                                factor * ripple->standard_error_nm, amplitude_words(report.kind));
        else
            text += fmt::format(": {:.3g} Nm {}", line.median_nm, amplitude_words(report.kind));
        text += line.rows == 1
                    ? fmt::format(" at {:.4g} deg/s", line.least_at_deg_s)
                    : fmt::format(", from {:.3g} at {:.4g} to {:.3g} at {:.4g} deg/s", line.least_nm,
                                  line.least_at_deg_s, line.greatest_nm, line.greatest_at_deg_s);
    }
    return text + fmt::format("; {:.2g} Nm rms are neither line nor trend.", report.tracks.residual_rms_nm);
}

namespace {

// Chosen, not derived: terms per turn of the joint, whose torque follows its angle.
constexpr double trend_terms_per_turn = 12.0;
constexpr double periods_per_trend_term = 2.0;  // periods of the slowest line: no term comes near it
constexpr double fewest_cosines = 3.0, fewest_polynomials = 2.0;  // the polynomials make a cubic

double cycles_of(const TrackedLine& line) {
    return line.order * std::abs(line.turns.back() - line.turns.front());
}

std::size_t curved_terms(double output_turns, std::span<const TrackedLine> lines, double fewest) {
    double most = trend_terms_per_turn * output_turns;
    for (const TrackedLine& line : lines) most = std::min(most, cycles_of(line) / periods_per_trend_term);
    return static_cast<std::size_t>(std::max(fewest, std::round(most)));
}

}  // namespace

std::vector<SampleRun> cut_windows(const SampleRun& run, std::span<const double> place, double length,
                                   double shortest, double hop) {
    const double start = place[run.first];
    const double whole = std::abs(place[run.end - 1] - start);
    if (whole < shortest) return {};
    if (whole <= length) return {run};
    // No more windows than samples, however far apart those are.
    const double hops =
        std::min(std::ceil((whole - length) / (hop * length)), static_cast<double>(run.size()));
    std::vector<SampleRun> windows;
    std::size_t from = run.first, to = run.first;
    for (double i = 0.0; i <= hops; i += 1.0) {
        const double begin = (whole - length) * i / hops;
        while (from < run.end && std::abs(place[from] - start) < begin) ++from;
        to = std::max(to, from);
        while (to < run.end && std::abs(place[to] - start) <= begin + length) ++to;
        windows.push_back({from, to});
    }
    return windows;
}

WindowFit::WindowFit(std::span<const double> place, std::span<const double> root_weight, double output_turns,
                     std::vector<TrackedLine> lines, int envelope_degree)
    : root_weight_(root_weight.begin(), root_weight.end()),
      lines_(std::move(lines)),
      degree_(static_cast<std::size_t>(envelope_degree)),
      cosines_(!root_weight.empty()),
      trend_(2 + curved_terms(output_turns, lines_, cosines_ ? fewest_cosines : fewest_polynomials)) {
    root_weight_.resize(place.size(), 1.0);
    weight_ = dot(root_weight_.data(), root_weight_.data(), place.size());
    const double length = std::abs(place.back() - place.front());
    for (const double at : place)
        place_.push_back(std::clamp(std::abs(at - place.front()) / length, 0.0, 1.0));
}

void WindowFit::add_trend() {
    columns_.assign(trend_, std::vector<double>(place_.size()));
    for (std::size_t k = 0; k < place_.size(); ++k) {
        columns_[0][k] = root_weight_[k];
        columns_[1][k] = root_weight_[k] * (place_[k] - 0.5);
        // Chebyshev's recurrence gives the cosines of multiples of an angle, or polynomials of the place.
        const double s = 2.0 * place_[k] - 1.0;
        const double x = cosines_ ? portable::cos(std::numbers::pi * place_[k]) : s;
        double before = cosines_ ? 1.0 : s, now = cosines_ ? x : 2.0 * s * s - 1.0;
        for (std::size_t m = 2; m < trend_; ++m) {
            columns_[m][k] = root_weight_[k] * now;
            const double next = 2.0 * x * now - before;
            before = now;
            now = next;
        }
    }
}

void WindowFit::waves(const TrackedLine& line, std::vector<double>& cosine, std::vector<double>& sine) const {
    std::vector<double> angle(place_.size());
    for (std::size_t k = 0; k < angle.size(); ++k)
        angle[k] = 2.0 * std::numbers::pi * line.order * line.turns[k];
    cosine.resize(angle.size());
    sine.resize(angle.size());
    portable::phasors(angle, cosine, sine);
    for (std::size_t k = 0; k < angle.size(); ++k) {
        cosine[k] *= root_weight_[k];
        sine[k] *= root_weight_[k];
    }
}

void WindowFit::add_wave(const TrackedLine& line) {
    std::vector<double> cosine, sine;
    waves(line, cosine, sine);
    for (std::size_t degree = 0; degree <= degree_; ++degree) {
        columns_.push_back(cosine);
        columns_.push_back(sine);
        for (std::size_t k = 0; degree < degree_ && k < place_.size(); ++k) {
            cosine[k] *= 2.0 * place_[k] - 1.0;
            sine[k] *= 2.0 * place_[k] - 1.0;
        }
    }
}

Eigen::Index WindowFit::first_of(std::size_t line) const {
    return static_cast<Eigen::Index>(trend_ + 2 * (degree_ + 1) * line);
}

void WindowFit::factorise() {
    add_trend();
    for (const TrackedLine& line : lines_) add_wave(line);
    const auto n = static_cast<Eigen::Index>(columns_.size());
    Eigen::MatrixXd normal(n, n);
    scale_.resize(n);
    for (Eigen::Index i = 0; i < n; ++i) {
        const double* const column = columns_[static_cast<std::size_t>(i)].data();
        for (Eigen::Index j = 0; j <= i; ++j)
            normal(i, j) = dot(column, columns_[static_cast<std::size_t>(j)].data(), place_.size());
        scale_[i] = 1.0 / std::sqrt(std::max(normal(i, i), 1e-300));
    }
    normal = scale_.asDiagonal() * normal * scale_.asDiagonal();
    factors_.compute(normal);
    Eigen::MatrixXd units = Eigen::MatrixXd::Zero(n, static_cast<Eigen::Index>(2 * lines_.size()));
    for (std::size_t i = 0; i < lines_.size(); ++i) {
        const auto column = static_cast<Eigen::Index>(2 * i);
        units(first_of(i), column) = units(first_of(i) + 1, column + 1) = 1.0;
    }
    inverse_ = factors_.solve(units);
}

double WindowFit::inflation(std::size_t line) const {
    const auto column = static_cast<Eigen::Index>(2 * line);
    return 0.5 * (inverse_(first_of(line), column) + inverse_(first_of(line) + 1, column + 1));
}

double WindowFit::variance(std::size_t line, std::complex<double> along) const {
    const Eigen::Index first = first_of(line), column = static_cast<Eigen::Index>(2 * line);
    const double a = along.real() * scale_[first], b = -along.imag() * scale_[first + 1];
    return a * a * inverse_(first, column) + 2.0 * a * b * inverse_(first, column + 1) +
           b * b * inverse_(first + 1, column + 1);
}

WindowFit::Torque WindowFit::fit(std::span<const double> torque_nm) const {
    const std::size_t samples = place_.size();
    Torque found{Eigen::VectorXd(scale_.size()), std::vector<double>(samples)};
    for (std::size_t k = 0; k < samples; ++k) found.residual[k] = root_weight_[k] * torque_nm[k];
    for (Eigen::Index i = 0; i < scale_.size(); ++i)
        found.coefficients[i] =
            scale_[i] * dot(columns_[static_cast<std::size_t>(i)].data(), found.residual.data(), samples);
    const Eigen::VectorXd solved = factors_.solve(found.coefficients);
    found.coefficients = scale_.asDiagonal() * solved;
    for (Eigen::Index i = 0; i < scale_.size(); ++i)
        add_scaled(-found.coefficients[i], columns_[static_cast<std::size_t>(i)].data(),
                   found.residual.data(), samples);
    return found;
}

std::complex<double> WindowFit::amplitude(const Torque& torque, std::size_t line) const {
    return {torque.coefficients[first_of(line)], -torque.coefficients[first_of(line) + 1]};
}

std::vector<double> WindowFit::terms_in_sum(const Torque& torque, std::size_t from, std::size_t end) const {
    std::vector<double> sum(place_.size(), 0.0);
    for (std::size_t i = from; i < end; ++i)
        add_scaled(torque.coefficients[static_cast<Eigen::Index>(i)], columns_[i].data(), sum.data(),
                   sum.size());
    return sum;
}

std::vector<double> WindowFit::middle_half(std::span<const double> weighted) const {
    std::vector<double> values;
    for (std::size_t k = 0; k < weighted.size(); ++k)
        if (std::abs(place_[k] - 0.5) <= 0.25) values.push_back(weighted[k] / root_weight_[k]);
    return values;
}

double WindowFit::power_beside(const Torque& torque, const TrackedLine& line, double clear_cycles) const {
    const double cycles = cycles_of(line);
    bool taken = cycles < 0.5 * static_cast<double>(trend_ - 2) + clear_cycles;
    for (const TrackedLine& other : lines_)
        taken = taken || std::abs(cycles - cycles_of(other)) < 0.99 * clear_cycles;
    if (taken) return not_a_number;
    std::vector<double> cosine, sine;
    waves(line, cosine, sine);
    const double c = dot(cosine.data(), torque.residual.data(), place_.size());
    const double s = dot(sine.data(), torque.residual.data(), place_.size());
    return 4.0 * (c * c + s * s) / (weight_ * weight_);
}

namespace {

/// Smallest pivot of the normal equations with unit columns. Below, a line is collinear with the others, to
/// within rounding times the torque's range.
constexpr double least_pivot = 1e-9;

void check_signal(const TrackedSignal& signal, const WindowRule& rule) {
    if (signal.lines.empty()) raise<UsageError>("there is no order to track");
    for (const TrackedLine& line : signal.lines) {
        if (!(line.order > 0.0)) raise<UsageError>("order {} is not above 0", shortest(line.order));
    }
    if (rule.seconds.value() < 0.0 || (rule.seconds.value() == 0.0 && !(rule.turns > 0.0))) {
        raise<UsageError>("a window of {} turns is not above 0", shortest(rule.turns));
    }
    if (!(rule.hop > 0.0) || rule.hop > 1.0 || rule.envelope_degree < 0 || rule.envelope_degree > 2) {
        raise<UsageError>("windows are 0 to 1 length apart and their envelopes of degree 0 to 2");
    }
}

void add_row(const TrackedSignal& signal, const SampleRun& window, OrderTracks& tracks) {
    const auto times = signal.time_s.subspan(window.first, window.size());
    const double middle_s = 0.5 * (times.front() + times.back());
    const auto nearest = std::lower_bound(times.begin(), times.end(), middle_s) - times.begin();
    tracks.time_s.push_back(middle_s);
    tracks.speed_deg_s.push_back(signal.speed_deg_s[window.first + static_cast<std::size_t>(nearest)]);
    const double duration_s = times.back() - times.front();
    bool folded = false;
    for (std::size_t i = 0; i < signal.lines.size(); ++i) {
        const TrackedLine& line = signal.lines[i];
        const double hz =
            line.order * std::abs(line.turns[window.end - 1] - line.turns[window.first]) / duration_s;
        tracks.lines[i].hz.push_back(hz);
        folded = folded || hz > 0.5 * signal.sample_rate.value();
    }
    tracks.rows_folded += folded ? 1 : 0;
}

/// Amplitude, phase and error of each line, from the variance of the residual.
void add_amplitudes(const WindowFit& fit, const WindowFit::Torque& torque, double variance,
                    OrderTracks& tracks) {
    for (std::size_t i = 0; i < tracks.lines.size(); ++i) {
        const std::complex<double> found = fit.amplitude(torque, i);
        const double amplitude = std::abs(found);
        const std::complex<double> along = amplitude > 0.0 ? found / amplitude : 1.0;
        tracks.lines[i].amplitude_nm.push_back(amplitude);
        tracks.lines[i].standard_error_nm.push_back(
            std::sqrt(std::max(variance * fit.variance(i, along), 0.0)));
        tracks.lines[i].phase_deg.push_back(portable::arg(found) * degrees_per_radian);
    }
}

constexpr double ranges_wanted = 24.0;  // chosen, not derived: rows that a person reads
constexpr double finest_share =
    0.01;  ///< share of the highest speed: a steady log is not cut up by its speed noise

void gather_line(const LineTrack& track, const std::vector<std::size_t>& rows, SpeedTrack::Line& line) {
    double sum = 0.0, square = 0.0, hz = 0.0, error = not_a_number;
    std::complex<double> arrow;
    std::size_t count = 0;
    for (const std::size_t row : rows) {
        const double amplitude = track.amplitude_nm[row];
        if (!std::isfinite(amplitude)) continue;
        ++count;
        sum += amplitude;
        square += amplitude * amplitude;
        hz += track.hz[row];
        error = track.standard_error_nm[row];
        arrow += portable::polar(amplitude, track.phase_deg[row] / degrees_per_radian);
    }
    const double n = static_cast<double>(count);
    const double mean = count > 0 ? sum / n : not_a_number;
    const double variance = count > 1 ? std::max(0.0, (square - sum * mean) / (n - 1.0)) : error * error;
    line.amplitude_nm.push_back(mean);
    line.spread_nm.push_back(std::sqrt(variance));
    line.phase_deg.push_back(count > 0 ? portable::arg(arrow) * degrees_per_radian : not_a_number);
    line.hz.push_back(count > 0 ? hz / n : not_a_number);
}

// A step so much longer than its neighbours holds no data: windows grow and shrink with the speed, but
// slowly.
constexpr double longest_step = 3.0;

}  // namespace

double separating_window_turns(std::span<const double> orders) {
    // Chosen, not derived: periods of the lowest line, and of the slowest beat.
    constexpr double periods = 8.0, beats = 2.0;
    std::vector<double> sorted(orders.begin(), orders.end());
    std::sort(sorted.begin(), sorted.end());
    if (sorted.empty() || !(sorted.front() > 0.0)) raise<UsageError>("orders must be above 0");
    double turns = periods / sorted.front();
    for (std::size_t i = 1; i < sorted.size(); ++i) {
        if (sorted[i] == sorted[i - 1]) raise<UsageError>("order {} is listed twice", shortest(sorted[i]));
        turns = std::max(turns, beats / (sorted[i] - sorted[i - 1]));
    }
    return turns;
}

OrderTracks track_orders(const TrackedSignal& signal, const WindowRule& rule) {
    check_signal(signal, rule);
    OrderTracks tracks;
    tracks.lines.resize(signal.lines.size());
    const bool by_time = rule.seconds.value() > 0.0;
    const auto place = by_time ? signal.time_s : signal.reference_turns;
    const double length = by_time ? rule.seconds.value() : rule.turns;
    double squares = 0.0;
    std::size_t freedom = 0;
    for (const SampleRun& run : directed_runs(signal.speed_deg_s, signal.run_starts, {})) {
        for (const SampleRun& window : cut_windows(run, place, length, 0.5 * length, rule.hop)) {
            const auto part = [&](std::span<const double> all) {
                return all.subspan(window.first, window.size());
            };
            if (window.size() < 2) continue;
            const auto reference = part(signal.reference_turns);
            std::vector<TrackedLine> lines;
            for (const TrackedLine& line : signal.lines) lines.push_back({line.order, part(line.turns)});
            WindowFit fit(part(signal.time_s), {},
                          std::abs(reference.back() - reference.front()) / signal.ratio.value(),
                          std::move(lines), rule.envelope_degree);
            if (!fit.has_enough_samples()) {
                ++tracks.windows_too_few_samples;
                continue;
            }
            fit.factorise();
            if (!(fit.least_pivot() > least_pivot)) {
                ++tracks.rows_not_separable;
                continue;
            }
            const WindowFit::Torque torque = fit.fit(part(signal.torque_nm));
            const std::size_t free = window.size() - fit.unknowns();
            const double square = dot(torque.residual.data(), torque.residual.data(), window.size());
            add_row(signal, window, tracks);
            add_amplitudes(fit, torque, square / static_cast<double>(free), tracks);
            squares += square;
            freedom += free;
        }
    }
    if (freedom > 0) tracks.residual_rms_nm = std::sqrt(squares / static_cast<double>(freedom));
    return tracks;
}

double speed_step(const SpeedSpan& speeds) {
    const double slowest_deg_s = speeds.from.value(), fastest_deg_s = speeds.to.value();
    const double fastest = std::max(std::abs(slowest_deg_s), std::abs(fastest_deg_s));
    const double least = std::max((fastest_deg_s - slowest_deg_s) / ranges_wanted, finest_share * fastest);
    if (!(least > 0.0)) return 1.0;
    const double power = portable::pow(10.0, std::floor(portable::log10(least)));
    for (const double step : {1.0, 2.0, 5.0}) {
        if (step * power >= least) return step * power;
    }
    return 10.0 * power;
}

SpeedTrack gather_by_speed(const OrderTracks& tracks, DegPerSec step) {
    SpeedTrack result;
    result.lines.resize(tracks.lines.size());
    if (tracks.speed_deg_s.empty()) return result;
    const auto [low, high] = std::minmax_element(tracks.speed_deg_s.begin(), tracks.speed_deg_s.end());
    result.step_deg_s = step.value() > 0.0 ? step.value() : speed_step({DegPerSec(*low), DegPerSec(*high)});
    std::map<long long, std::vector<std::size_t>> ranges;
    for (std::size_t row = 0; row < tracks.speed_deg_s.size(); ++row) {
        ranges[std::llround(tracks.speed_deg_s[row] / result.step_deg_s)].push_back(row);
    }
    for (const auto& [range, rows] : ranges) {
        double speed = 0.0;
        for (const std::size_t row : rows) speed += tracks.speed_deg_s[row];
        result.speed_deg_s.push_back(speed / static_cast<double>(rows.size()));
        result.rows.push_back(rows.size());
        for (std::size_t i = 0; i < tracks.lines.size(); ++i)
            gather_line(tracks.lines[i], rows, result.lines[i]);
    }
    return result;
}

std::vector<std::size_t> track_breaks(const OrderTracks& tracks) {
    const std::vector<double>& time_s = tracks.time_s;
    const std::vector<double>& speed = tracks.speed_deg_s;
    const auto step = [&](std::size_t row) { return time_s[row] - time_s[row - 1]; };
    std::vector<std::size_t> breaks;
    for (std::size_t row = 1; row < time_s.size(); ++row) {
        const bool turned = speed[row] * speed[row - 1] < 0.0;
        double neighbour = 0.0;
        if (row > 1) neighbour = std::max(neighbour, step(row - 1));
        if (row + 1 < time_s.size()) neighbour = std::max(neighbour, step(row + 1));
        if (turned || (neighbour > 0.0 && step(row) > longest_step * neighbour)) breaks.push_back(row);
    }
    return breaks;
}

std::vector<std::size_t> track_breaks(const SpeedTrack& tracks) {
    const std::vector<double>& speed = tracks.speed_deg_s;
    std::vector<std::size_t> breaks;
    for (std::size_t row = 1; row < speed.size(); ++row) {
        // The mean of a range lies anywhere in it, so that neighbours are less than two widths apart.
        if (speed[row] - speed[row - 1] > 2.0 * tracks.step_deg_s) breaks.push_back(row);
    }
    return breaks;
}

}  // namespace ripplenotch
