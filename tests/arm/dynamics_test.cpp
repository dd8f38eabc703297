// SPDX-License-Identifier: MIT
// The torque of an arm against mechanics worked out another way.
#include "arm_support.hpp"
#include "ripplenotch/core/error.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using namespace ripplenotch::test;
using Catch::Matchers::WithinAbs;

namespace {

// The energies of an arm at one moment by its positions alone: where each link's frame is, by multiplying
// transforms, and how fast, by differences of it. Nothing of the recursion is in it.
struct Pose {
    std::vector<Vector3> origin;
    std::vector<Rotation> turn;
};

Rotation product(const Rotation& a, const Rotation& b) {
    Rotation c{};
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j)
            for (std::size_t k = 0; k < 3; ++k) c[3 * i + j] += a[3 * i + k] * b[3 * k + j];
    return c;
}

Vector3 turned(const Rotation& r, const Vector3& v) {
    Vector3 out{};
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t k = 0; k < 3; ++k) out[i] += r[3 * i + k] * v[k];
    return out;
}

// Rodrigues' formula, element by element.
Rotation rotation(const Vector3& u, double angle) {
    const double c = std::cos(angle), s = std::sin(angle), v = 1.0 - c;
    return {c + u[0] * u[0] * v,        u[0] * u[1] * v - u[2] * s, u[0] * u[2] * v + u[1] * s,
            u[1] * u[0] * v + u[2] * s, c + u[1] * u[1] * v,        u[1] * u[2] * v - u[0] * s,
            u[2] * u[0] * v - u[1] * s, u[2] * u[1] * v + u[0] * s, c + u[2] * u[2] * v};
}

Pose pose(const Chain& chain, const std::vector<double>& q) {
    Pose found;
    Vector3 origin{};
    Rotation turn{1, 0, 0, 0, 1, 0, 0, 0, 1};
    for (std::size_t j = 0; j < chain.size(); ++j) {
        const ChainJoint& joint = chain.joints[j];
        const Vector3 step = turned(turn, joint.origin_m);
        for (std::size_t i = 0; i < 3; ++i) origin[i] += step[i];
        turn = product(turn, joint.rotation);
        if (joint.kind == JointKind::revolute) {
            turn = product(turn, rotation(joint.axis, q[j]));
        } else {
            const Vector3 slide = turned(turn, joint.axis);
            for (std::size_t i = 0; i < 3; ++i) origin[i] += q[j] * slide[i];
        }
        found.origin.push_back(origin);
        found.turn.push_back(turn);
    }
    return found;
}

double kinetic(const Chain& chain, const std::vector<double>& links, const std::vector<double>& q,
               const std::vector<double>& qd) {
    constexpr double h = 1e-4;
    std::vector<double> before = q, after = q;
    for (std::size_t j = 0; j < q.size(); ++j) before[j] -= h * qd[j], after[j] += h * qd[j];
    const Pose now = pose(chain, q), early = pose(chain, before), late = pose(chain, after);
    double energy = 0.0;
    for (std::size_t j = 0; j < chain.size(); ++j) {
        const double* const p = links.data() + 10 * j;
        Vector3 v{};
        Rotation change{};
        for (std::size_t i = 0; i < 3; ++i) v[i] = (late.origin[j][i] - early.origin[j][i]) / (2.0 * h);
        for (std::size_t i = 0; i < 9; ++i) change[i] = (late.turn[j][i] - early.turn[j][i]) / (2.0 * h);
        // R' dR is the cross product with the speed of turning, in the link's frame.
        const Rotation& r = now.turn[j];
        const Rotation spin = product({r[0], r[3], r[6], r[1], r[4], r[7], r[2], r[5], r[8]}, change);
        const Vector3 w{spin[7], spin[2], spin[3]}, mc = turned(r, {p[1], p[2], p[3]}), w_out = turned(r, w);
        const Vector3 crossed{w_out[1] * mc[2] - w_out[2] * mc[1], w_out[2] * mc[0] - w_out[0] * mc[2],
                              w_out[0] * mc[1] - w_out[1] * mc[0]};
        energy += 0.5 * p[0] * (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) + v[0] * crossed[0] +
                  v[1] * crossed[1] + v[2] * crossed[2] +
                  0.5 * (p[4] * w[0] * w[0] + p[7] * w[1] * w[1] + p[9] * w[2] * w[2]) + p[5] * w[0] * w[1] +
                  p[6] * w[0] * w[2] + p[8] * w[1] * w[2];
    }
    return energy;
}

double potential(const Chain& chain, const std::vector<double>& links, const std::vector<double>& q) {
    const Pose now = pose(chain, q);
    double energy = 0.0;
    for (std::size_t j = 0; j < chain.size(); ++j) {
        const double* const p = links.data() + 10 * j;
        const Vector3 mc = turned(now.turn[j], {p[1], p[2], p[3]});
        for (std::size_t i = 0; i < 3; ++i)
            energy -= chain.gravity_m_s2[i] * (p[0] * now.origin[j][i] + mc[i]);
    }
    return energy;
}

// d/dt dT/dqd - dT/dq + dV/dq by central differences.
double lagrange(const Chain& chain, const std::vector<double>& links, const std::vector<double>& q,
                const std::vector<double>& qd, const std::vector<double>& qdd, std::size_t joint) {
    constexpr double h = 1e-3;
    const auto momentum = [&](double t) {
        std::vector<double> at = q, fast = qd, slow = qd;
        for (std::size_t j = 0; j < q.size(); ++j) {
            at[j] += t * qd[j] + 0.5 * t * t * qdd[j];
            fast[j] += t * qdd[j];
            slow[j] += t * qdd[j];
        }
        fast[joint] += h;
        slow[joint] -= h;
        return (kinetic(chain, links, at, fast) - kinetic(chain, links, at, slow)) / (2.0 * h);
    };
    std::vector<double> up = q, down = q;
    up[joint] += h;
    down[joint] -= h;
    const double of_place = (kinetic(chain, links, up, qd) - kinetic(chain, links, down, qd)) / (2.0 * h);
    const double of_height = (potential(chain, links, up) - potential(chain, links, down)) / (2.0 * h);
    return (momentum(h) - momentum(-h)) / (2.0 * h) - of_place + of_height;
}

Chain random_chain(std::size_t joints, unsigned seed, bool slides) {
    std::mt19937_64 random(seed);
    const auto uniform = [&] { return 0x1p-52 * static_cast<double>(random() >> 11) - 1.0; };
    Chain chain{.source = "random", .joints = {}, .gravity_m_s2 = {1.0, -2.0, -9.0}};
    for (std::size_t j = 0; j < joints; ++j) {
        ChainJoint joint{"j" + std::to_string(j + 1)};
        if (slides && j % 3 == 1) joint.kind = JointKind::prismatic;
        joint.origin_m = {0.4 * uniform(), 0.4 * uniform(), 0.4 * uniform()};
        joint.rotation = rotation_of_rpy({180.0 * uniform(), 180.0 * uniform(), 180.0 * uniform()});
        joint.axis = {uniform(), uniform(), uniform()};
        chain.joints.push_back(joint);
    }
    settle_chain(chain);
    return chain;
}

void require_lagrange(const Chain& chain, unsigned seed) {
    const std::size_t n = chain.size();
    const std::vector<double> links = random_links(n, seed);
    std::vector<Motion> motions = fourier_motions(n, 3.0, 2.0, seed);
    for (std::size_t j = 0; j < n; ++j) {
        if (chain.joints[j].kind == JointKind::revolute) continue;
        for (auto* values :
             {&motions[j].position_deg, &motions[j].velocity_deg_s, &motions[j].acceleration_deg_s2})
            for (double& value : *values) value *= 0.01;  // metres
    }
    for (std::size_t joint = 0; joint < n; ++joint) {
        const auto torque_nm = arm_torque(chain, links, motions, joint);
        for (std::size_t k = 0; k < torque_nm.size(); ++k) {
            std::vector<double> q, qd, qdd;
            for (std::size_t j = 0; j < n; ++j) {
                const double unit = chain.joints[j].kind == JointKind::revolute ? radians : 1.0;
                q.push_back(unit * motions[j].position_deg[k]);
                qd.push_back(unit * motions[j].velocity_deg_s[k]);
                qdd.push_back(unit * motions[j].acceleration_deg_s2[k]);
            }
            INFO("joint " << joint << ", sample " << k);
            REQUIRE_THAT(torque_nm[k], WithinAbs(lagrange(chain, links, q, qd, qdd, joint), 2e-4));
        }
    }
}

double mean_difference(const std::vector<double>& a, const std::vector<double>& b) {
    double sum = 0.0;
    for (std::size_t k = 0; k < a.size(); ++k) sum += std::abs(a[k] - b[k]);
    return sum / static_cast<double>(a.size());
}

}  // namespace

TEST_CASE("a planar arm of two links has the torque of the textbooks", "[arm]") {
    // Two links in the xz plane that turn about y, each a mass m at its far end l: Spong, Robot Modeling and
    // Control, 2006, section 7.4, with gravity along -z and angles from the x axis downward.
    Chain chain{.source = "two links", .joints = {{"a"}, {"b"}}};
    chain.joints[0].axis = chain.joints[1].axis = {0, 1, 0};
    const double m1 = 2.0, m2 = 1.5, l1 = 0.4, l2 = 0.3, g = 9.81;
    chain.joints[1].origin_m = {l1, 0, 0};
    settle_chain(chain);
    const std::vector<double> links = {m1, m1 * l1, 0, 0, 0, 0, 0, m1 * l1 * l1, 0, m1 * l1 * l1,
                                       m2, m2 * l2, 0, 0, 0, 0, 0, m2 * l2 * l2, 0, m2 * l2 * l2};
    const auto motions = fourier_motions(2, 10.0, 20.0, 3);
    const auto first = arm_torque(chain, links, motions, 0), second = arm_torque(chain, links, motions, 1);
    for (std::size_t k = 0; k < first.size(); ++k) {
        const double q1 = radians * motions[0].position_deg[k], q2 = radians * motions[1].position_deg[k];
        const double v1 = radians * motions[0].velocity_deg_s[k], v2 = radians * motions[1].velocity_deg_s[k];
        const double a1 = radians * motions[0].acceleration_deg_s2[k],
                     a2 = radians * motions[1].acceleration_deg_s2[k];
        const double m12 = m2 * (l2 * l2 + l1 * l2 * std::cos(q2)), h = m2 * l1 * l2 * std::sin(q2);
        const double m11 = (m1 + m2) * l1 * l1 + m2 * l2 * l2 + 2.0 * m2 * l1 * l2 * std::cos(q2);
        REQUIRE_THAT(first[k],
                     WithinAbs(m11 * a1 + m12 * a2 - h * (2.0 * v1 * v2 + v2 * v2) -
                                   g * ((m1 + m2) * l1 * std::cos(q1) + m2 * l2 * std::cos(q1 + q2)),
                               1e-12));
        REQUIRE_THAT(
            second[k],
            WithinAbs(m12 * a1 + m2 * l2 * l2 * a2 + h * v1 * v1 - g * m2 * l2 * std::cos(q1 + q2), 1e-12));
    }
}

TEST_CASE("the torque of a random arm is what its energies change by", "[arm]") {
    require_lagrange(random_chain(5, 11, false), 12);
    require_lagrange(random_chain(5, 13, true), 14);
}

TEST_CASE("what the joints give is what the arm's energy gains", "[arm]") {
    const Chain chain = random_chain(6, 21, false);
    const auto links = random_links(6, 22);
    const auto motions = fourier_motions(6, 2.0, 1000.0, 23);
    std::vector<std::vector<double>> torque_nm;
    for (std::size_t j = 0; j < 6; ++j) torque_nm.push_back(arm_torque(chain, links, motions, j));
    const auto energy = [&](std::size_t k) {
        std::vector<double> q, qd;
        for (const Motion& motion : motions) {
            q.push_back(radians * motion.position_deg[k]);
            qd.push_back(radians * motion.velocity_deg_s[k]);
        }
        return kinetic(chain, links, q, qd) + potential(chain, links, q);
    };
    const auto power = [&](std::size_t k) {
        double sum = 0.0;
        for (std::size_t j = 0; j < 6; ++j) sum += torque_nm[j][k] * radians * motions[j].velocity_deg_s[k];
        return sum;
    };
    double work = 0.0;
    const std::size_t last = motions.front().size() - 1;
    for (std::size_t k = 0; k < last; ++k) work += 0.5 * (power(k) + power(k + 1)) * 0.001;
    CHECK(std::abs(work) > 0.5);
    CHECK_THAT(work, WithinAbs(energy(last) - energy(0), 2e-4));
}

TEST_CASE("columns times values are the torque, and links before the joint bring none", "[arm]") {
    const Chain chain = chain_of_mdh("panda.csv", panda_mdh);
    const auto links = random_links(7, 5);
    const auto motions = fourier_motions(7, 1.0, 100.0, 6);
    const auto columns = arm_columns(chain, motions, 4);
    REQUIRE(columns.size() == 70);
    std::vector<double> sum(100, 0.0);
    for (std::size_t c = 0; c < columns.size(); ++c)
        for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += links[c] * columns[c][k];
    CHECK(mean_difference(sum, arm_torque(chain, links, motions, 4)) < 1e-12);
    for (std::size_t c = 0; c < 40; ++c) CHECK(columns[c] == std::vector<double>(100, 0.0));
}

TEST_CASE("a Panda has 43 values, which is what those who identified it count", "[arm]") {
    // Gaz, Cognetti, Oliva, Robuffo Giordano, De Luca: Dynamic Identification of the Franka Emika Panda Robot
    // With Retrieval of Feasible Parameters, 2019, section III.
    const Chain chain = chain_of_mdh("panda.csv", panda_mdh);
    CHECK(arm_values_there(chain) == 43);
    std::vector<std::size_t> each;
    for (std::size_t j = 0; j < 7; ++j) each.push_back(arm_values_there(chain, j));
    CHECK(each == std::vector<std::size_t>{38, 42, 35, 28, 21, 14, 7});
    // About the first joint the links' inertia is a rotor's; about the third it is not.
    CHECK_FALSE(rotor_is_identifiable(chain, 0));
    CHECK(rotor_is_identifiable(chain, 2));
}

TEST_CASE("a joint that is kept still is part of the link before", "[arm]") {
    const Chain chain = random_chain(4, 31, false);
    const Chain still = hold_joint(chain, "j2", 30.0);
    REQUIRE(still.size() == 3);
    auto motions = fourier_motions(4, 1.0, 50.0, 32);
    motions[1].position_deg.assign(50, 30.0);
    motions[1].velocity_deg_s.assign(50, 0.0);
    motions[1].acceleration_deg_s2.assign(50, 0.0);
    auto links = random_links(4, 33);
    std::fill_n(links.begin() + 10, 10, 0.0);
    const auto torque_nm = arm_torque(chain, links, motions, 0);
    links.erase(links.begin() + 10, links.begin() + 20);
    motions.erase(motions.begin() + 1);
    CHECK(mean_difference(arm_torque(still, links, motions, 0), torque_nm) < 1e-11);
    CHECK_THROWS_WITH(hold_joint(chain, "j22", 0.0), Catch::Contains("did you mean j2"));
}

TEST_CASE("an arm is told how many motions it needs", "[arm]") {
    const Chain chain = random_chain(3, 1, false);
    CHECK_THROWS_AS(arm_columns(chain, fourier_motions(2, 1.0, 10.0, 1), 0), UsageError);
    CHECK_THROWS_AS(arm_columns(chain, fourier_motions(3, 1.0, 10.0, 1), 3), UsageError);
    CHECK_THROWS_AS(arm_torque(chain, std::vector<double>(29), fourier_motions(3, 1.0, 10.0, 1), 0),
                    UsageError);
}
