// SPDX-License-Identifier: MIT
// How much of an arm its torque can tell at all: the rank of its rows at random places (Gautier and Khalil,
// Direct calculation of minimum set of inertial parameters, 1990, tell it by hand; Gautier, Numerical
// calculation of the base inertial parameters, 1991, by QR as here).
#include <random>

#include "arm/dynamics/arm_row.hpp"
#include "core/matrices/factorisations.hpp"
#include "ripplenotch/arm/arm_dynamics.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

// Of the factor's diagonal: what is below this part of the largest is rounding.
constexpr double of_the_largest = 1e-9;

class RandomPlaces {
  public:
    explicit RandomPlaces(std::size_t joints) : states_(joints) {}

    std::span<const JointState> next() {
        for (JointState& state : states_) {
            const double angle_deg = 180.0 * uniform();
            state = {uniform(), uniform(), uniform(), portable::cos_degrees(angle_deg),
                     portable::sin_degrees(angle_deg)};
        }
        return states_;
    }

  private:
    // From -1 to 1. The standard says every bit of the engine, and nothing of how its distributions use them.
    double uniform() { return 0x1p-52 * static_cast<double>(bits_() >> 11) - 1.0; }
    std::mt19937_64 bits_{1};
    std::vector<JointState> states_;
};

std::size_t rank(MatrixXd rows) {
    const double largest = rows.colwise().norm().maxCoeff();
    for (Index c = 0; c < rows.cols(); ++c) {
        const double size = rows.col(c).norm();
        if (size > of_the_largest * largest)
            rows.col(c) /= size;
        else
            rows.col(c).setZero();
    }
    return static_cast<std::size_t>(RankedFactors(rows).rank(of_the_largest));
}

// Rows of the joints [first, end) at random places; with the rotor of `first` as a last column.
MatrixXd random_rows(const Chain& chain, std::size_t first, std::size_t end, bool rotor) {
    const std::size_t values = values_of_a_link * chain.size(), each = end - first;
    const std::size_t places = 4 * values / each + 10;
    MatrixXd rows(static_cast<Index>(places * each), static_cast<Index>(values + rotor));
    ArmRow arm(chain);
    RandomPlaces random(chain.size());
    std::vector<double> row(values);
    for (std::size_t k = 0; k < places; ++k) {
        const auto states = random.next();
        arm.move(states);
        for (std::size_t j = first; j < end; ++j) {
            arm.torque_of(j, row);
            const auto at = static_cast<Index>(k * each + j - first);
            for (std::size_t c = 0; c < values; ++c) rows(at, static_cast<Index>(c)) = row[c];
            if (rotor) rows(at, static_cast<Index>(values)) = states[first].acceleration;
        }
    }
    return rows;
}

}  // namespace

std::size_t arm_values_there(const Chain& chain) { return rank(random_rows(chain, 0, chain.size(), false)); }

std::size_t arm_values_there(const Chain& chain, std::size_t joint) {
    return rank(random_rows(chain, joint, joint + 1, false));
}

bool rotor_is_identifiable(const Chain& chain, std::size_t joint) {
    return rank(random_rows(chain, joint, joint + 1, true)) > arm_values_there(chain, joint);
}

}  // namespace ripplenotch
