// SPDX-License-Identifier: MIT
// The laws of the one measurement, on simulated logs whose true torque is known.

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include "evaluate/contenders.hpp"
#include "ripplenotch/evaluate/filter_metrics.hpp"
#include "ripplenotch/filter/engine.hpp"
#include "ripplenotch/model/motion.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using namespace ripplenotch::testing;

namespace {

const GearAccount gear{GearRatio(100.0), {Order(1.0), Order(2.0)}, {}, {}, "test"};

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

std::vector<Contender> tried() {
    std::vector<Contender> all;
    for (const char* text :
         {"none", "lowpass,cutoff=3Hz,order=1", "lowpass,cutoff=10Hz,order=1",
          "tracking,gear-ratio=100,orders=1:2", "tracking,gear-ratio=100,orders=1:2,q=4",
          "oscillator,gear-ratio=100,orders=1:2", "oscillator,gear-ratio=100,orders=1:2,output=minus-ripple"})
        all.push_back(contender(text));
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
    const std::vector<Contender> methods = tried();
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
