// SPDX-License-Identifier: MIT
// The kernels of this room give the same bits on every width of vectors, at any length.
#include <cstring>
#include <random>
#include <vector>

#include "analysis/kernels/point_kernel.hpp"
#include "analysis/kernels/spreading_kernel.hpp"
#include "support/catch.hpp"
#include "support/vectors.hpp"

using namespace ripplenotch;
using namespace ripplenotch::testing;

namespace {

/// Numbers of a kernel's results, one after another.
using Results = std::vector<double>;

Results noise(std::size_t count, std::mt19937_64& random) {
    std::uniform_real_distribution<double> between(-3.0, 3.0);
    Results values(count);
    for (double& value : values) value = between(random);
    return values;
}

/// Times that are nearly even.
Results times(std::size_t count, std::mt19937_64& random) {
    Results values = noise(count, random);
    for (std::size_t k = 0; k < count; ++k)
        values[k] = 7.0 + 0.25 * static_cast<double>(k) + 1e-4 * values[k];
    return values;
}

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

void check_point(std::size_t n, std::mt19937_64& random) {
    const Results time = times(n, random), value = noise(n, random);
    check_widths("even_point", n, [&](Results& into) {
        const FourierPoint point = even_point(time, value, time[n / 2], 0.25, 0.37);
        for (const auto& sum : {point.value, point.first, point.second})
            into.insert(into.end(), {sum.real(), sum.imag()});
    });
}

}  // namespace

TEST_CASE("kernels over samples give the same bits on every width of vectors, at any length") {
    std::mt19937_64 random(17);
    for (std::size_t n = 1; n < 70; ++n) check_point(n, random);
    for (const std::size_t n : {255U, 256U, 257U, 1000U, 4096U, 10007U}) check_point(n, random);
}

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
