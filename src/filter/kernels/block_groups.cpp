// SPDX-License-Identifier: MIT
#include "filter/kernels/block_groups.hpp"

#include "core/vectors/lanes.hpp"

namespace ripplenotch {
namespace {

constexpr std::size_t half = BlockForm::samples / 2;

template <class Lanes>
RIPPLENOTCH_INLINED void add_product(Lanes& sum, const double* column, const Lanes& factor, bool first) {
    Lanes coefficients;
    load(coefficients, column);
    sum = first ? coefficients * factor : sum + coefficients * factor;
}

/// The memory's four columns times its four lanes.
template <class Lanes>
RIPPLENOTCH_INLINED void multiply(Lanes& sum, const double* columns, std::size_t stride,
                                  const Lanes (&memory)[4]) {
    Lanes first, second, third, fourth;
    load(first, columns);
    load(second, columns + stride);
    load(third, columns + 2 * stride);
    load(fourth, columns + 3 * stride);
    sum = (first * memory[0] + second * memory[1]) + (third * memory[2] + fourth * memory[3]);
}

/// Finite and far from infinity: times this is still a number. No filter in use amplifies by what is left.
constexpr double headroom = 1e140;

template <class Lanes>
RIPPLENOTCH_INLINED void weigh(Lanes& excess, const Lanes& values) {
    Lanes scale;
    fill(scale, headroom);
    const Lanes scaled = values * scale;
    excess = excess + (scaled - scaled);  // zero, or not a number
}

/// What four inputs add, to the outputs that may know them and to the memory.
template <bool Early, class Lanes>
RIPPLENOTCH_INLINED void feed_four(const BlockForm& form, const Lanes& inputs, Lanes& early, Lanes& late,
                                   Lanes& next) {
    constexpr std::size_t first = Early ? 0 : half;
    Lanes x[4];
    spread(x, inputs);
#pragma GCC unroll 4
    for (std::size_t j = 0; j < half; ++j) {
        const bool begins = Early && j == 0;
        const double* const feed = form.feed[first + j].data();
        if (Early) add_product(early, feed, x[j], begins);
        add_product(late, feed + half, x[j], begins);
        add_product(next, form.drive[first + j].data(), x[j], begins);
    }
}

/// A stretch of signal on its way through one pass: out = plus + F(in - less).
struct Stretch {
    const double* in;
    double less;
    double* out;
    double plus;
    std::size_t count;
};

/// The first pass weighs its inputs on the way.
template <bool First, class Lanes>
RIPPLENOTCH_INLINED void run_pass(BlockPass& pass, const Stretch& stretch, Lanes& excess) {
    const BlockForm& form = pass.form;
    Lanes less, plus, memory;
    fill(less, stretch.less);
    fill(plus, stretch.plus);
    load(memory, pass.memory.data());
    for (std::size_t k = 0; k < stretch.count; k += BlockForm::samples) {
        Lanes low, high, early, late, next, part, spread_memory[4];
        load(low, stretch.in + k);
        load(high, stretch.in + k + half);
        if constexpr (First) {
            low = low - less;
            high = high - less;
            weigh(excess, low);
            weigh(excess, high);
        }
        feed_four<true>(form, low, early, late, next);
        feed_four<false>(form, high, early, late, next);
        spread(spread_memory, memory);
        multiply(part, form.recall.front().data(), BlockForm::samples, spread_memory);
        store(stretch.out + k, early + part + plus);
        multiply(part, form.recall.front().data() + half, BlockForm::samples, spread_memory);
        store(stretch.out + k + half, late + part + plus);
        multiply(part, form.turn.front().data(), BlockForm::memory, spread_memory);
        memory = next + part;
    }
    store(pass.memory.data(), memory);
}

struct RunGroups {
    template <class Lanes>
    RIPPLENOTCH_INLINED static bool run(std::span<BlockPass> passes, std::span<const double> in,
                                        double origin, std::span<double> out, bool whatever) {
        Lanes values, excess;
        fill(excess, 0.0);
        for (const BlockPass& pass : passes) {
            load(values, pass.memory.data());
            weigh(excess, values);
        }
        const BlockForm::Memory before = passes.front().memory;
        const auto plus = [&](std::size_t pass) { return pass + 1 == passes.size() ? origin : 0.0; };
        run_pass<true>(passes.front(), {in.data(), origin, out.data(), plus(0), in.size()}, excess);
        double lanes[4];
        store(lanes, excess);
        const bool moderate = lanes[0] == 0.0 && lanes[1] == 0.0 && lanes[2] == 0.0 && lanes[3] == 0.0;
        if (!moderate && !whatever) {
            passes.front().memory = before;
            return false;
        }
        for (std::size_t i = 1; i < passes.size(); ++i)
            run_pass<false>(passes[i], {out.data(), 0.0, out.data(), plus(i), out.size()}, excess);
        return true;
    }
};

}  // namespace

bool run_groups(std::span<BlockPass> passes, std::span<const double> in, double origin, std::span<double> out,
                bool whatever) {
    return in_lanes<RunGroups>(passes, in, origin, out, whatever);
}

}  // namespace ripplenotch
