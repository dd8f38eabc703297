// SPDX-License-Identifier: MIT
// A free mass on a damped spring, over steps of many lengths.
#include "model/spring/mass_on_spring.hpp"

#include <cmath>

#include "support/catch.hpp"

using namespace ripplenotch;

namespace {

struct FreeState {
    double at, moving;
};

FreeState after(const FreeMove& move, const FreeState& begun) {
    return {move.at_of_at * begun.at + move.at_of_moving * begun.moving,
            move.moving_of_moving * begun.moving - move.at_of_moving * begun.at};
}

}  // namespace

TEST_CASE("two steps are as one of their length, and a step of none changes nothing") {
    for (const double damping : {0.001, 0.1, 0.7, 1.0, 2.0}) {
        const FreeState begun{1.0, 0.25};
        for (const double radians : {0.0, 1e-3, 0.4, 3.0, 50.0}) {
            const FreeState once = after(free_move(damping, 1.5 * radians), begun),
                            twice = after(free_move(damping, 0.5 * radians),
                                          after(free_move(damping, radians), begun));
            CHECK(std::abs(once.at - twice.at) < 1e-14);
            CHECK(std::abs(once.moving - twice.moving) < 1e-14);
        }
        const FreeState stays = after(free_move(damping, 0.0), begun);
        CHECK(stays.at == begun.at);
        CHECK(stays.moving == begun.moving);
    }
}

TEST_CASE("moves from near ones are those of the formula, in whatever order they are asked for") {
    for (const double damping : {0.001, 0.1, 0.7, 1.0, 2.0}) {
        FreeMoves moves(damping);
        for (int k = 0; k < 20'000; ++k) {
            const double radians = std::fmod(7.123 * k, 25.0);
            const FreeMove near = moves.within(radians), formula = free_move(damping, radians);
            // Of rounding: the numbers are up to 1.
            REQUIRE(std::abs(near.at_of_at - formula.at_of_at) < 2e-14);
            REQUIRE(std::abs(near.at_of_moving - formula.at_of_moving) < 2e-14);
            REQUIRE(std::abs(near.moving_of_moving - formula.moving_of_moving) < 2e-14);
        }
    }
}
