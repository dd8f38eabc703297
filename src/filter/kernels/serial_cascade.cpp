// SPDX-License-Identifier: MIT
#include "filter/kernels/serial_cascade.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

namespace ripplenotch {
namespace {

constexpr std::size_t most_at_once = 4;

// A section waits for its own output of the sample before, about sixteen cycles. Several in one loop wait
// together, and coefficients and memories stay in registers.
template <std::size_t... I>
void run_together(const Biquad* sections, BiquadState* states, std::span<double> values,
                  std::index_sequence<I...>) {
    const std::array<Biquad, sizeof...(I)> f = {sections[I]...};
    std::array<BiquadState, sizeof...(I)> s = {states[I]...};
    for (double& value : values) {
        double signal = value;
        ((signal = step(f[I], s[I], signal)), ...);
        value = signal;
    }
    ((states[I] = s[I]), ...);
}

}  // namespace

void run_serial(std::span<const Biquad> sections, std::span<BiquadState> states, std::span<double> values) {
    for (std::size_t i = 0; i < sections.size(); i += most_at_once) {
        const Biquad* f = sections.data() + i;
        BiquadState* s = states.data() + i;
        switch (std::min(most_at_once, sections.size() - i)) {
            case 1:
                run_together(f, s, values, std::make_index_sequence<1>{});
                break;
            case 2:
                run_together(f, s, values, std::make_index_sequence<2>{});
                break;
            case 3:
                run_together(f, s, values, std::make_index_sequence<3>{});
                break;
            default:
                run_together(f, s, values, std::make_index_sequence<most_at_once>{});
                break;
        }
    }
}

}  // namespace ripplenotch
