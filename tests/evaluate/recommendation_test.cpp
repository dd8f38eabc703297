// SPDX-License-Identifier: MIT
// Which method is taken, on logs whose ripple is known.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include "evaluate/contenders.hpp"
#include "ripplenotch/evaluate/filter_metrics.hpp"
#include "ripplenotch/evaluate/recommendation.hpp"
#include "ripplenotch/filter/engine.hpp"
#include "ripplenotch/model/motion.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using namespace ripplenotch::testing;

namespace {

const GearAccount gear{GearRatio(100.0), {Order(1.0), Order(2.0)}, {}, {}, "test"};

// 90 deg/s at 1 kHz, ripple of 0.8 Nm (order 1) times `ripple`, a ramp, and white noise.
Trace log_of(double ripple, double ramp_nm_s, double seconds = 12.0) {
    std::mt19937 engine(5);
    std::normal_distribution<double> noise(0.0, 0.05);
    Trace trace;
    trace.sample_rate = Hertz(1000.0);
    for (std::size_t k = 0; static_cast<double>(k) < 1000.0 * seconds; ++k) {
        const double t = static_cast<double>(k) / 1000.0;
        const double theta = 2.0 * std::numbers::pi * 100.0 * 90.0 * t / 360.0;
        trace.time_s.push_back(t);
        trace.velocity_deg_s.push_back(90.0);
        trace.position_deg.push_back(90.0 * t);
        trace.torque_nm.push_back(ramp_nm_s * t + ripple * 0.8 * std::cos(theta) + noise(engine));
    }
    return trace;
}

std::vector<Contender> tried() {
    std::vector<Contender> all;
    for (const char* text : {"none", "lowpass,cutoff=3Hz,order=1", "lowpass,cutoff=10Hz,order=1",
                             "tracking,gear-ratio=100,orders=1:2", "tracking,gear-ratio=100,orders=1:2,q=4",
                             "oscillator,gear-ratio=100,orders=1:2"})
        all.push_back(make_contender(parse_spec(text)));
    return all;
}

std::vector<RippleEstimate> ripple_of(const Trace& trace) {
    const TraceView view = trace.view();
    return estimate_ripple({&view, 1}, gear.ratio, gear.orders);
}

Recommendation recommended(const Trace& trace, const RecommendationLimits& limits = {}) {
    return recommend(tried(), {trace.view()}, gear, limits, ripple_of(trace));
}

}  // namespace

TEST_CASE("the rate of a torque is that of its ramp, whatever ripple is on it") {
    CHECK(torque_rate_nm_s(log_of(1.0, 20.0).view(), gear.ratio) == Approx(20.0).epsilon(0.02));
    CHECK(torque_rate_nm_s(log_of(0.0, 20.0).view(), gear.ratio) == Approx(20.0).epsilon(0.02));
    CHECK(torque_rate_nm_s(TraceView{}, gear.ratio) == 0.0);
}

TEST_CASE("without a ripple that is present nothing is recommended, and a short log is not judged") {
    const Recommendation nothing = recommended(log_of(0.0, 0.0));
    CHECK(nothing.finding == RecommendationFinding::no_ripple);
    CHECK_THAT(recommendation_verdict(nothing), Catch::Contains("order 1: no ripple above 0.00"));
    CHECK_THAT(recommendation_verdict(nothing), Catch::Contains("at 90 to 90 deg/s"));
    CHECK(recommended(log_of(1.0, 0.0, 0.1)).finding == RecommendationFinding::cannot_tell);
}

TEST_CASE("what is off is the output minus the torque without ripple and noise") {
    const Trace trace = log_of(1.0, 20.0);
    const Recommendation found = recommended(trace);
    REQUIRE(found.finding == RecommendationFinding::recommended);
    for (const JudgedMethod& method : found.methods) {
        const auto filter = make_contender(parse_spec(method.figures.method));
        const std::vector<double> out = output_on_log(filter, {trace.view()});
        double squares = 0.0;
        for (std::size_t k = 0; k < out.size(); ++k)
            squares += std::pow(out[k] - 20.0 * trace.time_s[k], 2) / static_cast<double>(out.size());
        CHECK(method.error_nm() == Approx(std::sqrt(squares)).epsilon(0.05));
        if (method.figures.method == "none") {
            CHECK(*method.figures.moved_nm == 0.0);
            CHECK(*method.figures.added_nm == 0.0);
            CHECK(*method.figures.start_ratio == 1.0);
        }
        // On a ramp all that is moved is the way of the torque within the delay, once the filter follows.
        const double lag = 1e-3 * *method.figures.dc_delay_ms * found.torque_rate_nm_s;
        CHECK(*method.figures.moved_nm == Approx(lag).margin(0.02).epsilon(0.05));
    }
    // A low-pass of 3 Hz is 53 ms late, which is more than a Nm of this ramp.
    CHECK(found.taken()->figures.method.substr(0, 10) == "oscillator");
    CHECK(found.methods.back().figures.method == "lowpass,cutoff=3Hz,order=1");
}

TEST_CASE("the band of a torque is where 99 % of its variance above the noise lies") {
    Trace trace = log_of(0.0, 0.0);
    const auto band_of = [&](double hz, double nm) {
        Trace moved = trace;
        for (std::size_t k = 0; k < moved.size(); ++k)
            moved.torque_nm[k] += nm * std::sin(2.0 * std::numbers::pi * hz * moved.time_s[k]);
        return torque_band(moved.view());
    };
    CHECK(band_of(0.0, 0.0).at_rest);
    CHECK(band_of(0.0, 0.0).to.value() == Approx(4.0 / 12.0).epsilon(0.01));
    for (const double hz : {1.0, 3.0, 10.0}) {
        CHECK_FALSE(band_of(hz, 5.0).at_rest);
        CHECK(band_of(hz, 5.0).to.value() == Approx(hz).margin(0.2));
    }
}

TEST_CASE(
    "the distortion within the band is that of the filter's response there, and noise taken out is no "
    "credit") {
    Trace trace = log_of(1.0, 0.0);
    for (std::size_t k = 0; k < trace.size(); ++k)
        trace.torque_nm[k] += 5.0 * std::sin(2.0 * std::numbers::pi * 2.0 * trace.time_s[k]);
    const auto ripple = ripple_of(trace);
    for (const bool stated : {false, true}) {
        const auto band = stated ? std::optional(TorqueBand{Hertz(0.0), Hertz(5.0), true, false, Hertz(5.0)})
                                 : std::nullopt;
        const TorqueReference reference({trace.view()}, gear, ripple, band);
        CHECK(reference.band().to.value() == Approx(stated ? 5.0 : 2.0).margin(0.2));
        const auto rms_of = [&](const char* text) {
            const Contender method = make_contender(parse_spec(text));
            return reference.distortion(method);
        };
        CHECK(rms_of("none").moved_nm == 0.0);
        const Distortion slow = rms_of("lowpass,cutoff=10Hz,order=1");
        // The band ends at the sine where nobody states it: of its amplitude a half is seen there.
        const Cascade cascade = design_low_pass({Hertz(10.0), 1}, trace.sample_rate);
        const double off = std::abs(response(cascade, Hertz(2.0), SampledAt(trace.sample_rate)) - 1.0);
        if (stated) CHECK(slow.moved_nm == Approx(5.0 / std::sqrt(2.0) * off).epsilon(0.03));
        CHECK(slow.moved_nm > 0.4 * 5.0 / std::sqrt(2.0) * off);
        CHECK(slow.added_nm < 0.02);
    }
}

TEST_CASE("a low-pass, a delay and a gain add nothing, wherever a log begins and ends") {
    Trace trace = log_of(1.0, 0.0);
    const auto moves = [](double t) { return 5.0 * std::cos(2.0 * std::numbers::pi * 0.35 * t + 0.8); };
    for (std::size_t k = 0; k < trace.size(); ++k) trace.torque_nm[k] += moves(trace.time_s[k]);
    const TorqueReference reference({trace.view()}, gear, ripple_of(trace),
                                    TorqueBand{Hertz(0.0), Hertz(2.0), true, false, Hertz(2.0)});
    for (const char* text :
         {"lowpass,cutoff=3Hz,order=1", "lowpass,cutoff=10Hz,order=1", "lowpass,cutoff=1Hz,order=4"}) {
        const Distortion low = reference.distortion(make_contender(parse_spec(text)));
        CAPTURE(text);
        CHECK(low.added_nm < 5e-3);
        CHECK(low.moved_nm > 0.1);
    }
    const std::vector<double>& torque = reference.torque_nm();
    std::vector<double> late(torque.size()), larger = torque;
    for (std::size_t k = 0; k < 30; ++k) late[k] = moves(trace.time_s[k] - 0.03);
    std::copy(torque.begin(), torque.end() - 30, late.begin() + 30);
    for (double& nm : larger) nm *= 1.5;
    CHECK(reference.distortion(late).added_nm < 5e-3);
    CHECK(reference.distortion(larger).added_nm < 1e-3);
    CHECK(reference.distortion(larger).moved_nm == Approx(0.5 * 5.0 / std::sqrt(2.0)).epsilon(0.05));
    // A resonance of 9 dB at 3 Hz adds where the torque moves there, however much noise it takes out.
    for (std::size_t k = 0; k < trace.size(); ++k)
        trace.torque_nm[k] += 5.0 * std::sin(2.0 * std::numbers::pi * 2.0 * trace.time_s[k]);
    const TorqueReference slow({trace.view()}, gear, ripple_of(trace),
                               TorqueBand{Hertz(0.0), Hertz(1.0), true, false, Hertz(1.0)});
    const Contender rising = make_contender(parse_spec("oscillator,gear-ratio=100,orders=1:2,bandwidth=3Hz"));
    CHECK(slow.distortion(rising).added_nm > 0.1);
}

TEST_CASE("the response of the oscillator within the band is what sines measure") {
    const Contender oscillator = make_contender(parse_spec("oscillator,gear-ratio=100,orders=1:2,slip=0"));
    const Hertz rate(1000.0), at(5.0);
    const auto response = band_response(oscillator, rate, DegPerSec(90.0), {at, at, true, false, at});
    REQUIRE(response);
    const Bench bench(oscillator, rate, DegPerSec(90.0));
    CHECK(20.0 * std::log10(response->largest_gain) == Approx(-*bench.attenuation_db(at)).margin(0.01));
    CHECK(response->largest_gain > 1.01);
    CHECK(response->least_delay == response->longest_delay);
}

TEST_CASE("the longest delay of a table is that of the slowest band that the log comes into") {
    Trace trace = log_of(1.0, 5.0);
    for (std::size_t k = 0; k < 2000; ++k) trace.velocity_deg_s[k] = 60.0;
    const auto table = testing::paper_table();
    const std::vector<Contender> switching = {testing::contender("switching,table=paper.json", table)};
    const Recommendation found = recommend(switching, {trace.view()}, gear, {}, ripple_of(trace));
    REQUIRE(found.methods.size() == 1);
    CHECK(found.methods[0].delay == table->bands()[2].dc_delay);
    CHECK(found.methods[0].delay_at == DegPerSec(63.0));
}

TEST_CASE("looser limits give the same or a better answer, and every answer is within its limits") {
    const Trace trace = log_of(1.0, 5.0);
    for (const double db : {0.0, 10.0, 20.0, 30.0, 90.0}) {
        double before = 1e9;
        for (const double ms : {0.0, 2.0, 6.0, 20.0, 80.0}) {
            RecommendationLimits limits{Seconds(1e-3 * ms), db, std::nullopt};
            const Recommendation found = recommended(trace, limits);
            const JudgedMethod& first = *found.taken();
            if (!first.meets()) {
                CHECK(found.finding == RecommendationFinding::out_of_reach);
                CHECK_THAT(recommendation_verdict(found), Catch::Contains("None fits: the nearest is"));
                CHECK(before == 1e9);
                continue;
            }
            CHECK(1e3 * first.delay->value() <= ms);
            for (const OrderAttenuation& order : first.figures.attenuation)
                if (order.order == 1.0) CHECK(*order.db >= db);
            CHECK(first.error_nm() <= before);
            before = first.error_nm();
        }
        CHECK((before < 1e9) == (db < 90.0));
    }
}

// The laws of the one measurement, on simulated logs whose true torque is known.

namespace {

struct KnownLog {
    Trace trace;
    std::vector<double> true_nm;
};

// Of each kind of motion in turn; a log begins and ends anywhere in it, at standstill or at full speed.
KnownLog known_log(unsigned seed) {
    std::mt19937 engine(seed);
    const auto within = [&](double from, double to) {
        return from + (to - from) * std::uniform_real_distribution<double>()(engine);
    };
    constexpr std::array motions = {
        "constant,speed=40deg/s,duration=10s",
        "ramp,from-speed=10deg/s,to-speed=80deg/s,duration=10s",
        "sine,amplitude=40deg,frequency=0.2Hz,phase=-90deg,duration=10s",
        "sine,amplitude=25deg,frequency=0.3Hz,phase=0deg,duration=10s",
        "multisine,amplitude=80deg,frequency=0.1Hz,duration=10s",
        "fourier,speeds=20:-15:12:8:-6,duration=10s",
        "poly6,from=-80deg,to=120deg,duration=10s",
        "sweep,amplitude=15deg,from-frequency=0.1Hz,to-frequency=0.8Hz,duration=10s"};
    const Motion motion = make_motion(motions[seed % motions.size()], Hertz(500.0));
    const auto first = static_cast<std::size_t>(within(0.0, 500.0));
    const auto end = motion.position_deg.size() - static_cast<std::size_t>(within(0.0, 500.0));
    const double weight_nm = within(0.0, 10.0), friction_nm = within(0.2, 2.0), inertia = within(0.0, 0.02),
                 first_nm = within(0.2, 1.0), second_nm = within(0.1, 0.6), noise_nm = within(0.02, 0.08);
    std::normal_distribution<double> noise(0.0, noise_nm);
    KnownLog log;
    log.trace.sample_rate = Hertz(500.0);
    for (std::size_t k = first; k < end; ++k) {
        const double angle = motion.position_deg[k] * std::numbers::pi / 180.0, v = motion.velocity_deg_s[k];
        log.true_nm.push_back(weight_nm * std::sin(angle) + friction_nm * std::tanh(v / 3.0) +
                              inertia * motion.acceleration_deg_s2[k]);
        log.trace.time_s.push_back(static_cast<double>(k - first) / 500.0);
        log.trace.velocity_deg_s.push_back(v);
        log.trace.position_deg.push_back(motion.position_deg[k]);
        log.trace.torque_nm.push_back(log.true_nm.back() + first_nm * std::cos(100.0 * angle + 1.0) +
                                      second_nm * std::cos(200.0 * angle + 2.0) + noise(engine));
    }
    return log;
}

std::vector<Contender> tried_in_both_forms() {
    std::vector<Contender> all = tried();
    all.push_back(contender("oscillator,gear-ratio=100,orders=1:2,output=minus-ripple"));
    return all;
}

LogLevels measured(const std::vector<Contender>& methods, const KnownLog& log) {
    const TraceView view = log.trace.view();
    return measure_on_log(methods, {.trace = view, .truth_nm = log.true_nm}, &gear,
                          estimate_ripple({&view, 1}, gear.ratio, gear.orders), std::nullopt);
}

}  // namespace

TEST_CASE(
    "methods stand in the order of their true errors, whatever the motion, wherever a log begins and ends") {
    const std::vector<Contender> methods = tried_in_both_forms();
    int near = 0, pairs = 0, swapped = 0;
    for (unsigned seed = 1; seed <= 40; ++seed) {
        const std::vector<MethodFigures> figures = measured(methods, known_log(seed)).methods;
        REQUIRE(figures.front().error_nm);
        const auto least = [&](auto error) {
            return *std::min_element(figures.begin(), figures.end(),
                                     [&](const auto& a, const auto& b) { return *(a.*error) < *(b.*error); });
        };
        const double best = *least(&MethodFigures::error_rms_nm).error_rms_nm;
        const double taken = *least(&MethodFigures::error_nm).error_rms_nm;
        near += taken <= 1.2 * best ? 1 : 0;
        for (const MethodFigures& a : figures) {
            for (const MethodFigures& b : figures) {
                if (!(1.2 * *a.error_rms_nm < *b.error_rms_nm)) continue;
                ++pairs;
                if (*a.error_nm < *b.error_nm) continue;
                ++swapped;
                UNSCOPED_INFO("log " << seed << ": " << a.method << ", " << *a.error_rms_nm << " and "
                                     << b.method << ", " << *b.error_rms_nm << " stand the other way, "
                                     << *a.error_nm << " and " << *b.error_nm);
            }
        }
    }
    CHECK(near >= 38);
    CHECK(swapped * 100 <= pairs);
}

TEST_CASE("a filter that has run is measured as one that is compared") {
    const KnownLog log = known_log(3);
    for (const char* text : {"lowpass,cutoff=10Hz,order=1", "oscillator,gear-ratio=100,orders=1:2"}) {
        const Contender method = contender(text);
        KeptRows kept;
        kept.trace = log.trace;
        kept.out_nm = output_on_log(method, {log.trace.view()});
        kept.rows = 2 * log.trace.size();
        const LogLevels ran = measure_kept(method, kept, gear), compared = measured({method}, log);
        CHECK(ran.methods.front().error_nm == compared.methods.front().error_nm);
        CHECK(ran.methods.front().start_ratio == compared.methods.front().start_ratio);
        CHECK(ran.methods.front().moved_nm == compared.methods.front().moved_nm);
        CHECK(ran.lines.orders[0].amplitude_nm == compared.lines.orders[0].amplitude_nm);
        CHECK(ran.lines.measured_share == Approx(0.5 * compared.lines.measured_share));
    }
}
