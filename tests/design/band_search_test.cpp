// SPDX-License-Identifier: MIT
// What a search is told beforehand, and what it finds out sooner, changes nothing of what it finds.
#include "design/band_fit.hpp"

#include <cmath>

#include "support/catch.hpp"

using namespace ripplenotch;
using namespace ripplenotch::literals;

namespace {

TableSpec searched_ripple(WidthRule width, std::vector<double> amplitudes_nm) {
    TableSpec spec;
    spec.gear_ratio = GearRatio(100.0);
    spec.orders = {Order(1.0), Order(2.0)};
    spec.sample_rate = 1000_Hz;
    spec.width = width;
    spec.amplitude_nm = std::move(amplitudes_nm);
    return spec;
}

}  // namespace

TEST_CASE("the Q for a delay is the one that halving alone comes to, to the last bit") {
    for (const WidthRule width : {WidthRule::analog, WidthRule::digital}) {
        const TableSpec spec = searched_ripple(width, {});
        const BandFit fit(spec, {});
        const auto delay_s = [&](double center_deg_s, double q) {
            return fit.delay_s(*fit.tune(center_deg_s, {q, std::nullopt}));
        };
        for (double center_deg_s = 3.0; center_deg_s < 800.0; center_deg_s *= 1.3) {
            for (double most_s = 1e-4; most_s < 1.0; most_s *= 1.5) {
                INFO(center_deg_s << " deg/s, " << most_s << " s");
                const auto found = fit.tune(center_deg_s, {std::nullopt, most_s});
                double low = widest_q, high = narrowest_q;
                // A digital notch of a Q below f over half the sample rate would be wider than that half.
                const double line_hz = center_deg_s * 2.0 * 100.0 / 360.0;
                if (width == WidthRule::digital) low = std::max(low, (1.0 + 1e-6) * line_hz / 500.0);
                const bool begins_lower = low == widest_q;
                if (delay_s(center_deg_s, low) <= most_s) {
                    high = low;
                } else if (!(delay_s(center_deg_s, high) <= most_s)) {
                    REQUIRE(!found);
                    continue;
                }
                while (high - low > 1e-9 * high) {
                    const double middle = std::sqrt(low * high);
                    (delay_s(center_deg_s, middle) <= most_s ? high : low) = middle;
                }
                REQUIRE(found);
                // Of a search that begins elsewhere by a bit no more is equal than it is exact.
                if (begins_lower)
                    REQUIRE(found->q.front() == high);
                else
                    REQUIRE(found->q.front() == Approx(high).epsilon(2e-9));
            }
        }
    }
}

TEST_CASE("what is known of an attenuation or a delay spares looks and changes no result") {
    for (const auto& amplitudes_nm : {std::vector<double>{}, std::vector<double>{0.8, 0.1}}) {
        const TableSpec spec = searched_ripple(WidthRule::analog, amplitudes_nm);
        DesignGoal goal;
        goal.from = 18_deg_s;
        goal.to = 120_deg_s;
        const BandSearch search(spec, goal);
        std::optional<double> before_s;
        for (const std::size_t bands : {3U, 5U, 9U}) {
            const auto least_s = search.delay_s(20.0, bands, {});
            REQUIRE(least_s);
            if (before_s) CHECK(search.delay_s(20.0, bands, {0.0, *before_s}) == least_s);
            const auto more_s = search.delay_s(25.0, bands, {});
            CHECK(search.delay_s(25.0, bands, {*least_s * (1.0 - delay_as_exact), 1e9}) == more_s);
            const auto held_db = search.attenuation_db(bands, search.rule(*least_s));
            REQUIRE(held_db);
            CHECK(*held_db >= 20.0);
            CHECK(search.attenuation_db(bands, search.rule(*least_s), 0.0, 20.0) == held_db);
            before_s = least_s;
        }
    }
}
