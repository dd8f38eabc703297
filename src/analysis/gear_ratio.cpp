// SPDX-License-Identifier: MIT
#include "ripplenotch/analysis/gear_ratio.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>

#include "analysis/excess_scatter.hpp"

namespace ripplenotch {
namespace {

constexpr int most_alone = 8, most_besides = 16;
constexpr double match_share = 0.006;  // a line lies on a comb within this share, or four standard errors
constexpr double same_ratio_share = 0.008;  // candidates nearer than this are one
constexpr double hint_share = 0.015;
constexpr double least_scale_error = 0.0005;
constexpr double least_score = 0.7;
constexpr double lowest_usual = 25.0, highest_usual = 320.0;
constexpr std::array catalogue{30.0, 50.0, 80.0, 100.0, 101.0, 120.0, 121.0, 160.0, 161.0};
// In nats: how much likelier each makes a candidate.
constexpr double catalogue_nats = 1.5, unusual_nats = -5.0, hint_nats = 8.0, even_nats = -1.6,
                 coarse_nats = -3.0;
constexpr double unexplained_nats = -2.0;

struct Comb {
    double ratio = 0.0;
    std::vector<std::optional<int>> n;  // per line
    double nats = 0.0;
    int common = 0;  // greatest common divisor of the n
    std::size_t matches = 0;
    std::optional<double> listed;  // the catalogue's value, when it lies on one
    bool hinted = false;
    std::string reason;
};

double tolerance(const OrderLine& line) {
    return std::max(match_share * line.order_output, 4.0 * line.error);
}

std::optional<int> place_on(double ratio, const OrderLine& line) {
    const int n = static_cast<int>(std::lround(line.order_output / ratio));
    if (n < 1 || n > most_besides || std::abs(line.order_output - n * ratio) > tolerance(line))
        return std::nullopt;
    return n;
}

/// What is known of drives in general about the n of a line found alone: n = 2 nearly always leads, n = 1 is
/// often missing.
double alone_nats(int n) {
    constexpr std::array share{0.25, 0.55, 0.02, 0.06, 0.01, 0.04, 0.01, 0.06};
    return std::log(share[static_cast<std::size_t>(n - 1)]);
}

/// The ratio that fits the matched lines best, by weighted least squares, the weights from their errors.
double weighted_ratio(std::span<const OrderLine> lines, const Comb& comb) {
    double top = 0.0, bottom = 0.0;
    for (std::size_t i = 0; i < lines.size(); ++i) {
        if (!comb.n[i]) continue;
        const double error = std::max(lines[i].error, 1e-4 * lines[i].order_output) / *comb.n[i];
        top += lines[i].order_output / *comb.n[i] / (error * error);
        bottom += 1.0 / (error * error);
    }
    return bottom > 0.0 ? top / bottom : comb.ratio;
}

Comb matched(double ratio, std::span<const OrderLine> lines) {
    Comb comb;
    comb.ratio = ratio;
    for (int round = 0; round < 2; ++round) {
        comb.n.clear();
        for (const OrderLine& line : lines) comb.n.push_back(place_on(comb.ratio, line));
        comb.ratio = weighted_ratio(lines, comb);
    }
    for (const auto& n : comb.n) {
        if (!n) continue;
        comb.common = std::gcd(comb.common, *n);
        ++comb.matches;
    }
    return comb;
}

void judge(Comb& comb, std::span<const OrderLine> lines, std::optional<GearRatio> hint,
           std::span<const int> hinted_orders) {
    double strongest = 0.0;
    for (const OrderLine& line : lines) strongest = std::max(strongest, line.amplitude_nm);
    std::vector<int> orders;
    for (std::size_t i = 0; i < lines.size(); ++i) {
        const double weight =
            std::min(1.0, 2.0 * lines[i].amplitude_nm / strongest);  // weak lines count less
        if (comb.n[i]) {
            const double chance = std::min(0.9, 2.0 * tolerance(lines[i]) / comb.ratio);
            comb.nats += weight * -std::log(chance);
            orders.push_back(*comb.n[i]);
        } else {
            comb.nats += weight * unexplained_nats;
        }
    }
    std::sort(orders.begin(), orders.end());
    orders.erase(std::unique(orders.begin(), orders.end()), orders.end());
    comb.reason = fmt::format("lines at n = {}", fmt::join(orders, ", "));
    if (orders.size() == 1) {
        comb.nats += orders.front() <= most_alone ? alone_nats(orders.front()) : -6.0;
        if (orders.front() == 2) comb.reason += ", where a lone line usually is";
    } else if (comb.common == 2) {
        comb.nats += even_nats;
        comb.reason += fmt::format("; no odd line tells it from {:.4g}", 2.0 * comb.ratio);
    } else if (comb.common > 2) {
        comb.nats += coarse_nats;
        comb.reason += fmt::format("; all are multiples of {}", comb.common);
    }
    if (comb.ratio < lowest_usual || comb.ratio > highest_usual) {
        comb.nats += unusual_nats;
        comb.reason += fmt::format("; outside {:.0f} to {:.0f}, where ratios of joints lie", lowest_usual,
                                   highest_usual);
    }
    for (const double listed : catalogue) {
        if (std::abs(comb.ratio - listed) < 0.004 * listed) comb.listed = listed;
    }
    if (comb.listed) {
        comb.nats += catalogue_nats;
        comb.reason += fmt::format("; {:.0f} is a catalogue ratio", *comb.listed);
    }
    if (hint && std::abs(comb.ratio - hint->value()) < hint_share * hint->value()) {
        comb.nats += hint_nats;
        comb.hinted = true;
        comb.reason += fmt::format("; agrees with the hint {:.6g}", hint->value());
    }
    for (std::size_t i = 0; i < lines.size(); ++i) {
        const bool leads = lines[i].amplitude_nm == strongest && comb.n[i];
        if (!leads ||
            std::find(hinted_orders.begin(), hinted_orders.end(), *comb.n[i]) == hinted_orders.end())
            continue;
        comb.nats += hint_nats;
        comb.hinted = true;
        comb.reason += fmt::format("; its strongest line is at n = {}, as hinted", *comb.n[i]);
        break;
    }
}

std::vector<Comb> all_combs(std::span<const OrderLine> lines, std::optional<GearRatio> hint,
                            std::span<const int> hinted_orders) {
    std::vector<Comb> combs;
    const auto add = [&](double ratio) {
        Comb comb = matched(ratio, lines);
        if (comb.matches == 0) return;
        const bool known = std::any_of(combs.begin(), combs.end(), [&](const Comb& other) {
            return std::abs(other.ratio - comb.ratio) < same_ratio_share * comb.ratio && other.n == comb.n;
        });
        if (known) return;
        judge(comb, lines, hint, hinted_orders);
        combs.push_back(std::move(comb));
    };
    if (hint) add(hint->value());
    for (const OrderLine& line : lines) {
        for (int n = 1; n <= most_alone; ++n) add(line.order_output / n);
        for (const int n : hinted_orders) add(line.order_output / n);
    }
    std::stable_sort(combs.begin(), combs.end(),
                     [](const Comb& a, const Comb& b) { return a.nats > b.nats; });
    // Slightly different ratios that miss different weak lines are one candidate, the better one.
    std::vector<Comb> apart;
    for (Comb& comb : combs) {
        const bool shadowed = std::any_of(apart.begin(), apart.end(), [&](const Comb& better) {
            return std::abs(better.ratio - comb.ratio) < same_ratio_share * comb.ratio;
        });
        if (!shadowed) apart.push_back(std::move(comb));
    }
    return apart;
}

/// Two-sided 95 % quantile of Student's t.
double student_95(double freedom) {
    constexpr std::array table{12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228};
    if (freedom <= 10.0) return table[static_cast<std::size_t>(std::max(freedom, 1.0)) - 1];
    return 1.960 + 2.4 / freedom + 3.5 / (freedom * freedom);
}

/// What one source (a stretch of one speed, or a line over a whole motion) says about the ratio.
struct Estimate {
    double ratio = 0.0, variance = 0.0, weight = 1.0;
};

std::map<std::size_t, Estimate> by_source(std::span<const OrderLine> lines, const Comb& comb) {
    std::map<std::size_t, Estimate> estimates;
    std::map<std::size_t, double> bottom, speed_error;
    for (std::size_t i = 0; i < lines.size(); ++i) {
        if (!comb.n[i]) continue;
        for (const OrderObservation& seen : lines[i].observations) {
            const double ratio = seen.order_output / *comb.n[i];
            const double error = std::max(seen.error, 1e-7 * seen.order_output) / *comb.n[i];
            estimates[seen.source].ratio += ratio / (error * error);
            bottom[seen.source] += 1.0 / (error * error);
            speed_error[seen.source] = std::max(speed_error[seen.source], seen.speed_share_error);
        }
    }
    for (auto& [source, estimate] : estimates) {
        estimate.ratio /= bottom[source];
        const double shared = estimate.ratio * speed_error[source];
        estimate.variance = 1.0 / bottom[source] + shared * shared;
    }
    return estimates;
}

void fit(std::span<const OrderLine> lines, const Comb& comb, GearRatioFit& result) {
    auto estimates = by_source(lines, comb);
    constexpr double huber = 1.345;
    double ratio = comb.ratio, scale = 1.0, bottom = 0.0;
    const auto freedom = static_cast<double>(estimates.size()) - 1.0;
    for (int round = 0; round < 30; ++round) {
        double top = 0.0, misfit = 0.0;
        bottom = 0.0;
        for (auto& [source, e] : estimates) {
            const double off = std::abs(e.ratio - ratio) / (scale * std::sqrt(e.variance));
            e.weight = round == 0 || off <= huber ? 1.0 : huber / off;
            top += e.weight * e.ratio / e.variance;
            bottom += e.weight / e.variance;
        }
        ratio = top / bottom;
        for (const auto& [source, e] : estimates)
            misfit += e.weight * (e.ratio - ratio) * (e.ratio - ratio) / e.variance;
        scale = excess_scatter(misfit, freedom);
    }
    result.value = ratio;
    result.standard_error = scale / std::sqrt(bottom);
    const double reach = (scale > 1.0 ? student_95(freedom) : 1.960) * result.standard_error;
    result.ci95_low = ratio - reach;
    result.ci95_high = ratio + reach;
    for (std::size_t i = 0; i < lines.size(); ++i) {
        if (!comb.n[i]) continue;
        for (const OrderObservation& seen : lines[i].observations) {
            const double expected = *comb.n[i] * ratio * std::abs(seen.speed_deg_s) / 360.0;
            result.residuals.push_back({seen.speed_deg_s, seen.hz, static_cast<double>(*comb.n[i]),
                                        seen.hz - expected, estimates[seen.source].weight});
        }
    }
}

/// Factors by which a wrong unit of the speed scales a ratio: the apparent ratio times the factor is the true
/// one.
void name_wrong_units(const Comb& comb, std::optional<GearRatio> hint, GearRatioResult& result) {
    struct Slip {
        double factor;
        std::string_view what;
    };
    const std::array slips{Slip{1.0 / degrees_per_radian, "the speed is in rad/s, not deg/s"},
                           Slip{degrees_per_radian, "the speed is in deg/s, not rad/s"},
                           Slip{1.0 / 6.0, "the speed is in rpm, not deg/s"},
                           Slip{6.0, "the speed is in deg/s, not rpm"},
                           Slip{1.0 / 60.0, "the speed is off by 60"},
                           Slip{60.0, "the speed is off by 60"},
                           Slip{1.0 / 360.0, "the speed is in turns/s, not deg/s"},
                           Slip{360.0, "the speed is in deg/s, not turns/s"}};
    const bool odd_size = comb.ratio < lowest_usual || comb.ratio > highest_usual;
    for (const Slip& slip : slips) {
        const double ratio = comb.ratio * slip.factor;
        const bool near_hint = hint && std::abs(ratio - hint->value()) < 0.01 * hint->value();
        const bool listed = std::any_of(catalogue.begin(), catalogue.end(), [&](double known) {
            return std::abs(ratio - known) < 0.004 * known;
        });
        if (!near_hint && !(odd_size && listed)) continue;
        result.fit.candidates.push_back({ratio, 0.0, fmt::format("if {}", slip.what)});
        result.notes.push_back(
            fmt::format("a ratio of {:.4g} would be {:.4g} if {}", comb.ratio, ratio, slip.what));
    }
}

/// A ratio is a ratio of teeth: when the lines lie off the hinted one by more than their errors allow and by
/// little, the speed's or position's scale is the likelier culprit.
void name_scale_error(GearRatio hint, GearRatioResult& result) {
    if (!result.fit.value) return;
    const double share = *result.fit.value / hint.value() - 1.0;
    const double doubt = 0.5 * (result.fit.ci95_high - result.fit.ci95_low) / hint.value();
    if (std::abs(share) < least_scale_error || std::abs(share) < 1.5 * doubt || std::abs(share) > hint_share)
        return;
    const std::string what = fmt::format("the velocity's or position's scale reads {:.2f} % {}",
                                         100.0 * std::abs(share), share < 0.0 ? "high" : "low");
    result.fit.candidates.push_back({hint.value(), 0.0, "if " + what});
    result.notes.push_back(fmt::format(
        "the ratio {:.6g} is {:+.2f} % from the hint {:.6g}, more than its error of {:.2f} %: the "
        "likely cause is that {}, or that a time column runs off by that much; a gear ratio that "
        "odd is unlikely",
        *result.fit.value, 100.0 * share, hint.value(), 100.0 * doubt, what));
}

void check_hint(const std::vector<Comb>& combs, std::span<const OrderLine> lines, GearRatio hint,
                std::vector<std::string>& notes) {
    if (std::any_of(combs.begin(), combs.end(), [](const Comb& comb) { return comb.hinted; })) return;
    const OrderLine& first = lines.front();
    const double n = std::max(1.0, std::round(first.order_output / hint.value()));
    const double off = 100.0 * (first.order_output / (n * hint.value()) - 1.0);
    notes.push_back(fmt::format(
        "the hint {:.6g} is not supported: output order {:.5g} is {:+.2f} % from {:.0f} times it, more than "
        "its error allows; a speed or position scale wrong by that much would explain it",
        hint.value(), first.order_output, off, n));
    const double clock = first.order_output / (2.0 * hint.value());
    notes.push_back(
        fmt::format("were that line at n = 2 of {:.6g}, a clock (nominal sample rate) {:.3g} times "
                    "{} would explain "
                    "it, where the log has no position",
                    hint.value(), clock > 1.0 ? clock : 1.0 / clock, clock > 1.0 ? "too fast" : "too slow"));
}

}  // namespace

GearRatioResult fit_gear_ratio(std::span<const OrderLine> lines, std::optional<GearRatio> hint,
                               std::span<const int> hinted_orders) {
    GearRatioResult result;
    result.order_of_line.resize(lines.size());
    if (lines.empty()) return result;
    const std::vector<Comb> combs = all_combs(lines, hint, hinted_orders);
    if (combs.empty()) return result;
    double total = 0.0;
    for (const Comb& comb : combs) total += std::exp(comb.nats - combs.front().nats);
    for (const Comb& comb : combs) {
        const double score = std::exp(comb.nats - combs.front().nats) / total;
        if (score < 0.005 || result.fit.candidates.size() >= 8) break;
        result.fit.candidates.push_back({comb.ratio, score, comb.reason});
    }
    const Comb& best = combs.front();
    name_wrong_units(best, hint, result);
    if (hint) check_hint(combs, lines, *hint, result.notes);
    if (!hinted_orders.empty() && !hint &&
        std::none_of(combs.begin(), combs.end(), [](const Comb& comb) { return comb.hinted; })) {
        result.notes.push_back("no comb puts the strongest line at a hinted order");
    }
    const bool certain = std::any_of(lines.begin(), lines.end(), [&](const OrderLine& line) {
        return line.certain && best.n[static_cast<std::size_t>(&line - lines.data())];
    });
    if (result.fit.candidates.front().score < least_score) return result;
    if (!certain && !best.hinted && !best.listed) return result;
    result.order_of_line = best.n;
    fit(lines, best, result.fit);
    // The robust fit moves the value a little from where the comparison of combs left it; one ratio, one
    // number.
    if (result.fit.value) result.fit.candidates.front().value = *result.fit.value;
    if (hint && best.hinted) name_scale_error(*hint, result);
    return result;
}

}  // namespace ripplenotch
