// SPDX-License-Identifier: MIT
#include "model/spring/mass_on_spring.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "model/spring/between_samples.hpp"
#include "model/spring/free_move.hpp"
#include "model/spring/turning_drive.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

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

// Integrals over a step of u^m times what a kick at u is at the step's end: displacement, and speed.
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
    const auto drive = turning_drive(motion, cycles_per_deg);
    FreeMoves known(spring.damping);
    std::vector<FreeMove> moves;
    for (const double step_s : drive->steps_s)
        moves.push_back(known.within(2.0 * std::numbers::pi * spring.frequency_hz * step_s));
    Mass mass(spring.damping, drive->hz[0] / spring.frequency_hz);
    const auto tell = [&](std::complex<double>& one) {
        const Phasor now = mass.response();
        one.real(now.real);
        one.imag(now.imaginary);
    };
    tell(response[0]);
    for (std::size_t k = 1; k < response.size(); ++k) {
        mass.go(moves[drive->step[k]], drive->hz[k] / spring.frequency_hz,
                {drive->cosine[k], drive->sine[k]});
        tell(response[k]);
    }
}

}  // namespace ripplenotch
