// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>

#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/evaluate/contender.hpp"

namespace ripplenotch {

SwitchLedger::SwitchLedger(std::span<const double> truth_nm) : truth_nm_(truth_nm) {
    if (truth_nm.empty()) return;
    const auto [low, high] = std::minmax_element(truth_nm.begin(), truth_nm.end());
    for (std::size_t b = 0; b < bands_nm_.size(); ++b)
        bands_nm_[b] = 0.01 * settle_bands_percent[b] * (*high - *low);
}

void SwitchLedger::add(std::span<const double> time_s, std::span<const double> out_nm,
                       std::span<const Switch> changes) {
    for (std::size_t k = 0; k < out_nm.size(); ++k, ++done_) {
        if (entries_.size() < changes.size() && changes[entries_.size()].sample == done_) {
            SwitchEntry entry{changes[entries_.size()],
                              Seconds(time_s[k]),
                              Seconds(0.0),
                              last_error_nm_,
                              std::nullopt,
                              std::nullopt,
                              {}};
            entries_.push_back(entry);
            watched_ = true;
            outside_.fill(false);
        }
        if (watched_) entries_.back().stretch = Seconds(time_s[k]) - entries_.back().time;
        if (truth_nm_.empty()) continue;
        const double error_nm = std::abs(out_nm[k] - truth_nm_[done_]);
        if (watched_) follow(Seconds(time_s[k]), error_nm);
        last_error_nm_ = error_nm;
    }
}

void SwitchLedger::follow(Seconds time, double error_nm) {
    SwitchEntry& entry = entries_.back();
    const Seconds after = time - entry.time;
    if (!entry.peak_error_nm || error_nm > *entry.peak_error_nm) {
        entry.peak_error_nm = error_nm;
        entry.peak_after = after;
    }
    for (std::size_t b = 0; b < bands_nm_.size(); ++b) {
        const bool outside = error_nm > bands_nm_[b];
        if (outside) {
            entry.settle[b].reset();
        } else if (outside_[b] || after == Seconds(0.0)) {
            entry.settle[b] = after;  // until it goes out again
        }
        outside_[b] = outside;
    }
}

void SwitchLedger::split() {
    watched_ = false;
    last_error_nm_.reset();
}

namespace {

constexpr std::array typical_speeds_deg_s = {5.0, 10.0, 20.0, 50.0, 100.0, 200.0};
constexpr int speeds_looked_at = 97;  // steps of 5 % over two decades at most
constexpr double slowest_searched_deg_s = 0.1, fastest_searched_deg_s = 3000.0;  // chosen, not derived

// The same method with a table of one band: at the band's middle speed it does the same, and a table of a
// thousand bands does not run a thousand filters a thousand times.
Contender with_band(const Contender& contender, const Band& band) {
    Contender one = contender;
    Band first = band;
    first.number = 1;
    one.table = std::make_shared<const CandidateTable>(
        CandidateTable::from_bands(contender.table->spec(), {std::move(first)}));
    return one;
}

LedgerEntry entry_of(const Contender& contender, const Contender& runs, Hertz sample_rate, DegPerSec from,
                     DegPerSec to, const LedgerRequest& request) {
    const DegPerSec speed = 0.5 * (from + to);
    LedgerEntry entry{0, from, to, "", Seconds(0.0), {}, {}, {}, {}};
    if (const auto frozen = contender.frozen(sample_rate, speed)) {
        entry.filter = frozen->note;
        entry.dc_delay = group_delay(frozen->cascade, Hertz(0.0), SampledAt(sample_rate));
        if (request.crossover) {
            const CrossoverFigures figures =
                at_crossover(frozen->cascade, *request.crossover, SampledAt(sample_rate));
            entry.phase_lag_deg = figures.phase_lag_deg;
            entry.crossover_db = figures.gain_db;
        }
    }
    if (!request.measured) return entry;
    const Bench bench(runs, sample_rate, speed);
    try {
        entry.ramp_delay = bench.ramp(usual_ramp_nm_s).delay;
        entry.step = bench.step(NewtonMeters(usual_step_nm));
    } catch (const UsageError&) {
        // A filter that does not settle has no such figures; the rest of the ledger still counts.
    }
    return entry;
}

double delay_s(const Contender& contender, Hertz sample_rate, double speed_deg_s) {
    const auto frozen = contender.frozen(sample_rate, DegPerSec(speed_deg_s));
    return frozen ? group_delay(frozen->cascade, Hertz(0.0), SampledAt(sample_rate)).value() : 0.0;
}

bool follows_gear(const Contender& contender) { return contender.settings.has("orders"); }

}  // namespace

CrossoverFigures at_crossover(std::span<const Biquad> cascade, Hertz at, SampledAt sampled) {
    if (!(at.value() > 0.0) || !(at < 0.5 * sampled.rate)) {
        raise<UsageError>("a crossover of {} Hz is not between 0 and half the sample rate, {} Hz",
                          shortest(at.value()), shortest(0.5 * sampled.rate.value()));
    }
    CrossoverFigures figures;
    for (const Biquad& section : cascade) {
        const auto gain = response(section, at, sampled);
        figures.phase_lag_deg -= degrees_per_radian * portable::arg(gain);
        // A complete null has no gain in dB; what counts is that nothing is left.
        figures.gain_db +=
            std::max(20.0 * portable::log10(std::max(std::abs(gain), 1e-300)), -most_attenuation_db);
    }
    figures.gain_db = std::max(figures.gain_db, -most_attenuation_db);
    return figures;
}

std::vector<LedgerEntry> delay_ledger(const Contender& contender, Hertz sample_rate,
                                      const LedgerRequest& request) {
    std::vector<LedgerEntry> ledger;
    if (contender.table != nullptr) {
        for (const Band& band : contender.table->bands()) {
            ledger.push_back(
                entry_of(contender, with_band(contender, band), sample_rate, band.from, band.to, request));
            ledger.back().band = band.number;
        }
    } else if (follows_gear(contender)) {
        for (const double speed : typical_speeds_deg_s) {
            ledger.push_back(
                entry_of(contender, contender, sample_rate, DegPerSec(speed), DegPerSec(speed), request));
        }
    } else {
        ledger.push_back(
            entry_of(contender, contender, sample_rate, DegPerSec(0.0), DegPerSec(0.0), request));
    }
    return ledger;
}

LongestDelay longest_delay(const Contender& contender, Hertz sample_rate, const SpeedSpan& speeds) {
    const double high = speeds.to.value(), low = std::max(speeds.from.value(), 0.01 * high);
    LongestDelay longest{Seconds(0.0), speeds.to, ""};
    for (int i = 0; i < speeds_looked_at; ++i) {
        const double share = static_cast<double>(i) / (speeds_looked_at - 1);
        const double speed = high > 0.0 ? low * portable::pow(high / low, share) : 0.0;
        const auto frozen = contender.frozen(sample_rate, DegPerSec(speed));
        if (!frozen) continue;
        const Seconds delay = group_delay(frozen->cascade, Hertz(0.0), SampledAt(sample_rate));
        if (i == 0 || delay > longest.delay) longest = {delay, DegPerSec(speed), frozen->note};
    }
    return longest;
}

std::optional<DegPerSec> within_from(const Contender& contender, Hertz sample_rate, Seconds limit) {
    // From above: methods fade out or pass at low speed, which would hide that they are too slow further up.
    const double step = 1.01;
    double speed = fastest_searched_deg_s;
    if (delay_s(contender, sample_rate, speed) > limit.value()) return std::nullopt;
    while (speed > slowest_searched_deg_s) {
        const double next = speed / step;
        if (delay_s(contender, sample_rate, next) > limit.value()) return DegPerSec(speed);
        speed = next;
    }
    return DegPerSec(0.0);
}

}  // namespace ripplenotch
