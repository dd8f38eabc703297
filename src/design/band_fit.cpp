// SPDX-License-Identifier: MIT
#include "design/band_fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
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
constexpr int most_secants = 8;         // chosen, not derived: bisection follows
// Chosen, not derived: checked by its bracket.
constexpr double secant_as_exact = 1e-6, bracket_width = 1e-10;

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

// Two Q close to each other, with the one of which the delay is more than `most_s` and with the other not.
struct Bracket {
    double beyond, within;
};

// By secants against 1/Q, with which an analogue notch's delay goes.
template <class Delay>
Bracket bracket(const Delay& delay_at, double most_s, Bracket known, std::array<double, 2> delay_s) {
    const auto look = [&](double q) {
        const double found_s = delay_at(q);
        (found_s <= most_s ? known.within : known.beyond) = q;
        return found_s;
    };
    double before = 1.0 / known.beyond, here = 1.0 / known.within;
    for (int step = 0; step < most_secants; ++step) {
        const double next = here + (most_s - delay_s[1]) * (here - before) / (delay_s[1] - delay_s[0]);
        const double q = 1.0 / next;
        if (!(q > known.beyond && q < known.within)) break;
        const bool close = std::abs(next - here) < secant_as_exact * next;
        before = here;
        here = next;
        delay_s = {delay_s[1], look(q)};
        if (close) break;
    }
    for (const double q : {(1.0 - bracket_width) / here, (1.0 + bracket_width) / here})
        if (q > known.beyond && q < known.within) look(q);
    return known;
}

}  // namespace

BandFit::BandFit(const TableSpec& spec, const Shape& how)
    : spec_(spec),
      shaped_(how.q_by_amplitude && how.together),
      shape_(spec.orders.size(), 1.0),
      hz_per_deg_s_(spec.orders.size()),
      floor_gain_(portable::pow(10.0, -spec.depth_db / 20.0)) {
    double all = 0.0;
    for (const double amplitude : spec.amplitude_nm) all += amplitude * amplitude;
    for (std::size_t i = 0; i < spec.orders.size(); ++i) {
        hz_per_deg_s_[i] = spec.orders[i].value() * spec.gear_ratio.value() / 360.0;
        if (spec.amplitude_nm.empty() || !how.together) continue;
        weight_.push_back(spec.amplitude_nm[i] * spec.amplitude_nm[i] / all);
        // Least delay sum 1/(n Q) for a given remaining ripple sum (a Q)^2: Q is proportional to (n
        // a^2)^(-1/3).
        if (shaped_) {
            const double order = spec.orders[i].value() / spec.orders[0].value();
            shape_[i] = 1.0 / portable::cbrt(order * weight_[i] / weight_[0]);
        }
    }
}

double BandFit::q_each(std::size_t order, double q) const {
    return shaped_ ? std::clamp(q * shape_[order], widest_q, narrowest_q) : q;
}

BandFit::Centre BandFit::centre(double warped) const {
    if (spec_.width == WidthRule::analog) return {warped, 0.0, 0.0};
    return {warped, portable::atan(warped), 2.0 * warped / (1.0 + warped * warped)};
}

// The digital rule is the analogue one at another Q: alpha = sin W / (2 Q') there.
double BandFit::damping(const Centre& centre, double q) const {
    if (spec_.width == WidthRule::analog) return 1.0 / q;
    return 2.0 * portable::tan(centre.half_angle / q) / centre.sine;
}

double BandFit::warped(std::size_t order, double speed_deg_s) const {
    return portable::tan(std::numbers::pi * hz_per_deg_s_[order] * speed_deg_s / spec_.sample_rate.value());
}

Tuning BandFit::tuned(double center_deg_s, double q) const {
    Tuning tuning{center_deg_s, {}, {}, {}};
    for (std::size_t i = 0; i < shape_.size(); ++i) {
        tuning.q.push_back(q_each(i, q));
        tuning.warped.push_back(warped(i, center_deg_s));
        tuning.damping.push_back(damping(centre(tuning.warped.back()), tuning.q.back()));
    }
    return tuning;
}

std::optional<Tuning> BandFit::tune(double center_deg_s, const QRule& rule) const {
    if (rule.q) return tuned(center_deg_s, *rule.q);
    // From where all orders are as wide as they may be to where all are as narrow, whatever their shape.
    double low = narrowest_q, high = widest_q;
    for (const double shape : shape_) {
        low = std::min(low, widest_q / shape);
        high = std::max(high, narrowest_q / shape);
    }
    std::vector<Centre> centres;
    for (std::size_t i = 0; i < shape_.size(); ++i) centres.push_back(centre(warped(i, center_deg_s)));
    low = std::max(low, least_q(centres));
    const auto delay_at = [&](double q) {
        double samples = 0.0;
        for (std::size_t i = 0; i < centres.size(); ++i)
            samples += delay_samples(centres[i].warped, damping(centres[i], q_each(i, q)));
        return samples / spec_.sample_rate.value();
    };
    const double most_s = *rule.delay_s, at_low_s = delay_at(low), at_high_s = delay_at(high);
    if (at_low_s <= most_s) return tuned(center_deg_s, low);
    if (!(at_high_s <= most_s)) return std::nullopt;
    // Bisection converges to one of the Qs that are equally exact. A few secant steps along the delay find it
    // sooner, so that most halves are known without an evaluation.
    const Bracket known = bracket(delay_at, most_s, {low, high}, {at_low_s, at_high_s});
    while (high - low > as_exact * high) {
        const double middle = std::sqrt(low * high);
        const bool within = middle >= known.within || (middle > known.beyond && delay_at(middle) <= most_s);
        (within ? high : low) = middle;
    }
    return tuned(center_deg_s, high);
}

// A digital notch of a lower Q would be wider than half the sample rate, and is none.
double BandFit::least_q(const std::vector<Centre>& centres) const {
    constexpr double inside = 1.0 + 1e-6;  // chosen, not derived: off the edge by rounding
    double least = 0.0;
    for (std::size_t i = 0; i < centres.size(); ++i)
        least = std::max(least, inside * centres[i].half_angle / (0.5 * std::numbers::pi * shape_[i]));
    return least;
}

// theory.md, equation 5, with alpha = sin W damping / 2 and sin W / (1 - cos W) = 1 / tan(W/2).
double BandFit::delay_samples(double warped, double damping) const {
    return 0.5 * damping * (1.0 - floor_gain_) / warped;
}

double BandFit::delay_s(const Tuning& tuning) const {
    double samples = 0.0;
    for (std::size_t i = 0; i < tuning.warped.size(); ++i)
        samples += delay_samples(tuning.warped[i], tuning.damping[i]);
    return samples / spec_.sample_rate.value();
}

double BandFit::power(const Tuning& tuning, double speed_deg_s) const {
    double together = 0.0, largest = 0.0;
    for (std::size_t line = 0; line < hz_per_deg_s_.size(); ++line) {
        const double t = warped(line, speed_deg_s);
        double power = 1.0;
        for (std::size_t i = 0; i < tuning.warped.size(); ++i) {
            const double r = t / tuning.warped[i];
            const double off = (1.0 - r * r) * (1.0 - r * r),
                         across = (r * tuning.damping[i]) * (r * tuning.damping[i]);
            power *= (off + floor_gain_ * floor_gain_ * across) / (off + across);
        }
        largest = std::max(largest, power);
        if (!weight_.empty()) together += weight_[line] * power;
    }
    return weight_.empty() ? largest : together;
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
bool BandFit::holds(const Tuning& tuning, double from_deg_s, double to_deg_s, double most_gain) const {
    for (int i = 0; i < points_a_side; ++i) {
        const int point = i % 2 == 0 ? i / 2 : points_a_side - 1 - i / 2;
        if (std::sqrt(power(tuning, speed_in(from_deg_s, to_deg_s, point))) > most_gain) return false;
    }
    return true;
}

std::optional<double> BandFit::reach(double from_deg_s, double end_deg_s, double most_gain,
                                     const QRule& rule) const {
    const auto held = [&](double center, double from, double to) {
        const auto tuning = tune(center, rule);
        return tuning && holds(*tuning, from, to, most_gain);
    };
    if (!held(from_deg_s, from_deg_s, from_deg_s)) return std::nullopt;
    // A centre further up serves speeds further up, as far as the lower edge is still held.
    const double center =
        first_failure(from_deg_s, end_deg_s, [&](double at) { return held(at, from_deg_s, at); });
    const Tuning tuning = *tune(center, rule);
    return first_failure(center, end_deg_s, [&](double to) { return holds(tuning, center, to, most_gain); });
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

std::optional<std::vector<double>> BandFit::edges(double from_deg_s, double to_deg_s, double most_gain,
                                                  const QRule& rule, std::size_t most) const {
    std::vector<double> found = {from_deg_s};
    while (found.back() < to_deg_s) {
        if (found.size() > most) return std::nullopt;
        const auto next = reach(found.back(), to_deg_s, most_gain, rule);
        if (!next || !(*next > found.back() * (1.0 + 1e-9))) return std::nullopt;
        found.push_back(*next);
    }
    return found;
}

namespace {

constexpr double most_db = 140.0, least_db = 0.1;  // complete_null_gain in dB; and chosen, not derived
constexpr int settling_trials = 49;                // Q from widest to narrowest, 6 % apart

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
    : spec_(spec),
      fit_(spec_, {.together = goal.together(), .q_by_amplitude = !goal.q}),
      together_(goal.together()),
      from_(goal.from.value()),
      to_(goal.to.value()),
      q_(goal.q) {}

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

namespace {

constexpr std::array attenuations_db = {6.0, 10.0, 15.0, 20.0, 25.0, 30.0, 35.0, 40.0, 45.0, 50.0, 60.0};
constexpr double step_of_bands = 1.26;  // ten points a decade

TradePoint point_of(const CandidateTable& table, bool together) {
    TradePoint point;
    point.bands = table.bands().size();
    point.attenuation_db = held_db(table.bands().front(), together);
    point.least_q = point.largest_q = table.bands().front().notches.front().notch.q;
    for (const Band& band : table.bands()) {
        point.attenuation_db = std::min(point.attenuation_db, held_db(band, together));
        point.delay = std::max(point.delay, band.dc_delay);
        point.settle = std::max(point.settle, band.settle);
        point.overshoot_percent = std::max(point.overshoot_percent, band.overshoot_percent);
        for (const CandidateNotch& notch : band.notches) {
            point.least_q = std::min(point.least_q, notch.notch.q);
            point.largest_q = std::max(point.largest_q, notch.notch.q);
        }
    }
    return point;
}

/// A table with so many bands at that delay, as good as possible; they are known to hold `held_db`, which is
/// set to the attenuation that they hold.
std::optional<TradePoint> best(const BandSearch& search, std::size_t bands, double delay_s, double& held_db) {
    const QRule rule = search.rule(delay_s);
    const auto held = search.attenuation_db(bands, rule, 0.0, held_db);
    if (!held) return std::nullopt;
    held_db = *held;
    return point_of(search.table(*held, rule), search.together());
}

std::vector<std::size_t> counts(std::size_t from, std::size_t to) {
    std::vector<std::size_t> list;
    for (double count = static_cast<double>(from); count <= static_cast<double>(to);
         count = std::max(count + 1.0, std::round(count * step_of_bands))) {
        list.push_back(static_cast<std::size_t>(count));
    }
    return list;
}

// Attenuation against delay with so many bands.
void add_by_attenuation(std::vector<TradePoint>& points, const BandSearch& search, std::size_t bands) {
    BandSearch::KnownDelays known;  // a delay too short for one attenuation is so for a larger one
    for (const double db : attenuations_db) {
        double held_db = db + rounding_db;
        const auto delay = search.delay_s(held_db, bands, known);
        if (!delay) return;
        known.short_s = *delay * (1.0 - delay_as_exact);
        const auto point = best(search, bands, *delay, held_db);
        // At the narrowest notches several demands have one answer.
        if (point && (points.empty() || point->attenuation_db > points.back().attenuation_db + 0.05))
            points.push_back(*point);
    }
}

// Bands against delay for one attenuation, the delay within `most_s`.
void add_by_bands(std::vector<TradePoint>& points, const BandSearch& search, double attenuation_db,
                  std::optional<double> most_s, std::optional<std::size_t> most_bands) {
    const double widest_s = most_s ? std::min(*most_s, search.most_delay_s()) : search.most_delay_s();
    const auto fewest = search.bands(attenuation_db + rounding_db, search.rule(widest_s));
    if (!fewest) return;
    const auto at_narrowest = search.bands(attenuation_db + rounding_db, search.rule(search.least_delay_s()));
    const std::size_t last =
        std::min(most_bands.value_or(most_bands_ever), at_narrowest.value_or(most_bands_ever));
    BandSearch::KnownDelays known;  // a delay sufficient for some bands is so for more
    for (const std::size_t count : counts(*fewest, std::min(last, 32 * *fewest))) {
        double held_db = attenuation_db + rounding_db;
        const auto delay = search.delay_s(held_db, count, known);
        if (!delay) continue;
        known.enough_s = *delay;
        if (const auto point = best(search, count, *delay, held_db)) points.push_back(*point);
    }
}

// Bands against attenuation for one delay.
void add_by_delay(std::vector<TradePoint>& points, const BandSearch& search, double delay_s,
                  std::size_t last) {
    double held_db = 0.0;  // what some bands hold, more do
    for (const std::size_t count : counts(1, last))
        if (const auto point = best(search, count, delay_s, held_db)) points.push_back(*point);
}

// The point a design would take, put in its place among the others; one that it beats by nothing gives way.
std::size_t insert(std::vector<TradePoint>& points, const TradePoint& chosen, bool by_attenuation) {
    const auto key = [by_attenuation](const TradePoint& point) {
        return by_attenuation ? point.attenuation_db : static_cast<double>(point.bands);
    };
    const double near = by_attenuation ? 0.05 : 0.5;
    const auto same = [&](const TradePoint& point) { return std::abs(key(point) - key(chosen)) < near; };
    points.erase(std::remove_if(points.begin(), points.end(), same), points.end());
    const auto place = std::find_if(points.begin(), points.end(),
                                    [&](const TradePoint& point) { return key(point) > key(chosen); });
    const auto index = static_cast<std::size_t>(place - points.begin());
    points.insert(place, chosen);
    return index;
}

// Neither limit stated: the delay is that of the notches which settle soonest.
DesignGoal with_delay(const DesignGoal& goal, const BandSearch& search, std::string& reason,
                      const TableSpec& spec) {
    DesignGoal asked = goal;
    if (!asked.most_bands) asked.most_bands = frontier_bands;
    const auto soonest = search.soonest();
    asked.max_delay = Seconds(soonest.delay_s);
    reason = fmt::format(
        "the most attenuation that {} bands hold with notches that settle soonest at {:.4g} deg/s (Q {:.2g}, "
        "{:.0f} ms to {:.4g} %): more attenuation lags and settles longer, less delay rings longer",
        *asked.most_bands, goal.from.value(), soonest.q, 1e3 * soonest.settle_s, spec.settle_band_percent);
    return asked;
}

}  // namespace

Frontier design_frontier(TableSpec spec, DesignGoal goal) {
    if (goal.q) raise<UsageError>("the frontier is found by varying Q; leave --q out");
    if (!spec.bands.empty())
        raise<UsageError>("the frontier is found by varying the bands; give the speeds as FROM:TO");
    const bool by_attenuation = !goal.attenuation_db() && !goal.max_delay;
    DesignGoal probe = goal;
    // Any value, to have the other parts of the goal checked.
    if (by_attenuation) probe.max_delay = Seconds(1e9);
    if (by_attenuation && !probe.most_bands) probe.most_bands = 1;
    DesignChoice choice = design_for(spec, probe);
    const BandSearch search(spec, goal);
    Frontier frontier{spec, goal, {}, 0, choice.reason, std::nullopt};
    if (by_attenuation) choice = design_for(spec, with_delay(goal, search, frontier.reason, spec));
    auto& points = frontier.points;
    const auto most =
        goal.most_bands ? std::optional(static_cast<std::size_t>(*goal.most_bands)) : std::nullopt;
    if (by_attenuation) {
        add_by_attenuation(points, search, most.value_or(frontier_bands));
    } else if (goal.attenuation_db()) {
        add_by_bands(points, search, *goal.attenuation_db(),
                     goal.max_delay ? std::optional(goal.max_delay->value()) : std::nullopt, most);
    } else {
        add_by_delay(points, search, goal.max_delay->value(), most.value_or(2 * choice.table.bands().size()));
    }
    const TradePoint chosen = point_of(choice.table, search.together());
    frontier.recommended = insert(points, chosen, by_attenuation);
    frontier.slowest = slowest_within(spec, chosen.delay);
    return frontier;
}

}  // namespace ripplenotch
