// SPDX-License-Identifier: MIT
#include "ripplenotch/design/guarantee.hpp"

#include <fmt/format.h>

#include <cmath>

#include "design/band_fit.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

template <class... Args>
[[noreturn]] void refuse(fmt::format_string<Args...> format, Args&&... args) {
    throw Error(ExitCode::limit_violated, fmt::format(format, std::forward<Args>(args)...));
}

std::string plain(double value) { return fmt::format("{:.4g}", value); }

double db_of(double gain) { return -20.0 * portable::log10(gain); }

void check_goal(const TableSpec& spec, const DesignGoal& goal) {
    if (!goal.min_attenuation_db && !goal.max_delay)
        raise<UsageError>("nothing is asked of the table: no attenuation and no delay");
    check_ripple(spec);
    if (goal.q && !(*goal.q > 0.0)) raise<UsageError>("notch Q {} is not above 0", shortest(*goal.q));
    if (goal.min_attenuation_db && !(*goal.min_attenuation_db > 0.0 && *goal.min_attenuation_db <= 120.0)) {
        raise<UsageError>("an attenuation of {} dB is outside 0 to 120 dB",
                          shortest(*goal.min_attenuation_db));
    }
    if (goal.max_delay && !(goal.max_delay->value() > 0.0))
        raise<UsageError>("a delay of {} ms is not above 0", shortest(1e3 * goal.max_delay->value()));
}

// A search works with lines below half the sample rate only: above it they come back as something else.
void check_speeds(const TableSpec& spec, const DesignGoal& goal) {
    const bool fixed = !spec.bands.empty();
    const double from = fixed ? spec.bands.front().first.value() : goal.from.value();
    const double to = fixed ? spec.bands.back().second.value() : goal.to.value();
    if (!(from > 0.0)) {
        raise<UsageError>(
            "speeds from {} deg/s: no notch holds anything at standstill, where the line lies at 0 Hz; start "
            "above 0",
            plain(from));
    }
    if (!(from < to)) raise<UsageError>("speeds {} to {} deg/s: they must go up", plain(from), plain(to));
    const Hertz highest =
        ripple_frequency(spec.orders.back(), spec.gear_ratio, DegPerSec(to * (1.0 + spec.ratio_error)));
    if (!(highest < 0.5 * spec.sample_rate)) {
        raise<UsageError>(
            "{} reaches half the sample rate, {} Hz, at {} deg/s; end the speeds below, or leave the order "
            "out",
            order_in_words(spec.orders.back(), spec.gear_ratio), plain(0.5 * spec.sample_rate.value()),
            plain(to * 0.5 * spec.sample_rate.value() / highest.value()));
    }
}

std::string delay_text(double delay_s) { return fmt::format("{} ms", plain(1e3 * delay_s)); }

// Notches of every width that a design may take are too slow at the lowest speed.
[[noreturn]] void refuse_delay(const TableSpec& spec, double from, double limit_s, double least_s,
                               const std::string& q) {
    const auto slowest = slowest_within(spec, Seconds(limit_s));
    refuse(
        "--max-delay {} cannot be met at {} deg/s: notches of Q {} delay by {} there{}; start the speeds "
        "higher or leave more delay",
        delay_text(limit_s), plain(from), q, delay_text(least_s),
        slowest && q == plain(narrowest_q)
            ? fmt::format(", and by no more than that only from {} deg/s on", plain(slowest->value()))
            : "");
}

// Not even a band of one single speed holds the attenuation: reports the reason.
[[noreturn]] void refuse_attenuation(const TableSpec& spec, const DesignGoal& goal, const BandSearch& search,
                                     const QRule& rule) {
    const double wanted = *goal.min_attenuation_db;
    const auto best_db = [&](double speed) {
        const auto tuning = search.fit().tune(speed, rule);
        return tuning ? db_of(search.fit().worst_gain(*tuning, speed, speed)) : 0.0;
    };
    double speed = goal.from.value();
    if (best_db(speed) >= wanted) speed = goal.to.value();
    const double best = best_db(speed);
    if (best >= wanted) {
        refuse("{} {} dB takes more than {} bands; ask for less, or for fewer speeds", "--min-attenuation",
               plain(wanted), max_bands_ever);
    }
    const std::string notches = fmt::format("notches of Q {}", plain(search.fit().tune(speed, rule)->q));
    const std::string within =
        goal.max_delay && !goal.q ? fmt::format(" within --max-delay {}", delay_text(goal.max_delay->value()))
                                  : "";
    if (spec.ratio_error > 0.0) {
        refuse(
            "{} {} dB cannot be held at {} deg/s{}: on a gear ratio that may be {} % off, {} hold {:.1f} dB "
            "at most; measure the ratio better, or leave more delay",
            "--min-attenuation", plain(wanted), plain(speed), within, plain(100.0 * spec.ratio_error),
            notches, best);
    }
    refuse("{} {} dB cannot be held at {} deg/s{}: {}{} hold {:.1f} dB at their centre", "--min-attenuation",
           plain(wanted), plain(speed), within, notches,
           spec.depth_db < infinite_depth_db ? fmt::format(" and --depth {} dB", plain(spec.depth_db)) : "",
           best);
}

// The delay that the Qs are chosen for, and why.
struct Budget {
    std::optional<double> delay_s;
    std::string reason;
};

Budget budget_of(const TableSpec& spec, const DesignGoal& goal, const BandSearch& search) {
    if (goal.q) return {std::nullopt, fmt::format("at Q {}", shortest(*goal.q))};
    if (goal.max_delay) {
        const double limit = goal.max_delay->value(), least = search.min_delay_s();
        if (!search.fit().tune(goal.from.value(), search.rule(limit)))
            refuse_delay(spec, goal.from.value(), limit, least, plain(narrowest_q));
        return {limit, fmt::format("within {}", delay_text(limit))};
    }
    const auto soonest = search.soonest();
    return {soonest.delay_s, fmt::format("with notches that settle soonest at {} deg/s (Q {}, {:.0f} ms to "
                                         "{} %): wider ones lag more, narrower ones ring longer",
                                         plain(goal.from.value()), fmt::format("{:.2g}", soonest.q),
                                         1e3 * soonest.settle_s, plain(spec.settle_band_percent))};
}

void check_held(const CandidateTable& table, const DesignGoal& goal) {
    for (const Band& band : table.bands()) {
        if (goal.max_delay && !(band.dc_delay.value() <= goal.max_delay->value() * (1.0 + 1e-9)))
            refuse_delay(table.spec(), band.from.value(), goal.max_delay->value(), band.dc_delay.value(),
                         plain(band.notches.front().notch.q));
        if (goal.min_attenuation_db && !(band.least_attenuation_db() >= *goal.min_attenuation_db))
            throw std::logic_error("a designed band does not hold what it was designed for");
    }
}

DesignChoice choose_bands(const TableSpec& spec, const DesignGoal& goal) {
    const BandSearch search(spec, goal);
    const Budget budget = budget_of(spec, goal, search);
    const QRule rule = search.rule(budget.delay_s);
    std::size_t count = 0;
    double held_db = 0.0;
    std::string reason;
    if (goal.min_attenuation_db) {
        held_db = *goal.min_attenuation_db + rounding_db;
        const auto needed = search.bands(held_db, rule);
        if (!needed) refuse_attenuation(spec, goal, search, rule);
        count = *needed;
        reason = fmt::format("the fewest bands that hold {} dB {}", plain(*goal.min_attenuation_db),
                             budget.reason);
    } else {
        count = search.bands_worth_it(rule);
        reason = fmt::format("the most attenuation {} until a further band adds less than {} dB",
                             budget.reason, plain(gain_worth_a_band_db));
    }
    const auto held = search.attenuation_db(count, rule, 0.0, held_db);
    if (!held) refuse("{} bands hold nothing {}", count, budget.reason);
    CandidateTable table = search.table(*held, rule);
    check_held(table, goal);
    return {std::move(table), reason};
}

// The highest Q, so the least delay, with which a band holds the attenuation; 0 when none does.
double highest_q(const BandFit& fit, double from, double to, double max_gain) {
    const auto held = [&](double q) {
        const QRule rule{q, std::nullopt};
        return fit.worst_gain(*fit.balanced(from, to, rule), from, to) <= max_gain;
    };
    double low = widest_q, high = narrowest_q;
    if (!held(low)) return 0.0;
    if (held(high)) return high;
    while (high / low > 1.0 + 1e-7) (held(std::sqrt(low * high)) ? low : high) = std::sqrt(low * high);
    return low;
}

Band fixed_band(const TableSpec& spec, const DesignGoal& goal, const BandFit& fit, std::size_t i) {
    const auto [from, to] = spec.bands[i];
    const int number = static_cast<int>(i) + 1;
    const std::string label =
        fmt::format("band {} ({}-{} deg/s)", number, plain(from.value()), plain(to.value()));
    QRule rule;
    if (goal.min_attenuation_db) {
        const double wanted = *goal.min_attenuation_db;
        rule.q =
            highest_q(fit, from.value(), to.value(), portable::pow(10.0, -(wanted + rounding_db) / 20.0));
        if (*rule.q == 0.0) {
            const Band widest = band_of(spec, number, from, to,
                                        *fit.balanced(from.value(), to.value(), {widest_q, std::nullopt}));
            refuse(
                "{}: notches as wide as Q {} hold {:.1f} dB, less than {} {} dB; make the band narrower, or "
                "leave the bands to the design",
                label, plain(widest_q), widest.least_attenuation_db(), "--min-attenuation", plain(wanted));
        }
    } else {
        rule.delay_s = goal.max_delay->value();
    }
    const auto tuning = fit.balanced(from.value(), to.value(), rule);
    if (!tuning) {
        const Tuning narrow = *fit.tune(to.value(), {narrowest_q, std::nullopt});
        refuse_delay(spec, from.value(), goal.max_delay->value(), fit.delay_s(narrow), plain(narrowest_q));
    }
    Band band = band_of(spec, number, from, to, *tuning);
    if (goal.max_delay && !(band.dc_delay.value() <= goal.max_delay->value() * (1.0 + 1e-9))) {
        refuse(
            "{}: holding {} dB takes Q {}, which delays by {}, more than --max-delay {}; make the band "
            "narrower, or leave the bands to the design",
            label, plain(goal.min_attenuation_db.value_or(0.0)), plain(band.notches[0].notch.q),
            delay_text(band.dc_delay.value()), delay_text(goal.max_delay->value()));
    }
    return band;
}

DesignChoice choose_widths(const TableSpec& spec, const DesignGoal& goal) {
    TableSpec open = spec;
    open.bands.clear();
    const BandFit fit(open);
    std::vector<Band> bands;
    for (std::size_t i = 0; i < spec.bands.size(); ++i) bands.push_back(fixed_band(spec, goal, fit, i));
    open.q = bands.front().notches.front().notch.q;
    CandidateTable table = CandidateTable::from_bands(open, std::move(bands));
    check_held(table, goal);
    if (goal.min_attenuation_db) {
        return {std::move(table), fmt::format("the least delay with which each of these bands holds {} dB",
                                              plain(*goal.min_attenuation_db))};
    }
    return {std::move(table), fmt::format("the most attenuation of these bands within {}",
                                          delay_text(goal.max_delay->value()))};
}

}  // namespace

DesignChoice design_for(TableSpec spec, const DesignGoal& goal) {
    check_goal(spec, goal);
    check_speeds(spec, goal);
    if (spec.bands.empty()) return choose_bands(spec, goal);
    if (goal.q)
        raise<UsageError>(
            "bands and Q are both stated; nothing is left to choose for an attenuation or a delay");
    return choose_widths(spec, goal);
}

std::optional<DegPerSec> slowest_within(const TableSpec& spec, Seconds delay) {
    const BandFit fit(spec);
    const auto within = [&](double speed) {
        return fit.delay_s(*fit.tune(speed, {narrowest_q, std::nullopt})) <= delay.value();
    };
    double high = 180.0 * spec.sample_rate.value() * (1.0 - 1e-9) /
                  (spec.orders.back().value() * spec.gear_ratio.value());
    if (!within(high)) return std::nullopt;
    double low = 1e-9 * high;
    while (high / low > 1.0 + 1e-9) (within(std::sqrt(low * high)) ? high : low) = std::sqrt(low * high);
    return DegPerSec(high);
}

std::string slowest_sentence(Seconds delay, DegPerSec slowest) {
    return fmt::format("Below {:.4g} deg/s no notch of Q 5 or less is within {:.4g} ms.", slowest.value(),
                       1e3 * delay.value());
}

}  // namespace ripplenotch
