// SPDX-License-Identifier: MIT
#include "analysis/kernels/power_kernel.hpp"

#include <cmath>
#include <numbers>

#include "core/vectors/lanes.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

constexpr std::size_t lanes = lane_count;

/// Twice the sums of the real signal at k and, conjugate, at its mirror: even samples' part and odd samples'.
template <class Number>
struct Pair {
    Number even_real, even_imaginary, odd_real, odd_imaginary;
};

template <class Number>
RIPPLENOTCH_INLINED void untangle(const Number& real, const Number& imaginary, const Number& far_real,
                                  const Number& far_imaginary, const Number& cosine, const Number& sine,
                                  Pair<Number>& pair) {
    const Number odd_real = imaginary + far_imaginary, odd_imaginary = far_real - real;
    pair.even_real = real + far_real;
    pair.even_imaginary = imaginary - far_imaginary;
    pair.odd_real = cosine * odd_real + sine * odd_imaginary;
    pair.odd_imaginary = cosine * odd_imaginary - sine * odd_real;
}

template <class Number>
RIPPLENOTCH_INLINED void powers(const Pair<Number>& pair, Number& here, Number& mirror) {
    const Number real = pair.even_real + pair.odd_real, imaginary = pair.even_imaginary + pair.odd_imaginary;
    const Number far_real = pair.even_real - pair.odd_real,
                 far_imaginary = pair.even_imaginary - pair.odd_imaginary;
    here = real * real + imaginary * imaginary;
    mirror = far_real * far_real + far_imaginary * far_imaginary;
}

struct AddHalfPower {
    template <class Lanes>
    RIPPLENOTCH_INLINED static void run(std::span<const std::complex<double>> sums, double scale,
                                        std::span<double> power, const double* cosines, const double* sines) {
        const auto* const parts = reinterpret_cast<const double*>(sums.data());
        const std::size_t half = sums.size();
        const double sum = parts[0] + parts[1], difference = parts[0] - parts[1], quarter = 0.25 * scale;
        power[0] += scale * (sum * sum);
        power[half] += scale * (difference * difference);
        Lanes real, imaginary, far_real, far_imaginary, cosine, sine, here, mirror, there;
        Pair<Lanes> four;
        std::size_t k = 1;
        for (; 2 * (k + lanes - 1) < half; k += lanes) {
            const std::size_t far = half - k - (lanes - 1);
            load_complex(real, imaginary, parts + 2 * k);
            load_complex(far_real, far_imaginary, parts + 2 * far);
            reverse(far_real);
            reverse(far_imaginary);
            load(cosine, cosines + k);
            load(sine, sines + k);
            untangle(real, imaginary, far_real, far_imaginary, cosine, sine, four);
            powers(four, here, mirror);
            load(there, power.data() + k);
            store(power.data() + k, there + here * quarter);
            reverse(mirror);
            load(there, power.data() + far);
            store(power.data() + far, there + mirror * quarter);
        }
        Pair<double> one;
        for (double near_power, far_power; 2 * k <= half; ++k) {
            const std::size_t far = half - k;
            untangle(parts[2 * k], parts[2 * k + 1], parts[2 * far], parts[2 * far + 1], cosines[k], sines[k],
                     one);
            powers(one, near_power, far_power);
            power[k] += near_power * quarter;
            if (far > k) power[far] += far_power * quarter;
        }
    }
};

}  // namespace

// Only for lengths whose transform takes many times as long.
void add_power(std::span<const std::complex<double>> sums, double scale, std::span<double> power) {
    for (std::size_t k = 0; k < sums.size(); ++k)
        power[k] += (sums[k].real() * sums[k].real() + sums[k].imag() * sums[k].imag()) * scale;
}

HalfPower::HalfPower(std::size_t length) {
    const double step = 2.0 * std::numbers::pi / static_cast<double>(length);
    for (std::size_t k = 0; 4 * k <= length; ++k) {
        cosine_.push_back(portable::cos(step * static_cast<double>(k)));
        sine_.push_back(portable::sin(step * static_cast<double>(k)));
    }
}

void HalfPower::add(std::span<const std::complex<double>> sums, double scale, std::span<double> power) const {
    in_lanes<AddHalfPower>(sums, scale, power, cosine_.data(), sine_.data());
}

}  // namespace ripplenotch
