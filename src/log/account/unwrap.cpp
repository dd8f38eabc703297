// SPDX-License-Identifier: MIT
#include "log/account/unwrap.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace ripplenotch {

double Unwrapper::next(double position_deg) {
    if (before_) turns_ -= std::round((position_deg + turns_ * period_ - *before_) / period_);
    before_ = position_deg + turns_ * period_;
    return *before_;
}

void WrapWatch::Continuous::add(double angle) {
    sum += angle;
    largest = std::max(largest, std::abs(angle));
}

// A wrapped angle never exceeds its turn, and steps over the seam in one row: other steps are much smaller.
void WrapWatch::look_at(double step, Turn& turn) const {
    const double magnitude = std::abs(step);
    if (magnitude > 0.5 * turn.period) {
        if (turn.unwrapper) return;
        turn.unwrapper.emplace(turn.period, before_);
        turn.made = raw_;
    } else if (magnitude >= 0.25 * turn.period) {
        turn.ruled_out = true;
    }
}

void WrapWatch::follow(std::span<const double> position_deg) {
    constexpr double harmless = 0.25 * 2.0 * std::numbers::pi;  // no turn is ruled out by less, none begun
    for (const double angle : position_deg) {
        const double step = count_++ > 0 ? angle - before_ : 0.0;
        low_ = std::min(low_, angle);
        high_ = std::max(high_, angle);
        if (jumped_ || std::abs(step) >= harmless) {
            for (Turn& turn : turns_) {
                turn.ruled_out = turn.ruled_out || high_ - low_ > 1.0001 * turn.period;
                if (turn.ruled_out) continue;
                look_at(step, turn);
                if (!turn.unwrapper) continue;
                jumped_ = true;
                turn.made.add(turn.unwrapper->next(angle));
            }
        }
        raw_.add(angle);
        before_ = angle;
    }
}

const WrapWatch::Turn* WrapWatch::found() const {
    const double range = high_ - low_;
    const auto fits = [&](const Turn& turn) {
        // It fills its turn nearly.
        return count_ >= 3 && !turn.ruled_out && turn.unwrapper && range >= 0.9 * turn.period &&
               range <= 1.0001 * turn.period;
    };
    const auto turn = std::find_if(turns_.begin(), turns_.end(), fits);
    return turn == turns_.end() ? nullptr : &*turn;
}

std::optional<double> WrapWatch::period() const {
    return found() != nullptr ? std::optional<double>(found()->period) : std::nullopt;
}

std::string wrap_in_words(double period_deg) {
    return fmt::format("the position starts again at {:.4g} deg; it was made continuous", period_deg);
}

std::optional<double> wrap_period(std::span<const double> position_deg) {
    WrapWatch watch;
    watch.follow(position_deg);
    return watch.period();
}

}  // namespace ripplenotch
