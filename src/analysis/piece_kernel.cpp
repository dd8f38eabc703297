// SPDX-License-Identifier: MIT
#include "analysis/piece_kernel.hpp"

#include <algorithm>
#include <cmath>

#include "analysis/four_lanes.hpp"

namespace ripplenotch {
namespace {

using namespace four_lanes;

// Four groups of four lanes under way: an addition takes several steps of the processor, and the next need
// not wait.
constexpr std::size_t groups = 4;
constexpr double next_groups = groups * lanes;

}  // namespace

RIPPLENOTCH_FOR_AVX2_TOO
double off_even_grid(std::span<const double> time, double step, std::size_t from) {
    const double* const t = time.data();
    const std::size_t n = time.size(), even = n - (n - from) % (groups * lanes);
    const double begin = n > 0 ? t[0] : 0.0;
    Four place = {0.0, 1.0, 2.0, 3.0}, now, most[groups] = {}, least[groups] = {};
    place += static_cast<double>(from);
    for (std::size_t k = from; k < even; k += groups * lanes, place += next_groups) {
#pragma GCC unroll 4
        for (std::size_t g = 0; g < groups; ++g) {
            load(now, t + k + g * lanes);
            const Four off = now - begin - (place + static_cast<double>(g * lanes)) * step;
            most[g] = off > most[g] ? off : most[g];
            least[g] = off < least[g] ? off : least[g];
        }
    }
    double worst = 0.0;
    for (std::size_t i = 0; i < groups * lanes; ++i)
        worst = std::max({worst, most[i / lanes][i % lanes], -least[i / lanes][i % lanes]});
    for (std::size_t k = even; k < n; ++k)
        worst = std::max(worst, std::abs(t[k] - begin - static_cast<double>(k) * step));
    return worst;
}

RIPPLENOTCH_FOR_AVX2_TOO
EvenLine even_line(std::span<const double> values) {
    const double* const x = values.data();
    const std::size_t n = values.size(), even = n - n % (groups * lanes);
    const double middle = 0.5 * (static_cast<double>(n) - 1.0);
    Four place = {0.0, 1.0, 2.0, 3.0}, value, sums[groups] = {}, tilts[groups] = {};
    place -= middle;
    for (std::size_t k = 0; k < even; k += groups * lanes, place += next_groups) {
#pragma GCC unroll 4
        for (std::size_t g = 0; g < groups; ++g) {
            load(value, x + k + g * lanes);
            sums[g] += value;
            tilts[g] += (place + static_cast<double>(g * lanes)) * value;
        }
    }
    double total = 0.0, tilt = 0.0;
    for (std::size_t g = 0; g < groups; ++g) {
        total += sum(sums[g]);
        tilt += sum(tilts[g]);
    }
    for (std::size_t k = even; k < n; ++k) {
        total += x[k];
        tilt += (static_cast<double>(k) - middle) * x[k];
    }
    const auto count = static_cast<double>(n);
    const double squares = count * (count * count - 1.0) / 12.0;
    return {total / count, squares > 0.0 ? tilt / squares : 0.0};
}

RIPPLENOTCH_FOR_AVX2_TOO
void take_line_and_window(std::span<const double> values, const EvenLine& line,
                          std::span<const double> window, std::span<double> to) {
    const std::size_t n = values.size(), even = n - n % (groups * lanes);
    const double middle = 0.5 * (static_cast<double>(n) - 1.0);
    Four place = {0.0, 1.0, 2.0, 3.0}, value, weight;
    place -= middle;
    for (std::size_t k = 0; k < even; k += groups * lanes, place += next_groups) {
#pragma GCC unroll 4
        for (std::size_t g = 0; g < groups; ++g) {
            const std::size_t at = k + g * lanes;
            load(value, values.data() + at);
            load(weight, window.data() + at);
            const Four trend = (place + static_cast<double>(g * lanes)) * line.slope + line.mean;
            store(to.data() + at, (value - trend) * weight);
        }
    }
    for (std::size_t k = even; k < n; ++k) {
        const double at = static_cast<double>(k) - middle;
        to[k] = (values[k] - (at * line.slope + line.mean)) * window[k];
    }
}

RIPPLENOTCH_FOR_AVX2_TOO
void add_power(std::span<const std::complex<double>> sums, double scale, std::span<double> power) {
    const auto* const parts = reinterpret_cast<const double*>(sums.data());
    const std::size_t n = sums.size(), even = n - n % lanes;
    Four low, high, there;
    for (std::size_t k = 0; k < even; k += lanes) {
        load(low, parts + 2 * k);
        load(high, parts + 2 * k + lanes);
        load(there, power.data() + k);
        const Four real = __builtin_shufflevector(low, high, 0, 2, 4, 6);
        const Four imaginary = __builtin_shufflevector(low, high, 1, 3, 5, 7);
        store(power.data() + k, there + (real * real + imaginary * imaginary) * scale);
    }
    for (std::size_t k = even; k < n; ++k)
        power[k] += (parts[2 * k] * parts[2 * k] + parts[2 * k + 1] * parts[2 * k + 1]) * scale;
}

RIPPLENOTCH_FOR_AVX2_TOO
Moments turned_moments(std::span<const double> value, std::span<const double> place,
                       std::span<const double> cosine, std::span<const double> sine) {
    constexpr std::size_t orders = std::tuple_size_v<Moments>;
    const std::size_t n = value.size(), even = n - n % lanes;
    Four real[orders] = {}, imaginary[orders] = {};
    Four x, at, c, s;
    for (std::size_t k = 0; k < even; k += lanes) {
        load(x, value.data() + k);
        load(at, place.data() + k);
        load(c, cosine.data() + k);
        load(s, sine.data() + k);
        c *= x;
        s *= x;
#pragma GCC unroll 8
        for (std::size_t d = 0; d < orders; ++d) {
            real[d] += c;
            imaginary[d] += s;
            c *= at;
            s *= at;
        }
    }
    Moments moments;
    for (std::size_t d = 0; d < orders; ++d) moments[d] = {sum(real[d]), sum(imaginary[d])};
    for (std::size_t k = even; k < n; ++k) {
        double weight = value[k];
        for (std::size_t d = 0; d < orders; ++d, weight *= place[k])
            moments[d] += std::complex<double>(weight * cosine[k], weight * sine[k]);
    }
    return moments;
}

}  // namespace ripplenotch
