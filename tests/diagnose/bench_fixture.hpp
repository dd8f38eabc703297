// SPDX-License-Identifier: MIT
#pragma once
// A bench on a log with something hidden in it, for judges that are asked alone.

#include <random>

#include "core/vectors/dot.hpp"
#include "diagnose/judging/doubt.hpp"
#include "diagnose/limits.hpp"
#include "diagnose/search/model_bench.hpp"
#include "diagnose_fixture.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/model/motion.hpp"

namespace ripplenotch::fixture {

inline Case case_of(const Trace& log) { return whole_case(log.view(), default_smoothing); }

/// A log of `truth` along the tour, less its noise of the speed: 8500 samples.
inline Trace plain_log(const Model& truth, std::uint64_t seed) {
    Trace log = logged(truth, tour(), seed);
    log.velocity_deg_s = tour().velocity_deg_s;
    return log;
}

/// The whole tour of a joint that its model explains.
inline const Case& along_tour() {
    static const Case c = case_of(plain_log(joint(), 60));
    return c;
}

/// The bench and what has to outlive it. The noise is known, so that no test waits for it to be measured.
struct TestBench {
    explicit TestBench(Case looked_at) : c(std::move(looked_at)), bench(c, {noise_nm, noise_nm, {}}, work) {}
    TestBench(const TestBench&) = delete;
    TestBench& operator=(const TestBench&) = delete;

    /// Fitted to the log from `guess` on, its numbers open; the terms cost nothing.
    [[nodiscard]] Candidate fitted(const Model& guess) const {
        return bench.with_errors(bench.fitted(opened(guess), guess, std::vector<double>(guess.terms.size())));
    }

    Work work{1e9};
    Case c;
    ModelBench bench;
};

/// Slow waves that go with nothing of the joint's own: what an arm's other joints do to this one.
inline std::vector<double> slow_leftover(const Motion& motion, std::uint64_t seed, double rms_nm) {
    std::mt19937_64 draw(seed);
    const auto part = [&] { return static_cast<double>(draw() >> 11U) / 9007199254740992.0; };
    std::vector<double> left(motion.size(), 0.0);
    for (int wave = 0; wave < 12; ++wave) {
        const double hz = 0.05 + 0.9 * part(), phase = part();
        for (std::size_t k = 0; k < left.size(); ++k)
            left[k] += portable::cos_degrees(360.0 * (hz * motion.time_s[k] + phase));
    }
    const double now = rms(left);
    for (double& value : left) value *= rms_nm / now;
    return left;
}

}  // namespace ripplenotch::fixture
