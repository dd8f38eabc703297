// SPDX-License-Identifier: MIT
#pragma once
// Filters of one length side by side on one signal, four in the lanes of a section.

#include <array>
#include <cstddef>
#include <span>

namespace ripplenotch {

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
