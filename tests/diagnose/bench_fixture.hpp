// SPDX-License-Identifier: MIT
#pragma once
// A bench on a log with something hidden in it, for judges that are asked alone.

#include "diagnose/judging/doubt.hpp"
#include "diagnose/search/model_bench.hpp"
#include "diagnose_fixture.hpp"
#include "ripplenotch/model/measured_motion.hpp"

namespace ripplenotch::fixture {

inline Case case_of(const Trace& log) {
    return whole_case(log.view(), default_smoothing, standard.recording);
}

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
    explicit TestBench(Case looked_at, const DiagnosisRules& by = standard)
        : rules(by), c(std::move(looked_at)), bench(c, {noise_nm, noise_nm, {}}, work, rules) {}
    TestBench(const TestBench&) = delete;
    TestBench& operator=(const TestBench&) = delete;

    /// Fitted to the log from `guess` on, its numbers open; the terms cost nothing.
    [[nodiscard]] Candidate fitted(const Model& guess) const {
        return bench.with_errors(bench.fitted(opened(guess), guess, std::vector<double>(guess.terms.size())));
    }

    DiagnosisRules rules;
    Work work{1e9};
    Case c;
    ModelBench bench;
};

inline const Decision& last_against(const std::vector<Decision>& decisions) {
    static const Decision none;
    const Decision* last = &none;
    for (const Decision& decision : decisions) {
        if (decision.against) last = &decision;
    }
    return *last;
}

}  // namespace ripplenotch::fixture
