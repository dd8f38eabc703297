// SPDX-License-Identifier: MIT
// The ripple of a map, subtracted at the measured angle: no delay, no memory.
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "filter/map/map_runner.hpp"
#include "filter/method.hpp"

namespace ripplenotch {
namespace {

constexpr Key start_key{.name = "start",
                        .dimension = Dimension::angle,
                        .help = "position at the first row of a log without one, which otherwise passes"};

constexpr auto keys = joined_keys(std::array{gear_ratio_key, orders_key}, required_map_keys(),
                                  std::array{angle_key, start_key});

class MapFilter final : public CausalFilter {
  public:
    MapFilter(MapRunner runner, const MotorAngle& angle, const MapReach& reach, bool has_start)
        : runner_(std::move(runner)), angle_(angle), reach_(reach), has_start_(has_start) {}

    void process(const Samples& in, std::span<double> out) override {
        for (std::size_t k = 0; k < out.size(); ++k) {
            angle_.next(in.velocity_deg_s[k], in.position_deg.empty() ? nullptr : &in.position_deg[k]);
            reach_.next(angle_.step_turns());
            runner_.at(in.velocity_deg_s[k], angle_.turns());
            // Without either, the motor's angle is unknown.
            const bool tied = has_start_ || !in.position_deg.empty();
            const double ripple = tied ? runner_.ripple(angle_.turns(), angle_.step_turns()) : 0.0;
            out[k] = in.torque_nm[k] - ripple;
        }
    }
    void restart() override {
        angle_.restart();
        reach_.restart();
    }

  private:
    MapRunner runner_;
    MotorAngle angle_;
    MapReach reach_;
    bool has_start_;
};

RippleMap map_in(const Settings& settings) {
    return *map_of("map", settings, counted_orders("map", settings));  // its cosines are required
}

std::unique_ptr<CausalFilter> start(const Settings& settings, Hertz sample_rate, const CandidateTable*) {
    RippleMap map = map_in(settings);
    const double ratio = map.gear_ratio.value();
    const MotorAngle angle(ratio, sample_rate.value(), angle_source(settings),
                           settings.has("start") ? settings.number("start") : 0.0);
    return std::make_unique<MapFilter>(MapRunner(std::move(map)), angle,
                                       MapReach("map", settings, ratio, sample_rate.value()),
                                       settings.has("start"));
}

FrozenFilter frozen(const Settings& settings, Hertz, const CandidateTable*, DegPerSec) {
    static_cast<void>(map_in(settings));
    return {{}, "subtracts the map; passes all else", true};
}

Trials trials(const TrialConditions& log) {
    if (log.map.empty()) return {};
    return {{{",map=" + log.map}}};
}

double multiplications(const Settings& settings, const CandidateTable*) {
    return map_multiplications(settings);
}

}  // namespace

const Method filter_methods::map = {
    .name = "map",
    .summary = "the ripple of a map, subtracted at the measured angle: no delay, no memory",
    .source = "cogging feed-forward by harmonics of the motor angle, as drives store it",
    .noun = "a ripple map",
    .keys = keys,
    .is_map = true,
    .start = start,
    .frozen = frozen,
    .frozen_is_dear = true,  // and independent of the ripple, which does not change a linear filter
    .trials = trials,
    .multiplications = multiplications,
};

}  // namespace ripplenotch
