// SPDX-License-Identifier: MIT
// Sums over sweeps that are made in a quicker way than they are written: what they are by themselves.
#include <cmath>
#include <numbers>
#include <random>

#include "analysis/motion/motion_lines.hpp"
#include "ripplenotch/analysis/stack.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;

namespace {

// Forth and back over several turns at changing speed, with torque that nothing smooth explains.
struct Moved {
    Trace trace;
    std::vector<Sweep> sweeps;

    Moved() {
        trace.sample_rate = Hertz(500.0);
        std::mt19937 random(3);
        std::normal_distribution<double> noise(0.0, 0.3);
        for (int k = 0; k < 12'000; ++k) {
            const double t = k / 500.0, phase = 2.0 * std::numbers::pi * t / 6.0;
            trace.time_s.push_back(t);
            trace.position_deg.push_back(300.0 * std::sin(phase));
            trace.velocity_deg_s.push_back(300.0 * std::cos(phase) * 2.0 * std::numbers::pi / 6.0);
            trace.torque_nm.push_back(2.0 + 0.01 * trace.position_deg.back() + noise(random));
        }
        const TraceView log = trace.view();
        sweeps = cut_sweeps({&log, 1}, {}).pieces;
    }
};

// The smooth terms of a sweep at one of its samples.
std::vector<double> smooth_at(const Sweep& sweep, std::size_t k) {
    const double u = std::abs(sweep.turns[k] - sweep.turns.front()) / sweep.length_turns;
    std::vector<double> terms{1.0, u - 0.5};
    for (std::size_t m = 1; m + 1 < sweep.trend_terms; ++m)
        terms.push_back(std::cos(std::numbers::pi * static_cast<double>(m) * u));
    return terms;
}

}  // namespace

TEST_CASE("what is left of a sweep is at right angles to its smooth part and to lines taken out beside it") {
    const Moved moved;
    REQUIRE(moved.sweeps.size() > 3);
    const std::vector<KnownLine> lines{{Axis::angle, 40.0}, {Axis::time, 17.0}};
    for (const std::size_t taken : {0U, 1U, 2U}) {
        for (Sweep sweep : moved.sweeps) {
            fit_out(sweep, std::span(lines).first(taken));
            std::vector<double> with(sweep.trend_terms, 0.0), size(sweep.trend_terms, 0.0);
            double left = 0.0;
            std::vector<std::complex<double>> with_line(taken);
            for (std::size_t k = 0; k < sweep.value.size(); ++k) {
                const std::vector<double> terms = smooth_at(sweep, k);
                left += sweep.weight[k] * sweep.torque_nm[k] * sweep.torque_nm[k];
                for (std::size_t m = 0; m < terms.size(); ++m) {
                    with[m] += sweep.value[k] * terms[m];
                    size[m] += sweep.weight[k] * terms[m] * terms[m];
                }
                for (std::size_t i = 0; i < taken; ++i)
                    with_line[i] += std::polar(sweep.value[k], 2.0 * std::numbers::pi * lines[i].place *
                                                                   places(sweep, lines[i].axis)[k]);
            }
            // Line and first cosine are nearly parallel: the fit is held by 1e-10 of itself.
            for (std::size_t m = 0; m < with.size(); ++m)
                CHECK(std::abs(with[m]) < 1e-7 * std::sqrt(left * size[m]));
            for (const std::complex<double>& sum : with_line)
                CHECK(std::abs(sum) < 1e-7 * std::sqrt(left * sweep.weight_sum));
        }
    }
}

TEST_CASE("a line that is restored leaves what only the others explain") {
    const Moved moved;
    // Clear of each other and of the trend; near each other; an order and a tone that cross.
    for (const auto& lines : {std::vector<KnownLine>{{Axis::angle, 40.0}, {Axis::angle, 90.0}},
                              {{Axis::angle, 40.0}, {Axis::angle, 43.0}},
                              {{Axis::angle, 40.0}, {Axis::time, 17.0}}}) {
        std::vector<Sweep> removed = moved.sweeps;
        for (std::size_t count = 1; count <= lines.size(); ++count)
            remove_last(removed, std::span(lines).first(count));
        for (std::size_t restored = 0; restored < lines.size(); ++restored) {
            const std::vector<Sweep> with = with_line(removed, lines, restored);
            for (std::size_t i = 0; i < with.size(); ++i) {
                Sweep alone = moved.sweeps[i];
                fit_out(alone, std::span(lines).subspan(1 - restored, 1));
                double apart = 0.0, size = 0.0;
                for (std::size_t k = 0; k < alone.value.size(); ++k) {
                    apart += std::pow(with[i].value[k] - alone.value[k], 2);
                    size += std::pow(alone.value[k], 2);
                }
                // Lines ten cycles apart have a few thousandths of each other's amplitude in them.
                CHECK(apart < 5e-5 * size);
            }
        }
    }
}

TEST_CASE("each mean of a stack is over the sweeps") {
    const Moved moved;
    for (const Axis axis : {Axis::angle, Axis::time}) {
        const Stack whole = stack_sweeps(moved.sweeps, axis, {});
        // Against the sweeps one by one, each a stack of its own on the same bins.
        REQUIRE(whole.floors.size() == moved.sweeps.size());
        for (std::size_t k = whole.first; k < whole.ratio.size(); k += 37) {
            double square = 0.0, weight = 0.0;
            for (std::size_t i = 0; i < moved.sweeps.size(); ++i) {
                const double floor = static_cast<double>(whole.floors[i][k]),
                             sum = moved.sweeps[i].weight_sum;
                if (floor == 0.0) continue;
                square += whole.sweep_weights[i] * 4.0 * floor / (sum * sum);
                weight += whole.sweep_weights[i];
            }
            // The floors are kept as floats.
            if (weight > 0.0) CHECK(whole.floor_nm[k] == Approx(std::sqrt(square / weight)).epsilon(1e-6));
        }
    }
}

TEST_CASE("of no sweeps there is no stack") { CHECK(stack_sweeps({}, Axis::angle, {}).ratio.empty()); }
