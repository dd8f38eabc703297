// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "core/rows/row_facts.hpp"
#include "ripplenotch/analysis/ripple_estimate.hpp"
#include "ripplenotch/analysis/ripple_meter.hpp"
#include "ripplenotch/analysis/spectrum.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/core/progress.hpp"
#include "ripplenotch/evaluate/comparison.hpp"
#include "ripplenotch/evaluate/contender.hpp"
#include "ripplenotch/evaluate/filter_metrics.hpp"

namespace ripplenotch {

namespace {

bool is(const MethodFigures& figures, std::string_view method) {
    return figures.method == method || figures.method.rfind(std::string(method) + ",", 0) == 0;
}

std::vector<std::string> parts_of(const std::string& method) {
    std::vector<std::string> parts;
    for (std::size_t at = 0; at <= method.size();) {
        const std::size_t end = std::min(method.find(',', at), method.size());
        parts.push_back(method.substr(at, end - at));
        at = end + 1;
    }
    return parts;
}

constexpr std::size_t short_enough = 36;  // letters of a method that is named as it was typed
constexpr std::size_t longest_name = 40;  // letters of a name in a table and next to a line

// "oscillator B", with the letter that the page of results has for it.
std::string lettered(const std::string& method, const MethodFigures& figures, const Comparison& comparison) {
    std::size_t before = 0;
    for (const MethodFigures& other : comparison.methods) {
        if (&other == &figures) break;
        if (!is(other, "none")) ++before;
    }
    constexpr std::size_t letters = 'Z' - 'A' + 1;  // number of letters in the alphabet
    return before < letters ? fmt::format("{} {}", method, static_cast<char>('A' + before))
                            : fmt::format("{} M{}", method, before + 1);
}

}  // namespace

std::string short_name(const MethodFigures& figures, const Comparison& comparison) {
    if (figures.method.size() <= short_enough) return figures.method;
    const std::vector<std::string> parts = parts_of(figures.method);
    std::string name = parts.front();
    std::vector<std::vector<std::string>> others;
    for (const MethodFigures& other : comparison.methods) {
        if (&other != &figures && is(other, parts.front())) others.push_back(parts_of(other.method));
    }
    for (std::size_t i = 1; i < parts.size(); ++i) {
        const bool shared = std::all_of(others.begin(), others.end(), [&](const auto& other) {
            return std::find(other.begin(), other.end(), parts[i]) != other.end();
        });
        if (!shared) name += "," + parts[i];
    }
    return name.size() <= longest_name ? name : lettered(parts.front(), figures, comparison);
}

namespace {

// "settles 2.8 times faster than B (147 against 408 ms to 0.5 %)"
std::string settling(const MethodFigures& a, const MethodFigures& b, const std::string& rival) {
    const double mine = (*a.settle_ms)[0], theirs = (*b.settle_ms)[0];
    const std::string figures =
        fmt::format("({:.0f} against {:.0f} ms to {} %)", mine, theirs, settle_bands_percent[0]);
    if (mine == theirs) return fmt::format("settles as fast as {} {}", rival, figures);
    if (mine == 0.0 || theirs == 0.0) {
        return fmt::format("settles {:.0f} ms {} than {} {}", std::abs(mine - theirs),
                           mine < theirs ? "earlier" : "later", rival, figures);
    }
    const double ratio = std::max(mine, theirs) / std::min(mine, theirs);
    if (ratio < 1.05) return fmt::format("settles about as fast as {} {}", rival, figures);
    return fmt::format("settles {:.1f} times {} than {} {}", ratio, mine < theirs ? "faster" : "slower",
                       rival, figures);
}

// "lags 38.9 ms less (38.0 against 76.9 ms)"; on a ramp where one was run, else by the DC group delay.
std::string lag(const MethodFigures& a, const MethodFigures& b, const std::string& rival) {
    const auto of = [](const MethodFigures& f) { return f.ramp_delay_ms ? f.ramp_delay_ms : f.dc_delay_ms; };
    if (!of(a) || !of(b)) return "";
    const double mine = *of(a), theirs = *of(b);
    const std::string than = rival.empty() ? "" : " than " + rival;
    const std::string figures = fmt::format("({} against {} ms)", rounded(mine, 1), rounded(theirs, 1));
    if (std::abs(mine - theirs) < 0.05) return fmt::format("lags as much {}", figures);
    return fmt::format("lags {:.1f} ms {}{} {}", std::abs(mine - theirs), mine < theirs ? "less" : "more",
                       than, figures);
}

std::string decibels(double db) {
    return db >= most_attenuation_db ? fmt::format("more than {:.0f} dB", most_attenuation_db)
                                     : fmt::format("{} dB", rounded(db, 1));
}

// The least attenuation of any line.
std::optional<double> least_db(const MethodFigures& figures) {
    std::optional<double> least;
    for (const OrderAttenuation& entry : figures.attenuation) {
        if (entry.db) least = std::min(least.value_or(*entry.db), *entry.db);
    }
    return least;
}

std::string ripple(const MethodFigures& a, const MethodFigures& b) {
    if (a.ripple_rms_nm && b.ripple_rms_nm) {
        return fmt::format("has a remaining ripple of {:.3g} Nm rms against {:.3g}", *a.ripple_rms_nm,
                           *b.ripple_rms_nm);
    }
    const auto mine = least_db(a), theirs = least_db(b);
    if (!mine || !theirs) return "";
    return fmt::format("attenuates its weakest line by {} against {}", decibels(*mine), decibels(*theirs));
}

std::string alone(const MethodFigures& a, const std::string& name) {
    std::vector<std::string> parts;
    if (a.settle_ms)
        parts.push_back(
            fmt::format("settles in {:.0f} ms to {} %", (*a.settle_ms)[0], settle_bands_percent[0]));
    if (const auto delay = a.ramp_delay_ms ? a.ramp_delay_ms : a.dc_delay_ms)
        parts.push_back(fmt::format("lags {} ms", rounded(*delay, 1)));
    if (a.ripple_rms_nm) {
        parts.push_back(fmt::format("has a remaining ripple of {:.3g} Nm rms", *a.ripple_rms_nm));
    } else if (const auto db = least_db(a)) {
        parts.push_back(fmt::format("attenuates its weakest line by {}", decibels(*db)));
    }
    if (parts.empty()) return fmt::format("{}: nothing was asked for that could be measured.", name);
    return fmt::format("{} {}.", name, fmt::join(parts, ", "));
}

// " Nearest to the truth is oscillator: 0.0281 Nm rms off, switching 0.783."; nothing where one ran, or no
// truth is known.
std::string nearest(const MethodFigures& a, const std::string& name, const Comparison& comparison) {
    const MethodFigures* best = nullptr;
    std::size_t known = 0;
    for (const MethodFigures& figures : comparison.methods) {
        if (!figures.error_rms_nm) continue;
        if (part_of(figures) != MethodPart::control) ++known;
        if (best == nullptr || *figures.error_rms_nm < *best->error_rms_nm) best = &figures;
    }
    if (known < 2 || !a.error_rms_nm) return "";
    if (best == &a)
        return fmt::format(" Smallest error against the true torque: {}, {:.3g} Nm rms.", name,
                           *a.error_rms_nm);
    return fmt::format(" Smallest error against the true torque: {}, {:.3g} Nm rms; {} {:.3g}.",
                       short_name(*best, comparison), *best->error_rms_nm, name, *a.error_rms_nm);
}

}  // namespace

MethodPart part_of(const MethodFigures& figures) {
    for (const Method* method : methods()) {
        if (is(figures, method->name)) return method->part;
    }
    return MethodPart::contender;
}

const MethodFigures* Comparison::subject() const {
    const MethodFigures* found = nullptr;
    for (const MethodFigures& figures : methods) {
        const MethodPart part = part_of(figures);
        if (part == MethodPart::control) continue;
        if (part == MethodPart::contender) return &figures;
        if (found == nullptr) found = &figures;
    }
    return found;
}

const MethodFigures* Comparison::rival() const {
    const MethodFigures *rival = nullptr, *other = nullptr;
    for (const MethodFigures& figures : methods) {
        const MethodPart part = part_of(figures);
        if (&figures == subject() || part == MethodPart::control) continue;
        if (rival == nullptr && part == MethodPart::rival) rival = &figures;
        if (other == nullptr) other = &figures;
    }
    return rival != nullptr ? rival : other;
}

std::string differences(const Comparison& comparison) {
    const MethodFigures* const a = comparison.subject();
    if (a == nullptr) return "Only the control ran; there is nothing to compare.";
    const MethodFigures* const b = comparison.rival();
    const std::string name = short_name(*a, comparison);
    if (b == nullptr) return alone(*a, name);
    const std::string rival = short_name(*b, comparison);
    std::vector<std::string> parts;
    if (a->settle_ms && b->settle_ms) parts.push_back(settling(*a, *b, rival));
    if (const std::string text = lag(*a, *b, parts.empty() ? rival : ""); !text.empty())
        parts.push_back(text);
    const std::string left = ripple(*a, *b);
    const std::string more = left.empty() || parts.empty() ? left : ". It " + left;
    return fmt::format("{} {}{}.{}", name, fmt::join(parts, ", "), more, nearest(*a, name, comparison));
}

std::string verdict(const Comparison& comparison) {
    const std::string& best = comparison.best_sentence;
    return best.empty() ? differences(comparison) : best + " " + differences(comparison);
}

std::unique_ptr<CausalFilter> Contender::start(Hertz sample_rate) const {
    return method->start(settings, sample_rate, table.get());
}

std::string Contender::refusal(Hertz sample_rate) const {
    try {
        static_cast<void>(start(sample_rate));
    } catch (const UsageError& error) {
        return error.what();
    } catch (const DataError& error) {
        return error.what();
    }
    return "";
}

std::unique_ptr<CausalFilter> Contender::start_on_bench(Hertz sample_rate) const {
    return without_ripple ? without_ripple->start(sample_rate) : start(sample_rate);
}

std::optional<FrozenFilter> Contender::frozen(Hertz sample_rate, DegPerSec speed) const {
    if (method->frozen == nullptr) return std::nullopt;
    return method->frozen(settings, sample_rate, table.get(), speed);
}

std::optional<GearRatio> Contender::made_for() const {
    if (settings.has("gear-ratio")) return GearRatio(settings.number("gear-ratio"));
    if (settings.has("orders")) return no_ratio;
    if (table != nullptr) return table->spec().gear_ratio;
    return std::nullopt;
}

Contender make_contender(const Spec& spec, std::shared_ptr<const CandidateTable> table) {
    const Method& method = find_method(spec.name);
    return {spec.text(), &method, Settings(fmt::format("method {}", spec.name), spec, method.keys),
            std::move(table)};
}

namespace {

constexpr std::size_t block_rows = 4096;  // chosen, not derived
constexpr double moving_share = 0.05;     // of the fastest |v|: slower is standstill

// One method on its way through a log.
struct Runner {
    std::unique_ptr<CausalFilter> filter;
    std::vector<double> out;
    double error_squares = 0.0;                         ///< against the true torque
    double off_squares = 0.0, largest_start = 0.0;      ///< against the reference
    std::optional<SwitchLedger> ledger = std::nullopt;  ///< ledger of a method that switches
};

void fill_levels(MethodFigures& figures, const RippleLevels& levels, GearRatio ratio, std::size_t signal) {
    if (levels.windows == 0) return;
    for (const OrderLevel& level : levels.orders) {
        const double before = level.amplitude_nm[0], after = level.amplitude_nm[signal];
        OrderAttenuation entry{level.order, level.mean_hz, std::nullopt, ratio};
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

// Feeds a block to every method and to the meter; signal 0 is the log's own torque. `truth_nm` and
// `given_nm`, the output where it is known, may be empty.
void run_block(std::vector<Runner>& runners, RippleMeter& meter, const TraceView& block,
               std::span<const double> truth_nm, std::span<const double> given_nm) {
    for (Runner& runner : runners) {
        runner.out.resize(block.size());
        if (!given_nm.empty())
            std::copy(given_nm.begin(), given_nm.end(), runner.out.begin());
        else
            runner.filter->process({block.velocity_deg_s, block.torque_nm, block.position_deg}, runner.out);
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
        figures.undershoot_percent = step.undershoot_percent;
    }
    if (ramp_nm_s) {
        const RampMeasurement ramp = bench.ramp(*ramp_nm_s);
        figures.ramp_delay_ms = 1e3 * ramp.delay.value();
        figures.ramp_overshoot_nm = ramp.overshoot_nm;
    }
    if (const auto frozen = contender.frozen(sample_rate, speed)) {
        figures.dc_delay_ms = 1e3 * group_delay(frozen->cascade, Hertz(0.0), SampledAt(sample_rate)).value();
        figures.note = frozen->note;
    }
    if (lines != nullptr) {
        for (const Order order : lines->orders) {
            const Hertz at = ripple_frequency(order, lines->ratio, speed);
            figures.attenuation.push_back(
                {order.value(), at.value(), bench.attenuation_db(at), lines->ratio});
        }
    }
    return figures;
}

DegPerSec median_moving_speed(const TraceView& trace) {
    const double slow = moving_share * fastest_of(trace.velocity_deg_s);
    std::vector<double> moving;
    for (const double v : trace.velocity_deg_s) {
        if (std::abs(v) > slow) moving.push_back(std::abs(v));
    }
    return DegPerSec(median_in(moving));
}

std::vector<double> output_on_log(const Contender& contender, const ComparedLog& log) {
    const auto filter = contender.start(log.trace.sample_rate);
    std::vector<double> out(log.trace.size());
    for_each_block(
        log.trace,
        [&](const TraceView& block) {
            filter->process({block.velocity_deg_s, block.torque_nm, block.position_deg},
                            std::span(out).subspan(block.first_row, block.size()));
        },
        [&] { filter->restart(); });
    return out;
}

namespace {

MethodFigures on_bench(const Contender& contender, Hertz sample_rate,
                       const std::optional<BenchSignals>& asked) {
    if (!asked) {
        MethodFigures figures;
        figures.method = contender.text;
        return figures;
    }
    const BenchSignals& signals = *asked;
    try {
        return measure_on_signals(contender, sample_rate, signals.speed, signals.step_nm, signals.ramp_nm_s,
                                  nullptr);
    } catch (const UsageError&) {
        // A filter that does not settle has no such figures; the others still count.
        return measure_on_signals(contender, sample_rate, signals.speed, std::nullopt, std::nullopt, nullptr);
    }
}

// The complex gains of the method's filter, by speed.
LineGains gains_of(const Contender& method, const GearAccount& lines, Hertz sample_rate) {
    return [&method, &lines, sample_rate](double speed, std::span<std::complex<double>> gains) {
        const auto frozen = method.frozen(sample_rate, DegPerSec(speed));
        for (std::size_t i = 0; i < gains.size(); ++i) {
            const Hertz at = ripple_frequency(lines.orders[i], lines.ratio, DegPerSec(speed));
            gains[i] = frozen ? response(frozen->cascade, at, SampledAt(sample_rate)) : 1.0;
        }
    };
}

// Whether what is left of the ripple is predicted along a log: not for methods whose filter at a speed is too
// slow to compute for every window of a log.
bool predictable(const Contender& method) {
    return method.method->frozen != nullptr && !method.method->frozen_is_dear && method.gear;
}

std::size_t longest_unbroken_run(const TraceView& trace) {
    std::size_t longest = 0, from = 0;
    for (const std::size_t start : trace.run_starts) {
        longest = std::max(longest, start - from);
        from = start;
    }
    return std::max(longest, trace.size() - from);
}

// Output minus TorqueReference::smooth_nm(), as the blocks of a log go by.
class ReferenceErrors {
  public:
    ReferenceErrors(const ComparedLog& log, const std::vector<double>& smooth_nm)
        : smooth_nm_(smooth_nm), slow_deg_s_(moving_share * fastest_of(log.trace.velocity_deg_s)) {}

    void add(const TraceView& block, std::vector<Runner>& runners) {
        const double step_s = 1.0 / block.sample_rate.value();
        for (std::size_t k = 0; k < block.size(); ++k) {
            const double smooth = smooth_nm_[block.first_row + k];
            if (std::isnan(smooth)) continue;
            ++rows_;
            const bool starts = moved_s_ < start_seconds;
            if (std::abs(block.velocity_deg_s[k]) > slow_deg_s_) moved_s_ += step_s;
            if (starts) own_start_ = std::max(own_start_, std::abs(block.torque_nm[k] - smooth));
            for (Runner& runner : runners) {
                const double error = runner.out[k] - smooth;
                runner.off_squares += error * error;
                if (starts) runner.largest_start = std::max(runner.largest_start, std::abs(error));
            }
        }
    }
    void fill(MethodFigures& figures, const Runner& runner) const {
        if (rows_ > 0) figures.error_nm = std::sqrt(runner.off_squares / static_cast<double>(rows_));
        if (own_start_ > 0.0) figures.start_ratio = runner.largest_start / own_start_;
    }

  private:
    const std::vector<double>& smooth_nm_;
    double slow_deg_s_, moved_s_ = 0.0, own_start_ = 0.0;
    std::size_t rows_ = 0;
};

}  // namespace

LogLevels measure_on_log(std::span<const Contender> contenders, const ComparedLog& log,
                         const GearAccount* lines, std::vector<RippleEstimate> ripple,
                         const std::optional<BenchSignals>& signals, std::optional<TorqueBand> band) {
    LogLevels result;
    result.ripple = std::move(ripple);
    Progress::current().begin("measuring", "methods", contenders.size());
    for (const Contender& contender : contenders) {
        result.methods.push_back(on_bench(contender, log.trace.sample_rate, signals));
        Progress::current().add(1);
    }
    if (lines == nullptr) return result;
    Progress::current().begin("measuring on the log", "", 0);
    std::vector<Runner> runners;
    for (const Contender& contender : contenders) {
        runners.push_back({contender.start(log.trace.sample_rate), {}});
        if (contender.method->needs_table) runners.back().ledger.emplace(log.truth_nm);
    }
    std::optional<TorqueReference> reference;
    if (longest_unbroken_run(log.trace) >= fewest_spectrum_samples)
        reference.emplace(log, *lines, result.ripple, band);
    if (reference && reference->smooth_nm().empty()) reference.reset();
    std::optional<ReferenceErrors> errors;
    if (reference) errors.emplace(log, reference->smooth_nm());
    LineGains gains;
    if (contenders.size() == 1 && predictable(contenders.front()))
        gains = gains_of(contenders.front(), *lines, log.trace.sample_rate);
    RippleMeter meter(lines->ratio, lines->orders, log.trace.sample_rate, runners.size() + 1, gains);
    std::size_t done = 0;
    for_each_block(
        log.trace,
        [&](const TraceView& block) {
            const auto truth = log.truth_nm.empty() ? log.truth_nm : log.truth_nm.subspan(done, block.size());
            const auto given = log.out_nm.empty() ? log.out_nm : log.out_nm.subspan(done, block.size());
            run_block(runners, meter, block, truth, given);
            if (errors) errors->add(block, runners);
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
    result.lines = meter.levels();
    const RippleLevels& levels = result.lines;
    if (levels.windows > 0) result.raw_ripple_rms_nm = ripple_rms_nm(levels, 0);
    if (reference) result.band = reference->band();
    if (levels.windows == 0) {
        result.why_none = levels.windows_too_few_samples > 0
                              ? "too few samples per motor turn for so many orders"
                              : "the joint nowhere turns four periods of an order in one direction below "
                                "half the sample rate";
    }
    for (std::size_t i = 0; i < contenders.size(); ++i) {
        MethodFigures& figures = result.methods[i];
        fill_levels(figures, levels, lines->ratio, i + 1);
        if (errors) errors->fill(figures, runners[i]);
        if (reference) {
            const Distortion distortion = reference->distortion(contenders[i]);
            figures.moved_nm = distortion.moved_nm;
            figures.added_nm = distortion.added_nm;
        }
        if (runners[i].ledger) {
            figures.switches = runners[i].filter->switch_count();
            figures.largest_jump_nm = largest_jump_nm(*runners[i].filter);
            figures.switch_ledger = runners[i].ledger->entries();
        }
        if (!log.truth_nm.empty()) {
            const auto rows = static_cast<double>(log.truth_nm.size());
            figures.error_rms_nm = std::sqrt(runners[i].error_squares / rows);
        }
    }
    return result;
}

}  // namespace ripplenotch
