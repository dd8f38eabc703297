// SPDX-License-Identifier: MIT
// Filters of one channel as the tool runs them, and their kernels without AVX2.
#include <array>
#include <memory>

#include "benchmark.hpp"
#include "core/vectors/dispatch.hpp"
#include "filter/bank/filter_bank.hpp"
#include "filter/kernels/block_sections.hpp"
#include "ripplenotch/core/spec.hpp"
#include "ripplenotch/filter/method.hpp"

namespace ripplenotch::bench {
namespace {

constexpr std::size_t samples = 1'000'000;
constexpr std::size_t piece = 16384;  // about the rows of a block of the log
const Hertz rate(2000.0);

/// Nine bands of two notches at the orders of BenchLog's ripple.
CandidateTable nine_bands() {
    return CandidateTable::design(
        {.gear_ratio = GearRatio(40.0),
         .orders = {Order(1.0), Order(2.0)},
         .sample_rate = rate,
         .bands = bands_by_spacing({DegPerSec(20.0), DegPerSec(200.0)}, DegPerSec(20.0)),
         .q = 5.0,
         .above = OutsideRule::pass});
}

/// One log through one filter in pieces.
struct Channel {
    BenchLog log{samples};
    std::vector<double> out = std::vector<double>(samples);
    std::unique_ptr<CausalFilter> filter;

    void pass() {
        filter->restart();
        for (std::size_t at = 0; at < samples; at += piece) {
            const std::size_t count = std::min(piece, samples - at);
            filter->process({std::span(log.velocity_deg_s).subspan(at, count),
                             std::span(log.torque_nm).subspan(at, count),
                             {}},
                            std::span(out).subspan(at, count));
        }
        keep(out.back());
    }
};

std::function<Benchmark::Pass()> method(const std::string& text, bool exact = false) {
    return [text, exact] {
        const Spec spec = parse_spec(text);
        const Method& found = find_method(spec.name);
        const CandidateTable table = nine_bands();
        auto channel = std::make_shared<Channel>();
        channel->filter =
            found.start(Settings("method", spec, found.keys), rate, found.needs_table ? &table : nullptr);
        if (!exact) static_cast<void>(channel->filter->hurry());
        return [channel] { channel->pass(); };
    };
}

Cascade two_notches() {
    return {design_notch({.center = Hertz(60.0), .q = 5.0}, rate),
            design_notch({.center = Hertz(120.0), .q = 5.0}, rate)};
}

Benchmark::Pass block_form_in_narrow_vectors() {
    auto log = std::make_shared<BenchLog>(samples);
    auto out = std::make_shared<std::vector<double>>(samples);
    auto filter = std::make_shared<BlockCascade>(two_notches());
    return [log, out, filter] {
        const NarrowVectors here;
        filter->start(log->torque_nm.front());
        filter->run(log->torque_nm, *out);
        keep(out->back());
    };
}

Benchmark::Pass bank() {
    auto log = std::make_shared<BenchLog>(samples);
    const CandidateTable table = nine_bands();
    auto filter = std::make_shared<FilterBank>(Candidates(table.bands()));
    return [log, filter] {
        filter->start(log->torque_nm.front());
        for (std::size_t at = 0; at < samples; at += FilterBank::capacity()) {
            filter->run(
                std::span(log->torque_nm).subspan(at, std::min(FilterBank::capacity(), samples - at)));
            keep(filter->output(8, 0));
        }
    };
}

Benchmark::Pass bank_in_narrow_vectors() {
    return [pass = bank()] {
        const NarrowVectors here;
        pass();
    };
}

const std::string notches = "fixed,centers=60Hz:120Hz,q=5";
const Benchmark fixed("filter: fixed notch, one channel", samples, method(notches));
const Benchmark fixed_exact("filter: fixed notch, --exact", samples, method(notches, true));
const Benchmark low_pass("filter: low-pass of order 4", samples, method("lowpass,cutoff=60Hz,order=4"));
const Benchmark switching("filter: switching bank, one channel", samples,
                          method("switching,table=nine,transition=keep"));
const Benchmark hysteresis("filter: switching bank, hysteresis of 1 deg/s", samples,
                           method("switching,table=nine,transition=keep,hysteresis=1deg/s"));
const Benchmark keep_state("filter: switching bank, keep-state-variable", samples,
                           method("switching,table=nine,transition=keep-state-variable"));
const Benchmark reset("filter: switching bank, reset", samples,
                      method("switching,table=nine,transition=reset"));
const Benchmark warm("filter: switching bank, all nine warm", samples, method("switching,table=nine"));
const Benchmark crossfade("filter: switching bank, crossfade", samples,
                          method("switching,table=nine,transition=crossfade"));
const Benchmark nine("filter: nine candidates in lanes", samples, bank);
const Benchmark nine_portable("filter: nine candidates in lanes, no AVX2", samples, bank_in_narrow_vectors);
const Benchmark block_portable("filter: fixed notch, no AVX2", samples, block_form_in_narrow_vectors);

}  // namespace
}  // namespace ripplenotch::bench
