// SPDX-License-Identifier: MIT
#include "model/spring/mass_on_spring.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <span>
#include <vector>

#include "core/vectors/dot.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {

namespace {

/// Samples of the polynomial about a step between two of them.
constexpr int step_points = 6;  // chosen, not derived

using StepWeights = std::array<double, step_points>;

// Value at a place of the signal that goes on as its ends.
double at(std::span<const double> values, std::ptrdiff_t place) {
    const auto last = static_cast<std::ptrdiff_t>(values.size()) - 1;
    return values[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(place, 0, last))];
}

constexpr int shift_points = 16;  // chosen, not derived
constexpr int lag_points = step_points;

// Weights of the samples at -(count / 2 - 1), ..., count / 2 for the value at u in [0, 1).
template <int count>
std::array<double, count> lagrange_weights(double u) {
    std::array<double, count> weights{};
    for (int i = 0; i < count; ++i) {
        double weight = 1.0;
        for (int j = 0; j < count; ++j) {
            if (j != i) weight *= (u - (j - count / 2 + 1)) / static_cast<double>(i - j);
        }
        weights[static_cast<std::size_t>(i)] = weight;
    }
    return weights;
}

// integral from 0 to 1 of u^m rate exp(-(1 - u) rate), m = 0 ... lag_points - 1. Partial integration ties
// neighbours together: I(m) = 1 - m / rate * I(m - 1). Upwards it is stable for a large rate, downwards for a
// small one.
std::array<double, lag_points> moments(double rate) {
    std::array<double, lag_points> found{};
    if (rate > lag_points) {
        found[0] = 1.0 - portable::exp(-std::min(rate, 700.0));
        for (int m = 1; m < lag_points; ++m)
            found[static_cast<std::size_t>(m)] = 1.0 - m / rate * found[static_cast<std::size_t>(m - 1)];
        return found;
    }
    constexpr int far = 60;  // chosen, not derived: where the recurrence begins
    double moment = rate / (far + 1.0);
    for (int m = far; m > 0; --m) {
        moment = (1.0 - moment) * rate / m;
        if (m <= lag_points) found[static_cast<std::size_t>(m - 1)] = moment;
    }
    return found;
}

// Coefficients of u^0, u^1, ... of the polynomial that is 1 at sample i and 0 at the others.
std::array<double, lag_points> lagrange_coefficients(int i) {
    std::array<double, lag_points> coefficients{1.0};
    for (int j = 0; j < lag_points; ++j) {
        if (j == i) continue;
        const double zero = j - lag_points / 2 + 1, scale = i - j;
        for (std::size_t m = lag_points - 1; m > 0; --m)
            coefficients[m] = (coefficients[m - 1] - zero * coefficients[m]) / scale;
        coefficients[0] = -zero * coefficients[0] / scale;
    }
    return coefficients;
}

// values[k] becomes the sum of weights[i] * before[k + first + i], in this order, for every k.
void weigh_neighbours(std::span<const double> before, std::span<const double> weights, std::ptrdiff_t first,
                      std::span<double> values) {
    const auto n = static_cast<std::ptrdiff_t>(before.size()),
               points = static_cast<std::ptrdiff_t>(weights.size());
    // Where all points are samples, point after point for many samples at once: the same sums.
    const std::ptrdiff_t begin = std::clamp<std::ptrdiff_t>(-first, 0, n),
                         end = std::clamp<std::ptrdiff_t>(n - first - points + 1, begin, n);
    const auto by_itself = [&](std::ptrdiff_t k) {
        double sum = 0.0;
        for (std::ptrdiff_t i = 0; i < points; ++i)
            sum += weights[static_cast<std::size_t>(i)] * at(before, k + first + i);
        values[static_cast<std::size_t>(k)] = sum;
    };
    for (std::ptrdiff_t k = 0; k < begin; ++k) by_itself(k);
    constexpr std::ptrdiff_t block = 512;
    for (std::ptrdiff_t k = begin; k < end; k += block) {
        const auto count = static_cast<std::size_t>(std::min(block, end - k));
        std::fill_n(values.data() + k, count, 0.0);
        for (std::ptrdiff_t i = 0; i < points; ++i) {
            add_scaled(weights[static_cast<std::size_t>(i)], before.data() + k + first + i, values.data() + k,
                       count);
        }
    }
    for (std::ptrdiff_t k = end; k < n; ++k) by_itself(k);
}

}  // namespace

void shift_samples(std::span<double> values, double delay) {
    if (values.empty()) return;
    const double whole = std::ceil(delay);
    const auto weights = lagrange_weights<shift_points>(whole - delay);
    const std::vector<double> before(values.begin(), values.end());
    weigh_neighbours(before, weights, -static_cast<std::ptrdiff_t>(whole) - (shift_points / 2 - 1), values);
}

namespace {

// Weights of the samples at -2, ..., 3 from the beginning of a step for the integral over it of the
// polynomial times anything; moments[m]: the integral of that times u^m, u from 0 to 1 along the step.
StepWeights step_weights(const std::array<double, step_points>& moments) {
    StepWeights weights{};
    for (int i = 0; i < step_points; ++i) {
        const auto coefficients = lagrange_coefficients(i);
        for (std::size_t m = 0; m < step_points; ++m)
            weights[static_cast<std::size_t>(i)] += coefficients[m] * moments[m];
    }
    return weights;
}

// Entry k: the integral over the step that ends at sample k. Before the first sample and after the last, the
// signal is taken as constant.
std::vector<double> over_steps(std::span<const double> values, const StepWeights& weights) {
    std::vector<double> found(values.size());
    // From sample k - 1 (u = 0) to sample k (u = 1).
    weigh_neighbours(values, weights, -1 - (step_points / 2 - 1), found);
    return found;
}

}  // namespace

void first_order_lag(std::span<double> values, double time_constant) {
    if (values.empty()) return;
    const double rate = 1.0 / time_constant;
    const StepWeights weights = step_weights(moments(rate));
    const double kept = portable::exp(-std::min(rate, 700.0));
    const std::vector<double> before(values.begin(), values.end());
    // From sample k - 1 (u = 0) to sample k (u = 1).
    weigh_neighbours(before, weights, -1 - (lag_points / 2 - 1), values);
    values[0] = before[0];
    for (std::size_t k = 1; k < values.size(); ++k) values[k] += kept * values[k - 1];
}

FreeMove free_move(double damping, double radians) {
    const double square = damping * damping - 1.0;
    double even = 0.0, odd = 0.0;
    if (const double root = std::sqrt(std::abs(square)); root * radians < 1e-4) {
        // Near critical damping, or hardly any time: differences of exponentials are lost in rounding.
        const double left = portable::exp(-std::min(damping * radians, 700.0));
        even = left * (1.0 + square * radians * radians / 2.0);
        odd = left * radians * (1.0 + square * radians * radians / 6.0);
    } else if (square < 0.0) {
        const double left = portable::exp(-std::min(damping * radians, 700.0));
        even = left * portable::cos(root * radians);
        odd = left * portable::sin(root * radians) / root;
    } else {
        const double slow = portable::exp(-std::min((damping - root) * radians, 700.0)),
                     fast = portable::exp(-std::min((damping + root) * radians, 700.0));
        even = 0.5 * (slow + fast);
        odd = 0.5 * (slow - fast) / root;
    }
    return {even + damping * odd, odd, even - damping * odd};
}

namespace {

// Times are accurate to a few bits; steps that differ by less than this share of the usual one are one step.
constexpr double same_step = 1e-9;

// Square of ringing that is no more than rounding.
constexpr double died_away = 1e-36;

// Parts by themselves: complex numbers that go through memory cost more than their products.
struct Phasor {
    double real = 0.0, imaginary = 0.0;

    Phasor operator+(const Phasor& b) const { return {real + b.real, imaginary + b.imaginary}; }
    Phasor operator-(const Phasor& b) const { return {real - b.real, imaginary - b.imaginary}; }
    Phasor operator*(const Phasor& b) const {
        return {real * b.real - imaginary * b.imaginary, real * b.imaginary + imaginary * b.real};
    }
    Phasor operator*(double b) const { return {real * b, imaginary * b}; }
    [[nodiscard]] double square() const { return real * real + imaginary * imaginary; }
};

class Mass {
  public:
    Mass(double damping, double u) : damping_(damping), rest_(steady(u)) {}

    // To the next sample, at a constant frequency of the drive: exact where it is constant, and else the
    // drive is off by an eighth of its change in the step times the step. `turned` is the drive's turn,
    // reversed.
    void go(const FreeMove& move, double u, const Phasor& turned) {
        const State before = rest_;
        rest_ = steady(u);
        const Phasor at = ringing_.at + (before.at - rest_.at),
                     moving = ringing_.moving + (before.moving - rest_.moving);
        if (at.square() + moving.square() < died_away) {
            ringing_ = {};
            return;
        }
        ringing_ = {turned * (at * move.at_of_at + moving * move.at_of_moving),
                    turned * (moving * move.moving_of_moving - at * move.at_of_moving)};
    }

    [[nodiscard]] Phasor response() const { return rest_.at + ringing_.at; }

  private:
    struct State {
        Phasor at, moving;
    };

    [[nodiscard]] State steady(double u) const {
        const double real = 1.0 - u * u, imaginary = 2.0 * damping_ * u;
        const double square = real * real + imaginary * imaginary;
        const Phasor at{real / square, -imaginary / square};
        return {at, {-u * at.imaginary, u * at.real}};
    }

    double damping_;
    State rest_, ringing_;
};

// Integrals over a step of u^m times the response at the step's end to an impulse at u: displacement, and
// speed.
struct KickMoments {
    std::array<double, step_points> at{}, moving{};
};

KickMoments kick_moments(double damping, double radians) {
    // Gauss and Legendre, eight places in each radian.
    constexpr double places[] = {0.1834346424956498, 0.5255324099163290, 0.7966664774136267,
                                 0.9602898564975363};
    // And their weights.
    constexpr double weights[] = {0.3626837833783620, 0.3137066458778873, 0.2223810344533745,
                                  0.1012285362903763};
    KickMoments moments;
    const double parts = std::max(1.0, std::ceil(radians));
    const auto add = [&](double u, double weight) {
        const FreeMove after = free_move(damping, radians * (1.0 - u));
        double power = weight;
        for (std::size_t m = 0; m < step_points; ++m) {
            moments.at[m] += power * after.at_of_moving;
            moments.moving[m] += power * after.moving_of_moving;
            power *= u;
        }
    };
    for (double part = 0.0; part < parts; ++part) {
        for (std::size_t i = 0; i < std::size(places); ++i) {
            for (const double sign : {-1.0, 1.0})
                add((part + 0.5 + 0.5 * sign * places[i]) / parts, 0.5 * radians * weights[i] / parts);
        }
    }
    return moments;
}

}  // namespace

void pass_spring(const Spring& spring, Hertz sample_rate, std::span<double> values) {
    if (values.empty()) return;
    const double radians = 2.0 * std::numbers::pi * spring.frequency_hz / sample_rate.value();
    const KickMoments moments = kick_moments(spring.damping, radians);
    const FreeMove move = free_move(spring.damping, radians);
    const std::vector<double> kicked = over_steps(values, step_weights(moments.at)),
                              hurried = over_steps(values, step_weights(moments.moving));
    double at = values[0], moving = 0.0;
    for (std::size_t k = 1; k < values.size(); ++k) {
        const double before = at;
        at = move.at_of_at * before + move.at_of_moving * moving + kicked[k];
        moving = move.moving_of_moving * moving - move.at_of_moving * before + hurried[k];
        values[k] = at;
    }
}

void response_of(const Spring& spring, const Motion& motion, double cycles_per_deg,
                 std::span<std::complex<double>> response) {
    if (response.empty()) return;
    // From sample to sample: frequency of the drive, negative where the joint turns back, and its turn,
    // reversed.
    const std::size_t samples = response.size();
    std::vector<double> hz(samples), angle_deg(samples), cosine(samples), sine(samples);
    for (std::size_t k = 0; k < samples; ++k) {
        const std::size_t before = k - std::min<std::size_t>(k, 1);
        const double deg_s = 0.5 * (motion.velocity_deg_s[before] + motion.velocity_deg_s[k]);
        hz[k] = cycles_per_deg * deg_s;
        angle_deg[k] = -360.0 * cycles_per_deg * deg_s * (motion.time_s[k] - motion.time_s[before]);
    }
    portable::cos_degrees(angle_deg, cosine);
    portable::sin_degrees(angle_deg, sine);
    const double usual_s = 1.0 / motion.sample_rate.value();
    const auto move_within = [&](double step_s) {
        return free_move(spring.damping, 2.0 * std::numbers::pi * spring.frequency_hz * step_s);
    };
    const FreeMove usual = move_within(usual_s);
    Mass mass(spring.damping, hz[0] / spring.frequency_hz);
    const auto tell = [&](std::complex<double>& one) {
        const Phasor now = mass.response();
        one.real(now.real);
        one.imag(now.imaginary);
    };
    tell(response[0]);
    for (std::size_t k = 1; k < samples; ++k) {
        // A step that is no step forward is a usual one.
        const double step_s = motion.time_s[k] - motion.time_s[k - 1];
        const bool is_usual = !(step_s > 0.0) || std::abs(step_s / usual_s - 1.0) < same_step;
        mass.go(is_usual ? usual : move_within(step_s), hz[k] / spring.frequency_hz, {cosine[k], sine[k]});
        tell(response[k]);
    }
}

}  // namespace ripplenotch
