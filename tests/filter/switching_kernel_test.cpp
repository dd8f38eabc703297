// SPDX-License-Identifier: MIT
// The kernels under the switching filter give the bits of one sample, one section, one candidate after the
// other.

#include <cstring>
#include <limits>

#include "core/rows/row_facts.hpp"
#include "filter/bank/filter_bank.hpp"
#include "filter/kernels/bank_sections.hpp"
#include "filter/kernels/in_series.hpp"
#include "filter/tables.hpp"
#include "support/catch.hpp"
#include "support/vectors.hpp"

using namespace ripplenotch;
using namespace ripplenotch::testing;

namespace {

CandidateTable some_table(std::size_t bands, std::size_t orders, std::mt19937& engine) {
    TableSpec spec = table_spec({});
    for (std::size_t i = 0; i < orders; ++i) spec.orders.push_back(Order(static_cast<double>(i + 1)));
    spec.q = between(0.2, 3.0, engine);
    if (engine() % 2 == 0) spec.depth_db = 30.0;
    const double last = 12.0 * static_cast<double>(bands + 1);
    spec.bands = bands_by_spacing({DegPerSec(12.0), DegPerSec(last)}, DegPerSec(12.0));
    return CandidateTable::design(spec);
}

bool same_bits(double a, double b) { return std::memcmp(&a, &b, sizeof a) == 0; }

}  // namespace

TEST_CASE(
    "a candidate in the bank gives the bits it gives alone, whatever the number of candidates and sections") {
    std::mt19937 engine(1);
    for (std::size_t bands = 1; bands <= 14; ++bands) {
        const std::size_t orders = 1 + bands % 5;
        const Candidates candidates(some_table(bands, orders, engine).bands());
        for (const bool wide : widths()) {
            const Width here(wide);
            FilterBank bank(candidates);
            std::vector<std::vector<BiquadState>> alone(bands, std::vector<BiquadState>(candidates.sections));
            const double origin = between(-2.0, 2.0, engine);
            bank.start(origin);
            std::size_t wrong = 0;
            for (const std::size_t count : {128UL, 1UL, 2UL, 77UL, 128UL, 3UL, 64UL}) {
                std::vector<double> in(count);
                for (double& value : in) value = between(-2.0, 2.0, engine);
                bank.run(in);
                for (std::size_t b = 0; b < bands; ++b) {
                    for (std::size_t k = 0; k < count; ++k) {
                        double signal = in[k] - origin;
                        for (std::size_t i = 0; i < candidates.sections; ++i)
                            signal = step(candidates.cascades[b][i], alone[b][i], signal);
                        wrong += !same_bits(bank.output(static_cast<int>(b), k), origin + signal);
                    }
                }
            }
            INFO(bands << " bands, " << orders << " sections, wide " << wide);
            CHECK(wrong == 0);
        }
    }
}

TEST_CASE("the first value outside a range is found wherever it is, by every instruction set") {
    std::mt19937 engine(2);
    const double infinity = std::numeric_limits<double>::infinity(),
                 nan = std::numeric_limits<double>::quiet_NaN();
    for (const bool wide : widths()) {
        const Width here(wide);
        for (const std::size_t size : {0UL, 1UL, 15UL, 16UL, 17UL, 64UL, 100UL}) {
            std::vector<double> values(size);
            for (double& value : values)
                value = (engine() % 2 == 0 ? 1.0 : -1.0) * between(18.001, 36.0, engine);
            CHECK(first_outside(values, 18.0, 36.0) == size);
            for (std::size_t at = 0; at < size; ++at) {
                const double kept = values[at];
                for (const double out : {18.0, -18.0, 36.0000001, -40.0, 0.0, nan, infinity, -infinity}) {
                    values[at] = out;
                    CHECK(first_outside(values, 18.0, 36.0) == at);
                }
                for (const double edge : {36.0, -36.0, 18.0000001}) {
                    values[at] = edge;
                    CHECK(first_outside(values, 18.0, 36.0) == size);
                }
                values[at] = kept;
            }
        }
        CHECK(first_outside(std::vector<double>(40, 1e9), 180.0, infinity) == 40);
        CHECK(first_outside(std::vector<double>(40, 0.0), -infinity, 18.0) == 40);
    }
}

TEST_CASE("direct form I gives the bits of one section after the other, in stretches of any length") {
    std::mt19937 engine(3);
    for (std::size_t sections = 1; sections <= 5; ++sections) {
        const Candidates candidates(some_table(1, sections, engine).bands());
        std::vector<Past> past(sections), alone(sections);
        const double origin = between(-2.0, 2.0, engine);
        for (const std::size_t count : {1UL, 2UL, 3UL, 4UL, 5UL, 1000UL, 1UL, 6UL, 7UL, 8UL, 9UL, 17UL}) {
            std::vector<double> in(count), out(count);
            for (double& value : in) value = between(-2.0, 2.0, engine);
            run_direct_form(candidates.cascades[0], past, in, origin, out);
            std::size_t wrong = 0;
            for (std::size_t k = 0; k < count; ++k) {
                double signal = in[k] - origin;
                for (std::size_t i = 0; i < sections; ++i)
                    signal = advance(candidates.cascades[0][i], alone[i], signal);
                wrong += !same_bits(out[k], origin + signal);
            }
            CHECK(wrong == 0);
        }
    }
}

// The sign of a zero shows what was added on the way.
TEST_CASE("sections in series change nothing but by their own steps, be the origin -0") {
    const auto pass = [](const Biquad& f, BiquadState& s, double x) { return step(f, s, x); };
    for (std::size_t count = 0; count <= 9; ++count) {
        const std::vector<Biquad> sections(count);
        std::vector<BiquadState> states(count);
        for (const double origin : {0.0, -0.0, 1.5}) {
            const std::vector<double> in = {origin, -0.0, 0.0, 3.0, -2.0};
            std::vector<double> out(in.size());
            run_in_series(std::span(sections), std::span(states), in, origin, out, pass);
            for (std::size_t k = 0; k < in.size(); ++k) {
                double signal = in[k] - origin;
                BiquadState state;
                for (std::size_t i = 0; i < count; ++i) signal = step(Biquad{}, state, signal);
                CHECK(same_bits(out[k], origin + signal));
            }
        }
    }
}
