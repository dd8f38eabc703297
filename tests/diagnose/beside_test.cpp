// SPDX-License-Identifier: MIT
// Names beside a leftover, step by step, and on logs whose leftover nothing in the catalogue explains.

#include "diagnose/beside/finding/beside.hpp"

#include <algorithm>
#include <cmath>

#include "bench_fixture.hpp"
#include "diagnose/beside/weighing/color.hpp"
#include "diagnose/beside/weighing/ground.hpp"
#include "diagnose/beside/weighing/outside_gain.hpp"
#include "support/catch.hpp"

namespace ripplenotch {
namespace {

using fixture::slow_leftover;
using fixture::standard;
using fixture::strokes;

Trace log_beside(const Model& truth, std::uint64_t seed, double leftover_nm) {
    Trace log = fixture::logged(truth, strokes(), seed);
    const auto left = slow_leftover(strokes(), seed, leftover_nm);
    for (std::size_t k = 0; k < left.size(); ++k) log.torque_nm[k] += left[k];
    return log;
}

Model truth_of(std::initializer_list<const char*> terms) {
    Model model{GearRatio(100.0), {}};
    for (const char* term : terms) model.terms.push_back(parse_term(term));
    return model;
}

/// With `other` each finding has to hold on that log, too.
BesideOutcome found_in(const Trace& log, const Trace* other = nullptr) {
    const auto case_of = [](const Trace& trace) {
        return whole_case(trace.view(), default_smoothing, standard.recording);
    };
    const Case here = case_of(log), there = case_of(other != nullptr ? *other : log);
    const GivenCase validation{there};
    const Model none{GearRatio(100.0), {}};
    Work work(1e9);
    std::vector<const Effect*> effects(catalogue().begin(), catalogue().end());
    return find_beside({here}, other != nullptr ? &validation : nullptr, {none, none, {}, {}, 0.0, true},
                       effects, standard, work);
}

std::vector<std::string> confirmed(const BesideOutcome& outcome) {
    std::vector<std::string> names;
    for (const Finding& finding : outcome.findings) {
        if (finding.status == FindingStatus::confirmed) names.emplace_back(finding.term.effect->name);
    }
    std::sort(names.begin(), names.end());
    return names;
}

std::string told(const BesideOutcome& outcome) {
    std::string text;
    for (const Finding& finding : outcome.findings)
        text += std::string(finding.term.effect->name) + " " + std::string(status_name(finding.status)) +
                " " + finding.reason + "\n";
    return text;
}

}  // namespace

TEST_CASE("the colour of an autoregression of two lags is found, and nothing beyond it") {
    std::vector<double> white(60'000, 0.0), e(white.size(), 0.0);
    add_white_noise(white, 1.0, 3, NoiseChannel::torque);
    for (std::size_t k = 2; k < e.size(); ++k) e[k] = 1.2 * e[k - 1] - 0.5 * e[k - 2] + white[k];
    const auto color = long_color(e, 6, 0.0);
    REQUIRE(color.size() == 6);
    CHECK(color[0] == Approx(1.2).margin(0.02));
    CHECK(color[1] == Approx(-0.5).margin(0.02));
    for (std::size_t lag = 2; lag < 6; ++lag) CHECK(color[lag] == Approx(0.0).margin(0.02));
    // A hundredth of white noise besides shortens the memory.
    CHECK(std::abs(long_color(e, 6, 0.01)[0]) < color[0]);
    CHECK(long_color(std::vector<double>(500, 2.0), 6, 0.0).empty());
}

TEST_CASE(
    "a gain out of fold is the sum of its blocks, and its deviation counts how each is like the one before") {
    // Blocks of two rows whose squares fall by 4, 1, 1, 2.
    const std::vector<double> without = {2, 0, 1, 0, 1, 0, 1, 1}, with(8, 0.0);
    const std::vector<RowRange> blocks = {{0, 2}, {2, 2}, {4, 2}, {6, 2}};
    const OutsideGain gain = outside_gain(without, with, blocks, 0.5);
    CHECK(gain.by_block == std::vector<double>{16, 4, 4, 8});
    CHECK(gain.gain == 32);
    CHECK(gain.positive() == 4);
    CHECK(gain.without_best(2) == 8);
    // Mean 8: squares 64 + 16 + 16 + 0, products of neighbours -32 + 16 + 0.
    CHECK(gain.t == Approx(32.0 / std::sqrt(96.0 - 16.0)));
    CHECK(is_worth(gain, 8.0, standard.beside));
    CHECK_FALSE(is_worth(gain, 8.1, standard.beside));
}

TEST_CASE(
    "rows that do not count are bridged in every column alike, so that what holds between columns still "
    "does") {
    Case c = whole_case(fixture::logged(truth_of({"inertia,inertia_kgm2=0.4"}), strokes(), 7).view(),
                        default_smoothing, standard.recording);
    for (std::size_t k = 1000; k < 1300; ++k) c.use[k] = 0;
    Ground ground(c, standard.beside);
    std::vector<double> twice = c.torque_nm;
    for (double& value : twice) value = 2.0 * value + 3.0;
    const auto bridged = ground.bridged(c.torque_nm), other = ground.bridged(twice);
    for (std::size_t k = 0; k < bridged.size(); ++k) CHECK(other[k] == Approx(2.0 * bridged[k] + 3.0));
    ground.color({0.5});
    std::size_t rows = 0;
    for (const RowRange& fold : ground.folds()) rows += fold.count;
    CHECK(rows == ground.rows());
    CHECK(ground.rows() < c.used());
    for (std::size_t row = 0; row < ground.rows(); ++row) CHECK(c.use[ground.sample_of(row)] != 0);
}

TEST_CASE("nothing but a leftover names nothing, whatever the leftover") {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        const BesideOutcome outcome = found_in(log_beside(truth_of({}), seed, 0.8));
        INFO("seed " << seed << "\n" << told(outcome));
        CHECK(outcome.believed.empty());
    }
}

TEST_CASE("friction is named beside a leftover of its own size, and its interval holds the truth") {
    const BesideOutcome outcome =
        found_in(log_beside(truth_of({"coulomb-friction,torque_nm=0.9,width_deg_s=1"}), 5, 0.9));
    INFO(told(outcome));
    REQUIRE(confirmed(outcome) == std::vector<std::string>{"coulomb-friction"});
    const Finding& finding = outcome.findings[0];
    REQUIRE(finding.out_of_fold);
    CHECK(finding.size_uncertain);
    CHECK(finding.out_of_fold->blocks_positive > finding.out_of_fold->blocks / 2);
    REQUIRE(finding.values[0].ci95);
    CHECK(finding.values[0].ci95->low < 0.9);
    CHECK(finding.values[0].ci95->high > 0.9);
}

TEST_CASE("two frictions beside a leftover are found as the two that they are") {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
        const BesideOutcome outcome =
            found_in(log_beside(truth_of({"coulomb-friction,torque_nm=0.9,width_deg_s=1",
                                          "viscous-friction,coefficient_nm_per_deg_s=0.012",
                                          "ripple,order=2,amplitude_nm=0.3,phase_deg=40"}),
                                seed, 1.2));
        INFO("seed " << seed << "\n" << told(outcome));
        std::vector<std::string> believed;
        for (const Term& term : outcome.believed) believed.emplace_back(term.effect->name);
        std::sort(believed.begin(), believed.end());
        CHECK(believed == std::vector<std::string>{"coulomb-friction", "ripple", "viscous-friction"});
        // What grows with the speed and what grows with its square is a tie now and then.
        CHECK(confirmed(outcome).size() >= 2);
    }
}

TEST_CASE("what another log bears out is no name either while the interval of its size holds 0") {
    std::size_t doubted = 0;
    for (const char* effect :
         {"drift,rate_nm_s=0.05,time_constant_s=1000000", "viscous-friction,coefficient_nm_per_deg_s=0.01"}) {
        for (std::uint64_t seed = 1; seed <= 4; ++seed) {
            const Model truth = truth_of({"coulomb-friction,torque_nm=0.9,width_deg_s=1", effect});
            const Trace log = log_beside(truth, seed, 0.9), other = log_beside(truth, seed + 100, 0.9);
            const BesideOutcome outcome = found_in(log, &other);
            INFO(effect << ", seed " << seed << "\n" << told(outcome));
            for (const Finding& finding : outcome.findings) {
                if (finding.reason == "the interval of its size holds 0") ++doubted;
                if (finding.status != FindingStatus::confirmed) continue;
                for (const FittedValue& value : finding.values) {
                    const Effect& named = *finding.term.effect;
                    const bool is_size = named.parameters[value.parameter].linear ||
                                         (named.polar && named.polar->size == value.parameter);
                    if (is_size && value.ci95) CHECK((value.ci95->low > 0.0 || value.ci95->high < 0.0));
                }
            }
        }
    }
    CHECK(doubted > 0);  // or this asked nothing
}

}  // namespace ripplenotch
