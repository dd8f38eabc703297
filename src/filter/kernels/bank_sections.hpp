// SPDX-License-Identifier: MIT
#pragma once
// Filters of one length side by side on one signal, four in the lanes of a section.

#include <array>
#include <cstddef>
#include <span>

#include "ripplenotch/core/biquad.hpp"

namespace ripplenotch {

// Sections in direct form I, whose memory is past inputs and outputs.

/// Inputs and outputs of a section one and two samples ago.
struct Past {
    double x1 = 0.0, x2 = 0.0, y1 = 0.0, y2 = 0.0;
};

/// The latest output comes last in the sum: the next sample waits for it through two operations.
inline double advance(const Biquad& f, Past& past, double x) noexcept {
    const double y = f.b0 * x + f.b1 * past.x1 + f.b2 * past.x2 - f.a2 * past.y2 - f.a1 * past.y1;
    past = {x, past.x1, y, past.y1};
    return y;
}

/// out = origin + F(in - origin), the bits of advance(), section after section. `past` has one entry a
/// section; `in` may be `out`.
void run_direct_form(std::span<const Biquad> sections, std::span<Past> past, std::span<const double> in,
                     double origin, std::span<double> out);

// Sections in series, sample by sample: the arithmetic that every faster form is measured against.

/// out = origin + F(in - origin) by step(), section after section. `states` has one entry a section; `in` may
/// be `out`.
void run_serial(std::span<const Biquad> sections, std::span<BiquadState> states, std::span<const double> in,
                double origin, std::span<double> out);

/// The same section of four filters, and its memory in transposed direct form II.
struct BankSection {
    using Lanes = std::array<double, 4>;
    alignas(32) Lanes b0{}, b1{}, b2{}, a1{}, a2{};
    alignas(32) Lanes s1{}, s2{};
};

/// Four outputs at one sample.
struct alignas(32) BankOutput {
    BankSection::Lanes lanes;
};

/// `sections` of each of the groups of four filters, group after group; `outputs` of each group, `stride`
/// apart, get what `in` gives. Each lane does what step() does, in its order, so it
/// gives the bits of one filter alone.
struct BankRun {
    std::span<BankSection> sections;
    std::size_t groups;
    std::span<BankOutput> outputs;
    std::size_t stride;
    bool mirrored;  ///< b2 is b0 in every section and lane
};
void run_bank(const BankRun& bank, std::span<const double> in);

}  // namespace ripplenotch
