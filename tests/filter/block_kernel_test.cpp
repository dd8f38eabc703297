// SPDX-License-Identifier: MIT
// The block form against the recursion, sample by sample: how near it is, and that neither pieces nor
// instruction sets show in it.

#include <cstring>
#include <limits>

#include "filter/kernels/bank_sections.hpp"
#include "filter/kernels/block_sections.hpp"
#include "filter/tables.hpp"
#include "ripplenotch/design/notch.hpp"
#include "support/catch.hpp"
#include "support/vectors.hpp"

using namespace ripplenotch;
using namespace ripplenotch::testing;

namespace {

constexpr std::size_t most_sections = 6;

// Poles anywhere within the circle, up to a hundredth of it; numerators of any kind, unity gain at 0 Hz.
Biquad some_section(std::mt19937& engine) {
    Biquad f;
    const double radius = between(0.0, 0.99, engine);
    if (between(0.0, 1.0, engine) < 0.5) {
        f.a1 = -2.0 * radius * std::cos(between(0.0, std::numbers::pi, engine));
        f.a2 = radius * radius;
    } else {
        const double other = between(-0.99, 0.99, engine);
        f.a1 = -(radius + other);
        f.a2 = radius * other;
    }
    f.b1 = between(-2.0, 2.0, engine);
    f.b2 = between(-1.0, 1.0, engine);
    f.b0 = 1.0 + f.a1 + f.a2 - f.b1 - f.b2;
    return f;
}

Cascade some_cascade(std::mt19937& engine) {
    Cascade sections(std::uniform_int_distribution<std::size_t>(1, most_sections)(engine));
    for (Biquad& section : sections) section = some_section(engine);
    return sections;
}

Cascade notches(std::initializer_list<double> centers_hz, double q, double rate_hz) {
    Cascade sections;
    for (const double hz : centers_hz)
        sections.push_back(design_notch({.center = Hertz(hz), .q = q}, Hertz(rate_hz)));
    return sections;
}

// Torque in [-1, 1]: noise for a while, then held, then a tone, and so on.
std::vector<double> torque(std::size_t count, std::mt19937& engine) {
    std::vector<double> values;
    for (int kind = 0; values.size() < count; ++kind) {
        const std::size_t length = std::uniform_int_distribution<std::size_t>(1, 3000)(engine);
        const double level = between(-1.0, 1.0, engine), turn = between(0.0, 3.0, engine);
        for (std::size_t k = 0; k < length && values.size() < count; ++k) {
            values.push_back(kind % 3 == 0   ? between(-1.0, 1.0, engine)
                             : kind % 3 == 1 ? level
                                             : level * std::cos(turn * static_cast<double>(k)));
        }
    }
    return values;
}

std::vector<double> in_blocks(const Cascade& sections, const std::vector<double>& in, bool wide,
                              std::size_t piece = std::numeric_limits<std::size_t>::max()) {
    const Width here(wide);
    BlockCascade filter(sections);
    filter.start(in.front());
    std::vector<double> out(in.size());
    for (std::size_t at = 0; at < in.size(); at += std::min(piece, in.size() - at)) {
        const std::size_t count = std::min(piece, in.size() - at);
        filter.run(std::span(in).subspan(at, count), std::span(out).subspan(at, count));
    }
    return out;
}

std::vector<double> by_sample(const Cascade& sections, const std::vector<double>& in) {
    std::vector<BiquadState> states(sections.size());
    std::vector<double> out;
    for (const double x : in) {
        double signal = x - in.front();
        for (std::size_t i = 0; i < sections.size(); ++i) signal = step(sections[i], states[i], signal);
        out.push_back(signal + in.front());
    }
    return out;
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
    double largest = 0.0;
    for (std::size_t k = 0; k < a.size(); ++k) largest = std::max(largest, std::abs(a[k] - b[k]));
    return largest;
}

}  // namespace

TEST_CASE("sections run together give the bits of one step after the other, for any number of them") {
    std::mt19937 engine(1);
    for (std::size_t count = 0; count <= 11; ++count) {
        Cascade sections(count);
        for (Biquad& section : sections) section = some_section(engine);
        const std::vector<double> in = torque(5000, engine);
        std::vector<double> out(in.size());
        std::vector<BiquadState> states(count);
        run_serial(sections, states, std::span(in).first(1234), in.front(), std::span(out).first(1234));
        run_serial(sections, states, std::span(in).subspan(1234), in.front(), std::span(out).subspan(1234));
        CHECK(same_bits(out, by_sample(sections, in)));
    }
}

TEST_CASE("a random cascade that goes in blocks stays within 1e-12 of the recursion, and most do") {
    std::mt19937 engine(2);
    int served = 0;
    for (int trial = 0; trial < 60; ++trial) {
        const Cascade sections = some_cascade(engine);
        if (!block_form_serves(sections)) continue;
        ++served;
        const auto in = torque(60000, engine);
        for (const bool wide : widths())
            CHECK(largest_difference(in_blocks(sections, in, wide), by_sample(sections, in)) < 1e-12);
    }
    CHECK(served > 20);
}

TEST_CASE("pieces and instruction sets do not show in the block form, to the last bit") {
    std::mt19937 engine(3);
    for (int trial = 0; trial < 12; ++trial) {
        const Cascade sections = some_cascade(engine);
        const auto in = torque(10007, engine);
        const auto expected = in_blocks(sections, in, false);
        for (const bool wide : widths()) {
            for (const std::size_t piece : {1UL, 3UL, 7UL, 8UL, 9UL, 1000UL, 4096UL, 100000UL})
                CHECK(same_bits(in_blocks(sections, in, wide, piece), expected));
        }
    }
}

TEST_CASE(
    "an input is not heard before its time, be it infinite, no number or huge, in pieces of any length") {
    std::mt19937 engine(4);
    for (const double bad :
         {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN(), -1e300, 1e160}) {
        for (const std::size_t at : {3UL, 16UL, 1029UL, 2047UL}) {
            const Cascade sections = some_cascade(engine);
            auto in = torque(3000, engine);
            const auto before = in_blocks(sections, in, false);
            in[at] = bad;
            for (const bool wide : widths()) {
                const auto whole = in_blocks(sections, in, wide), pieces = in_blocks(sections, in, wide, 7);
                CHECK(std::memcmp(whole.data(), before.data(), at * sizeof(double)) == 0);
                CHECK(whole[at] != before[at]);
                CHECK(same_bits(whole, pieces));
            }
        }
    }
}

TEST_CASE("the block form can be left and entered at a group's edge: its memory is that of the recursion") {
    std::mt19937 engine(5);
    const Cascade sections = {some_section(engine), some_section(engine)};
    const auto in = torque(16, engine);
    std::vector<BiquadState> states(2);
    std::vector<double> out(in.size());
    run_serial(sections, states, in, 0.0, out);
    std::vector<BlockPass> passes = {{BlockForm(sections)}};
    REQUIRE(run_groups(passes, in, 0.0, out));
    const BlockForm::Memory expected = {states[0].s1, states[0].s2, states[1].s1, states[1].s2};
    for (std::size_t k = 0; k < expected.size(); ++k)
        CHECK(passes[0].memory[k] == Approx(expected[k]).epsilon(0).margin(1e-12));
}

TEST_CASE("the paper's notch goes in blocks, a notch of 0.5 Hz at 10 kHz does not") {
    CHECK(block_form_serves(notches({25.0, 50.0}, 0.25, 1000.0)));
    CHECK(block_form_serves(notches({60.0, 120.0}, 5.0, 2000.0)));
    CHECK(block_form_serves(design_low_pass({.cutoff = Hertz(2.07), .order = 1}, Hertz(1000.0))));
    CHECK_FALSE(block_form_serves(notches({0.5, 1.0}, 0.25, 10000.0)));
    CHECK_FALSE(block_form_serves(design_low_pass({.cutoff = Hertz(2.07), .order = 4}, Hertz(4000.0))));
}

// The table of docs/studies/methods.md.
TEST_CASE("the trial's differences are those that the documentation states, and decide the way") {
    const auto low_pass = [](double cutoff_hz, int order) {
        return design_low_pass({.cutoff = Hertz(cutoff_hz), .order = order}, Hertz(1000.0));
    };
    const double slow_hz = 13.0 / (2.0 * std::numbers::pi);
    struct Row {
        Cascade sections;
        double stated;
        bool serves;
    };
    const std::vector<Row> rows = {
        {notches({25.0, 50.0}, 0.25, 1000.0), 4.33e-14, true},
        {notches({60.0, 120.0}, 5.0, 2000.0), 7.98e-14, true},
        {notches({5.0, 10.0}, 0.25, 1000.0), 4.9e-13, false},
        {low_pass(slow_hz, 1), 2.5e-14, true},
        {low_pass(13.0, 4), 1.06e-13, true},
        {low_pass(slow_hz, 2), 1.68e-12, false},
    };
    for (const Row& row : rows) {
        const double difference = trial_difference(row.sections);
        INFO(row.stated << " stated, " << difference);
        CHECK(difference <= 1.02 * row.stated);
        CHECK(difference >= 0.98 * row.stated);
        CHECK(block_form_serves(row.sections) == row.serves);
    }
}

TEST_CASE(
    "fixed and lowpass in a hurry stay within 1e-12 of full scale, start settled, and start anew after a "
    "gap") {
    for (const std::string text : {"fixed,centers=25Hz:50Hz", "fixed,centers=31Hz:62Hz:93Hz,q=2",
                                   "lowpass,cutoff=13Hz", "lowpass,cutoff=30Hz,order=5"}) {
        INFO(text);
        Signals s = wandering(20000, 3);
        double full_scale = 0.0;
        for (const double x : s.torque_nm) full_scale = std::max(full_scale, std::abs(x));
        const auto plain = start(text), quick = start(text), pieces = start(text);
        CHECK(quick->hurry().find("in blocks") != std::string::npos);
        CHECK_FALSE(pieces->hurry().empty());
        const auto expected = filtered(*plain, s.samples()), out = filtered(*quick, s.samples());
        CHECK(largest_difference(out, expected) < 1e-12 * full_scale);
        CHECK_FALSE(same_bits(out, expected));  // or the kernel did not run
        std::vector<double> joined(out.size());
        for (std::size_t at = 0; at < out.size(); at += 1009) {
            const std::size_t count = std::min<std::size_t>(1009, out.size() - at);
            pieces->process(s.part(at, count), std::span(joined).subspan(at, count));
        }
        CHECK(same_bits(joined, out));
        quick->restart();
        CHECK(same_bits(filtered(*quick, s.samples()), out));
        s.torque_nm.assign(4000, -0.512);
        quick->restart();
        CHECK(same_bits(filtered(*quick, {s.velocity_deg_s, s.torque_nm, {}}), s.torque_nm));
    }
}
