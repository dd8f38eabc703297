// SPDX-License-Identifier: MIT
#include "filter/kernels/block_sections.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <span>
#include <vector>

#include "core/vectors/lanes.hpp"
#include "filter/kernels/bank_sections.hpp"
#include "ripplenotch/core/biquad.hpp"

namespace ripplenotch {

namespace {

// The response over eight steps to a memory and an input at one of the samples (or none: `at` beyond them).
struct Course {
    BlockForm::Memory memory{};
    std::array<double, BlockForm::samples> outputs{};

    void run(std::span<const Biquad> sections, std::size_t at) {
        for (std::size_t k = 0; k < BlockForm::samples; ++k) {
            double signal = k == at ? 1.0 : 0.0;
            for (std::size_t i = 0; i < sections.size(); ++i) {
                const Biquad& f = sections[i];
                double& s1 = memory[2 * i];
                double& s2 = memory[2 * i + 1];
                const double y = f.b0 * signal + s1;
                s1 = f.b1 * signal + s2 - f.a1 * y;
                s2 = f.b2 * signal - f.a2 * y;
                signal = y;
            }
            outputs[k] = signal;
        }
    }
};

}  // namespace

BlockForm::BlockForm(std::span<const Biquad> sections) {
    for (std::size_t j = 0; j < samples; ++j) {
        Course course;
        course.run(sections, j);
        feed[j] = course.outputs;
        drive[j] = course.memory;
    }
    for (std::size_t k = 0; k < 2 * sections.size(); ++k) {
        Course course;
        course.memory[k] = 1.0;
        course.run(sections, samples);
        recall[k] = course.outputs;
        turn[k] = course.memory;
    }
}

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

/// Finite and far from infinity: times this is still a number. No filter in use amplifies by the remaining
/// factor.
constexpr double headroom = 1e140;

template <class Lanes>
RIPPLENOTCH_INLINED void weigh(Lanes& excess, const Lanes& values) {
    Lanes scale;
    fill(scale, headroom);
    const Lanes scaled = values * scale;
    excess = excess + (scaled - scaled);  // zero, or not a number
}

/// Adds the contribution of four inputs, to the outputs that depend on them and to the memory.
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

namespace {

constexpr std::size_t sections_a_pass = BlockForm::memory / 2;
constexpr std::size_t most_at_once = 1024;  // samples that stay in the first cache between passes

}  // namespace

BlockCascade::BlockCascade(std::span<const Biquad> sections) {
    for (std::size_t i = 0; i < sections.size(); i += sections_a_pass) {
        passes_.push_back({BlockForm(sections.subspan(i, std::min(sections_a_pass, sections.size() - i)))});
    }
    before_.resize(passes_.size());
}

void BlockCascade::start(double origin) {
    origin_ =
        origin + 0.0;  // +0 for -0: then a zero's sign, which a sum may lose, does not show in the output
    known_ = 0;
    for (BlockPass& pass : passes_) pass.memory = {};
}

void BlockCascade::run(std::span<const double> in, std::span<double> out) {
    std::size_t at = 0;
    while (at < in.size()) {
        const std::size_t left = in.size() - at;
        if (known_ == 0 && left >= group) {
            const std::size_t count = std::min(left, most_at_once) / group * group;
            if (!run_whole(in.subspan(at, count), out.subspan(at, count))) {
                for (std::size_t k = at; k < at + count; k += group) {
                    std::copy_n(in.begin() + static_cast<std::ptrdiff_t>(k), group, inputs_.begin());
                    run_group_by_output(out.subspan(k, group), 0, group);
                }
            }
            at += count;
            continue;
        }
        const std::size_t count = std::min(left, group - known_);
        std::copy_n(in.begin() + static_cast<std::ptrdiff_t>(at), count,
                    inputs_.begin() + static_cast<std::ptrdiff_t>(known_));
        run_group_by_output(out.subspan(at, count), known_, known_ + count);
        known_ = (known_ + count) % group;
        at += count;
    }
}

bool BlockCascade::run_whole(std::span<const double> in, std::span<double> out, bool whatever) {
    return run_groups(passes_, in, origin_, out, whatever);
}

// Each output from the inputs that it depends on; those that follow count as settled, and their coefficients
// are zero.
void BlockCascade::run_group_by_output(std::span<double> out, std::size_t from, std::size_t to) {
    for (std::size_t k = from; k < to; ++k) {
        std::array<double, group> in, result;
        const auto next = static_cast<std::ptrdiff_t>(k) + 1;
        std::fill(std::copy(inputs_.begin(), inputs_.begin() + next, in.begin()), in.end(), origin_);
        std::transform(passes_.begin(), passes_.end(), before_.begin(),
                       [](const BlockPass& pass) { return pass.memory; });
        static_cast<void>(run_whole(in, result, true));
        out[k - from] = result[k];
        if (k + 1 == group) return;  // the memory after the whole group stays
        for (std::size_t i = 0; i < passes_.size(); ++i) passes_[i].memory = before_[i];
    }
}

namespace {

/// A log is longer than the trial, and may be worse.
constexpr double trial_reserve = 4.0;

constexpr double largest_radius = 0.999;          // chosen, not derived
constexpr double time_constants = 40.0;           // until nothing is left of what was before
constexpr int steps = 24, turns = 4, noises = 4;  // chosen, not derived: extent of the trial

// Not std::uniform_real_distribution, which may differ between libraries: a filter must be chosen alike
// everywhere.
double between_minus_one_and_one(std::mt19937_64& engine) {
    return static_cast<double>(static_cast<std::int64_t>(engine() >> 11)) * 0x1p-52 - 1.0;
}

/// Both ways side by side.
class Trial {
  public:
    explicit Trial(std::span<const Biquad> sections)
        : sections_(sections), states_(sections.size()), blocks_(sections) {
        blocks_.start(0.0);
    }

    void hear(std::span<const double> signal) {
        serial_.resize(signal.size());
        run_serial(sections_, states_, signal, 0.0, serial_);
        in_blocks_.resize(signal.size());
        blocks_.run(signal, in_blocks_);
        for (std::size_t k = 0; k < signal.size(); ++k)
            largest_ = std::max(largest_, std::abs(serial_[k] - in_blocks_[k]));
    }

    [[nodiscard]] double largest() const { return largest_; }

  private:
    std::span<const Biquad> sections_;
    std::vector<BiquadState> states_;
    BlockCascade blocks_;
    std::vector<double> serial_, in_blocks_;
    double largest_ = 0.0;
};

/// The signs of the impulse response backward in time, so that all of it adds up at the last sample.
std::vector<double> turning_signs(std::span<const Biquad> sections, std::size_t length) {
    std::vector<double> response(length);
    response.front() = 1.0;
    std::vector<BiquadState> states(sections.size());
    run_serial(sections, states, response, 0.0, response);
    for (double& value : response) value = std::copysign(1.0, value);
    std::reverse(response.begin(), response.end());
    return response;
}

}  // namespace

double trial_difference(std::span<const Biquad> sections) {
    const double radius = pole_radius(sections);
    if (!(radius <= largest_radius)) return std::numeric_limits<double>::infinity();
    std::vector<double> signal(static_cast<std::size_t>(time_constants / (1.0 - radius)));
    std::mt19937_64 engine(1);
    Trial trial(sections);
    for (int i = 0; i < steps; ++i) {
        std::fill(signal.begin(), signal.end(), between_minus_one_and_one(engine));
        trial.hear(signal);
    }
    std::vector<double> signs = turning_signs(sections, signal.size());
    for (int i = 0; i < turns; ++i) {
        trial.hear(signs);
        for (double& value : signs) value = -value;
    }
    for (int i = 0; i < noises; ++i) {
        for (double& value : signal) value = between_minus_one_and_one(engine);
        trial.hear(signal);
    }
    // Filters run relative to the first sample of a log, so they may meet twice its largest torque.
    return 2.0 * trial.largest();
}

bool block_form_serves(std::span<const Biquad> sections) {
    return !sections.empty() && trial_reserve * trial_difference(sections) <= most_block_difference;
}

}  // namespace ripplenotch
