// SPDX-License-Identifier: MIT
// Ripple maps: fitted to logs whose ripple is known, of several motors, and subtracted.

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "filter/tables.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/core/trace.hpp"
#include "ripplenotch/design/ripple_map.hpp"
#include "ripplenotch/document/results.hpp"
#include "ripplenotch/filter/map_fit.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using namespace ripplenotch::testing;

namespace {

constexpr double mapped_ratio = 100.0;

GearAccount mapped_gear(std::vector<Order> orders = {Order(1.0), Order(2.0)}) {
    return {GearRatio(mapped_ratio), std::move(orders), {}, {}, "test"};
}

/// Orders 1 and 2, alike at every speed and in both directions: 0.8 and 0.5 Nm.
RippleMap plain_map() {
    RippleMap map;
    map.gear_ratio = GearRatio(mapped_ratio);
    map.orders = {Order(1.0), Order(2.0)};
    map.values = {{{0.6, -0.529}}, {{-0.3, 0.4}}};
    map.spread_nm = {0.0, 0.0};
    return map;
}

/// Order 2 by speed (10 and 110 deg/s) and direction.
RippleMap speed_map() {
    RippleMap map;
    map.gear_ratio = GearRatio(mapped_ratio);
    map.orders = {Order(2.0)};
    map.form = {{10.0, 110.0}, 2};
    map.speeds_deg_s = {10.0, 110.0};
    map.values = {{{0.5, 0.1}, {0.2, -0.4}, {-0.1, 0.6}, {0.4, 0.3}}};
    map.spread_nm = {0.0};
    return map;
}

/// Orders 1 and 2 of both combs, n 100 and n 101 cycles per output turn, alike at every speed.
RippleMap two_comb_map() {
    RippleMap map = plain_map();
    map.form.second_comb = 1;
    map.values = {{{0.1, 0.2}, {0.5, -0.3}}, {{-0.3, 0.4}, {0.1, -0.3}}};
    return map;
}

/// A joint that swings at up to 110 deg/s under a slow torque, at 1 kHz, with this ripple and white noise.
/// The encoder counts `shift_deg` more than the map does.
Trace mapped_log(const RippleMap& map, double seconds, double noise_nm, unsigned seed, double shift_deg = 0.0,
                 double swing_rad_s = 0.9) {
    std::mt19937 engine(seed);
    std::normal_distribution<double> noise;
    const double phase = std::uniform_real_distribution<double>(0.0, 6.0)(engine);
    Trace trace;
    trace.sample_rate = Hertz(1000.0);
    double position = 7.0;
    for (std::size_t k = 0; static_cast<double>(k) < 1000.0 * seconds; ++k) {
        const double t = static_cast<double>(k) / 1000.0;
        const double v = 80.0 * std::sin(swing_rad_s * t + phase) + 30.0 * std::sin(0.37 * t);
        if (k > 0) position += (trace.velocity_deg_s.back() + v) / 2000.0;
        trace.time_s.push_back(t);
        trace.velocity_deg_s.push_back(v);
        trace.position_deg.push_back(position + shift_deg);
        trace.torque_nm.push_back(6.0 * std::sin(0.5 * t) + map_torque(map, {v, position}) +
                                  noise_nm * noise(engine));
    }
    return trace;
}

MapFit fit_of(const Trace& trace, const GearAccount& gear, double zero_deg = 0.0) {
    const TraceView view = trace.view();
    return fit_ripple_map({&view, 1}, gear, zero_deg);
}

double worst_difference(const RippleMap& one, const RippleMap& other) {
    double worst = 0.0;
    for (double speed = -100.0; speed <= 100.0; speed += 12.5) {
        for (double position = -40.0; position <= 40.0; position += 0.17) {
            const MapState state{speed, position};
            worst = std::max(worst, std::abs(map_torque(one, state) - map_torque(other, state)));
        }
    }
    return worst;
}

/// Another joint, which swings at a frequency of its own.
Trace motion_of(unsigned seed) { return mapped_log(plain_map(), 20.0, 0.0, seed, 0.0, 1.13); }

/// A joint with its own ripple and, where `share` is not 0, that of the motor of another one.
Trace torque_with(const Trace& other, unsigned seed, double share) {
    Trace log = mapped_log(plain_map(), 20.0, 0.05, seed);
    const std::vector<double> ripple = map_along(two_comb_map(), other.view());
    for (std::size_t k = 0; k < log.size(); ++k) log.torque_nm[k] += share * ripple[k];
    return log;
}

MapFit fit_of(const Trace& log, const Trace& other, std::size_t pairs = 2, bool own = true) {
    const TraceView view = log.view();
    const GearAccount gear = mapped_gear();
    const OtherMotor motor{"other", mapped_gear(), {other.view()}};
    return fit_joint_map({&view, 1}, own ? &gear : nullptr, {&motor, 1}, pairs);
}

double rms(const std::vector<double>& values) {
    double sum = 0.0;
    for (const double value : values) sum += value * value;
    return std::sqrt(sum / static_cast<double>(values.size()));
}

std::vector<double> less(std::vector<double> values, const std::vector<double>& others) {
    for (std::size_t k = 0; k < values.size(); ++k) values[k] -= others[k];
    return values;
}

std::string with_map(const std::string& method, const RippleMap& map) {
    std::string text = method;
    for (const auto& [key, value] : map_as_keys(map)) text += "," + key + "=" + value;
    return text;
}

Samples samples_of(const Trace& trace) { return {trace.velocity_deg_s, trace.torque_nm, trace.position_deg}; }

std::vector<double> slow_part(const Trace& trace) {
    std::vector<double> torque;
    for (const double t : trace.time_s) torque.push_back(6.0 * std::sin(0.5 * t));
    return torque;
}

double rms_from(const std::vector<double>& a, const std::vector<double>& b, std::size_t first) {
    double sum = 0.0;
    for (std::size_t k = first; k < a.size(); ++k) sum += (a[k] - b[k]) * (a[k] - b[k]);
    return std::sqrt(sum / static_cast<double>(a.size() - first));
}

}  // namespace

TEST_CASE("a map of lines per turn of the joint is that of a gear ratio that names them, and states none") {
    RippleMap truth = plain_map();
    truth.orders = {Order(2.0), Order(4.0)};
    const Trace log = mapped_log(truth, 20.0, 0.05, 3);
    const MapFit named = fit_of(log, mapped_gear(truth.orders));
    const MapFit fit = fit_of(log, {no_ratio, {Order(200.0), Order(400.0)}, {}, {}, "test", true});
    REQUIRE(named.finding == MapFinding::mapped);
    REQUIRE(named.map.form.second_comb == 0);
    CHECK(fit.map.values == named.map.values);
    CHECK(map_as_keys(fit.map).front() == std::pair<std::string, std::string>("orders", "200/turn:400/turn"));
    CHECK_THAT(map_verdict(fit), Catch::Contains("200/turn falls from"));
}

TEST_CASE("a map of a ripple that is the same everywhere has the simplest form and its amplitudes") {
    std::size_t within = 0, values = 0;
    for (unsigned seed = 1; seed <= 8; ++seed) {
        const MapFit fit = fit_of(mapped_log(plain_map(), 20.0, 0.05, seed), mapped_gear());
        INFO(seed << ": " << map_verdict(fit));
        REQUIRE(fit.finding == MapFinding::mapped);
        CHECK(fit.conclusive);
        REQUIRE(fit.map.form.columns() == 1);
        REQUIRE(fit.map.orders == plain_map().orders);
        for (std::size_t i = 0; i < 2; ++i) {
            const auto off = fit.map.values[i][0] - plain_map().values[i][0];
            for (const auto& [error, allowed] : {std::pair(off.real(), fit.errors[i][0].real()),
                                                 std::pair(off.imag(), fit.errors[i][0].imag())}) {
                CHECK(std::abs(error) < 4.0 * allowed);
                CHECK(allowed < 0.01);
                within += std::abs(error) < 1.96 * allowed ? 1 : 0;
                ++values;
            }
            CHECK(fit.scores[i].predicted_share > 0.99);
        }
    }
    // 95 % intervals: of 32 values fewer than 27 within has a chance of 2 %.
    CHECK(within >= 27 * values / 32);
}

TEST_CASE("a ripple that depends on speed and direction is found again") {
    const MapFit fit = fit_of(mapped_log(speed_map(), 40.0, 0.05, 3), mapped_gear({Order(2.0)}));
    INFO(map_verdict(fit));
    REQUIRE(fit.finding == MapFinding::mapped);
    CHECK(fit.map.form.directions == 2);
    CHECK(fit.map.form.speeds_deg_s.size() >= 2);
    CHECK(fit.map.form.second_comb == 0);
    CHECK(worst_difference(fit.map, speed_map()) < 0.1);
    CHECK(fit.scores[0].predicted_share > 0.98);
    CHECK(fit.scores[0].left_nm < 2.0 * fit.scores[0].noise_nm);
}

TEST_CASE("an encoder that counts from elsewhere turns the phases, and --zero turns them back") {
    const double shift_deg = 1.234;
    const RippleMap here = fit_of(mapped_log(plain_map(), 20.0, 0.02, 5), mapped_gear()).map;
    const Trace shifted = mapped_log(plain_map(), 20.0, 0.02, 5, shift_deg);
    const RippleMap there = fit_of(shifted, mapped_gear()).map;
    REQUIRE(there.orders.size() == 2);
    for (std::size_t i = 0; i < 2; ++i) {
        const double ahead =
            2.0 * std::numbers::pi * static_cast<double>(i + 1) * mapped_ratio * shift_deg / 360.0;
        // ripple = Re(z exp(-i n theta)), and theta is larger by the shift.
        CHECK(std::abs(there.values[i][0] - here.values[i][0] * std::polar(1.0, ahead)) < 1e-3);
    }
    const RippleMap anchored = fit_of(shifted, mapped_gear(), shift_deg).map;
    for (std::size_t i = 0; i < 2; ++i) CHECK(std::abs(anchored.values[i][0] - here.values[i][0]) < 1e-3);
    CHECK(worst_difference(anchored, there) < 1e-6);
}

TEST_CASE("the same ripple is the same from any zero") {
    for (const double zero : {-400.0, -3.3, 0.0, 17.0})
        CHECK(worst_difference(with_zero(speed_map(), zero), speed_map()) < 1e-9);
}

TEST_CASE("where nothing turns with the motor the map is empty and says so, whatever the seed") {
    RippleMap none = plain_map();
    for (auto& values : none.values) values = {0.0};
    for (unsigned seed = 1; seed <= 20; ++seed) {
        Trace log = mapped_log(none, 20.0, 0.05, seed);
        // A tone does not turn with the motor, however strong.
        for (std::size_t k = 0; k < log.size(); ++k)
            log.torque_nm[k] += 0.3 * std::sin(2.0 * std::numbers::pi * 31.0 * log.time_s[k]);
        const MapFit fit = fit_of(log, mapped_gear());
        INFO(seed << ": " << map_verdict(fit));
        CHECK(fit.finding == MapFinding::nothing);
        CHECK(fit.map.orders.empty());
        CHECK_THAT(map_verdict(fit), Catch::Contains("the map is empty"));
    }
}

TEST_CASE("both combs of a harmonic drive are found, whichever is the stronger one, on either side") {
    for (const int side : {1, -1}) {
        RippleMap truth = two_comb_map();
        truth.form.second_comb = side;
        const MapFit fit = fit_of(mapped_log(truth, 20.0, 0.05, 4), mapped_gear());
        INFO(map_verdict(fit));
        REQUIRE(fit.finding == MapFinding::mapped);
        CHECK(fit.map.form.second_comb == side);
        REQUIRE(fit.map.form.columns() == 2);
        for (std::size_t i = 0; i < 2; ++i) {
            for (std::size_t c = 0; c < 2; ++c) {
                const auto off = fit.map.values[i][c] - truth.values[i][c];
                CHECK(std::abs(off.real()) < 4.0 * fit.errors[i][c].real());
                CHECK(std::abs(off.imag()) < 4.0 * fit.errors[i][c].imag());
            }
            CHECK(fit.scores[i].left_nm < 1.2 * fit.scores[i].noise_nm);
        }
        CHECK(worst_difference(fit.map, truth) < 0.05);
    }
    // One line per order at n 101 alone is what a map of gear ratio 100 finds, too.
    RippleMap second = two_comb_map();
    for (auto& values : second.values) values[0] = 0.0;
    const MapFit fit = fit_of(mapped_log(second, 20.0, 0.05, 4), mapped_gear());
    CHECK(fit.map.form.second_comb == 1);
    for (const MapOrderScore& score : fit.scores) CHECK(score.predicted_share > 0.99);
}

TEST_CASE("a single line at n (Kg + 1) is at 1 + 1 / Kg times the motor's angle") {
    RippleMap map = plain_map();
    map.orders = {Order(2.0)};
    map.form.second_comb = 1;
    map.values = {{{0.0, 0.0}, {0.3, 0.2}}};
    for (const double position : {-400.0, 3.21, 77.7}) {
        const double phase = 2.0 * (mapped_ratio + 1.0) * position * std::numbers::pi / 180.0;
        CHECK(map_torque(map, {50.0, position}) ==
              Approx(0.3 * std::cos(phase) + 0.2 * std::sin(phase)).margin(1e-9));
    }
}

TEST_CASE("a short run at one speed holds its orders: sixteen windows are enough") {
    for (unsigned seed = 1; seed <= 6; ++seed) {
        const MapFit fit = fit_of(mapped_log(plain_map(), 1.25, 0.05, seed), mapped_gear());
        if (fit.windows < fewest_map_windows) continue;
        INFO(seed << ": " << fit.windows << ", " << map_verdict(fit));
        CHECK(fit.map.orders.size() == 2);
    }
}

TEST_CASE("no short run is told to be empty below a bound that its ripple exceeds") {
    std::size_t empty = 0;
    for (const double share : {0.01, 0.03, 0.1, 0.3}) {
        RippleMap weak = plain_map();
        for (auto& values : weak.values) values[0] *= share;
        for (unsigned seed = 1; seed <= 6; ++seed) {
            const MapFit fit = fit_of(mapped_log(weak, 1.25 + 0.25 * seed, 0.05, 200 + seed), mapped_gear());
            INFO(share << ", " << seed << ": " << map_verdict(fit));
            if (fit.finding != MapFinding::nothing && fit.finding != MapFinding::mapped) continue;
            for (std::size_t i = 0; i < 2; ++i) {
                if (fit.scores[i].in_map) continue;
                CHECK(fit.scores[i].detectable_nm > std::abs(weak.values[i][0]));
                ++empty;
            }
        }
    }
    CHECK(empty > 0);
}

TEST_CASE("an empty map is bounded: a ripple of the bound is found, of twice the bound always") {
    RippleMap none = plain_map();
    none.orders = {Order(2.0)};
    none.values = {{0.0}};
    none.spread_nm = {0.0};
    std::size_t at_bound = 0;
    constexpr unsigned logs = 20;
    for (unsigned seed = 1; seed <= logs; ++seed) {
        const MapFit empty = fit_of(mapped_log(none, 6.0, 0.05, seed), mapped_gear({Order(2.0)}));
        REQUIRE(empty.finding == MapFinding::nothing);
        CHECK_THAT(map_verdict(empty), Catch::Contains("would have been found"));
        for (const double factor : {1.0, 2.0}) {
            RippleMap one = none;
            one.values[0] = {std::polar(factor * empty.scores[0].detectable_nm, 0.7 * seed)};
            const MapFit fit = fit_of(mapped_log(one, 6.0, 0.05, 100 + seed), mapped_gear({Order(2.0)}));
            if (factor > 1.0) CHECK(fit.scores[0].in_map);
            if (factor == 1.0 && fit.scores[0].in_map) ++at_bound;
        }
    }
    // 19 of 20 are expected; fewer than 16 have a chance of 0.3 %.
    CHECK(at_bound >= 16);
}

TEST_CASE("a torque that repeats with the joint's position is no ripple of the motor") {
    // Smooth bumps every 11 deg of the joint, the same in every sweep: they leak into every order.
    RippleMap none = plain_map();
    for (auto& values : none.values) values = {0.0};
    std::size_t maps = 0;
    for (unsigned seed = 1; seed <= 10; ++seed) {
        Trace log = mapped_log(none, 20.0, 0.02, seed);
        for (std::size_t k = 0; k < log.size(); ++k) {
            const double along = log.position_deg[k] / 11.0 + 0.3 * std::sin(log.position_deg[k] / 7.0);
            log.torque_nm[k] += 0.5 * std::exp(4.0 * (std::cos(2.0 * std::numbers::pi * along) - 1.0));
        }
        maps += fit_of(log, mapped_gear()).finding == MapFinding::mapped ? 1 : 0;
    }
    CHECK(maps == 0);
}

TEST_CASE("too little motion is told, not mapped") {
    const MapFit fit = fit_of(mapped_log(plain_map(), 0.5, 0.05, 1), mapped_gear());
    CHECK(fit.finding == MapFinding::too_little);
    CHECK_FALSE(fit.conclusive);
    CHECK_THAT(map_verdict(fit), Catch::Contains("Cannot tell"));
}

TEST_CASE("of three logs the one that does not agree is named") {
    std::vector<Trace> logs;
    for (unsigned seed = 1; seed <= 3; ++seed)
        logs.push_back(mapped_log(plain_map(), 20.0, 0.05, seed, seed == 2 ? 0.6 : 0.0));
    const auto fit_all = [&] {
        std::vector<TraceView> views;
        for (const Trace& log : logs) views.push_back(log.view());
        return fit_ripple_map(views, mapped_gear());
    };
    const MapFit apart = fit_all();
    CHECK_FALSE(apart.conclusive);
    double of_second = 0.0, of_others = 0.0;
    for (const MapAgreement& one : apart.agreement) {
        double& worst = one.log == 1 ? of_second : of_others;
        worst = std::max(worst, std::abs(one.phase_deg));
        if (one.log == 1) CHECK_FALSE(one.agrees);
    }
    CHECK(of_second > of_others);
    logs[1] = mapped_log(plain_map(), 20.0, 0.05, 2);
    const MapFit together = fit_all();
    CHECK(together.conclusive);
    REQUIRE(together.agreement.size() == 6);
    for (const MapAgreement& one : together.agreement) CHECK(one.agrees);
}

TEST_CASE("what a map says of its orders follows from what they left where they were left out") {
    const MapFit fit = fit_of(mapped_log(speed_map(), 40.0, 0.05, 3), mapped_gear({Order(2.0)}));
    REQUIRE(fit.map.spread_nm.size() == 1);
    const MapOrderScore& score = fit.scores.front();
    const double there = score.ripple_nm * score.ripple_nm, left = score.left_nm * score.left_nm;
    const double noise = score.noise_nm * score.noise_nm;
    CHECK(score.predicted_share == Approx(std::min(1.0, (there - left) / (there - noise))));
    CHECK(fit.map.spread_nm[0] == Approx(std::sqrt(std::max(left - noise, 0.01 * left))));
}

TEST_CASE("of an order that is not there nothing shows but its noise") {
    RippleMap none = plain_map();
    for (auto& values : none.values) values = {0.0};
    double there = 0.0, noise = 0.0;
    for (unsigned seed = 1; seed <= 8; ++seed) {
        for (const MapOrderScore& score : fit_of(mapped_log(none, 20.0, 0.05, seed), mapped_gear()).scores) {
            there += score.ripple_nm * score.ripple_nm;
            noise += score.noise_nm * score.noise_nm;
        }
    }
    // Measured 0.87: the noise is told 7 % too large, which errs to the side of a smaller map.
    CHECK(there == Approx(noise).epsilon(0.2));
}

TEST_CASE("a log of another amplitude is told by the factor, with the error that its scatter has") {
    double square = 0.0, count = 0.0;
    for (unsigned seed = 1; seed <= 12; ++seed) {
        RippleMap larger = plain_map();
        for (auto& values : larger.values) values[0] *= 1.25;
        const Trace one = mapped_log(plain_map(), 20.0, 0.05, seed);
        const Trace other = mapped_log(larger, 20.0, 0.05, 100 + seed);
        const std::vector<TraceView> views = {one.view(), other.view()};
        const MapFit fit = fit_ripple_map(views, mapped_gear());
        REQUIRE(fit.agreement.size() == 4);
        for (const MapAgreement& found : fit.agreement) {
            const double truth = found.log == 1 ? 1.25 : 0.8;
            CHECK(found.amplitude_ratio == Approx(truth).epsilon(0.02));
            CHECK(found.phase_error_deg ==
                  Approx(std::asin(found.amplitude_error / found.amplitude_ratio) * degrees_per_radian));
            square += std::pow((found.amplitude_ratio - truth) / found.amplitude_error, 2);
            count += 1.0;
        }
    }
    CHECK(std::sqrt(square / count) == Approx(1.0).margin(0.35));
}

TEST_CASE("a log without a position is mapped from its first row, and not with another") {
    Trace log = mapped_log(plain_map(), 20.0, 0.02, 4);
    log.position_deg.clear();
    const MapFit fit = fit_of(log, mapped_gear());
    CHECK_FALSE(fit.anchored);
    CHECK_FALSE(fit.conclusive);
    REQUIRE(fit.finding == MapFinding::mapped);
    const std::vector<TraceView> two = {log.view(), log.view()};
    CHECK_THROWS_AS(fit_ripple_map(two, mapped_gear()), DataError);
}

TEST_CASE("a map holds its edges, and its directions meet at standstill") {
    const RippleMap map = speed_map();
    const double at = 3.21;
    CHECK(map_torque(map, {500.0, at}) == map_torque(map, {110.0, at}));
    CHECK(map_torque(map, {0.0, at}) ==
          Approx(0.5 * (map_torque(map, {10.0, at}) + map_torque(map, {-10.0, at}))));
}

TEST_CASE("the ripple of two motors in one torque is told apart by their angles") {
    for (unsigned seed = 1; seed <= 6; ++seed) {
        const Trace other = motion_of(100 + seed), log = torque_with(other, seed, 0.5);
        for (const bool own : {true, false}) {
            const MapFit fit = fit_of(log, other, 2, own);
            INFO(seed << ", own gear known: " << own << ": " << map_verdict(fit));
            REQUIRE(fit.others.size() == 1);
            REQUIRE(fit.others[0].finding == MapFinding::mapped);
            CHECK(fit.others[0].doubt.empty());
            REQUIRE(fit.map.others.size() == 1);
            CHECK(fit.map.others[0].joint == "other");
            if (own)
                CHECK(rms(less(map_along(fit.map, log.view()), map_along(plain_map(), log.view()))) < 0.05);
            std::vector<double> truth = map_along(two_comb_map(), other.view());
            for (double& nm : truth) nm *= 0.5;
            const std::vector<double> left = less(map_along(fit.map.others[0], other.view()), truth);
            CHECK(rms(left) < (own ? 0.05 : 0.3) * rms(truth) + 0.02);
        }
    }
}

TEST_CASE("another motor whose ripple is not in the torque is not claimed, and a bound is stated") {
    std::size_t claimed = 0, bounds = 0;
    for (unsigned seed = 1; seed <= 20; ++seed) {
        const Trace other = motion_of(200 + seed), log = torque_with(other, seed, 0.0);
        const MapFit fit = fit_of(log, other);
        claimed += fit.others[0].finding == MapFinding::mapped ? 1 : 0;
        for (const MapOrderScore& score : fit.others[0].scores)
            bounds += !score.in_map && score.detectable_nm < 0.2 ? 1 : 0;
        CHECK(fit.map.others.empty());
        CHECK(fit.finding == MapFinding::mapped);
    }
    CHECK(claimed == 0);
    CHECK(bounds >= 36);
}

TEST_CASE("two joints that move alike cannot be told apart, and nothing is subtracted") {
    const Trace log = torque_with(motion_of(1), 1, 0.0), same = mapped_log(plain_map(), 20.0, 0.0, 1);
    const MapFit own_known = fit_of(log, same);
    CHECK(own_known.map.others.empty());
    // Ripple of its own motor, whose gear is not known, is not that of a joint that moves alike.
    const MapFit own_unknown = fit_of(log, same, 2, false);
    CHECK(own_unknown.others[0].finding == MapFinding::mapped);
    CHECK_THAT(own_unknown.others[0].doubt, Catch::Contains("whose gear ratio is not known"));
    CHECK(own_unknown.map.others.empty());
    // Without a gear of its own, both of two other joints could have made it.
    const TraceView view = log.view();
    const std::vector<OtherMotor> two = {{"a", mapped_gear(), {same.view()}},
                                         {"b", mapped_gear(), {same.view()}}};
    const MapFit fit = fit_joint_map({&view, 1}, nullptr, two, 2);
    REQUIRE(fit.others.size() == 2);
    REQUIRE(fit.others[0].finding == MapFinding::mapped);
    CHECK_THAT(fit.others[0].doubt, Catch::Contains("Cannot tell the ripple of the motor of a from that of"));
    CHECK(fit.map.others.empty());
}

TEST_CASE("a map with other motors is the same after JSON, and is subtracted from any log of these joints") {
    const Trace other = motion_of(101), log = torque_with(other, 1, 0.5);
    const MapFit fit = fit_of(log, other);
    const MapFit read = map_from_json(map_text(fit, {}), "test");
    REQUIRE(read.others.size() == 1);
    REQUIRE(read.map.others.size() == 1);
    CHECK(read.map.others[0].joint == "other");
    CHECK(read.others[0].finding == MapFinding::mapped);
    const Trace next = motion_of(301), after = torque_with(next, 9, 0.5), clean = torque_with(next, 9, 0.0);
    const TraceView view = after.view();
    const OtherMotor motor{"other", mapped_gear(), {next.view()}};
    std::vector<double> left = without_other_motors({&view, 1}, read.map, {&motor, 1}).front();
    for (std::size_t k = 0; k < left.size(); ++k) left[k] -= clean.torque_nm[k];
    CHECK(rms(left) < 0.1 * 0.5 * rms(map_along(two_comb_map(), next.view())) + 0.02);
}

TEST_CASE("the rows of another joint have to be those of the torque") {
    const Trace log = torque_with(motion_of(1), 1, 0.0);
    const Trace shorter = mapped_log(plain_map(), 10.0, 0.0, 2);
    CHECK_THROWS_AS(fit_of(log, shorter), DataError);
}

TEST_CASE("the method map subtracts the closed form at the measured angle, at once") {
    for (RippleMap map : {plain_map(), with_zero(speed_map(), 12.5)}) {
        const Trace log = mapped_log(map, 6.0, 0.0, 3);
        const auto out = filtered(*start(with_map("map", map)), samples_of(log));
        const auto expected = slow_part(log);
        double worst = 0.0;
        for (std::size_t k = 0; k < out.size(); ++k) worst = std::max(worst, std::abs(out[k] - expected[k]));
        CHECK(worst < 1e-9);
    }
}

TEST_CASE("a map with a value too few is refused with the number that it takes") {
    CHECK_THROWS_WITH(start("map,gear-ratio=100,orders=1:2,cosines=0.1:0.2:0.3,sines=0:0"),
                      Catch::Contains("3 values, and 2 orders of 1 take 2"));
}

TEST_CASE("without a position and a start the map passes the torque") {
    const Trace log = mapped_log(plain_map(), 1.0, 0.01, 3);
    Samples blind = samples_of(log);
    blind.position_deg = {};
    CHECK(filtered(*start(with_map("map", plain_map())), blind) == log.torque_nm);
}

TEST_CASE("an oscillator with a map starts right, and follows what the map does not know") {
    const RippleMap map = speed_map();
    const Trace log = mapped_log(map, 6.0, 0.05, 9);
    const auto truth = slow_part(log);
    const auto warm = filtered(*start(with_map("oscillator,slip=0", map)), samples_of(log));
    CHECK(rms_from(warm, truth, 0) < 0.03);
    const auto cold = filtered(*start("oscillator,gear-ratio=100,orders=2,slip=0"), samples_of(log));
    CHECK(rms_from(warm, truth, 0) < rms_from(cold, truth, 0));
    // The joint's ripple has grown by half since the map was made.
    RippleMap grown = map;
    for (auto& value : grown.values[0]) value *= 1.5;
    const Trace later = mapped_log(grown, 6.0, 0.05, 9);
    const auto followed = filtered(*start(with_map("oscillator", map)), samples_of(later));
    const auto subtracted = filtered(*start(with_map("map", map)), samples_of(later));
    CHECK(rms_from(followed, truth, 1000) < 0.6 * rms_from(subtracted, truth, 1000));
}

TEST_CASE("after an encoder swap the map's zero is found within one motor turn") {
    const RippleMap map = plain_map();
    for (const double shift_deg : {0.3, 1.1, 2.9, -1.7}) {
        const Trace log = mapped_log(map, 3.0, 0.05, 9, shift_deg);
        const auto truth = slow_part(log);
        double turned = 0.0;
        std::size_t first = 0;
        while (turned < 1.0) turned += mapped_ratio * std::abs(log.velocity_deg_s[first++]) / 360000.0;
        const auto found = filtered(*start(with_map("oscillator,zero=unknown", map)), samples_of(log));
        const auto wrong = filtered(*start(with_map("oscillator", map)), samples_of(log));
        CHECK(rms_from(found, truth, first) < 0.05);
        CHECK(rms_from(found, truth, first) < rms_from(wrong, truth, first));
    }
}
