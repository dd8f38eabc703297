// SPDX-License-Identifier: MIT
#include "filter/kernels/block_groups.hpp"

#include "filter/kernels/lanes.hpp"

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

template <class Lanes>
RIPPLENOTCH_INLINED void run_pass(BlockPass& pass, double* values, std::size_t count, double offset) {
    const double* const feed = pass.form.feed.front().data();
    const double* const recall = pass.form.recall.front().data();
    const double* const drive = pass.form.drive.front().data();
    const double* const turn = pass.form.turn.front().data();
    Lanes origin, memory;
    fill(origin, offset);
    load(memory, pass.memory.data());
    for (const double* const end = values + count; values != end; values += BlockForm::samples) {
        Lanes early, late, next, part, spread_memory[4];
#pragma GCC unroll 8
        for (std::size_t j = 0; j < BlockForm::samples; ++j) {
            Lanes x;
            fill(x, values[j]);
            // The first outputs know nothing of the last inputs.
            if (j < half) add_product(early, feed + j * BlockForm::samples, x, j == 0);
            add_product(late, feed + j * BlockForm::samples + half, x, j == 0);
            add_product(next, drive + j * BlockForm::memory, x, j == 0);
        }
        spread(spread_memory, memory);
        multiply(part, recall, BlockForm::samples, spread_memory);
        store(values, early + part + origin);
        multiply(part, recall + half, BlockForm::samples, spread_memory);
        store(values + half, late + part + origin);
        multiply(part, turn, BlockForm::memory, spread_memory);
        memory = next + part;
    }
    store(pass.memory.data(), memory);
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

template <class Lanes>
RIPPLENOTCH_INLINED bool run_all(std::span<BlockPass> passes, std::span<const double> in, double origin,
                                 std::span<double> out, bool whatever) {
    Lanes origins, values, excess;
    fill(origins, origin);
    fill(excess, 0.0);
    for (const BlockPass& pass : passes) {
        load(values, pass.memory.data());
        weigh(excess, values);
    }
    for (std::size_t k = 0; k < in.size(); k += half) {
        load(values, in.data() + k);
        values = values - origins;
        weigh(excess, values);
        store(out.data() + k, values);
    }
    double lanes[4];
    store(lanes, excess);
    const bool moderate = lanes[0] == 0.0 && lanes[1] == 0.0 && lanes[2] == 0.0 && lanes[3] == 0.0;
    if (!moderate && !whatever) return false;
    for (BlockPass& pass : passes) {
        const double offset = &pass == &passes.back() ? origin : 0.0;
        run_pass<Lanes>(pass, out.data(), out.size(), offset);
    }
    return true;
}

}  // namespace

bool run_groups(std::span<BlockPass> passes, std::span<const double> in, double origin, std::span<double> out,
                bool whatever) {
    return run_all<TwoAndTwo>(passes, in, origin, out, whatever);
}

RIPPLENOTCH_TARGET_AVX2 bool run_groups_avx2(std::span<BlockPass> passes, std::span<const double> in,
                                             double origin, std::span<double> out, bool whatever) {
    return run_all<Four>(passes, in, origin, out, whatever);
}

}  // namespace ripplenotch
