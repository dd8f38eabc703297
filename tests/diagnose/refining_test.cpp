// SPDX-License-Identifier: MIT
// Beside a leftover: shapes are refined until that is worth nothing, and what rings in a ripple is sought
// from each of its beginnings.
#include <algorithm>

#include "bench_fixture.hpp"
#include "core/rows/rms.hpp"
#include "diagnose/beside/naming/exchanges.hpp"
#include "diagnose/beside/naming/ringing.hpp"
#include "diagnose/beside/naming/rivals.hpp"
#include "support/catch.hpp"

namespace ripplenotch {
namespace {

using fixture::logged;
using fixture::model_of;
using fixture::standard;
using fixture::strokes;

// A log, weighed for names beside what is left of it.
struct Weighed {
    explicit Weighed(const Trace& log, const DiagnosisRules& rules = standard)
        : looked_at(fixture::case_of(log)),
          lens(looked_at, {none, none, {}, {}, 0.0, true}, {}, effects, rules, work),
          sums(lens) {}
    Weighed(const Weighed&) = delete;
    Weighed& operator=(const Weighed&) = delete;

    [[nodiscard]] Named named(Names names) const {
        Named now{std::move(names)};
        now.left = sums.left_outside(now.names);
        return now;
    }
    [[nodiscard]] Names listed(std::string_view effect) const {
        Names found;
        for (std::size_t i = 0; i < sums.listed(); ++i) {
            if (sums.shapes()[i].term.effect->name == effect) found.push_back(i);
        }
        return found;
    }
    // In units of the gain.
    [[nodiscard]] double worth(const Named& before, const Named& after) const {
        return (before.left - after.left) / (lens.sigma() * lens.sigma());
    }

    Model none{GearRatio(100.0), {}};
    std::vector<const Effect*> effects{catalogue().begin(), catalogue().end()};
    Work work{1e9};
    Case looked_at;
    Lens lens;
    Sums sums;
};

Trace log_of(std::initializer_list<const char*> terms) { return logged(model_of(terms), strokes(), 42); }

// Ripple of order 2 that two modes of the joint make: a broad one below what a log tells, and a weak and
// sharp one.
Trace log_of_two_modes() {
    Trace log = log_of(
        {"ripple,order=2,amplitude_nm=0.1,phase_deg=70", "resonance,order=2,frequency_hz=4,damping=0.6"});
    const Trace sharp = log_of({"ripple,order=2,amplitude_nm=0.01,phase_deg=70",
                                "resonance,order=2,frequency_hz=70,damping=0.04"}),
                nothing = log_of({});
    for (std::size_t k = 0; k < log.size(); ++k)
        log.torque_nm[k] += sharp.torque_nm[k] - nothing.torque_nm[k];
    return log;
}

// Of ripple of order 2: without what rings, and every beginning of it.
struct Beginnings {
    std::size_t plain = 0;
    Names ringing;
};

Beginnings beginnings_of(const Weighed& on) {
    Beginnings found;
    for (const std::size_t i : on.listed("ripple")) {
        const Shape& shape = on.sums.shapes()[i];
        if (order_of(shape) != 2.0) continue;
        if (shape.ringing)
            found.ringing.push_back(i);
        else
            found.plain = i;
    }
    return found;
}

double frequency_hz(const Weighed& on, const Named& now) {
    return *on.sums.shapes()[now.names.front()].ringing->values.front();
}

}  // namespace

TEST_CASE(
    "a scale that went up and down is where it was, and columns that had to go come again as they were") {
    Weighed on(log_of({"hysteresis,torque_nm=0.5,width_deg=3"}));
    const std::size_t begun = on.listed("hysteresis").front();
    const Shape start = on.sums.shapes()[begun];
    const Scale width = scales_of(start).front();
    const double value = value_of(start, width);
    CHECK(on.sums.place_of(moved(start, width, value * 1.2 * (1.0 / 1.2) * (1.0 + 1e-15))) == begun);
    const std::size_t first = on.sums.place_of(moved(start, width, value * 1.01));
    CHECK(first != begun);
    const std::vector<double> column = *on.sums.weighed(first)[0];
    // More shapes than 40 MiB hold.
    const std::size_t many = 40U * 1024 * 1024 / (2 * sizeof(double) * on.lens.ground().rows()) + 10;
    for (std::size_t k = 0; k < many; ++k)
        (void)on.sums.place_of(moved(start, width, value * (1.1 + 1e-3 * static_cast<double>(k))));
    // A pair that nobody asked for before.
    CHECK(on.named({first, first + 1}).left < on.named({first}).left);
    CHECK(*on.sums.weighed(first)[0] == column);
}

TEST_CASE("what rings, worked out where names are weighed, is what every sample gives") {
    DiagnosisRules thinned = standard;
    thinned.beside.most_rate_hz = 250.0;
    for (const DiagnosisRules& rules : {standard, thinned}) {
        const Weighed on(log_of({"ripple,order=2,amplitude_nm=0.1,phase_deg=70"}), rules);
        CAPTURE(rules.beside.most_rate_hz);
        for (const std::size_t ringing : beginnings_of(on).ringing) {
            const auto every = on.lens.weighed(on.sums.shapes()[ringing]).columns;
            const auto found = on.sums.weighed(ringing);
            REQUIRE(found.size() == every.size());
            for (std::size_t c = 0; c < every.size(); ++c) {
                std::vector<double> off = every[c];
                for (std::size_t k = 0; k < off.size(); ++k) off[k] -= (*found[c])[k];
                // Between the samples that are weighed the drive is taken to turn evenly.
                CHECK(rms(off) <= 0.001 * rms(every[c]));
            }
        }
    }
}

TEST_CASE("two frictions are refined until another turn is worth nothing, wherever they begin") {
    Weighed on(log_of({"coulomb-friction,torque_nm=0.1,width_deg_s=1.2",
                       "stribeck-friction,torque_nm=0.6,stribeck_speed_deg_s=12,width_deg_s=0.8"}));
    std::vector<double> left;
    for (const std::size_t coulomb : on.listed("coulomb-friction")) {
        for (const std::size_t stribeck : on.listed("stribeck-friction")) {
            const Named begun = on.named({coulomb, stribeck}), first = refined(on.sums, begun),
                        second = refined(on.sums, first);
            CHECK(on.worth(begun, first) > 5000.0);
            // What a value is worth. After one turn more than a thousand is left in some.
            CHECK(on.worth(first, second) < 2.0);
            left.push_back(on.worth({{}, 0.0}, first));
        }
    }
    REQUIRE(left.size() > 6);
    // All valleys end at about one depth, of some 15,000.
    CHECK(*std::max_element(left.begin(), left.end()) - *std::min_element(left.begin(), left.end()) < 150.0);
}

TEST_CASE("what rings is sought from its other beginnings where one leads to nothing") {
    Weighed on(log_of(
        {"ripple,order=2,amplitude_nm=0.1,phase_deg=70", "resonance,order=2,frequency_hz=70,damping=0.05"}));
    const Beginnings found = beginnings_of(on);
    REQUIRE(found.ringing.size() == 4);
    const Named plain = on.named({found.plain}), lowest = on.named({found.ringing.front()});
    const Named near = refined(on.sums, lowest), all = refined_from_others(on.sums, lowest, 0);
    CHECK(on.worth(plain, near) < 10.0);
    CHECK(on.worth(plain, all) > 3000.0);
    CHECK(frequency_hz(on, all) == Approx(70.0).epsilon(0.02));
    for (const std::size_t other : found.ringing) {
        if (other != found.ringing.front()) CHECK(on.worth(refined(on.sums, on.named({other})), all) >= 0.0);
    }
}

TEST_CASE("a beginning that is ahead and ends at a bound does not hide what rings") {
    Weighed on(log_of_two_modes());
    const Beginnings found = beginnings_of(on);
    REQUIRE(found.ringing.size() == 4);
    const Named plain = on.named({found.plain});
    // The lowest is the best as it stands, and ends below what may be told.
    std::vector<double> at_first;
    for (const std::size_t begun : found.ringing) at_first.push_back(on.worth(plain, on.named({begun})));
    REQUIRE(std::max_element(at_first.begin(), at_first.end()) == at_first.begin());
    const Named nearest = refined(on.sums, on.named({found.ringing.front()}));
    REQUIRE_FALSE(is_worth_ringing(on.sums, nearest.names, 0, catalogue().size()));
    const Named rings = with_ringing(on.sums, plain, catalogue().size());
    REQUIRE(on.sums.shapes()[rings.names.front()].ringing);
    CHECK(frequency_hz(on, rings) == Approx(70.0).epsilon(0.05));
    CHECK(on.worth(plain, rings) > 1000.0);
}

TEST_CASE("a longer colour decides which of two curves it is, beside a leftover that is slow") {
    std::size_t decided = 0, decided_further = 0;
    for (std::uint64_t seed = 1; seed <= 12; ++seed) {
        Trace log = logged(model_of({"viscous-friction,coefficient_nm_per_deg_s=0.008"}), strokes(), seed);
        const auto left = fixture::slow_leftover(strokes(), seed, 1.0);
        for (std::size_t k = 0; k < left.size(); ++k) log.torque_nm[k] += left[k];
        Weighed on(log);
        const Candidate model{on.none, on.none, {}, {}, 0.0, true};
        LongerLook longer(on.lens, model, {}, on.effects);
        const Names names = on.listed("viscous-friction");
        REQUIRE(names.size() == 1);
        const double price = price_of(on.sums, names[0], catalogue().size());
        const auto is_decided = [&](LongerLook* further) {
            const auto rivalry = rivalry_of(on.sums, names, 0, price, further);
            // No other name is clearly ahead of what is there.
            const bool behind = rivalry && rivalry->ahead.gain < -standard.beside.tie_margin;
            CHECK_FALSE(behind);
            return !rivalry || (rivalry->ahead.gain >= standard.beside.tie_margin &&
                                rivalry->ahead.t >= standard.beside.tie_t);
        };
        const bool here = is_decided(nullptr), there = is_decided(&longer);
        CHECK((there || !here));  // what is decided stays so
        decided += here ? 1 : 0;
        decided_further += there ? 1 : 0;
    }
    // 3 and 7 of 12.
    CHECK(decided_further >= decided + 3);
    CHECK(decided < 6);
}

}  // namespace ripplenotch
