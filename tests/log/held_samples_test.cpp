// SPDX-License-Identifier: MIT
#include "log/account/held_samples.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include "support/catch.hpp"

using namespace ripplenotch;

namespace {

struct Rows {
    std::vector<double> velocity_deg_s, torque_nm, position_deg;
    [[nodiscard]] TraceView view(std::size_t first, std::size_t count) const {
        const TraceView all{{}, velocity_deg_s, velocity_deg_s, torque_nm, position_deg};
        return all.part(first, count);
    }
};

/// Every third row repeats the one before.
Rows every_third(std::size_t size) {
    std::mt19937 engine(2);
    Rows rows;
    for (std::size_t k = 0; k < size; ++k) {
        const bool repeats = k > 0 && k % 3 == 0;
        rows.velocity_deg_s.push_back(repeats ? rows.velocity_deg_s.back()
                                              : 20.0 + 0.01 * static_cast<double>(k));
        rows.torque_nm.push_back(repeats ? rows.torque_nm.back() : static_cast<double>(engine() % 1000));
    }
    return rows;
}

}  // namespace

TEST_CASE("held rows and the longest hold are the same however a log is cut into blocks", "[log]") {
    std::mt19937 engine(3);
    Rows rows = every_third(500);
    for (std::size_t k = 301; k < 305; ++k) {
        rows.velocity_deg_s[k] = rows.velocity_deg_s[300];
        rows.torque_nm[k] = rows.torque_nm[300];
    }
    HeldCounter whole;
    whole.count(rows.view(0, 500), true);
    CHECK(whole.held().longest == 5);  // rows 300 to 304 repeat row 299
    for (std::size_t i = 0; i < 50; ++i) {
        HeldCounter held;
        for (std::size_t first = 0; first < 500;) {
            const std::size_t end = std::min<std::size_t>(500, first + 1 + engine() % 40);
            held.count(rows.view(first, end - first), first == 0);
            first = end;
        }
        CHECK(held.held().count == whole.held().count);
        CHECK(held.held().longest == whole.held().longest);
    }
    HeldCounter plain;
    plain.count(every_third(500).view(0, 500), true);
    CHECK(plain.held().count == 499 / 3);
}

TEST_CASE("a torque that is held at a commanded speed counts, with and without a position", "[log]") {
    std::mt19937 engine(4);
    std::normal_distribution<double> noise;
    for (const bool position : {false, true}) {
        Rows rows;
        for (std::size_t k = 0; k < 4000; ++k) {
            rows.velocity_deg_s.push_back(60.0);
            rows.torque_nm.push_back(k % 2 == 1 ? rows.torque_nm.back() : noise(engine));
            const double now = 0.06 * static_cast<double>(k);
            if (position) rows.position_deg.push_back(k % 2 == 1 ? rows.position_deg.back() : now);
        }
        HeldCounter held;
        held.count(rows.view(0, 4000), true);
        CHECK(held.held().count == 2000);
        CHECK(held.held().longest == 1);
    }
}

TEST_CASE("the row after a gap holds nothing", "[log]") {
    Rows rows = every_third(30);
    HeldCounter held;
    held.count(rows.view(0, 15), true);
    held.count(rows.view(15, 15), true);  // row 15 repeats row 14
    CHECK(held.held().count == 8);
}

TEST_CASE("rows that are written several times are held whatever the steps of the torque", "[log]") {
    std::mt19937 engine(5);
    std::normal_distribution<double> noise;
    for (const bool position : {false, true}) {
        Rows held_rows, coarse_rows;
        for (std::size_t k = 0; k < 8000; ++k) {
            const auto updates = static_cast<double>(k - k % 4);
            held_rows.velocity_deg_s.push_back(30.0 + 0.002 * updates);
            held_rows.torque_nm.push_back(k % 4 != 0 ? held_rows.torque_nm.back()
                                                     : 0.25 * std::round(8.0 * noise(engine)));
            if (position) held_rows.position_deg.push_back(0.03 * updates);
            // Steps of the velocity and of the position, but every row measured.
            coarse_rows.velocity_deg_s.push_back(30.0 + 0.1 * std::round(0.02 * static_cast<double>(k)));
            coarse_rows.torque_nm.push_back(0.25 * std::round(noise(engine)));
            if (position) coarse_rows.position_deg.push_back(0.1 * std::round(0.3 * static_cast<double>(k)));
        }
        HeldCounter held, coarse;
        held.count(held_rows.view(0, 8000), true);
        coarse.count(coarse_rows.view(0, 8000), true);
        CHECK(held.held().count == 6000);
        CHECK(held.held().longest == 3);
        CHECK(held.held().moving == 7999);
        CHECK(coarse.held().count == 0);
    }
}

TEST_CASE("without a velocity the joint moves where its position does", "[log]") {
    std::mt19937 engine(7);
    std::normal_distribution<double> noise;
    std::vector<double> time_s, slope, torque_nm, position_deg;
    for (std::size_t k = 0; k < 8000; ++k) {
        const bool rests = k >= 4000;
        time_s.push_back(0.001 * static_cast<double>(k));
        slope.push_back(0.0);
        torque_nm.push_back(k % 4 != 0 ? torque_nm.back() : 0.25 * std::round(8.0 * noise(engine)));
        position_deg.push_back(rests ? 120.0 : 0.03 * static_cast<double>(k - k % 4));
    }
    for (const std::size_t block : {std::size_t{7}, std::size_t{8000}}) {
        HeldCounter held(true);
        const TraceView all{{}, time_s, slope, torque_nm, position_deg};
        for (std::size_t first = 0; first < 8000; first += block)
            held.count(all.part(first, std::min(block, 8000 - first)), first == 0);
        CHECK(held.held().count == 3000);
        CHECK(held.held().longest == 3);
        CHECK(held.held().moving == 4000);
    }
}
