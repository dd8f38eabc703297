// SPDX-License-Identifier: MIT
#include "design/band_search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/design/transient.hpp"

namespace ripplenotch {
namespace {

constexpr double most_db = 140.0, least_db = 0.1;  // complete_null_gain in dB; and by hand
constexpr int settling_trials = 49;                // Q from widest to narrowest, 6 % apart

double gain_of(double attenuation_db) { return portable::pow(10.0, -attenuation_db / 20.0); }

// A higher Q delays less, so it is rounded up; the limits themselves stay what they are.
double rounded_up(double q) {
    const double rounded = to_digits(q, 7);
    return rounded >= q ? rounded : to_digits(q * (1.0 + 1e-6), 7);
}

}  // namespace

Band band_of(const TableSpec& spec, int number, DegPerSec from, DegPerSec to, const Tuning& tuning) {
    Band band;
    band.number = number;
    band.from = from;
    band.to = to;
    for (std::size_t i = 0; i < spec.orders.size(); ++i) {
        const Hertz center =
            ripple_frequency(spec.orders[i], spec.gear_ratio, DegPerSec(tuning.center_deg_s));
        const NotchSpec notch{Hertz(to_digits(center.value(), 12)), rounded_up(tuning.q[i]), spec.depth_db,
                              spec.width};
        try {
            band.notches.push_back({spec.orders[i], notch, design_notch(notch, spec.sample_rate)});
        } catch (const UsageError& error) {
            raise<UsageError>("band {} ({:.6g}-{:.6g} deg/s): {}", number, from.value(), to.value(),
                              error.what());
        }
    }
    measure_band(band, spec);
    return band;
}

BandSearch::BandSearch(const TableSpec& spec, const DesignGoal& goal)
    : spec_(spec), fit_(spec_, !goal.q), from_(goal.from.value()), to_(goal.to.value()), q_(goal.q) {}

QRule BandSearch::rule(std::optional<double> delay_s) const {
    if (q_) return {q_, std::nullopt};
    return {std::nullopt, delay_s};
}

std::optional<std::size_t> BandSearch::bands(double attenuation_db, const QRule& rule) const {
    const auto found = fit_.edges(from_, to_, gain_of(attenuation_db), rule, most_bands_ever);
    return found ? std::optional(found->size() - 1) : std::nullopt;
}

std::optional<double> BandSearch::attenuation_db(std::size_t bands, const QRule& rule, double known_db,
                                                 double held_db) const {
    const auto holds = [&](double db) {
        return db <= held_db || fit_.edges(from_, to_, gain_of(db), rule, bands).has_value();
    };
    double low = std::max(known_db, least_db), high = low + 1.0;
    if (known_db < least_db && !holds(low)) return std::nullopt;
    while (high < most_db && holds(high)) {
        low = high;
        high = std::min(low + 2.0 * (high - known_db), most_db);
    }
    while (high - low > 1e-3) {
        const double middle = 0.5 * (low + high);
        (holds(middle) ? low : high) = middle;
    }
    return low;
}

std::optional<double> BandSearch::delay_s(double attenuation_db, std::size_t bands, KnownDelays known) const {
    const auto holds = [&](double delay_s) {
        if (delay_s <= known.short_s || delay_s >= known.enough_s) return delay_s >= known.enough_s;
        return fit_.edges(from_, to_, gain_of(attenuation_db), rule(delay_s), bands).has_value();
    };
    double low = least_delay_s(), high = most_delay_s();
    if (!holds(high)) return std::nullopt;
    if (holds(low)) return low;
    while (high / low > 1.0 + delay_as_exact) {
        const double middle = std::sqrt(low * high);
        (holds(middle) ? high : low) = middle;
    }
    return high;
}

// What a further band adds falls with every band, so the last that is worth it can be closed in on.
std::size_t BandSearch::bands_worth_it(const QRule& rule) const {
    double known_db = 0.0;  // held by the fewest bands that are still tried
    const auto worth = [&](std::size_t count) {
        const auto held = attenuation_db(count, rule, known_db);
        if (!held) return true;
        const double wanted = *held + gain_worth_a_band_db;
        const bool is = fit_.edges(from_, to_, gain_of(wanted), rule, count + 1).has_value();
        if (is) known_db = *held;
        return is;
    };
    std::size_t low = 0, high = 1;  // the band after `low` is worth it, that after `high` is not
    while (high < most_bands_ever && worth(high)) {
        low = high;
        high = std::min(2 * high, most_bands_ever);
    }
    while (high - low > 1) {
        const std::size_t middle = (low + high) / 2;
        (worth(middle) ? low : high) = middle;
    }
    return high;
}

BandSearch::Settling BandSearch::soonest() const {
    std::vector<Settling> trials;
    for (int i = 0; i < settling_trials; ++i) {
        const double q =
            widest_q * portable::pow(narrowest_q / widest_q, static_cast<double>(i) / (settling_trials - 1));
        const Tuning tuning = *fit_.tune(from_, {q, std::nullopt});
        Cascade cascade;
        for (std::size_t n = 0; n < tuning.q.size(); ++n) {
            const Hertz center = ripple_frequency(spec_.orders[n], spec_.gear_ratio, DegPerSec(from_));
            cascade.push_back(
                design_notch({center, tuning.q[n], spec_.depth_db, spec_.width}, spec_.sample_rate));
        }
        const StepFigures step = measure_step(cascade, spec_.sample_rate, spec_.settle_band_percent);
        trials.push_back({fit_.delay_s(tuning), step.settle.value(), q});
    }
    const auto sooner = [](const Settling& a, const Settling& b) { return a.settle_s < b.settle_s; };
    return *std::min_element(trials.begin(), trials.end(), sooner);  // the widest of equals
}

CandidateTable BandSearch::table(double attenuation_db, const QRule& rule) const {
    const auto edges = fit_.edges(from_, to_, gain_of(attenuation_db), rule, most_bands_ever);
    if (!edges) throw std::logic_error("a band search was asked for a table that it had not found");
    std::vector<Band> bands;
    double from = from_;
    for (std::size_t i = 1; i < edges->size(); ++i) {
        const double to = i + 1 == edges->size() ? to_ : to_digits((*edges)[i], 8);
        const Tuning tuning = *fit_.balanced(from, to, rule);
        bands.push_back(band_of(spec_, static_cast<int>(i), DegPerSec(from), DegPerSec(to), tuning));
        from = to;
    }
    TableSpec spec = spec_;
    spec.q = bands.front().notches.front().notch.q;
    return CandidateTable::from_bands(std::move(spec), std::move(bands));
}

}  // namespace ripplenotch
