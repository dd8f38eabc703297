// SPDX-License-Identifier: MIT
// Laws of the engine: what its parts must do for any log, and that effects hidden in a log are named.

#include "diagnose/engine/engine.hpp"

#include <cmath>

#include "core/matrices/linear_algebra.hpp"
#include "diagnose/engine/criterion.hpp"
#include "diagnose/engine/search.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/model/motion.hpp"
#include "ripplenotch/model/noise.hpp"
#include "support/catch.hpp"

namespace ripplenotch {
namespace {

using namespace engine;

constexpr double noise_nm = 0.05;

// A joint of known inertia, weight and ripple that moves back and forth at several speeds.
const Motion& motion() {
    static const Motion made =
        make_motion(std::vector<std::string>{"poly6,from=-60deg,to=70deg,duration=3s", "rest,duration=0.3s",
                                             "poly6,to=-50deg,duration=1.4s", "poly6,to=40deg,duration=5s",
                                             "poly6,to=-70deg,duration=2.2s",
                                             "sine,amplitude=40deg,frequency=0.4Hz,"
                                             "duration=5s",
                                             "poly6,to=60deg,duration=1.8s", "poly6,to=-60deg,duration=4s"},
                    Hertz(1000.0));
    return made;
}

Model known_joint() {
    Model model{GearRatio(100.0), {}};
    for (const char* term :
         {"inertia,inertia_kgm2=0.4", "gravity,amplitude_nm=3,phase_deg=20",
          "ripple,order=1,amplitude_nm=0.2,phase_deg=30", "ripple,order=2,amplitude_nm=0.3,phase_deg=-70"})
        model.terms.push_back(parse_term(term));
    return model;
}

Trace log_of(const Model& truth, std::uint64_t seed = 1) {
    std::vector<double> noise(motion().size(), 0.0);
    add_noise(noise, {.rms = noise_nm, .correlation = 0.5}, seed, NoiseChannel::torque);
    Trace log{"",
              "",
              motion().sample_rate,
              motion().time_s,
              motion().velocity_deg_s,
              measure_nm(truth, motion(), noise),
              motion().position_deg};
    return log;
}

Result diagnosed(const Trace& log) {
    const Model model = known_joint();
    return find_missing_effects({.log = log.view(), .model = model});
}

std::vector<std::string> names(const Result& result) {
    std::vector<std::string> found;
    for (const AdoptedTerm& term : result.terms) found.emplace_back(term.term.effect->name);
    return found;
}

struct Bench {
    Trace log = log_of(known_joint());
    Model model = known_joint();
    RecordedMotion recorded{log.view(), std::nullopt};
    Baseline base;
    std::shared_ptr<const SaturatedFit> noise;

    Bench() {
        recorded.smooth(0.02);
        base = make_baseline(recorded, {.model = &model}, 0.4 / degrees_per_radian);
        noise = std::make_shared<const SaturatedFit>(fit_saturated(recorded, base, {}, nullptr));
    }
};

const Bench& bench() {
    static const Bench made;
    return made;
}

SearchedTerm searched(std::string_view effect, double first = 0.0, double second = 0.0) {
    return {&term_kind(effect), {first, second}};
}

TEST_CASE("a clock of jittering stamps with lost rows is regular") {
    std::vector<double> time_s;
    std::vector<std::size_t> slots;
    for (std::size_t k = 0; k < 2000; ++k) {
        if (k % 97 == 13) continue;
        slots.push_back(k);
        time_s.push_back(5.0 + 0.002 * static_cast<double>(k) +
                         0.0004 * portable::sin(1.7 * static_cast<double>(k)));
    }
    const Clock clock = regular_clock(time_s);
    CHECK(std::abs(clock.step_s - 0.002) < 1e-7);
    CHECK(clock.slot_of == slots);
}

TEST_CASE("smoothing leaves a cubic as it is") {
    std::vector<double> values, slope, curvature;
    for (int k = 0; k < 60; ++k) {
        const double t = 0.01 * k;
        values.push_back(3.0 + t * (2.0 + t * (-5.0 + 7.0 * t)));
        slope.push_back(2.0 + t * (-10.0 + 21.0 * t));
        curvature.push_back(-10.0 + 42.0 * t);
    }
    const SmoothedSignal found = smooth_signal(values, 11, 0.01);
    for (std::size_t k = 0; k < values.size(); ++k) {
        CHECK(std::abs(found.value[k] - values[k]) < 1e-9);
        CHECK(std::abs(found.slope_per_s[k] - slope[k]) < 1e-7);
        CHECK(std::abs(found.curvature_per_s2[k] - curvature[k]) < 1e-5);
    }
}

TEST_CASE("the torque of a size is that many times the column") {
    const Motion& along = bench().recorded.motion();
    const Situation situation{.motion = along, .ratio = GearRatio(100.0), .load_nm = bench().noise->load_nm};
    for (const TermKind& kind : term_kinds()) {
        if (kind.role != Role::joint_torque && kind.role != Role::sensor_torque) continue;
        // Its loop is that of a smooth motion.
        if (kind.effect->name == "hysteresis") continue;
        SearchedTerm term{&kind, {}};
        for (std::size_t v = 0; v < kind.searched.size(); ++v)
            term.values[v] = kind.searched[v].grid.empty() ? 7.0 : kind.searched[v].grid.front();
        const auto columns = unit_columns(*kind.effect, unit_values(term), situation);
        std::vector<double> values = unit_values(term);
        for (std::size_t p = 0; p < values.size(); ++p)
            if (kind.effect->parameters[p].linear) values[p] = 2.5;
        if (kind.effect->polar) values[kind.effect->polar->phase] = 0.0;
        std::vector<double> torque(along.size(), 0.0);
        kind.effect->apply(situation, values, torque);
        std::vector<double> whole = columns[0];
        for (std::size_t c = 1; c < columns.size() && !kind.effect->polar; ++c)
            for (std::size_t k = 0; k < whole.size(); ++k) whole[k] += columns[c][k];
        double worst = 0.0;
        for (std::size_t k = 0; k < torque.size(); ++k)
            worst = std::max(worst, std::abs(torque[k] - 2.5 * whole[k]) / (1.0 + std::abs(torque[k])));
        INFO(kind.effect->name);
        CHECK(worst < 1e-9);
    }
}

TEST_CASE("a transform of a sum is the sum of the transforms") {
    const Motion& along = bench().recorded.motion();
    const std::vector<double>&a = along.acceleration_deg_s2, &b = along.velocity_deg_s;
    std::vector<double> both(a.size());
    for (std::size_t k = 0; k < a.size(); ++k) both[k] = a[k] + 3.0 * b[k];
    for (const SearchedTerm& term : {searched("delay", 0.0031), searched("lag", 0.01),
                                     searched("sensor-lowpass", 30.0), searched("resonance", 25.0, 0.1)}) {
        const auto of_a = transformed(a, {term}, along), of_b = transformed(b, {term}, along);
        const auto of_both = transformed(both, {term}, along);
        double worst = 0.0;
        for (std::size_t k = 0; k < a.size(); ++k)
            worst = std::max(worst, std::abs(of_both[k] - of_a[k] - 3.0 * of_b[k]));
        INFO(term.kind->effect->name);
        CHECK(worst < 1e-7);
    }
}

TEST_CASE("the whitened noise is white and of size 1") {
    std::vector<double> white = bench().noise->residual_nm;
    filter_in_place(white, bench().noise->whitening);
    std::vector<double> used;
    for (std::size_t k = 0; k < white.size(); ++k)
        if (bench().recorded.usable()[k] != 0) used.push_back(white[k] / bench().noise->innovation_nm);
    const double count = static_cast<double>(used.size());
    for (std::size_t lag = 0; lag <= 10; ++lag) {
        double product = 0.0;
        for (std::size_t k = lag; k < used.size(); ++k) product += used[k] * used[k - lag] / count;
        CHECK(std::abs(product - (lag == 0 ? 1.0 : 0.0)) < (lag == 0 ? 0.02 : 0.04));
    }
    CHECK(std::abs(bench().noise->noise_nm / noise_nm - 1.0) < 0.05);
}

TEST_CASE("products of columns give the same fit as the columns themselves") {
    Criterion criterion(bench().recorded, bench().base, bench().noise);
    const SearchedTerms terms = {searched("viscous-friction"), searched("delay", 0.002)};
    const LinearFit& fit = criterion.fit(terms);
    SearchedTerms sorted = terms;
    std::sort(sorted.begin(), sorted.end());
    const Design design = criterion.design(sorted);
    const auto target = criterion.white().column(design.target);
    std::vector<double> residual(target.begin(), target.end());
    for (std::size_t c = 0; c < design.columns.size(); ++c) {
        const auto column = criterion.white().column(design.columns[c]);
        for (std::size_t k = 0; k < residual.size(); ++k)
            residual[k] -= fit.factors[static_cast<Eigen::Index>(c)] * column[k];
    }
    double squares = 0.0;
    for (const double r : residual) squares += r * r;
    // The squares of the fit hold those of the priors' departures, too.
    CHECK(fit.squares > 0.999999 * squares);
    CHECK(fit.squares < 1.01 * squares);
    for (std::size_t c = 0; c < design.columns.size(); ++c) {
        if (design.deviation[c] < 1e300) continue;
        const auto column = criterion.white().column(design.columns[c]);
        double along = 0.0, size = 0.0;
        for (std::size_t k = 0; k < residual.size(); ++k) {
            along += residual[k] * column[k];
            size += column[k] * column[k];
        }
        CHECK(std::abs(along) < 1e-3 * std::sqrt(size * squares));
    }
}

TEST_CASE("a log with nothing hidden gets no name") {
    const Result result = diagnosed(log_of(known_joint()));
    CHECK(names(result).empty());
    CHECK(std::abs(result.rms_after_nm / noise_nm - 1.0) < 0.05);
}

TEST_CASE("one hidden effect of each family is named, and its interval holds its value") {
    struct Hidden {
        const char *term, *parameter;
        double value;
    };
    for (const Hidden& hidden :
         {Hidden{"coulomb-friction,torque_nm=0.4,width_deg_s=0.5", "torque_nm", 0.4},
          Hidden{"viscous-friction,coefficient_nm_per_deg_s=0.004", "coefficient_nm_per_deg_s", 0.004},
          Hidden{"hysteresis,torque_nm=0.4,width_deg=3", "torque_nm", 0.4},
          Hidden{"drift,rate_nm_s=0.05,time_constant_s=10", "time_constant_s", 10.0},
          Hidden{"offset,torque_nm=0.2", "torque_nm", 0.2},
          Hidden{"tone,frequency_hz=50,amplitude_nm=0.1,phase_deg=10", "amplitude_nm", 0.1},
          Hidden{"output-ripple,order=4,amplitude_nm=0.2,phase_deg=50", "amplitude_nm", 0.2},
          Hidden{"ripple,order=4,amplitude_nm=0.1,phase_deg=50", "amplitude_nm", 0.1},
          Hidden{"ripple-speed-dependence,gain_percent=80,exponent=1", "gain_percent", 80.0},
          Hidden{"delay,delay_s=0.004", "delay_s", 0.004},
          Hidden{"gear-ratio,error_percent=0.4", "error_percent", 0.4}}) {
        Model truth = known_joint();
        const Term term = parse_term(hidden.term);
        truth.terms.push_back(term);
        const Result result = diagnosed(log_of(truth));
        INFO(hidden.term);
        CHECK(names(result) == std::vector<std::string>{std::string(term.effect->name)});
        if (result.terms.size() != 1) continue;
        for (const FittedValue& value : result.terms[0].values) {
            if (term.effect->parameters[value.parameter].name != hidden.parameter) continue;
            const double half = 0.5 * (value.ci95->high - value.ci95->low);
            CHECK(std::abs(value.value - hidden.value) < 2.0 * half + 1e-3 * std::abs(hidden.value));
            CHECK(half < 0.3 * std::abs(hidden.value));
        }
    }
}

TEST_CASE("a stated mass that is wrong is a finding") {
    Model stated = known_joint();
    stated.terms[0].values[0] = 0.3;
    const Trace log = log_of(known_joint());
    const Result result = find_missing_effects({.log = log.view(), .model = stated});
    CHECK(names(result) == std::vector<std::string>{"inertia"});
    if (result.terms.size() == 1) CHECK(std::abs(result.terms[0].values[0].value - 0.1) < 0.005);
}

TEST_CASE("a gap of an hour takes no memory and no name") {
    Trace log = log_of(known_joint());
    for (std::size_t k = log.size() / 2; k < log.size(); ++k) log.time_s[k] += 3600.0;
    CHECK(names(diagnosed(log)).empty());
}

TEST_CASE("a log at standstill is refused") {
    Trace log = log_of(known_joint());
    std::fill(log.position_deg.begin(), log.position_deg.end(), 12.0);
    std::fill(log.velocity_deg_s.begin(), log.velocity_deg_s.end(), 0.0);
    CHECK_THROWS_AS(diagnosed(log), DataError);
}

TEST_CASE("the same log gives the same result to the last bit") {
    Model truth = known_joint();
    truth.terms.push_back(parse_term("viscous-friction,coefficient_nm_per_deg_s=0.004"));
    const Result first = diagnosed(log_of(truth)), second = diagnosed(log_of(truth));
    CHECK(first.rms_after_nm == second.rms_after_nm);
    CHECK(first.residual_after_nm == second.residual_after_nm);
    REQUIRE(first.terms.size() == second.terms.size());
    for (std::size_t i = 0; i < first.terms.size(); ++i) CHECK(first.terms[i].term == second.terms[i].term);
}

}  // namespace
}  // namespace ripplenotch
