// SPDX-License-Identifier: MIT
#include "ripplenotch/evaluate/comparison.hpp"

#include <algorithm>
#include <cmath>

#include "ripplenotch/analysis/ripple_estimate.hpp"
#include "ripplenotch/core/median.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/evaluate/bench.hpp"

namespace ripplenotch {
namespace {

constexpr std::size_t block_rows = 4096;  // by hand

// One method on its way through a log.
struct Runner {
    std::unique_ptr<CausalFilter> filter;
    std::vector<double> out;
    std::span<const double> temperature_degc;  ///< of the whole log, or empty
    double error_squares = 0.0;
    std::optional<SwitchLedger> ledger = std::nullopt;  ///< of a method that switches
};

double ripple_rms_nm(const RippleLevels& levels, std::size_t signal) {
    double power = 0.0;
    for (const OrderLevel& level : levels.orders) {
        const double a = level.amplitude_nm[signal];
        if (level.windows > 0) power += 0.5 * a * a;
    }
    return std::sqrt(power);
}

void fill_levels(MethodFigures& figures, const RippleLevels& levels, std::size_t signal) {
    if (levels.windows == 0) return;
    for (const OrderLevel& level : levels.orders) {
        const double before = level.amplitude_nm[0], after = level.amplitude_nm[signal];
        OrderAttenuation entry{level.order, level.mean_hz, std::nullopt};
        if (before > 0.0) {
            entry.db = after > 0.0 ? std::min(20.0 * portable::log10(before / after), most_attenuation_db)
                                   : most_attenuation_db;
        }
        figures.attenuation.push_back(entry);
    }
    figures.ripple_rms_nm = ripple_rms_nm(levels, signal);
    figures.residual_rms_nm = levels.residual_rms_nm[signal];
    figures.residual_peak_to_peak_nm = levels.residual_peak_to_peak_nm[signal];
}

double largest_jump_nm(const CausalFilter& filter) {
    double largest = 0.0;
    for (const Switch& change : filter.switches()) largest = std::max(largest, std::abs(change.jump_nm));
    return largest;
}

// Feeds a block to every method and to the meter; signal 0 is the log's own torque. `truth_nm` may be empty.
void run_block(std::vector<Runner>& runners, RippleMeter& meter, const TraceView& block,
               std::span<const double> truth_nm) {
    for (Runner& runner : runners) {
        runner.out.resize(block.size());
        const auto warmth = runner.temperature_degc.empty()
                                ? runner.temperature_degc
                                : runner.temperature_degc.subspan(block.first_row, block.size());
        runner.filter->process({block.velocity_deg_s, block.torque_nm, block.position_deg, warmth},
                               runner.out);
        if (runner.ledger) runner.ledger->add(block.time_s, runner.out, runner.filter->switches());
        for (std::size_t k = 0; k < truth_nm.size(); ++k) {
            const double error = runner.out[k] - truth_nm[k];
            runner.error_squares += error * error;
        }
    }
    std::vector<double> signals(runners.size() + 1);
    for (std::size_t k = 0; k < block.size(); ++k) {
        signals[0] = block.torque_nm[k];
        for (std::size_t i = 0; i < runners.size(); ++i) signals[i + 1] = runners[i].out[k];
        meter.add(Seconds(block.time_s[k]), block.velocity_deg_s[k],
                  block.has_position() ? &block.position_deg[k] : nullptr, signals);
    }
}

// The runs of the log, in blocks; `at_gap` between them.
template <class Block, class Gap>
void for_each_block(const TraceView& trace, const Block& block, const Gap& at_gap) {
    auto run = trace.run_starts.begin();
    for (std::size_t at = 0; at < trace.size();) {
        std::size_t end = std::min(at + block_rows, trace.size());
        if (run != trace.run_starts.end()) end = std::min(end, *run);
        block(trace.part(at, end - at));
        if (run != trace.run_starts.end() && *run == end) {
            ++run;
            at_gap();
        }
        at = end;
    }
}

// A filter for the log; one that looks at the whole log first has done so.
std::unique_ptr<CausalFilter> filter_for(const Contender& contender, const ComparedLog& log) {
    const auto learner = contender.learner(log.trace.sample_rate);
    if (learner == nullptr) return contender.start(log.trace.sample_rate);
    std::vector<double> passed;
    for_each_block(
        log.trace,
        [&](const TraceView& block) {
            passed.resize(block.size());
            learner->process({block.velocity_deg_s, block.torque_nm, block.position_deg}, passed);
        },
        [&] { learner->restart(); });
    return learner->learned();
}

}  // namespace

MethodFigures measure_on_signals(const Contender& contender, Hertz sample_rate, DegPerSec speed,
                                 std::optional<double> step_nm, std::optional<double> ramp_nm_s,
                                 const GearAccount* lines) {
    MethodFigures figures;
    figures.method = contender.text;
    const Bench bench(contender, sample_rate, speed);
    if (step_nm) {
        const StepMeasurement step = bench.step(NewtonMeters(*step_nm));
        figures.settle_ms.emplace();
        for (std::size_t i = 0; i < step.settle.size(); ++i)
            (*figures.settle_ms)[i] = 1e3 * step.settle[i].value();
        figures.overshoot_percent = step.overshoot_percent;
    }
    if (ramp_nm_s) figures.ramp_delay_ms = 1e3 * bench.ramp_delay(*ramp_nm_s).value();
    if (const auto frozen = contender.frozen(sample_rate, speed)) {
        figures.dc_delay_ms = 1e3 * group_delay(frozen->cascade, Hertz(0.0), SampledAt(sample_rate)).value();
        figures.note = frozen->note;
    }
    if (lines != nullptr) {
        for (const Order order : lines->orders) {
            const Hertz at = ripple_frequency(order, lines->ratio, speed);
            figures.attenuation.push_back({order.value(), at.value(), bench.attenuation_db(at)});
        }
    }
    return figures;
}

DegPerSec median_moving_speed(const TraceView& trace) {
    double fastest = 0.0;
    for (const double v : trace.velocity_deg_s) fastest = std::max(fastest, std::abs(v));
    std::vector<double> moving;
    for (const double v : trace.velocity_deg_s) {
        if (std::abs(v) > fastest / 20.0) moving.push_back(std::abs(v));
    }
    if (moving.empty()) return DegPerSec(0.0);
    return DegPerSec(median_in(moving));
}

LogLevels measure_on_log(std::span<const Contender> contenders, const ComparedLog& log,
                         const GearAccount& lines) {
    std::vector<Runner> runners;
    for (const Contender& contender : contenders) {
        runners.push_back({filter_for(contender, log), {}, {}});
        if (runners.size() <= log.temperatures_degc.size())
            runners.back().temperature_degc = log.temperatures_degc[runners.size() - 1];
        if (contender.method->needs_table) runners.back().ledger.emplace(log.truth_nm);
    }
    RippleMeter meter(lines.ratio, lines.orders, log.trace.sample_rate, runners.size() + 1);
    std::size_t done = 0;
    for_each_block(
        log.trace,
        [&](const TraceView& block) {
            const auto truth = log.truth_nm.empty() ? log.truth_nm : log.truth_nm.subspan(done, block.size());
            run_block(runners, meter, block, truth);
            for (std::size_t i = 0; log.watch && i < runners.size(); ++i)
                log.watch(i, block, runners[i].out, truth);
            done += block.size();
        },
        [&] {
            meter.split();
            for (Runner& runner : runners) {
                runner.filter->restart();
                if (runner.ledger) runner.ledger->split();
            }
        });
    const RippleLevels levels = meter.levels();
    LogLevels result{{}, levels.windows, levels.measured_share, ""};
    if (levels.windows == 0) {
        result.why_none = levels.windows_too_few_samples > 0
                              ? "too few samples per motor turn for so many orders"
                              : "the joint nowhere turns four periods of an order in one direction below "
                                "half the sample rate";
    }
    for (std::size_t i = 0; i < contenders.size(); ++i) {
        MethodFigures figures;
        figures.method = contenders[i].text;
        fill_levels(figures, levels, i + 1);
        if (runners[i].ledger) {
            figures.switches = runners[i].filter->switch_count();
            figures.largest_jump_nm = largest_jump_nm(*runners[i].filter);
            figures.switch_ledger = runners[i].ledger->entries();
        }
        if (!log.truth_nm.empty()) {
            const auto rows = static_cast<double>(log.truth_nm.size());
            figures.error_rms_nm = std::sqrt(runners[i].error_squares / rows);
        }
        result.methods.push_back(std::move(figures));
    }
    return result;
}

}  // namespace ripplenotch
