// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>

#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/evaluate/contender.hpp"
#include "ripplenotch/evaluate/ledger.hpp"

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
    if (!metrics.levels || metrics.levels->windows == 0) return found;
    const RippleLevels& levels = *metrics.levels;
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
    if (const double moved = levels.distortion_rms_nm[1];
        moved > taken && moved > share_that_counts * before) {
        found.push_back(fmt::format(
            "its delay moves the torque itself by {:.3g} Nm rms, more than the {:.3g} Nm rms of ripple that "
            "it removes; narrower notches (--q) delay less, and 'ripplenotch recommend' tries other methods",
            moved, taken));
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
    if (!metrics.levels) return found;
    for (std::size_t i = 0; i < metrics.levels->orders.size(); ++i) {
        const OrderLevel& level = metrics.levels->orders[i];
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
