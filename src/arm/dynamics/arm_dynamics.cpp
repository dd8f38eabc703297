// SPDX-License-Identifier: MIT
#include "arm/fit/arm_fit.hpp"

#include <algorithm>
#include <numbers>
#include <random>

#include "core/matrices/factorisations.hpp"
#include "ripplenotch/arm/arm_fit.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {

using namespace space;

ArmRow::ArmRow(const Chain& chain) : gravity_m_s2_(chain.gravity_m_s2) {
    for (const ChainJoint& joint : chain.joints) {
        const Rotation k = crossing(joint.axis);
        links_.push_back({.origin_m = joint.origin_m,
                          .axis = joint.axis,
                          .turns = joint.kind == JointKind::revolute,
                          .still = joint.rotation,
                          .by_sine = times(joint.rotation, k),
                          .by_versed = times(joint.rotation, times(k, k))});
    }
}

// From the base outward, each link's motion in its own frame. The base lies still and is lifted against
// gravity, which brings the weight of every link.
void ArmRow::move(std::span<const JointState> states) {
    Vector3 speed{}, acceleration{}, lift = -1.0 * gravity_m_s2_;
    for (std::size_t i = 0; i < links_.size(); ++i) {
        Link& link = links_[i];
        const JointState& state = states[i];
        link.rotation = link.still;
        link.place_m = link.origin_m;
        if (link.turns) {
            const double versed = 1.0 - state.cosine;
            for (std::size_t e = 0; e < 9; ++e)
                link.rotation[e] += state.sine * link.by_sine[e] + versed * link.by_versed[e];
        } else {
            link.place_m = link.place_m + state.position * outward(link.still, link.axis);
        }
        const Vector3 carried =
            lift + cross(acceleration, link.place_m) + cross(speed, cross(speed, link.place_m));
        link.speed = inward(link.rotation, speed);
        link.acceleration = inward(link.rotation, acceleration);
        link.lift = inward(link.rotation, carried);
        const Vector3 own = state.velocity * link.axis, change = state.acceleration * link.axis;
        if (link.turns) {
            link.acceleration = link.acceleration + change + cross(link.speed, own);
            link.speed = link.speed + own;
        } else {
            link.lift = link.lift + change + 2.0 * cross(link.speed, own);
        }
        speed = link.speed;
        acceleration = link.acceleration;
        lift = link.lift;
    }
}

// The torque is the product of the joint's axis, as a screw (turn, shift) carried out to each link, with the
// link's moment and force; that is the inward recursion read from the other end.
void ArmRow::torque_of(std::size_t joint, std::span<double> row) const {
    std::fill(row.begin(), row.end(), 0.0);
    Vector3 turn{}, shift{};
    (links_[joint].turns ? turn : shift) = links_[joint].axis;
    for (std::size_t j = joint; j < links_.size(); ++j) {
        const Link& link = links_[j];
        if (j > joint) {
            shift = inward(link.rotation, shift + cross(turn, link.place_m));
            turn = inward(link.rotation, turn);
        }
        const Vector3 &w = link.speed, &dw = link.acceleration, &a = link.lift;
        double* const at = row.data() + values_of_a_link * j;
        at[0] = dot(shift, a);
        const Vector3 first = cross(shift, dw) + dot(shift, w) * w + (-dot(w, w)) * shift + cross(a, turn);
        std::copy(first.begin(), first.end(), at + 1);
        const Vector3 gyration = cross(turn, w);
        const auto product = [&](std::size_t x, std::size_t y) {
            return turn[x] * dw[y] + gyration[x] * w[y];
        };
        at[4] = product(0, 0);
        at[5] = product(0, 1) + product(1, 0);
        at[6] = product(0, 2) + product(2, 0);
        at[7] = product(1, 1);
        at[8] = product(1, 2) + product(2, 1);
        at[9] = product(2, 2);
    }
}

ArmStates::ArmStates(const Chain& chain, std::span<const Motion> motions) : states_(chain.size()) {
    if (motions.size() != chain.size())
        raise<UsageError>("arm: {} motions for {} joints", motions.size(), chain.size());
    samples_ = motions.front().size();
    for (std::size_t j = 0; j < chain.size(); ++j) {
        const Motion& motion = motions[j];
        if (motion.size() != samples_ || motion.position_deg.size() != samples_)
            raise<UsageError>("arm: motions of {} and {} samples", samples_, motion.size());
        Joint joint{&motion, chain.joints[j].kind == JointKind::revolute, {}, {}};
        if (joint.turns) {
            joint.cosine.resize(samples_);
            joint.sine.resize(samples_);
            portable::cos_degrees(motion.position_deg, joint.cosine);
            portable::sin_degrees(motion.position_deg, joint.sine);
        }
        joints_.push_back(std::move(joint));
    }
}

std::span<const JointState> ArmStates::at(std::size_t k) {
    constexpr double radians = std::numbers::pi / 180.0;
    for (std::size_t j = 0; j < joints_.size(); ++j) {
        const Joint& joint = joints_[j];
        const double unit = joint.turns ? radians : 1.0;
        states_[j] = {unit * joint.motion->position_deg[k], unit * joint.motion->velocity_deg_s[k],
                      unit * joint.motion->acceleration_deg_s2[k], joint.turns ? joint.cosine[k] : 1.0,
                      joint.turns ? joint.sine[k] : 0.0};
    }
    return states_;
}

namespace {

// The number of identifiable values of an arm: the rank of its rows at random positions (Gautier and Khalil,
// Direct calculation of minimum set of inertial parameters, 1990, in closed form; Gautier, Numerical
// calculation of the base inertial parameters, 1991, by QR as here).

using Eigen::Index;
using Eigen::MatrixXd;

// Diagonal entries of the factor below this share of the largest are rounding.
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
    // From -1 to 1. The standard defines every bit of the engine, but not how its distributions use them.
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

namespace {

// Calls `take(sample, row)` for every sample.
template <class Take>
void each_row(const Chain& chain, std::span<const Motion> motions, std::size_t joint, const Take& take) {
    if (joint >= chain.size()) raise<UsageError>("arm: joint {} of {}", joint + 1, chain.size());
    ArmStates states(chain, motions);
    ArmRow arm(chain);
    std::vector<double> row(values_of_a_link * chain.size());
    for (std::size_t k = 0; k < states.size(); ++k) {
        arm.move(states.at(k));
        arm.torque_of(joint, row);
        take(k, row);
    }
}

}  // namespace

std::vector<std::vector<double>> arm_columns(const Chain& chain, std::span<const Motion> motions,
                                             std::size_t joint) {
    std::vector<std::vector<double>> columns(values_of_a_link * chain.size());
    for (auto& column : columns) column.resize(motions.empty() ? 0 : motions.front().size());
    each_row(chain, motions, joint, [&](std::size_t k, const std::vector<double>& row) {
        for (std::size_t c = 0; c < row.size(); ++c) columns[c][k] = row[c];
    });
    return columns;
}

std::vector<double> arm_torque(const Chain& chain, std::span<const double> values,
                               std::span<const Motion> motions, std::size_t joint) {
    if (values.size() != values_of_a_link * chain.size())
        raise<UsageError>("arm: {} values for {} links", values.size(), chain.size());
    std::vector<double> torque_nm(motions.empty() ? 0 : motions.front().size());
    each_row(chain, motions, joint, [&](std::size_t k, const std::vector<double>& row) {
        double sum = 0.0;
        for (std::size_t c = 0; c < row.size(); ++c) sum += row[c] * values[c];
        torque_nm[k] = sum;
    });
    return torque_nm;
}

}  // namespace ripplenotch
