// SPDX-License-Identifier: MIT
#include "cli/compare/comparison_costs.hpp"

#include "ripplenotch/design/guarantee.hpp"

namespace ripplenotch {

void attach_costs(Options& options, CostRequest& request) {
    options.quantity("--crossover", request.crossover, Dimension::frequency,
                     "the control loop's: phase lag and gain there, e.g. 12Hz");
    options.flag("--ledger", request.ledger,
                 "delay, settling and phase lag of every band of every method; on a log every switch");
    attach_gates(options, request.gates);
}

void add_costs(Comparison& comparison, const CostRequest& request, const Field& field) {
    comparison.crossover = request.crossover;
    if (request.gates.max_delay && comparison.lines) {
        TableSpec notches;
        notches.gear_ratio = comparison.lines->ratio;
        notches.orders = comparison.lines->orders;
        notches.sample_rate = comparison.sample_rate;
        comparison.max_delay = *request.gates.max_delay;
        comparison.no_notch_below = slowest_within(notches, *comparison.max_delay);
    }
    for (std::size_t i = 0; i < field.contenders.size(); ++i) {
        const Contender& contender = field.contenders[i];
        MethodFigures& figures = comparison.methods[i];
        const auto frozen = contender.frozen(comparison.sample_rate, comparison.speed);
        if (request.crossover && frozen) {
            const auto at =
                at_crossover(frozen->cascade, *request.crossover, SampledAt(comparison.sample_rate));
            figures.phase_lag_deg = at.phase_lag_deg;
            figures.crossover_db = at.gain_db;
        }
        if (request.ledger)
            figures.ledger = delay_ledger(contender, comparison.sample_rate, {request.crossover, true});
        if (!request.ledger) figures.switch_ledger.clear();
        if (request.gates.max_delay && contender.made_for()) {
            figures.within_from = within_from(contender, comparison.sample_rate, *request.gates.max_delay);
        }
    }
}

// The control is there to be compared with, not to be held to anything.
std::vector<std::string> violations(const Comparison& comparison, const CostRequest& request,
                                    const Field& field) {
    std::vector<std::string> found;
    const auto add = [&found](std::vector<std::string> more) {
        for (std::string& sentence : more) found.push_back(std::move(sentence));
    };
    for (std::size_t i = 0; i < field.contenders.size(); ++i) {
        const Contender& contender = field.contenders[i];
        if (contender.method->part == MethodPart::control) continue;
        const DegPerSec slowest = comparison.on_log ? comparison.slowest : comparison.speed;
        const DegPerSec fastest = comparison.on_log ? comparison.fastest : comparison.speed;
        add(delay_violations(request.gates, contender, comparison.sample_rate, slowest, fastest));
        add(attenuation_violations(request.gates, contender.text, comparison.methods[i].attenuation));
    }
    return found;
}

}  // namespace ripplenotch
