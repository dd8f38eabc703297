// SPDX-License-Identifier: MIT
#include "ripplenotch/analysis/fourier.hpp"

#include <fftw3.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <complex>
#include <map>
#include <memory>
#include <mutex>
#include <new>
#include <vector>

#include "analysis/kernels/spreading_kernel.hpp"
#include "core/functions/many_numbers.hpp"
#include "core/vectors/dot.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {

namespace {

constexpr double kernel_half =
    0.5 * static_cast<double>(SpreadingKernel::width);  // half of its width, in grid steps

/// A transform of samples that were spread, and that of the kernel, which every sum is divided by.
class Grid {
  public:
    explicit Grid(std::size_t size) : transform_(size) {}

    std::vector<std::complex<double>> sums(std::span<const double> where, std::span<const double> value,
                                           double spacing, std::size_t count) {
        std::fill(transform_.in().begin(), transform_.in().end(), 0.0);
        static const SpreadingKernel kernel;
        kernel.spread(where, value, spacing, transform_.in());
        const double step = full_turn * kernel_half / static_cast<double>(transform_.in().size());
        while (divisors_.size() < count)
            divisors_.push_back(kernel_half *
                                SpreadingKernel::transform(step * static_cast<double>(divisors_.size())));
        const auto all = transform_.run();
        std::vector<std::complex<double>> sums(count);
        for (std::size_t k = 0; k < count; ++k)
            sums[k] = {all[k].real() / divisors_[k], all[k].imag() / divisors_[k]};
        return sums;
    }

  private:
    RealTransform transform_;
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
    // Chosen, not derived: bounds the memory.
    constexpr std::size_t longest_kept = std::size_t{1} << 18, most_kept = 8;
    const std::size_t least = std::max<std::size_t>(4 * count, 4 * SpreadingKernel::width);
    if (least > longest_kept) return Grid(fast_length(least)).sums(where, value, spacing, count);
    thread_local std::map<std::size_t, Grid> kept;
    const std::size_t size = shared_length(least);
    if (kept.size() >= most_kept && !kept.contains(size)) kept.clear();
    return kept.try_emplace(size, size).first->second.sums(where, value, spacing, count);
}

namespace {

template <class T>
using FftwArray = std::unique_ptr<T, decltype(&fftw_free)>;

// Reports a failed allocation of FFTW, which returns a null pointer.
template <class T>
FftwArray<T> checked(T* allocated) {
    if (allocated == nullptr) throw std::bad_alloc();
    return {allocated, fftw_free};
}
FftwArray<double> real_array(std::size_t n) { return checked(fftw_alloc_real(n)); }
FftwArray<fftw_complex> complex_array(std::size_t n) { return checked(fftw_alloc_complex(n)); }

struct Plan {
    fftw_plan plan = nullptr;
    explicit Plan(std::size_t n) {
        // The arrays only shape the plan: it is always executed on others, of the same alignment.
        const auto in = real_array(n);
        const auto out = complex_array(n / 2 + 1);
        plan = fftw_plan_dft_r2c_1d(static_cast<int>(n), in.get(), out.get(), FFTW_ESTIMATE);
        if (plan == nullptr) throw std::bad_alloc();
    }
    ~Plan() { fftw_destroy_plan(plan); }
    Plan(const Plan&) = delete;
    Plan& operator=(const Plan&) = delete;
};

fftw_plan plan_for(std::size_t n) {
    static std::mutex mutex;
    static std::map<std::size_t, std::unique_ptr<Plan>> plans;
    const std::lock_guard lock(mutex);
    auto& entry = plans[n];
    if (!entry) entry = std::make_unique<Plan>(n);
    return entry->plan;
}

std::complex<double> unit_phasor(double angle) { return portable::phasor(angle); }

/// Positions of samples, evaluated at once for sums at several frequencies.
class Places {
  public:
    explicit Places(std::span<const double> where) : where_(where) {
        // Places are taken from the middle so that the derivatives stay well conditioned.
        if (!where.empty()) middle_ = 0.5 * (where.front() + where.back());
    }

    /// Sums whose phase is that of places from the middle.
    [[nodiscard]] FourierPoint centred(std::span<const double> value, double frequency) const {
        FourierPoint point;
        std::array<double, 256> angle{}, cosine{}, sine{}, weight{};
        for (std::size_t first = 0; first < where_.size(); first += angle.size()) {
            const std::size_t count = std::min(angle.size(), where_.size() - first);
            for (std::size_t i = 0; i < count; ++i)
                angle[i] = -full_turn * frequency * (where_[first + i] - middle_);
            portable::phasors(std::span(angle).first(count), cosine, sine);
            std::copy_n(value.begin() + static_cast<std::ptrdiff_t>(first), count, weight.begin());
            for (std::complex<double>* const sum : {&point.value, &point.first, &point.second}) {
                *sum += std::complex<double>(dot(weight.data(), cosine.data(), count),
                                             dot(weight.data(), sine.data(), count));
                for (std::size_t i = 0; i < count; ++i) weight[i] *= where_[first + i] - middle_;
            }
        }
        return point;
    }
    /// The same, placed as they are; derivatives by frequency stay those of the centred sum.
    [[nodiscard]] FourierPoint point(std::span<const double> value, double frequency) const {
        const FourierPoint point = centred(value, frequency);
        const std::complex<double> back = unit_phasor(-full_turn * frequency * middle_),
                                   turn(0.0, -full_turn);
        return {point.value * back, turn * point.first * back, turn * turn * point.second * back};
    }

  private:
    std::span<const double> where_;
    double middle_ = 0.0;
};

}  // namespace

struct RealTransform::Arrays {
    std::size_t length;
    FftwArray<double> in = real_array(length);
    FftwArray<fftw_complex> out = complex_array(length / 2 + 1);
    fftw_plan plan = nullptr;  // when first needed
};

RealTransform::RealTransform(std::size_t length) : arrays_(new Arrays{length}) {}

RealTransform::~RealTransform() = default;

RealTransform::RealTransform(RealTransform&&) noexcept = default;

RealTransform& RealTransform::operator=(RealTransform&&) noexcept = default;

std::span<double> RealTransform::in() { return {arrays_->in.get(), arrays_->length}; }

std::span<const std::complex<double>> RealTransform::run() {
    Arrays& arrays = *arrays_;
    if (arrays.plan == nullptr) arrays.plan = plan_for(arrays.length);
    fftw_execute_dft_r2c(arrays.plan, arrays.in.get(), arrays.out.get());
    // A std::complex<double> is laid out as two doubles, the real part first (C++ standard).
    return {reinterpret_cast<const std::complex<double>*>(arrays.out.get()), arrays.length / 2 + 1};
}

std::vector<std::complex<double>> real_fourier(std::span<const double> x) {
    if (x.empty()) return {};
    RealTransform transform(x.size());
    std::copy(x.begin(), x.end(), transform.in().begin());
    const auto sums = transform.run();
    return {sums.begin(), sums.end()};
}

std::size_t fast_length(std::size_t at_least) {
    const auto smooth = [](std::size_t n) {
        for (const std::size_t prime : {2U, 3U, 5U, 7U}) {
            while (n % prime == 0) n /= prime;
        }
        return n == 1;
    };
    std::size_t n = std::max<std::size_t>(at_least, 1);
    while (!smooth(n)) ++n;
    return n;
}

FourierPoint fourier_point(std::span<const double> where, std::span<const double> value, double frequency) {
    return Places(where).point(value, frequency);
}

double refine_peak(std::span<const double> where, std::span<const double> value, const PeakGuess& guess) {
    const auto [start, reach] = guess;
    double frequency = start;
    const Places places(where);
    for (int round = 0; round < 8; ++round) {
        const FourierPoint at = places.point(value, frequency);
        // Half the derivatives of |S|^2: a common phase has no slope.
        const double slope = std::real(std::conj(at.value) * at.first);
        const double curve = std::norm(at.first) + std::real(std::conj(at.value) * at.second);
        if (!(curve < 0.0)) return frequency;
        const double step = -slope / curve;
        const double next = std::clamp(frequency + step, start - reach, start + reach);
        const bool settled = std::abs(next - frequency) < 1e-9 * reach;
        frequency = next;
        if (settled) break;
    }
    return frequency;
}

}  // namespace ripplenotch
