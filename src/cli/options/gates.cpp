// SPDX-License-Identifier: MIT
#include "cli/options/gates.hpp"

#include <fmt/format.h>

#include "ripplenotch/core/number.hpp"
#include "ripplenotch/evaluate/ledger.hpp"

namespace ripplenotch {
namespace {

std::string excess(const Gates& gates, double delay_ms) {
    const double limit_ms = 1e3 * gates.max_delay->value();
    return fmt::format("delays by {:.1f} ms, {:.1f} ms more than --max-delay {:.6g}ms", delay_ms,
                       delay_ms - limit_ms, limit_ms);
}

}  // namespace

void attach_gates(Options& options, Gates& gates) {
    options.duration("--max-delay", gates.max_delay,
                     "exit code 1 when a method's DC delay is longer, e.g. 20ms");
    options.number("--min-attenuation", gates.min_attenuation_db, Dimension::decibel,
                   "exit code 1 when an order is attenuated less, e.g. 20dB");
}

std::vector<std::string> delay_violations(const Gates& gates, const Contender& contender, Hertz sample_rate,
                                          DegPerSec slowest, DegPerSec fastest) {
    std::vector<std::string> sentences;
    if (!gates.max_delay) return sentences;
    if (contender.table != nullptr) {
        for (const Band& band : contender.table->bands()) {
            if (!(band.from < fastest) || band.to < slowest) continue;
            const double delay_ms =
                1e3 * group_delay(band.cascade(), Hertz(0.0), SampledAt(sample_rate)).value();
            if (delay_ms <= 1e3 * gates.max_delay->value()) continue;
            sentences.push_back(fmt::format("{}: band {} ({:.6g}-{:.6g} deg/s) {}", contender.text,
                                            band.number, band.from.value(), band.to.value(),
                                            excess(gates, delay_ms)));
        }
        return sentences;
    }
    const LongestDelay longest = longest_delay(contender, sample_rate, {slowest, fastest});
    const double delay_ms = 1e3 * longest.delay.value();
    if (delay_ms <= 1e3 * gates.max_delay->value()) return sentences;
    std::string sentence = fmt::format("{}: it {}", contender.text, excess(gates, delay_ms));
    if (contender.made_for()) {
        sentence += fmt::format(" at {:.4g} deg/s", longest.speed.value());
        const auto from = within_from(contender, sample_rate, *gates.max_delay);
        if (from) sentence += fmt::format("; from {:.3g} deg/s on it stays within", from->value());
    }
    sentences.push_back(std::move(sentence));
    return sentences;
}

std::vector<std::string> attenuation_violations(const Gates& gates, const std::string& method,
                                                std::span<const OrderAttenuation> orders) {
    std::vector<std::string> sentences;
    if (!gates.min_attenuation_db) return sentences;
    const std::string limit = shortest(*gates.min_attenuation_db);
    for (const OrderAttenuation& entry : orders) {
        if (!entry.db) {
            sentences.push_back(fmt::format(
                "{}: order {:g} could not be measured, so --min-attenuation {}dB is not shown to hold",
                method, entry.order, limit));
        } else if (!(*entry.db >= *gates.min_attenuation_db)) {
            sentences.push_back(
                fmt::format("{}: it takes {:.1f} dB off order {:g}, {:.1f} dB less than "
                            "--min-attenuation {}dB",
                            method, *entry.db, entry.order, *gates.min_attenuation_db - *entry.db, limit));
        }
    }
    return sentences;
}

std::vector<std::string> filter_violations(const Gates& gates, const Contender& contender,
                                           const FilterMetrics& metrics) {
    const StreamReport& stream = metrics.stream;
    auto found = delay_violations(gates, contender, metrics.sample_rate, DegPerSec(stream.slowest_deg_s),
                                  DegPerSec(stream.fastest_deg_s));
    if (!metrics.levels) return found;
    std::vector<OrderAttenuation> orders;
    for (const OrderLevel& level : metrics.levels->orders) {
        OrderAttenuation entry{level.order, level.mean_hz, std::nullopt};
        if (level.windows > 0) entry.db = attenuation_db(level).value_or(most_attenuation_db);
        orders.push_back(entry);
    }
    for (std::string& sentence : attenuation_violations(gates, metrics.method, orders))
        found.push_back(std::move(sentence));
    for (std::string& sentence : found) sentence.insert(0, metrics.source + ": ");
    return found;
}

}  // namespace ripplenotch
