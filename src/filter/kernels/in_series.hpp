// SPDX-License-Identifier: MIT
#pragma once
// Sections in series over a stretch of samples, for any kind of section.

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <utility>

namespace ripplenotch {

/// A section waits for its own output of the sample before, several operations long. Sections in one loop
/// wait together, and their coefficients and memories stay in registers. `advance(section, state, input)`
/// returns the section's output.
template <class Section, class State, class Advance, std::size_t... I>
void run_together(const Section* sections, State* states, std::span<const double> in, double less,
                  std::span<double> out, double plus, const Advance& advance, std::index_sequence<I...>) {
    [[maybe_unused]] const std::array<Section, sizeof...(I)> f = {sections[I]...};
    [[maybe_unused]] std::array<State, sizeof...(I)> s = {states[I]...};
    for (std::size_t k = 0; k < out.size(); ++k) {
        double signal = in[k] - less;
        ((signal = advance(f[I], s[I], signal)), ...);
        out[k] = plus + signal;
    }
    ((states[I] = s[I]), ...);
}

/// out = origin + F(in - origin), sample by sample. `states` has one entry a section; `in` may be `out`.
template <class Section, class State, class Advance>
void run_in_series(std::span<const Section> sections, std::span<State> states, std::span<const double> in,
                   double origin, std::span<double> out, const Advance& advance) {
    constexpr std::size_t most_at_once = 4;
    std::size_t i = 0;
    do {
        const std::size_t count = std::min(most_at_once, sections.size() - i);
        // x - 0 and -0 + x change no number, not even the sign of a zero.
        const double less = i == 0 ? origin : 0.0, plus = i + count == sections.size() ? origin : -0.0;
        const auto run = [&]<std::size_t... I>(std::index_sequence<I...> indices) {
            run_together(sections.data() + i, states.data() + i, in, less, out, plus, advance, indices);
        };
        if (count == 0) run(std::make_index_sequence<0>{});
        if (count == 1) run(std::make_index_sequence<1>{});
        if (count == 2) run(std::make_index_sequence<2>{});
        if (count == 3) run(std::make_index_sequence<3>{});
        if (count == 4) run(std::make_index_sequence<4>{});
        in = out;
        i += count;
    } while (i < sections.size());
}

}  // namespace ripplenotch
