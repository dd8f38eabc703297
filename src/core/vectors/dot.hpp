// SPDX-License-Identifier: MIT
#pragma once
// Sums of products over long columns, four numbers at a time and in one order on every machine.

#include <cstddef>

namespace ripplenotch {

[[nodiscard]] double dot(const double* a, const double* b, std::size_t count);
/// to[k] += factor * from[k].
void add_scaled(double factor, const double* from, double* to, std::size_t count);
/// sums[2 i + j] += dot(a[i], b[j]) for two columns and two.
void add_dots(const double* const (&a)[2], const double* const (&b)[2], std::size_t count, double (&sums)[4]);

/// to[k] = signal[k] less the sum of weights[i] * signal[k - 1 - i], the first i first, for every k below
/// `count`. What lies `memory` numbers before `signal` is read as well.
void prediction_errors(const double* signal, std::size_t count, const double* weights, std::size_t memory,
                       double* to);

}  // namespace ripplenotch
