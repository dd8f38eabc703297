// SPDX-License-Identifier: MIT
#include "filter/kernels/bank_sections.hpp"

#include <algorithm>
#include <utility>

#include "core/vectors/lanes.hpp"
#include "filter/kernels/in_series.hpp"

namespace ripplenotch {

namespace {

/// How many samples the second of two sections works behind the first: long enough for its input to have been
/// written and to be read again without being waited for.
constexpr std::size_t behind = 6;

/// Two sections in the lanes of one register. The output of the first for a sample waits in `out` for the
/// second.
void run_two(const Biquad& f, const Biquad& g, std::span<Past> past, std::span<const double> in,
             double origin, std::span<double> out) {
    for (std::size_t k = 0; k < behind; ++k) out[k] = advance(f, past[0], in[k] - origin);
    const Two b0 = {f.b0, g.b0}, b1 = {f.b1, g.b1}, b2 = {f.b2, g.b2}, a1 = {f.a1, g.a1}, a2 = {f.a2, g.a2};
    // x - 0 and -0 + x change no number, not even the sign of a zero.
    const Two less = {origin, 0.0}, plus = {-0.0, origin};
    Two x1 = {past[0].x1, past[1].x1}, x2 = {past[0].x2, past[1].x2}, y1 = {past[0].y1, past[1].y1},
        y2 = {past[0].y2, past[1].y2};
    for (std::size_t k = behind; k < in.size(); ++k) {
        const Two x = Two{in[k], out[k - behind]} - less;
        const Two y = b0 * x + b1 * x1 + b2 * x2 - a2 * y2 - a1 * y1;
        x2 = x1;
        x1 = x;
        y2 = y1;
        y1 = y;
        const Two result = plus + y;
        out[k] = result[0];
        out[k - behind] = result[1];
    }
    past[0] = {x1[0], x2[0], y1[0], y2[0]};
    past[1] = {x1[1], x2[1], y1[1], y2[1]};
    for (std::size_t k = in.size() - behind; k < in.size(); ++k)
        out[k] = origin + advance(g, past[1], out[k]);
}

}  // namespace

void run_direct_form(std::span<const Biquad> sections, std::span<Past> past, std::span<const double> in,
                     double origin, std::span<double> out) {
    if (sections.size() == 2 && in.size() >= behind) {
        run_two(sections[0], sections[1], past, in, origin, out);
        return;
    }
    run_in_series(sections, past, in, origin, out,
                  [](const Biquad& f, Past& p, double x) { return advance(f, p, x); });
}

void run_serial(std::span<const Biquad> sections, std::span<BiquadState> states, std::span<const double> in,
                double origin, std::span<double> out) {
    run_in_series(sections, states, in, origin, out,
                  [](const Biquad& f, BiquadState& s, double x) { return step(f, s, x); });
}

namespace {

// A section waits for its own output of the sample before. Three groups of two sections are six that wait at
// the same time; their memories fill twelve of sixteen registers.
constexpr std::size_t most_groups = 3;

template <class Lanes>
struct Memory {
    Lanes s1, s2;
};

/// `Mirrored`: b2 is b0, as in notches of full depth, and so are their products.
template <bool Mirrored, class Lanes>
RIPPLENOTCH_INLINED void advance(const BankSection& f, Memory<Lanes>& memory, Lanes& value) {
    Lanes b0, b1, a1, a2;
    load(b0, f.b0.data());
    load(b1, f.b1.data());
    load(a1, f.a1.data());
    load(a2, f.a2.data());
    const Lanes x = value, first = b0 * x;
    value = first + memory.s1;
    memory.s1 = b1 * x + memory.s2 - a1 * value;
    if constexpr (Mirrored) {
        memory.s2 = first - a2 * value;
    } else {
        Lanes b2;
        load(b2, f.b2.data());
        memory.s2 = b2 * x - a2 * value;
    }
}

template <class Lanes>
RIPPLENOTCH_INLINED void recall(Memory<Lanes>& memory, const BankSection& f) {
    load(memory.s1, f.s1.data());
    load(memory.s2, f.s2.data());
}

template <class Lanes>
RIPPLENOTCH_INLINED void keep(BankSection& f, const Memory<Lanes>& memory) {
    store(f.s1.data(), memory.s1);
    store(f.s2.data(), memory.s2);
}

/// Some sections of one group, from the signal or from the result of the sections before in `output`.
template <bool Mirrored, bool FromSignal, class Lanes, std::size_t... S>
RIPPLENOTCH_INLINED void advance_group(const BankSection* f, Memory<Lanes>* memories, const Lanes& signal,
                                       BankOutput& output, std::index_sequence<S...>) {
    Lanes value = signal;
    if constexpr (!FromSignal) load(value, output.lanes.data());
    (advance<Mirrored>(f[S], memories[S], value), ...);
    store(output.lanes.data(), value);
}

/// Sections `first` and following of the groups from `group` on.
struct Part {
    std::size_t group, first;
};

template <class Lanes, bool Mirrored, bool FromSignal, std::size_t Sections, std::size_t... G>
RIPPLENOTCH_INLINED void run_part(const BankRun& bank, const Part& part, std::span<const double> in,
                                  std::index_sequence<G...>) {
    const std::size_t length = bank.sections.size() / bank.groups;
    constexpr std::make_index_sequence<Sections> sections{};
    BankSection* const f[] = {&bank.sections[(part.group + G) * length + part.first]...};
    BankOutput* const outputs[] = {&bank.outputs[(part.group + G) * bank.stride]...};
    Memory<Lanes> memories[sizeof...(G)][Sections];
    for (std::size_t s = 0; s < Sections; ++s) (recall(memories[G][s], f[G][s]), ...);
    for (std::size_t k = 0; k < in.size(); ++k) {
        Lanes signal;
        fill(signal, in[k]);  // once for all groups: spreading and adding share a unit of the processor
        (advance_group<Mirrored, FromSignal>(f[G], memories[G], signal, outputs[G][k], sections), ...);
    }
    for (std::size_t s = 0; s < Sections; ++s) (keep(f[G][s], memories[G][s]), ...);
}

template <class Lanes, bool Mirrored, std::size_t Groups>
RIPPLENOTCH_INLINED void run_some_groups(const BankRun& bank, std::size_t group, std::span<const double> in) {
    constexpr std::make_index_sequence<Groups> groups{};
    const std::size_t length = bank.sections.size() / bank.groups;
    if (length == 1) run_part<Lanes, Mirrored, true, 1>(bank, {group, 0}, in, groups);
    if (length >= 2) run_part<Lanes, Mirrored, true, 2>(bank, {group, 0}, in, groups);
    std::size_t first = 2;
    for (; first + 2 <= length; first += 2)
        run_part<Lanes, Mirrored, false, 2>(bank, {group, first}, in, groups);
    if (first < length) run_part<Lanes, Mirrored, false, 1>(bank, {group, first}, in, groups);
}

template <class Lanes, bool Mirrored>
RIPPLENOTCH_INLINED void run_groups_of_bank(const BankRun& bank, std::span<const double> in) {
    for (std::size_t group = 0; group < bank.groups; group += most_groups) {
        const std::size_t count = std::min(most_groups, bank.groups - group);
        if (count == 3) run_some_groups<Lanes, Mirrored, 3>(bank, group, in);
        if (count == 2) run_some_groups<Lanes, Mirrored, 2>(bank, group, in);
        if (count == 1) run_some_groups<Lanes, Mirrored, 1>(bank, group, in);
    }
}

struct RunBank {
    template <class Lanes>
    RIPPLENOTCH_INLINED static void run(const BankRun& bank, std::span<const double> in) {
        if (bank.mirrored) {
            run_groups_of_bank<Lanes, true>(bank, in);
        } else {
            run_groups_of_bank<Lanes, false>(bank, in);
        }
    }
};

}  // namespace

void run_bank(const BankRun& bank, std::span<const double> in) { in_lanes<RunBank>(bank, in); }

}  // namespace ripplenotch
