// SPDX-License-Identifier: MIT
#include "log/text/quick_rows.hpp"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <random>

#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/trace.hpp"
#include "support/catch.hpp"
#include "support/vectors.hpp"

using namespace ripplenotch;
using namespace ripplenotch::testing;

namespace {

constexpr double no_time = std::numeric_limits<double>::quiet_NaN();

/// Three columns, all wanted: velocity, torque, position.
QuickRows three_columns(char delimiter = ',', char mark = '.') {
    return QuickRows({{delimiter, mark},
                      3,
                      {{0, velocity_slot}, {1, torque_slot}, {2, position_slot}},
                      std::vector<double>(4, 1.0)});
}

bool same_number(double a, double b) {
    return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

/// A number as some program may have written it.
std::string written(std::mt19937_64& random) {
    const auto pick = [&](int below) {
        return static_cast<int>(random() % static_cast<std::uint64_t>(below));
    };
    const double value = std::bit_cast<double>(random());
    switch (pick(8)) {
        case 0:
            return fmt::format("{:.{}f}", (static_cast<double>(random() >> 11) - 4.5e15) * 1e-12, pick(10));
        case 1:
            return fmt::format("{}", static_cast<std::int64_t>(random() >> pick(60)));
        case 2:
            return fmt::format("{}", is_reading(value) ? value : 0.0);  // any exponent up to 30
        case 3:
            return fmt::format("{:.17g}", std::sin(static_cast<double>(random() % 1000000)));
        case 4:
            return fmt::format("{:.18e}", is_reading(value) ? value : 1.0);  // numpy.savetxt
        case 5:
            return fmt::format("{}{}.", pick(2) == 0 ? "-" : "", pick(1000));
        case 6:
            return fmt::format("{}.{}", pick(2) == 0 ? "-" : "", pick(1000000));
        default:
            return fmt::format("-0.{:0{}d}", pick(10), 1 + pick(12));
    }
}

/// What one way takes of a text with three columns.
struct Taken {
    std::size_t end = 0;
    RowBlock block;
};

Taken taken(const std::string& text, bool wide) {
    const Width here(wide);
    const QuickRows quick = three_columns();
    Taken result;
    result.block.bytes = text;
    result.end = quick.read(result.block, 0, no_time);
    return result;
}

bool same(const std::vector<double>& a, const std::vector<double>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), same_number);
}

bool same(const Taken& a, const Taken& b) {
    const JointRows &first = a.block.joints[0], &second = b.block.joints[0];
    return a.end == b.end && same(first.velocity_deg_s, second.velocity_deg_s) &&
           same(first.torque_nm, second.torque_nm) && same(first.position_deg, second.position_deg) &&
           first.torque_begin == second.torque_begin && first.torque_end == second.torque_end &&
           a.block.row_end == b.block.row_end;
}

/// Numbers, of 3 * rows, that the vectors or the scalar way read otherwise than parse_number does.
std::size_t misread(std::uint64_t seed, std::size_t rows) {
    std::mt19937_64 random(seed);
    std::vector<std::string> cells;
    std::string text;
    for (std::size_t i = 0; i < 3 * rows; ++i) {
        cells.push_back(written(random));
        text += cells.back() + (i % 3 < 2 ? "," : i % 7 == 0 ? "\r\n" : "\n");
    }
    const Taken careful = taken(text, false);
    REQUIRE(careful.end == text.size());
    REQUIRE(careful.block.size() == rows);
    REQUIRE(same(taken(text, true), careful));
    std::size_t different = 0;
    const JointRows& joint = careful.block.joints[0];
    for (std::size_t i = 0; i < rows; ++i) {
        const auto expect = [&](std::size_t column, double got) {
            different += same_number(got, *parse_number(cells[3 * i + column])) ? 0 : 1;
        };
        expect(0, joint.velocity_deg_s[i]);
        expect(1, joint.torque_nm[i]);
        expect(2, joint.position_deg[i]);
        const std::size_t begin = joint.torque_begin[i], size = joint.torque_end[i] - begin;
        different += text.compare(begin, size, cells[3 * i + 1]) == 0 ? 0 : 1;
    }
    return different;
}

}  // namespace

TEST_CASE("numbers of many rows at once are those of the careful reader, bit for bit", "[log]") {
    for (std::uint64_t seed = 7; seed < 10; ++seed) CHECK(misread(seed, 100000) == 0);
}

// The same for half a minute: ctest leaves it out, `test_log "[.kernels]"` runs it.
TEST_CASE("thirty million numbers at once are those of the careful reader, bit for bit", "[.kernels]") {
    for (std::uint64_t seed = 100; seed < 200; ++seed) CHECK(misread(seed, 100000) == 0);
}

TEST_CASE("a byte that is not as it was is read as the careful way reads it, wherever it stands", "[log]") {
    std::mt19937_64 random(11);
    const std::string_view junk = "0123456789.,-+eE \r\n\"x;:/\t";
    std::size_t stopped = 0;
    for (int trial = 0; trial < 20000; ++trial) {
        std::string text;
        const auto decimals = static_cast<int>(random() % 7);
        for (int i = 0; i < 24; ++i) {
            const double angle = static_cast<double>(random() % 1000000) * 1e-3 - 500.0;
            text += fmt::format("{:.4f},{:.{}f},{:.6f}\n", i * 0.0005, angle, decimals, -angle);
        }
        text[random() % text.size()] = junk[random() % junk.size()];
        CAPTURE(text);
        const Taken careful = taken(text, false);
        REQUIRE(same(taken(text, true), careful));
        stopped += careful.end < text.size() ? 1 : 0;
    }
    CHECK(stopped > 5000);  // and many were read
    CHECK(stopped < 15000);
}

TEST_CASE("rows are taken at once up to the first that is not certainly right, wherever it stands", "[log]") {
    const std::string good = "1.5,-2.25,300\n";
    for (const std::string bad :
         {"1.5,-2.25\n", "1.5,-2.25,3,4\n", "# 1,2,3\n", "\n", "1.5,\"2\",3\n", "1.5,2x,3\n", "1.5,,3\n",
          "1.5,.,3\n", "1.5,-,3\n", "1.5,--2,3\n", "1.5,1.2.3,3\n", "1.5,nan,3\n", "1.5,1e999,3\n", "EOF\n",
          "1.5,2;3,4\n", "1.5,2,3", "1,2,\n", "1,2,0x10\n", "1,2,3\r\r\n"}) {
        for (const int before : {0, 1, 2, 5, 600, 2000}) {
            for (const bool wide : widths()) {
                const Width here(wide);
                CAPTURE(bad, before, wide);
                RowBlock block;
                for (int i = 0; i < before; ++i) block.bytes += good;
                block.bytes += bad + good;
                const QuickRows quick = three_columns();
                CHECK(quick.read(block, 0, no_time) == static_cast<std::size_t>(before) * good.size());
                CHECK(block.size() == static_cast<std::size_t>(before));
            }
        }
    }
}

TEST_CASE("a delimiter within quotes is none, in columns that nobody reads as well", "[log]") {
    std::string text;
    for (int i = 0; i < 40; ++i) text += "1.5,a,b,-2.25\n";
    const std::size_t end = text.size();
    text += "3,\"a,b\",4\n";
    for (const bool wide : widths()) {
        const Width here(wide);
        RowBlock block;
        block.bytes = text;
        const QuickRows quick(
            {{',', '.'}, 4, {{0, velocity_slot}, {3, torque_slot}}, std::vector<double>(4, 1.0)});
        CHECK(quick.read(block, 0, no_time) == end);
        CHECK(block.size() == 40);
    }
}

TEST_CASE("taking goes on behind a row that was taken otherwise, and keeps what it has", "[log]") {
    RowBlock block;
    block.bytes = "1,2,3\n4,5\n6,7,8\n9,10,11\n";
    const QuickRows quick = three_columns();
    CHECK(quick.read(block, 0, no_time) == 6);
    CHECK(quick.read(block, 10, no_time) == block.bytes.size());
    CHECK(block.joints[0].torque_nm == std::vector<double>{2, 7, 10});
    CHECK(block.joints[0].torque_begin == std::vector<std::uint32_t>{2, 12, 18});
}

TEST_CASE("time that runs backward ends what is taken at once", "[log]") {
    for (const bool wide : widths()) {
        const Width here(wide);
        const QuickRows quick(
            {{',', '.'}, 2, {{0, time_slot}, {1, torque_slot}}, std::vector<double>(4, 1.0)});
        RowBlock block;
        block.bytes = "1,5\n2,5\n2,6\n1.999,7\n3,8\n";
        CHECK(quick.read(block, 0, no_time) == 12);
        CHECK(quick.read(block, 12, 2.0) == 12);
        CHECK(block.time_s == std::vector<double>{1, 2, 2});
    }
}

TEST_CASE("decimal commas, semicolons and wide rows are taken at once as well", "[log]") {
    RowBlock block;
    block.bytes = "1,5;-2,25;3\n4;5,125;6\n";
    const QuickRows quick = three_columns(';', ',');
    CHECK(quick.read(block, 0, no_time) == block.bytes.size());
    CHECK(block.joints[0].torque_nm == std::vector<double>{-2.25, 5.125});
    // 400 columns of 30 characters: a row longer than the stretch that is searched at once is left alone.
    const RowPlan plan{{',', '.'}, 400, {{399, torque_slot}}, std::vector<double>(4, 1.0)};
    RowBlock rows;
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 399; ++column) rows.bytes += std::string(29, 'x') + ",";
        rows.bytes += "7.5\n";
    }
    const std::size_t taken = QuickRows(plan).read(rows, 0, no_time);
    CHECK((taken == 0 || taken == rows.bytes.size()));
    const NarrowVectors here;
    CHECK(QuickRows(plan).read(rows, taken, no_time) == rows.bytes.size());
    CHECK(rows.joints[0].torque_nm == std::vector<double>{7.5, 7.5, 7.5});
}
