// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <bit>
#include <complex>
#include <map>
#include <numbers>
#include <vector>

#include "analysis/kernels/spreading_kernel.hpp"
#include "ripplenotch/analysis/fourier.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

constexpr double kernel_half =
    0.5 * static_cast<double>(SpreadingKernel::width);  // of its width, in grid steps

/// Transform of the kernel at 0, 1, 2, ... steps of phase (radians per half width), by the trapezoid rule in
/// x = sin t, where the integrand and all its derivatives are negligible at both ends.
class KernelTransform {
  public:
    explicit KernelTransform(double step) : step_(step) {
        for (std::size_t i = 0; i < nodes; ++i) {
            const double t = std::numbers::pi / 2.0 * (static_cast<double>(i) + 0.5) / nodes;
            place_[i] = portable::sin(t);
            weight_[i] = portable::exp(SpreadingKernel::beta * (portable::cos(t) - 1.0)) * portable::cos(t) *
                         std::numbers::pi / nodes;
            turn_real_[i] = portable::cos(step * place_[i]);
            turn_imaginary_[i] = portable::sin(step * place_[i]);
        }
    }

    double next() {
        // Cosines of evenly spaced phases turn by a constant; they are set anew before rounding adds up.
        if (count_ % 256 == 0) {
            for (std::size_t i = 0; i < nodes; ++i) {
                const double phase = step_ * static_cast<double>(count_) * place_[i];
                real_[i] = weight_[i] * portable::cos(phase);
                imaginary_[i] = weight_[i] * portable::sin(phase);
            }
        }
        ++count_;
        double sum = 0.0;
        for (std::size_t i = 0; i < nodes; ++i) {
            sum += real_[i];
            const double real = real_[i] * turn_real_[i] - imaginary_[i] * turn_imaginary_[i];
            imaginary_[i] = real_[i] * turn_imaginary_[i] + imaginary_[i] * turn_real_[i];
            real_[i] = real;
        }
        return sum;
    }

  private:
    static constexpr std::size_t nodes = 40;  // by hand
    using Row = std::array<double, nodes>;
    double step_;
    std::size_t count_ = 0;
    Row place_{}, weight_{}, turn_real_{}, turn_imaginary_{}, real_{}, imaginary_{};
};

/// A transform of samples that were spread, and that of the kernel, which every sum is divided by.
class Grid {
  public:
    explicit Grid(std::size_t size)
        : transform_(size), divisor_(2.0 * std::numbers::pi * kernel_half / static_cast<double>(size)) {}

    std::vector<std::complex<double>> sums(std::span<const double> where, std::span<const double> value,
                                           double spacing, std::size_t count) {
        std::fill(transform_.in().begin(), transform_.in().end(), 0.0);
        static const SpreadingKernel kernel;
        kernel.spread(where, value, spacing, transform_.in());
        while (divisors_.size() < count) divisors_.push_back(kernel_half * divisor_.next());
        const auto all = transform_.run();
        std::vector<std::complex<double>> sums(count);
        for (std::size_t k = 0; k < count; ++k)
            sums[k] = {all[k].real() / divisors_[k], all[k].imag() / divisors_[k]};
        return sums;
    }

  private:
    RealTransform transform_;
    KernelTransform divisor_;
    std::vector<double> divisors_;
};

/// The next power of two, or three quarters of it: a plan costs as much as ten transforms of usual lengths,
/// and sweeps of one log shall share one or two.
std::size_t shared_length(std::size_t at_least) {
    const std::size_t power = std::bit_ceil(at_least);
    return power / 4 * 3 >= at_least ? power / 4 * 3 : power;
}

}  // namespace

std::vector<std::complex<double>> nonuniform_fourier(std::span<const double> where,
                                                     std::span<const double> value, double spacing,
                                                     std::size_t count) {
    if (count == 0) return {};
    constexpr std::size_t longest_kept = std::size_t{1} << 18, most_kept = 8;  // by hand: bounds the memory
    const std::size_t least = std::max<std::size_t>(4 * count, 4 * SpreadingKernel::width);
    if (least > longest_kept) return Grid(fast_length(least)).sums(where, value, spacing, count);
    thread_local std::map<std::size_t, Grid> kept;
    const std::size_t size = shared_length(least);
    if (kept.size() >= most_kept && !kept.contains(size)) kept.clear();
    return kept.try_emplace(size, size).first->second.sums(where, value, spacing, count);
}

}  // namespace ripplenotch
