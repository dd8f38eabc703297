// SPDX-License-Identifier: MIT
// What is noted of rows four at a time is what a plain loop over the rows notes.

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "core/rows/row_facts.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/log/format.hpp"
#include "support/catch.hpp"
#include "support/vectors.hpp"

using namespace ripplenotch;
using namespace ripplenotch::testing;

namespace {

const double infinity = std::numeric_limits<double>::infinity();

/// Few values, so that neighbours are often equal.
std::vector<double> coarse(std::size_t size, std::mt19937& engine) {
    std::vector<double> values(size);
    for (double& value : values) value = static_cast<double>(engine() % 5) - 2.0;
    return values;
}

/// count_repeats by the words of their description.
RepeatCounts plainly(const JointRows& rows, std::size_t first, std::size_t end, double moving_deg_s) {
    RepeatCounts counts;
    for (std::size_t k = first + 1; k < end; ++k) {
        const auto same = [k](const std::vector<double>& values) {
            return !values.empty() && values[k - 1] == values[k];
        };
        const bool torque = same(rows.torque_nm);
        if (!(std::abs(rows.velocity_deg_s[k - 1]) > moving_deg_s)) continue;
        if (!(std::abs(rows.velocity_deg_s[k]) > moving_deg_s)) continue;
        ++counts.moving;
        if (torque) ++counts.torque;
        if (same(rows.velocity_deg_s)) ++counts.velocity;
        if (same(rows.position_deg)) ++counts.position;
        if (same(rows.velocity_deg_s) && torque) ++counts.velocity_and_torque;
        if (same(rows.position_deg) && torque) ++counts.position_and_torque;
        if (same(rows.velocity_deg_s) && same(rows.position_deg) && torque) ++counts.all;
    }
    return counts;
}

bool equal(const RepeatCounts& a, const RepeatCounts& b) {
    return a.moving == b.moving && a.velocity == b.velocity && a.position == b.position &&
           a.torque == b.torque && a.velocity_and_torque == b.velocity_and_torque &&
           a.position_and_torque == b.position_and_torque && a.all == b.all;
}

}  // namespace

TEST_CASE("repeated rows are counted as a plain loop counts them, with and without positions") {
    std::mt19937 engine(1);
    for (const bool wide : widths())
        for (const bool with_position : {false, true}) {
            const Width here(wide);
            for (std::size_t size = 1; size < 60; ++size) {
                JointRows rows;
                rows.velocity_deg_s = coarse(size, engine);
                rows.torque_nm = coarse(size, engine);
                if (with_position) rows.position_deg = coarse(size, engine);
                for (const double moving_deg_s : {0.0, 0.5, 1.0, 5.0}) {
                    const RepeatCounts found =
                        count_repeats({rows.velocity_deg_s.data(), rows.torque_nm.data(),
                                       with_position ? rows.position_deg.data() : nullptr},
                                      size - 1, moving_deg_s);
                    CHECK(equal(found, plainly(rows, 0, size, moving_deg_s)));
                }
            }
        }
}

TEST_CASE("the range of speeds is that of a plain loop, and what is no number widens nothing") {
    std::mt19937 engine(3);
    std::uniform_real_distribution<double> velocity(-90.0, 90.0);
    for (std::size_t size = 0; size < 60; ++size) {
        std::vector<double> values(size);
        for (double& value : values) value = engine() % 7 == 0 ? not_a_number : velocity(engine);
        SpeedExtent range{30.0, 40.0}, expected = range;
        SpeedExtent narrow = range;
        widen(range, values);
        {
            const NarrowVectors here;
            widen(narrow, values);
        }
        for (const double value : values) {
            if (std::abs(value) < expected.slowest_deg_s) expected.slowest_deg_s = std::abs(value);
            if (std::abs(value) > expected.fastest_deg_s) expected.fastest_deg_s = std::abs(value);
        }
        CHECK(range.slowest_deg_s == expected.slowest_deg_s);
        CHECK(range.fastest_deg_s == expected.fastest_deg_s);
        CHECK(narrow.slowest_deg_s == range.slowest_deg_s);
        CHECK(narrow.fastest_deg_s == range.fastest_deg_s);
    }
}

TEST_CASE("the first step outside a range is found wherever it is, by every instruction set") {
    for (const bool wide : widths()) {
        const Width here(wide);
        CHECK(first_step_outside({}, 0.0, 1.0) == 0);
        for (const std::size_t size : {1UL, 2UL, 16UL, 17UL, 18UL, 64UL, 100UL}) {
            std::vector<double> times(size);
            for (std::size_t k = 0; k < size; ++k) times[k] = 10.0 + 0.25 * static_cast<double>(k);
            CHECK(first_step_outside(times, 0.0, 0.25) == size);
            for (std::size_t at = 1; at < size; ++at) {
                for (const double step : {0.0, -0.25, 0.5, not_a_number, infinity, -infinity}) {
                    std::vector<double> changed = times;
                    for (std::size_t k = at; k < size; ++k) changed[k] += step - 0.25;
                    CHECK(first_step_outside(changed, 0.0, 0.25) == at);
                }
            }
        }
    }
}
