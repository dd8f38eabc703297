// SPDX-License-Identifier: MIT
#include "design/band_fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/design/guarantee.hpp"
#include "ripplenotch/design/notch.hpp"

namespace ripplenotch {

namespace {

constexpr int points_a_side = 9;        // number of points in the search for the largest gain of a trial band
constexpr double as_exact = 1e-9;       // share of a Q or a centre to which searches go
constexpr double edge_as_exact = 1e-7;  // share of a band's edge, from the side on which it still holds
// The end of the first stretch, from `low` upward, on which `holds` is true; `high` when it never fails.
template <class Holds>
double first_failure(double low, double high, const Holds& holds) {
    double good = low, step = 1e-4 * low;
    while (good < high) {
        const double next = std::min(good + step, high);
        if (!holds(next)) {
            double bad = next;
            while (bad - good > edge_as_exact * good) {
                const double middle = 0.5 * (good + bad);
                (holds(middle) ? good : bad) = middle;
            }
            return good;
        }
        good = next;
        step = std::min(2.0 * step, 0.05 * good);
    }
    return high;
}

}  // namespace

BandFit::BandFit(const TableSpec& spec)
    : spec_(spec), floor_gain_(portable::pow(10.0, -spec.depth_db / 20.0)) {
    for (const Order order : spec.orders)
        hz_per_deg_s_.push_back(order.value() * spec.gear_ratio.value() / 360.0);
}

double BandFit::warped(std::size_t order, double speed_deg_s) const {
    return portable::tan(std::numbers::pi * hz_per_deg_s_[order] * speed_deg_s / spec_.sample_rate.value());
}

std::optional<Tuning> BandFit::tune(double center_deg_s, const QRule& rule) const {
    Tuning tuning{center_deg_s, rule.q.value_or(1.0), {}};
    for (std::size_t i = 0; i < hz_per_deg_s_.size(); ++i) tuning.warped.push_back(warped(i, center_deg_s));
    if (rule.q) return tuning;
    const double least = delay_s(tuning) / *rule.delay_s;  // a delay goes with 1 / Q
    if (!(least <= narrowest_q)) return std::nullopt;
    tuning.q = std::max(widest_q, least);
    return tuning;
}

// theory.md, equation 5, with alpha = sin W damping / 2 and sin W / (1 - cos W) = 1 / tan(W/2).
double BandFit::delay_s(const Tuning& tuning) const {
    double samples = 0.0;
    for (const double centre : tuning.warped) samples += 0.5 / tuning.q * (1.0 - floor_gain_) / centre;
    return samples / spec_.sample_rate.value();
}

double BandFit::power(const Tuning& tuning, double speed_deg_s) const {
    double largest = 0.0;
    const double damping = 1.0 / tuning.q;
    for (std::size_t line = 0; line < hz_per_deg_s_.size(); ++line) {
        const double t = warped(line, speed_deg_s);
        double power = 1.0;
        for (std::size_t i = 0; i < tuning.warped.size(); ++i) {
            const double r = t / tuning.warped[i];
            const double off = (1.0 - r * r) * (1.0 - r * r), across = (r * damping) * (r * damping);
            power *= (off + floor_gain_ * floor_gain_ * across) / (off + across);
        }
        largest = std::max(largest, power);
    }
    return largest;
}

double BandFit::speed_in(double from_deg_s, double to_deg_s, int point) const {
    const auto [from, to] = speeds_in_force(spec_, from_deg_s, to_deg_s);
    const double share = static_cast<double>(point) / (points_a_side - 1);
    return from + share * (to - from);
}

double BandFit::worst_gain(const Tuning& tuning, double from_deg_s, double to_deg_s) const {
    double worst = 0.0;
    for (int i = 0; i < points_a_side; ++i)
        worst = std::max(worst, power(tuning, speed_in(from_deg_s, to_deg_s, i)));
    return std::sqrt(worst);
}

// Ends first: where a band does not hold, it does not hold there, mostly.
bool BandFit::holds(const Tuning& tuning, double from_deg_s, double to_deg_s, double max_gain) const {
    for (int i = 0; i < points_a_side; ++i) {
        const int point = i % 2 == 0 ? i / 2 : points_a_side - 1 - i / 2;
        if (std::sqrt(power(tuning, speed_in(from_deg_s, to_deg_s, point))) > max_gain) return false;
    }
    return true;
}

std::optional<double> BandFit::reach(double from_deg_s, double end_deg_s, double max_gain,
                                     const QRule& rule) const {
    const auto held = [&](double center, double from, double to) {
        const auto tuning = tune(center, rule);
        return tuning && holds(*tuning, from, to, max_gain);
    };
    if (!held(from_deg_s, from_deg_s, from_deg_s)) return std::nullopt;
    // A centre further up serves speeds further up, as far as the lower edge is still held.
    const double center =
        first_failure(from_deg_s, end_deg_s, [&](double at) { return held(at, from_deg_s, at); });
    const Tuning tuning = *tune(center, rule);
    return first_failure(center, end_deg_s, [&](double to) { return holds(tuning, center, to, max_gain); });
}

std::optional<Tuning> BandFit::balanced(double from_deg_s, double to_deg_s, const QRule& rule) const {
    double low = from_deg_s, high = to_deg_s;
    while (high - low > as_exact * high) {
        const double middle = 0.5 * (low + high);
        const auto tuning = tune(middle, rule);
        if (!tuning) {
            low = middle;  // a delay is easier met further up
            continue;
        }
        const double below = worst_gain(*tuning, from_deg_s, middle);
        const double above = worst_gain(*tuning, middle, to_deg_s);
        (below < above ? low : high) = middle;
    }
    return tune(high, rule);
}

std::optional<std::vector<double>> BandFit::edges(double from_deg_s, double to_deg_s, double max_gain,
                                                  const QRule& rule, std::size_t most) const {
    std::vector<double> found = {from_deg_s};
    while (found.back() < to_deg_s) {
        if (found.size() > most) return std::nullopt;
        const auto next = reach(found.back(), to_deg_s, max_gain, rule);
        if (!next || !(*next > found.back() * (1.0 + 1e-9))) return std::nullopt;
        found.push_back(*next);
    }
    return found;
}

namespace {

constexpr double max_db = 140.0, least_db = 0.1;  // chosen, not derived
constexpr int settling_trials = 49;               // Q from widest to narrowest, 6 % apart

double gain_of(double attenuation_db) { return portable::pow(10.0, -attenuation_db / 20.0); }

// A higher Q delays less, so it is rounded up; the limits themselves stay unchanged.
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
        const NotchSpec notch{Hertz(to_digits(center.value(), 12)), rounded_up(tuning.q), spec.depth_db};
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
    : spec_(spec), fit_(spec_), from_(goal.from.value()), to_(goal.to.value()), q_(goal.q) {}

QRule BandSearch::rule(std::optional<double> delay_s) const {
    if (q_) return {q_, std::nullopt};
    return {std::nullopt, delay_s};
}

std::optional<std::size_t> BandSearch::bands(double attenuation_db, const QRule& rule) const {
    const auto found = fit_.edges(from_, to_, gain_of(attenuation_db), rule, max_bands_ever);
    return found ? std::optional(found->size() - 1) : std::nullopt;
}

std::optional<double> BandSearch::attenuation_db(std::size_t bands, const QRule& rule, double known_db,
                                                 double held_db) const {
    const auto holds = [&](double db) {
        return db <= held_db || fit_.edges(from_, to_, gain_of(db), rule, bands).has_value();
    };
    double low = std::max(known_db, least_db), high = low + 1.0;
    if (known_db < least_db && !holds(low)) return std::nullopt;
    while (high < max_db && holds(high)) {
        low = high;
        high = std::min(low + 2.0 * (high - known_db), max_db);
    }
    while (high - low > 1e-3) {
        const double middle = 0.5 * (low + high);
        (holds(middle) ? low : high) = middle;
    }
    return low;
}

// The gain of a further band falls with every band, so the last that is worth it can be found by bisection.
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
    while (high < max_bands_ever && worth(high)) {
        low = high;
        high = std::min(2 * high, max_bands_ever);
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
        for (std::size_t n = 0; n < spec_.orders.size(); ++n) {
            const Hertz center = ripple_frequency(spec_.orders[n], spec_.gear_ratio, DegPerSec(from_));
            cascade.push_back(design_notch({center, q, spec_.depth_db}, spec_.sample_rate));
        }
        const StepFigures step = measure_step(cascade, spec_.sample_rate, spec_.settle_band_percent);
        trials.push_back({fit_.delay_s(tuning), step.settle.value(), q});
    }
    const auto sooner = [](const Settling& a, const Settling& b) { return a.settle_s < b.settle_s; };
    return *std::min_element(trials.begin(), trials.end(), sooner);  // the widest of equals
}

CandidateTable BandSearch::table(double attenuation_db, const QRule& rule) const {
    const auto edges = fit_.edges(from_, to_, gain_of(attenuation_db), rule, max_bands_ever);
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
