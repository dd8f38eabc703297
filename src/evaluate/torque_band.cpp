// SPDX-License-Identifier: MIT
// What a method does to a torque without ripple, within the band in which the torque moves and outside of it.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "ripplenotch/analysis/spectrum.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/design/notch.hpp"
#include "ripplenotch/evaluate/ledger.hpp"
#include "ripplenotch/evaluate/recommendation.hpp"

namespace ripplenotch {

namespace {

constexpr double share_of_variance = 0.99;  // chosen, not derived; stated in docs/commands/recommend.md
// Periods of a torque in a log that are fewer than this are not distinguished from its mean and trend.
constexpr double fewest_periods = 4.0;
constexpr double mean_over_median = 1.4426950408889634;  // of a noise bin's power, which is exponential
constexpr int band_limit_order = 4;                      // once forward and once backward
constexpr int frequencies_looked_at = 8;

// The lines of a spectrum are not of interest: with this chance of a false alarm none is looked for.
constexpr double no_lines = 0.0;

double noise_floor(const Spectrum& spectrum) {
    const auto above = spectrum.psd_nm2_hz.begin() + static_cast<std::ptrdiff_t>(spectrum.hz.size() / 2);
    return mean_over_median * median_of({above, spectrum.psd_nm2_hz.end()});
}

// From the state that is settled at its first value.
void run_settled(const Cascade& cascade, std::span<double> values) {
    if (values.empty()) return;
    std::vector<BiquadState> states(cascade.size());
    const double origin = values.front();
    for (double& value : values) {
        value -= origin;
        for (std::size_t i = 0; i < cascade.size(); ++i) value = step(cascade[i], states[i], value);
        value += origin;
    }
}

// Without phase, each run of the log on its own.
void low_pass(std::vector<double>& values, const TraceView& trace, Hertz cutoff) {
    if (!(cutoff < 0.5 * trace.sample_rate)) return;
    const Cascade cascade = design_low_pass({cutoff, band_limit_order}, trace.sample_rate);
    for (std::size_t from = 0, to = 0; from < values.size(); from = to) {
        for (to = from + 1; to < values.size() && !trace.starts_run(to);) ++to;
        const auto part = std::span(values).subspan(from, to - from);
        for (int way = 0; way < 2; ++way) {
            run_settled(cascade, part);
            std::reverse(part.begin(), part.end());
        }
    }
}

}  // namespace

TorqueBand torque_band(const TraceView& torque) {
    const Spectrum spectrum = torque_spectrum(torque, {{}, no_lines});
    const double floor = noise_floor(spectrum), bin_hz = spectrum.bin_width.value();
    double total = 0.0, power = 0.0;
    for (const double density : spectrum.psd_nm2_hz) total += density - floor;
    TorqueBand band{Hertz(0.0), Hertz(fewest_periods * bin_hz), false, true};
    // The sum of so many bins of noise alone is this uncertain.
    const double doubt = 3.0 * floor * std::sqrt(static_cast<double>(spectrum.hz.size()));
    if (!(total > doubt)) return band;
    band.at_rest = false;
    for (std::size_t i = 0; i < spectrum.hz.size(); ++i) {
        power += spectrum.psd_nm2_hz[i] - floor;
        band.to = std::max(band.to, Hertz(spectrum.hz[i]));
        if (power >= share_of_variance * total) break;
    }
    return band;
}

TorqueReference::TorqueReference(const ComparedLog& log, const GearAccount& lines,
                                 std::span<const RippleEstimate> ripple, std::optional<TorqueBand> stated)
    : log_(log), torque_nm_(log.trace.torque_nm.begin(), log.trace.torque_nm.end()) {
    std::vector<Order> present;
    for (const RippleEstimate& one : ripple)
        if (one.present()) present.emplace_back(one.order);
    const RippleCourse course = ripple_course(log.trace, lines.ratio, present);
    known_ = course.known;
    for (std::size_t k = 0; k < torque_nm_.size(); ++k) torque_nm_[k] -= course.nm[k];
    log_.trace.torque_nm = torque_nm_;
    log_.watch = {};
    band_ = stated ? *stated : torque_band(log_.trace);
    beside_nm2_ = powers_beside(torque_nm_);
}

// Mean square over the rows at which the ripple is known.
double TorqueReference::power(std::span<const double> values) const {
    double squares = 0.0, rows = 0.0;
    for (std::size_t k = 0; k < values.size(); ++k) {
        if (!known_[k]) continue;
        squares += values[k] * values[k];
        rows += 1.0;
    }
    return rows > 0.0 ? squares / rows : 0.0;
}

// Octave by octave above the band, so that noise removed far away is no credit for what is added near by.
std::vector<double> TorqueReference::powers_beside(const std::vector<double>& torque_nm) const {
    std::vector<double> powers, lower = torque_nm, upper;
    low_pass(lower, log_.trace, band_.to);
    for (Hertz edge = band_.to; edge < 0.5 * log_.trace.sample_rate; lower = std::move(upper)) {
        edge = 2.0 * edge;
        upper = torque_nm;
        low_pass(upper, log_.trace, edge);
        for (std::size_t k = 0; k < lower.size(); ++k) lower[k] = upper[k] - lower[k];
        powers.push_back(power(lower));
    }
    return powers;
}

Distortion TorqueReference::distortion(const Contender& contender) const {
    const Contender& method = contender.without_ripple ? *contender.without_ripple : contender;
    std::vector<double> out = output_on_log(method, log_);
    const std::vector<double> beside_nm2 = powers_beside(out);
    double added_nm2 = 0.0;
    for (std::size_t i = 0; i < beside_nm2.size(); ++i)
        added_nm2 += std::max(beside_nm2[i] - beside_nm2_[i], 0.0);
    for (std::size_t k = 0; k < out.size(); ++k) out[k] -= torque_nm_[k];
    std::vector<double> slower = out;
    low_pass(out, log_.trace, band_.to);
    if (band_.from.value() > 0.0) {
        low_pass(slower, log_.trace, band_.from);
        for (std::size_t k = 0; k < out.size(); ++k) out[k] -= slower[k];
    }
    return {std::sqrt(power(out)), std::sqrt(added_nm2)};
}

std::optional<BandResponse> band_response(const Contender& contender, Hertz sample_rate, DegPerSec speed,
                                          const TorqueBand& band) {
    const auto frozen = contender.frozen(sample_rate, speed);
    if (!frozen) return std::nullopt;
    std::optional<BandResponse> all;
    for (int i = 0; i <= frequencies_looked_at; ++i) {
        const Hertz at = band.from + (static_cast<double>(i) / frequencies_looked_at) * (band.to - band.from);
        if (!(at.value() > 0.0) || !(at < 0.5 * sample_rate)) continue;
        const CrossoverFigures here = at_crossover(frozen->cascade, at, SampledAt(sample_rate));
        const Seconds delay(here.phase_lag_deg / 360.0 / at.value());
        const double gain = portable::pow(10.0, here.gain_db / 20.0);
        if (!all) all = {delay, delay, gain, gain};
        all->least_delay = std::min(all->least_delay, delay);
        all->longest_delay = std::max(all->longest_delay, delay);
        all->least_gain = std::min(all->least_gain, gain);
        all->largest_gain = std::max(all->largest_gain, gain);
    }
    return all;
}

}  // namespace ripplenotch
