// SPDX-License-Identifier: MIT
#include "model/spring/free_move.hpp"

#include <algorithm>
#include <cmath>

#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

// Between two known moves, radians. At damping 2, the most that a spring may have, the first term that is
// left out is then 1e-15 of the move.
constexpr double spacing = 0.005;
constexpr double longest_known = 20.0;  // by hand: bounds the memory

}  // namespace

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

FreeMoves::FreeMoves(double damping) : damping_(damping), at_of_at_{1.0, 0.0}, at_of_moving_{0.0, 1.0} {
    // x'' + 2 damping x' + x = 0, power by power.
    for (Series* series : {&at_of_at_, &at_of_moving_}) {
        for (std::size_t n = 2; n < terms; ++n) {
            const auto power = static_cast<double>(n);
            (*series)[n] = -(2.0 * damping * (power - 1.0) * (*series)[n - 1] + (*series)[n - 2]) /
                           (power * (power - 1.0));
        }
    }
}

FreeMove FreeMoves::shortly(double radians) const {
    double at = 0.0, moving = 0.0;
    for (std::size_t n = terms; n-- > 0;) {
        at = at * radians + at_of_at_[n];
        moving = moving * radians + at_of_moving_[n];
    }
    return {at, moving, at - 2.0 * damping_ * moving};
}

FreeMove FreeMoves::within(double radians) {
    if (!(radians < longest_known)) return free_move(damping_, radians);
    const auto place = static_cast<std::size_t>(radians / spacing + 0.5);
    if (place >= known_.size()) known_.resize(place + 1);
    const double known_radians = spacing * static_cast<double>(place);
    if (!known_[place]) known_[place] = free_move(damping_, known_radians);
    const FreeMove &most = *known_[place], rest = shortly(radians - known_radians);
    return {most.at_of_at * rest.at_of_at - most.at_of_moving * rest.at_of_moving,
            most.at_of_at * rest.at_of_moving + most.at_of_moving * rest.moving_of_moving,
            most.moving_of_moving * rest.moving_of_moving - most.at_of_moving * rest.at_of_moving};
}

}  // namespace ripplenotch
