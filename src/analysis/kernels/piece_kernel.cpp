// SPDX-License-Identifier: MIT
#include "analysis/kernels/piece_kernel.hpp"

#include <algorithm>
#include <cmath>

#include "core/vectors/lanes.hpp"

namespace ripplenotch {
namespace {

constexpr std::size_t lanes = lane_count;

// Four groups of four lanes under way: an addition takes several steps of the processor, and the next need
// not wait.
constexpr std::size_t groups = 4;
constexpr double next_groups = groups * lanes;

struct LookAtEven {
    template <class Lanes>
    RIPPLENOTCH_INLINED static EvenPart run(std::span<const double> time, std::span<const double> values,
                                            double step, std::size_t from) {
        const double *const t = time.data(), *const x = values.data();
        const std::size_t n = time.size(), even = n - (n - from) % (groups * lanes);
        const double begin = n > from ? t[0] : 0.0;
        const double middle = 0.5 * (static_cast<double>(n + from) - 1.0);
        Lanes place, now, value;
        Lanes most[groups] = {}, least[groups] = {}, sums[groups] = {}, tilts[groups] = {};
        count_up(place, static_cast<double>(from));
        for (std::size_t k = from; k < even; k += groups * lanes, place += next_groups) {
#pragma GCC unroll 4
            for (std::size_t g = 0; g < groups; ++g) {
                const Lanes at = place + static_cast<double>(g * lanes);
                load(now, t + k + g * lanes);
                const Lanes off = now - begin - at * step;
                raise(most[g], off);
                lower(least[g], off);
                load(value, x + k + g * lanes);
                sums[g] += value;
                tilts[g] += (at - middle) * value;
            }
        }
        EvenPart part;
        part.count = n - from;
        for (std::size_t g = 0; g < groups; ++g) {
            double late[lanes], early[lanes];
            store(late, most[g]);
            store(early, least[g]);
            for (std::size_t i = 0; i < lanes; ++i) part.worst = std::max({part.worst, late[i], -early[i]});
            part.sum += sum(sums[g]);
            part.tilt += sum(tilts[g]);
        }
        for (std::size_t k = even; k < n; ++k) {
            const auto at = static_cast<double>(k);
            part.worst = std::max(part.worst, std::abs(t[k] - begin - at * step));
            part.sum += x[k];
            part.tilt += (at - middle) * x[k];
        }
        return part;
    }
};

struct SubtractLineAndWindow {
    template <class Lanes>
    RIPPLENOTCH_INLINED static void run(std::span<const double> values, const EvenLine& line,
                                        std::span<const double> window, std::span<double> to) {
        const std::size_t n = values.size(), even = n - n % (groups * lanes);
        const double middle = 0.5 * (static_cast<double>(n) - 1.0);
        Lanes place, value, weight;
        count_up(place, -middle);
        for (std::size_t k = 0; k < even; k += groups * lanes, place += next_groups) {
#pragma GCC unroll 4
            for (std::size_t g = 0; g < groups; ++g) {
                const std::size_t at = k + g * lanes;
                load(value, values.data() + at);
                load(weight, window.data() + at);
                const Lanes trend = (place + static_cast<double>(g * lanes)) * line.slope + line.mean;
                store(to.data() + at, (value - trend) * weight);
            }
        }
        for (std::size_t k = even; k < n; ++k) {
            const double at = static_cast<double>(k) - middle;
            to[k] = (values[k] - (at * line.slope + line.mean)) * window[k];
        }
    }
};

struct TurnedMoments {
    template <class Lanes>
    RIPPLENOTCH_INLINED static Moments run(std::span<const double> value, std::span<const double> place,
                                           std::span<const double> cosine, std::span<const double> sine) {
        constexpr std::size_t orders = std::tuple_size_v<Moments>;
        const std::size_t n = value.size(), even = n - n % lanes;
        Lanes real[orders] = {}, imaginary[orders] = {};
        Lanes x, at, c, s;
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
};

}  // namespace

EvenPart look_at_even(std::span<const double> time, std::span<const double> values, double step,
                      std::size_t from) {
    return in_lanes<LookAtEven>(time, values, step, from);
}

void subtract_line_and_window(std::span<const double> values, const EvenLine& line,
                              std::span<const double> window, std::span<double> to) {
    in_lanes<SubtractLineAndWindow>(values, line, window, to);
}

Moments turned_moments(std::span<const double> value, std::span<const double> place,
                       std::span<const double> cosine, std::span<const double> sine) {
    return in_lanes<TurnedMoments>(value, place, cosine, sine);
}

EvenPart together(const EvenPart& early, const EvenPart& late) {
    const auto before = static_cast<double>(early.count), behind = static_cast<double>(late.count);
    // Each part's middle lies half the other part away from the middle of both.
    return {std::max(early.worst, late.worst), early.sum + late.sum,
            early.tilt - 0.5 * behind * early.sum + late.tilt + 0.5 * before * late.sum,
            early.count + late.count};
}

EvenLine even_line(const EvenPart& values) {
    const auto count = static_cast<double>(values.count);
    const double squares = count * (count * count - 1.0) / 12.0;
    return {values.sum / count, squares > 0.0 ? values.tilt / squares : 0.0};
}

}  // namespace ripplenotch
