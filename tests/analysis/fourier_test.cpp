// SPDX-License-Identifier: MIT
// Fourier sums against direct ones, and their kernels on every width of vectors.
#include <complex>
#include <cstring>
#include <numbers>
#include <random>
#include <vector>

#include "analysis/kernels/spreading_kernel.hpp"
#include "analysis/traces.hpp"
#include "ripplenotch/analysis/fourier.hpp"
#include "support/catch.hpp"
#include "support/vectors.hpp"

using namespace ripplenotch;
using Catch::Matchers::WithinAbs;
using namespace ripplenotch::testing;

namespace {

std::complex<double> direct_sum(const std::vector<double>& where, const std::vector<double>& value,
                                double frequency) {
    std::complex<double> sum;
    for (std::size_t j = 0; j < where.size(); ++j) {
        sum += value[j] * std::polar(1.0, -2.0 * std::numbers::pi * frequency * where[j]);
    }
    return sum;
}

}  // namespace

TEST_CASE("the real transform equals its defining sum at every length, prime lengths included") {
    const std::size_t n = GENERATE(1U, 2U, 3U, 16U, 97U, 120U);
    tests::Noise noise(3);
    std::vector<double> x(n), index(n);
    for (std::size_t k = 0; k < n; ++k) {
        x[k] = noise();
        index[k] = static_cast<double>(k);
    }
    const auto sums = real_fourier(x);
    REQUIRE(sums.size() == n / 2 + 1);
    for (std::size_t k = 0; k < sums.size(); ++k) {
        const auto expected = direct_sum(index, x, static_cast<double>(k) / static_cast<double>(n));
        CHECK_THAT(std::abs(sums[k] - expected), WithinAbs(0.0, 1e-12 * static_cast<double>(n)));
    }
}

TEST_CASE("a fast length is the next one without large prime factors") {
    CHECK(fast_length(0) == 1);
    CHECK(fast_length(11) == 12);
    CHECK(fast_length(97) == 98);
    CHECK(fast_length(1021) == 1024);
}

TEST_CASE("the spreading kernel's polynomials are the kernel, and nothing lies beyond its points") {
    const SpreadingKernel polynomials;
    SpreadingKernel::Row row;
    for (const double offset : {0.0, 1e-9, 0.13, 0.5, 0.77, 1.0}) {
        polynomials.at(offset, row);
        for (std::size_t i = 0; i < row.size(); ++i) {
            const double x = (static_cast<double>(i) + offset) * 2.0 / SpreadingKernel::width - 1.0;
            const bool inside = i < SpreadingKernel::width;
            const double kernel = inside ? SpreadingKernel::value(std::clamp(x, -1.0, 1.0)) : 0.0;
            const bool end = i == 0 || i + 1 == SpreadingKernel::width;
            CHECK_THAT(row[i], WithinAbs(kernel, end ? 1e-10 : 1e-14));
        }
    }
}

TEST_CASE("the spreading kernel's transform is its integral") {
    for (const double phase : {0.0, 1.0, 7.85}) {
        double sum = 0.0;
        constexpr int steps = 20000;
        for (int k = 0; k < steps; ++k) {
            const double x = (2.0 * k + 1.0) / steps - 1.0;
            sum += SpreadingKernel::value(x) * std::cos(phase * x) * 2.0 / steps;
        }
        CHECK_THAT(SpreadingKernel::transform(phase), WithinAbs(sum, 1e-8));
    }
}

TEST_CASE("the non-uniform transform equals the direct sum to 1e-9 of the sum of magnitudes") {
    tests::Noise noise(5);
    const std::size_t count = GENERATE(1U, 7U, 300U);
    std::vector<double> where, value;
    double magnitude = 0.0;
    for (int j = 0; j < 400; ++j) {
        where.push_back(3.0 * noise());  // unsorted, negative, crowded
        value.push_back(noise());
        magnitude += std::abs(value.back());
    }
    const double spacing = 0.37;
    const auto sums = nonuniform_fourier(where, value, spacing, count);
    REQUIRE(sums.size() == count);
    for (std::size_t k = 0; k < count; ++k) {
        const auto expected = direct_sum(where, value, spacing * static_cast<double>(k));
        CHECK_THAT(std::abs(sums[k] - expected), WithinAbs(0.0, 1e-9 * magnitude));
    }
}

TEST_CASE("the derivatives of a Fourier sum are those of its centred form") {
    const std::vector<double> where{0.0, 0.4, 1.1, 2.0}, value{1.0, -2.0, 0.5, 1.5};
    const double f = 0.8, h = 1e-5;
    const FourierPoint at = fourier_point(where, value, f);
    CHECK_THAT(std::abs(at.value - direct_sum(where, value, f)), WithinAbs(0.0, 1e-12));
    // |S|^2 does not depend on the origin of `where`: its slope is 2 Re(conj(S) S').
    const double slope =
        (std::norm(direct_sum(where, value, f + h)) - std::norm(direct_sum(where, value, f - h))) / (2 * h);
    CHECK_THAT(2.0 * std::real(std::conj(at.value) * at.first), WithinAbs(slope, 1e-6));
}

TEST_CASE("a Fourier sum over an even grid is the direct sum at every length, its derivatives too") {
    const std::size_t n = GENERATE(1U, 2U, 7U, 8U, 9U, 255U, 256U, 257U, 1031U);
    const double frequency = GENERATE(0.0, 0.37, 41.3, 499.0);
    tests::Noise noise(7);
    std::vector<double> where, value, centred;
    for (std::size_t k = 0; k < n; ++k) {
        where.push_back(0.25 + 0.001 * static_cast<double>(k));
        value.push_back(noise());
    }
    const double middle = 0.5 * (where.front() + where.back());
    for (const double at : where) centred.push_back(at - middle);
    const FourierPoint found = fourier_point(where, value, frequency);
    const std::complex<double> back = std::polar(1.0, -2.0 * std::numbers::pi * frequency * middle);
    const auto moment = [&](int power) {
        std::vector<double> weighted = value;
        for (std::size_t k = 0; k < n; ++k) weighted[k] *= std::pow(centred[k], power);
        return direct_sum(centred, weighted, frequency) * back *
               std::pow(std::complex<double>(0.0, -2.0 * std::numbers::pi), power);
    };
    const double rounding = 1e-12 * static_cast<double>(n);
    CHECK_THAT(std::abs(found.value - moment(0)), WithinAbs(0.0, rounding));
    CHECK_THAT(std::abs(found.first - moment(1)), WithinAbs(0.0, 10.0 * rounding));
    CHECK_THAT(std::abs(found.second - moment(2)), WithinAbs(0.0, 50.0 * rounding));
}

namespace {

/// Numbers of a kernel's results, one after another.
using Results = std::vector<double>;

/// `work` appends what a kernel makes.
template <class Work>
void check_widths(const char* name, std::size_t length, Work work) {
    std::vector<Results> made;
    for (const bool wide : widths()) {
        const Width here(wide);
        made.emplace_back();
        work(made.back());
    }
    INFO(name << " of " << length);
    CHECK_FALSE(made.front().empty());
    CHECK(made.front().size() == made.back().size());
    CHECK(std::memcmp(made.front().data(), made.back().data(), made.front().size() * sizeof(double)) == 0);
}

}  // namespace

TEST_CASE("the spreading kernel gives the same bits on every width of vectors, wherever a sample lies") {
    std::mt19937_64 random(18);
    std::uniform_real_distribution<double> offset(0.0, 1.0);
    const SpreadingKernel kernel;
    for (int trial = 0; trial < 2000; ++trial) {
        const double at = offset(random);
        check_widths("spreading", SpreadingKernel::width, [&](Results& into) {
            SpreadingKernel::Row row;
            kernel.at(at, row);
            into.assign(row.begin(), row.end());
        });
    }
}
