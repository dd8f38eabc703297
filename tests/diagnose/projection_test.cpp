// SPDX-License-Identifier: MIT
// What columns explain is the same from their products as from columns at right angles.
#include "diagnose/search/model_bench.hpp"

#include <cmath>
#include <random>

#include "support/catch.hpp"

using namespace ripplenotch;

namespace {

constexpr std::size_t rows = 500;

Column noise(std::mt19937_64& random) {
    std::normal_distribution<double> usual;
    Column column(rows);
    for (double& value : column) value = usual(random);
    return column;
}

// a * x + b * y.
Column sum_of(double a, const Column& x, double b, const Column& y) {
    Column sum(rows);
    for (std::size_t k = 0; k < rows; ++k) sum[k] = a * x[k] + b * y[k];
    return sum;
}

double by_right_angles(const std::vector<Column>& columns, const Column& left) {
    const Column outside = outside_of(orthonormal(columns), left);
    return product(left, left) - product(outside, outside);
}

}  // namespace

TEST_CASE("columns beside a basis explain as much as all of them at right angles") {
    std::mt19937_64 random(51);
    for (std::size_t known = 0; known < 5; ++known) {
        for (std::size_t beside = 0; beside < 6; ++beside) {
            std::vector<Column> first, second;
            for (std::size_t c = 0; c < known; ++c) first.push_back(noise(random));
            // Nearly along each other, and of very unlike sizes, as slopes of a model are.
            for (std::size_t c = 0; c < beside; ++c) {
                const double size = std::pow(10.0, 3.0 * static_cast<double>(c) - 6.0);
                const Column own = noise(random);
                second.push_back(c == 0 ? sum_of(size, own, 0.0, own)
                                        : sum_of(size, own, 4e3, second.back()));
            }
            const Column left = noise(random);
            std::vector<Column> all = first;
            all.insert(all.end(), second.begin(), second.end());
            INFO(known << " columns known, " << beside << " beside them");
            // Products lose the square of the closeness: 4 to the 5 of 1e-16.
            CHECK(explained(orthonormal(first), second, left) ==
                  Approx(by_right_angles(all, left)).epsilon(1e-8));
        }
    }
}

TEST_CASE("a column that is a combination of others, or nothing, explains nothing more") {
    std::mt19937_64 random(52);
    const Column a = noise(random), b = noise(random), c = noise(random), left = noise(random);
    const std::vector<Column> basis = orthonormal(std::vector<Column>{a});
    const double expected = by_right_angles({a, b, c}, left);
    CHECK(explained(basis, std::vector<Column>{b, c}, left) == Approx(expected).epsilon(1e-10));
    const std::vector<Column> more = {b, sum_of(3.0, b, -2.0, a), c, Column(rows, 0.0),
                                      sum_of(1.0, b, 1.0, c)};
    CHECK(explained(basis, more, left) == Approx(expected).epsilon(1e-10));
    CHECK(explained(basis, {}, left) == Approx(by_right_angles({a}, left)).epsilon(1e-10));
    CHECK(explained({}, {}, left) == 0.0);
}
