// SPDX-License-Identifier: MIT
// Filters of one channel as the tool runs them.
#include <array>
#include <memory>

#include "benchmark.hpp"
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

std::function<Benchmark::Pass()> method(const std::string& text) {
    return [text] {
        const Spec spec = parse_spec(text);
        const Method& found = find_method(spec.name);
        const CandidateTable table = nine_bands();
        auto channel = std::make_shared<Channel>();
        channel->filter =
            found.start(Settings("method", spec, found.keys), rate, found.needs_table ? &table : nullptr);
        return [channel] { channel->pass(); };
    };
}

const Benchmark fixed("filter: fixed notch, one channel", samples, method("fixed,centers=60Hz:120Hz,q=5"));
const Benchmark low_pass("filter: low-pass of order 4", samples, method("lowpass,cutoff=60Hz,order=4"));
const Benchmark switching("filter: switching bank, one channel", samples, method("switching,table=nine"));
const Benchmark warm("filter: switching bank, all nine warm", samples,
                     method("switching,table=nine,transition=parallel"));

}  // namespace
}  // namespace ripplenotch::bench
