// SPDX-License-Identifier: MIT
// Sums over columns are what their plain loops are, and the same bits on every width of vectors.
#include "core/vectors/dot.hpp"

#include <cstring>
#include <random>
#include <vector>

#include "support/catch.hpp"
#include "support/vectors.hpp"

using namespace ripplenotch;
using namespace ripplenotch::testing;

namespace {

using Numbers = std::vector<double>;

Numbers noise(std::size_t count, std::mt19937_64& random) {
    std::uniform_real_distribution<double> between(-3.0, 3.0);
    Numbers values(count);
    for (double& value : values) value = between(random);
    return values;
}

bool same_bits(const Numbers& a, const Numbers& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

// Everything that these functions make of the same columns.
Numbers made_of(const Numbers& a, const Numbers& b, const Numbers& c, const Numbers& d) {
    const std::size_t n = a.size();
    Numbers made{dot(a.data(), b.data(), n)};
    double sums[4] = {1.0, 2.0, 3.0, 4.0};
    add_dots({a.data(), b.data()}, {c.data(), d.data()}, n, sums);
    made.insert(made.end(), std::begin(sums), std::end(sums));
    Numbers scaled = c;
    add_scaled(0.37, a.data(), scaled.data(), n);
    made.insert(made.end(), scaled.begin(), scaled.end());
    Numbers one = c, other = d;
    add_scaled_pair({0.37, -1.2, 0.11, 2.3}, {a.data(), b.data()}, {one.data(), other.data()}, n);
    made.insert(made.end(), one.begin(), one.end());
    made.insert(made.end(), other.begin(), other.end());
    return made;
}

}  // namespace

TEST_CASE("sums of products give the same bits on every width of vectors, and what a plain loop gives") {
    std::mt19937_64 random(41);
    for (const std::size_t n : {1U, 2U, 3U, 4U, 5U, 7U, 8U, 9U, 15U, 16U, 17U, 31U, 64U, 1001U}) {
        const Numbers a = noise(n, random), b = noise(n, random), c = noise(n, random), d = noise(n, random);
        std::vector<Numbers> made;
        for (const bool wide : widths()) {
            const Width here(wide);
            made.push_back(made_of(a, b, c, d));
        }
        INFO(n << " numbers");
        CHECK(same_bits(made.front(), made.back()));
        Numbers plain{0.0, 1.0, 2.0, 3.0, 4.0};
        for (std::size_t k = 0; k < n; ++k) {
            plain[0] += a[k] * b[k];
            plain[1] += a[k] * c[k];
            plain[2] += a[k] * d[k];
            plain[3] += b[k] * c[k];
            plain[4] += b[k] * d[k];
            plain.push_back(c[k] + 0.37 * a[k]);
        }
        for (std::size_t k = 0; k < n; ++k) plain.push_back(c[k] + 0.37 * a[k] + 0.11 * b[k]);
        for (std::size_t k = 0; k < n; ++k) plain.push_back(d[k] - 1.2 * a[k] + 2.3 * b[k]);
        // Products of up to 9, summed in another order.
        for (std::size_t i = 0; i < plain.size(); ++i)
            CHECK(made.front()[i] == Approx(plain[i]).margin(1e-11));
    }
}

TEST_CASE("errors of a prediction are those of a plain loop to the last bit, on every width of vectors") {
    std::mt19937_64 random(42);
    for (const std::size_t memory : {0U, 1U, 3U, 50U}) {
        const Numbers weights = noise(memory, random);
        for (const std::size_t n : {1U, 4U, 15U, 16U, 17U, 40U, 333U}) {
            const Numbers signal = noise(memory + n, random);
            Numbers plain;
            for (std::size_t k = memory; k < signal.size(); ++k) {
                double sum = 0.0;
                for (std::size_t i = 0; i < memory; ++i) sum += weights[i] * signal[k - 1 - i];
                plain.push_back(signal[k] - sum);
            }
            for (const bool wide : widths()) {
                const Width here(wide);
                Numbers errors(n);
                prediction_errors(signal.data() + memory, n, weights.data(), memory, errors.data());
                INFO(n << " numbers, memory of " << memory << ", " << (wide ? "wide" : "narrow"));
                CHECK(same_bits(errors, plain));
            }
        }
    }
}
