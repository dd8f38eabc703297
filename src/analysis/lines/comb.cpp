// SPDX-License-Identifier: MIT
#include "analysis/lines/comb.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

constexpr int most_alone = 8, most_besides = 16;  // by hand: n of a line alone, and beside others
constexpr double match_share = 0.006;  // a line lies on a comb within this share, or four standard errors
constexpr double same_ratio_share = 0.008;  // candidates nearer than this are one
constexpr double listed_share = 0.004;      // by hand: half of same_ratio_share
// Set by judgement, as are the shares of alone_nats(): there are no published statistics of what ripple lines
// robots show. That all lines seen are even, or multiples of three and more, happens, and more rarely; a line
// off the comb is a mistake of the finder or of the comb. scripts/prove-identify shows what they come to.
constexpr double even_nats = -1.6, coarse_nats = -3.0, unexplained_nats = -2.0;

double tolerance(const OrderLine& line) {
    return std::max(match_share * line.order_output, 4.0 * line.error);
}

std::optional<int> place_on(double ratio, const OrderLine& line) {
    const int n = static_cast<int>(std::lround(line.order_output / ratio));
    if (n < 1 || n > most_besides || std::abs(line.order_output - n * ratio) > tolerance(line))
        return std::nullopt;
    return n;
}

/// The n of a line found alone. The wave generator is an ellipse, so that what the gear does repeats twice a
/// turn of the motor: n = 2 nearly always leads, its multiples follow, and n = 1, from eccentric parts, is
/// often missing (Tuttle and Seering, IEEE Trans. Robotics and Automation 12, 1996). The shares are
/// judgement.
double alone_nats(int n) {
    constexpr std::array share{0.25, 0.55, 0.02, 0.06, 0.01, 0.04, 0.01, 0.06};
    return portable::log(share[static_cast<std::size_t>(n - 1)]);
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
            comb.nats += weight * -portable::log(chance);
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
    if (!usual_ratio(comb.ratio)) {
        comb.nats += unusual_nats;
        comb.reason += fmt::format("; outside {:.0f} to {:.0f}, where ratios of joints lie",
                                   lowest_usual_ratio, highest_usual_ratio);
    }
    comb.listed = listed_ratio(comb.ratio);
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

}  // namespace

std::optional<double> listed_ratio(double ratio) {
    for (const double listed : catalogue_ratios) {
        if (std::abs(ratio - listed) < listed_share * listed) return listed;
    }
    return std::nullopt;
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

}  // namespace ripplenotch
