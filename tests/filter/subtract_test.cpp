// SPDX-License-Identifier: MIT
// Ripple learned in a first pass and subtracted in a second.

#include "filter/moves.hpp"
#include "support/catch.hpp"

using namespace ripplenotch;
using namespace ripplenotch::testing;

namespace {

const std::string two_orders = "subtract,gear-ratio=100,orders=1:2";

std::unique_ptr<Learner> learner() {
    const Spec spec = parse_spec(two_orders);
    const Method& method = find_method(spec.name);
    return method.learner(Settings("method", spec, method.keys), Hertz(1000.0));
}

}  // namespace

TEST_CASE("on the paper's move subtract leaves the noise, 0.05 Nm, whatever the ripple's phase") {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        KnownMove move = paper_move(seed, 72.0 * static_cast<double>(seed), 50.0 * static_cast<double>(seed));
        CHECK(rms_error(filtered_in_two_passes(two_orders, move.signals.samples()), move.true_nm) < 0.052);
        integrate_noisy_velocity(move, 0.15, 0.0, seed);
        Samples blind = move.signals.samples();
        blind.position_deg = {};
        CHECK(rms_error(filtered_in_two_passes(two_orders, blind), move.true_nm) < 0.055);
    }
}

TEST_CASE("through a reversal subtract leaves the noise") {
    KnownMove move;
    double angle = 0.0;
    for (std::size_t k = 0; k < 20000; ++k) {
        const double t = static_cast<double>(k) / 1000.0;
        const double v = std::clamp(8.0 * (t - 10.0), -40.0, 40.0);
        angle += v / 1000.0;
        const double theta = 100.0 * angle * std::numbers::pi / 180.0;
        move.true_nm.push_back(10.0 + 5.0 * std::sin(2.0 * std::numbers::pi * 0.2 * t));
        move.signals.velocity_deg_s.push_back(v);
        move.signals.position_deg.push_back(angle);
        move.signals.torque_nm.push_back(move.true_nm.back() + 2.0 * std::sin(theta + 0.3) +
                                         std::sin(2.0 * theta + 1.1));
    }
    add_white_noise(move.signals.torque_nm, 0.05, 9, NoiseChannel::torque);
    CHECK(rms_error(filtered_in_two_passes(two_orders, move.signals.samples()), move.true_nm, 8000, 12000) <
          0.052);
}

TEST_CASE("subtract passes a constant torque bit for bit, and what turns too little") {
    Signals s = wandering(6000, 5);
    s.torque_nm.assign(6000, -0.512);
    CHECK(same_bits(filtered_in_two_passes(two_orders, s.samples()), s.torque_nm));
    s = wandering(6000, 6);
    s.velocity_deg_s.assign(6000, 0.0);
    s.position_deg.assign(6000, 12.0);
    CHECK(same_bits(filtered_in_two_passes(two_orders, s.samples()), s.torque_nm));
}

TEST_CASE("noise alone is not subtracted: no course foretells it") {
    Signals s = wandering(20000, 8);
    std::fill(s.torque_nm.begin(), s.torque_nm.end(), 3.0);
    add_white_noise(s.torque_nm, 0.05, 8, NoiseChannel::torque);
    const auto out = filtered_in_two_passes(two_orders, s.samples());
    CHECK(rms_error(out, s.torque_nm) < 0.005);
}

TEST_CASE("both passes give the same bytes for any split into blocks, and the first passes the torque") {
    const Signals s = wandering(8000, 7);
    const auto whole = learner(), pieces = learner();
    CHECK(same_bits(filtered(*whole, s.samples()), s.torque_nm));
    std::vector<double> out(8000), expected = filtered(*whole->learned(), s.samples());
    const auto run = [&](CausalFilter& filter) {
        std::mt19937 engine(3);
        for (std::size_t at = 0; at < out.size();) {
            const std::size_t count = std::min<std::size_t>(
                std::uniform_int_distribution<std::size_t>(0, 400)(engine), out.size() - at);
            filter.process(s.part(at, count), std::span(out).subspan(at, count));
            at += count;
        }
    };
    run(*pieces);
    const auto second = pieces->learned();
    run(*second);
    CHECK(same_bits(out, expected));
    CHECK(pieces->notes().size() == 2);
}

TEST_CASE("an amplitude that depends on the direction is subtracted in both") {
    Signals s = wandering(20000, 21);
    std::vector<double> truth;
    for (std::size_t k = 0; k < s.torque_nm.size(); ++k) {
        const double theta = 100.0 * s.position_deg[k] * std::numbers::pi / 180.0;
        truth.push_back(std::sin(0.0013 * static_cast<double>(k)));
        s.torque_nm[k] = truth.back() + (s.velocity_deg_s[k] > 0.0 ? 1.0 : 0.3) * std::cos(theta);
    }
    CHECK(rms_error(filtered_in_two_passes(two_orders, s.samples()), truth) <
          0.25 * rms_error(s.torque_nm, truth));
}
