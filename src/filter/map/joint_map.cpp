// SPDX-License-Identifier: MIT
// The ripple of several motors in the torque of one joint.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <memory>
#include <numbers>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/vectors/dot.hpp"
#include "filter/map/map_runner.hpp"
#include "ripplenotch/analysis/sweeps.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/filter/map_fit.hpp"

namespace ripplenotch {

namespace {

// Chosen, not derived: with two motors of a robot in one torque the explained share stays after the second.
constexpr std::size_t most_rounds = 4;
// Share of the power of one motor's lines that the other motor's angle explains from which on they are not
// told apart: more than half.
constexpr double same_angle_share = 0.5;

/// One motor and what its map predicts in the torque, by log and row.
struct Source {
    GearAccount gear;
    std::vector<TraceView> motion;
    bool is_own = false;
    MapFit fit = {};
    std::vector<std::vector<double>> ripple = {};

    [[nodiscard]] bool mapped() const { return fit.finding == MapFinding::mapped; }
};

void fit_beside(Source& source, std::span<const Source> all, std::span<const TraceView> logs, double zero_deg,
                double pair_false_alarm) {
    std::vector<std::vector<double>> torques;
    std::vector<TraceView> views = source.motion;
    for (std::size_t l = 0; l < logs.size(); ++l) {
        torques.emplace_back(logs[l].torque_nm.begin(), logs[l].torque_nm.end());
        for (const Source& other : all) {
            if (&other == &source || !other.mapped()) continue;
            add_scaled(-1.0, other.ripple[l].data(), torques[l].data(), torques[l].size());
        }
        views[l].torque_nm = torques[l];
    }
    source.fit = source.is_own ? fit_ripple_map(views, source.gear, zero_deg)
                               : fit_ripple_map(views, source.gear, 0.0, pair_false_alarm);
    source.ripple.clear();
    if (!source.mapped()) return;
    for (const TraceView& view : views) source.ripple.push_back(map_along(source.fit.map, view));
}

// Each to the torque less all other maps, until they stay.
void fit_all(std::vector<Source>& sources, std::span<const TraceView> logs, double zero_deg,
             std::size_t pairs) {
    const double pair_false_alarm = map_false_alarm / static_cast<double>(std::max<std::size_t>(pairs, 1));
    std::vector<bool> before;
    for (std::size_t round = 1; round <= most_rounds; ++round) {
        std::vector<bool> mapped;
        bool others = false;
        for (Source& source : sources) {
            fit_beside(source, sources, logs, zero_deg, pair_false_alarm);
            mapped.push_back(source.mapped());
            others = others || (source.mapped() && !source.is_own);
        }
        if (!others || mapped == before) break;
        before = std::move(mapped);
    }
}

/// The share of the power of a line n of one motor that a line m of the other explains along the logs: the
/// squared mean of exp(i (n a - m b)), a and b being their angles, while the first one turns.
double shared_power(const Source& one, double n, const Source& other, double m) {
    std::complex<double> sum;
    double rows = 0.0;
    for (std::size_t l = 0; l < one.motion.size(); ++l) {
        const TraceView &a = one.motion[l], &b = other.motion[l];
        for (std::size_t k = 1; k < a.size(); ++k) {
            const double weight = std::abs(a.position_deg[k] - a.position_deg[k - 1]);
            const double cycles = (n * a.position_deg[k] - m * b.position_deg[k]) / 360.0;
            sum += weight * portable::phasor(2.0 * std::numbers::pi * (cycles - std::floor(cycles)));
            rows += weight;
        }
    }
    return rows > 0.0 ? std::norm(sum / rows) : 0.0;
}

// On both combs of either.
bool same_angle(const Source& one, const Source& other) {
    for (const Order order : one.fit.map.orders) {
        for (const Order against : other.gear.orders) {
            for (const int comb : {0, 1}) {
                const double n = order.value() * (one.gear.ratio.value() + comb);
                for (const int other_comb : {-1, 0, 1}) {
                    const double m = against.value() * (other.gear.ratio.value() + other_comb);
                    if (shared_power(one, n, other, m) > same_angle_share ||
                        shared_power(one, n, other, -m) > same_angle_share)
                        return true;
                }
            }
        }
    }
    return false;
}

/// Whether the angle of a mapped motor follows from the position of the joint that the torque is of: then its
/// lines may be of that joint's own motor, whose gear is not known.
bool follows_own(const Source& one, std::span<const TraceView> own) {
    double products = 0.0, squares = 0.0;
    for (std::size_t l = 0; l < own.size(); ++l) {
        for (std::size_t k = 1; k < own[l].size(); ++k) {
            const double step = own[l].position_deg[k] - own[l].position_deg[k - 1];
            products += step * (one.motion[l].position_deg[k] - one.motion[l].position_deg[k - 1]);
            squares += step * step;
        }
    }
    if (!(squares > 0.0)) return false;
    const Source joint{{}, {own.begin(), own.end()}};
    const double slope = products / squares, ratio = one.fit.map.gear_ratio.value();
    return std::any_of(one.fit.map.orders.begin(), one.fit.map.orders.end(), [&](Order order) {
        const double n = order.value() * ratio;
        return shared_power(one, n, joint, n * slope) > same_angle_share;
    });
}

bool have_positions(std::span<const TraceView> logs) {
    return std::all_of(logs.begin(), logs.end(), [](const TraceView& log) { return log.has_position(); });
}

void doubt(MapFit& fit, const std::string& other) {
    fit.doubt = fmt::format(
        "Cannot tell the ripple of the motor of {} from that of {}: in this log one of their angles follows "
        "from the other.",
        fit.map.joint, other);
    fit.conclusive = false;
}

class MapPrediction final : public CausalFilter {
  public:
    MapPrediction(const RippleMap& map, Hertz sample_rate)
        : runner_(with_zero(map, 0.0)),
          angle_(map.gear_ratio.value(), sample_rate.value(), MotorAngle::Source::best, 0.0) {}
    void restart() override { angle_.restart(); }
    void process(const Samples& in, std::span<double> out) override {
        for (std::size_t k = 0; k < out.size(); ++k) {
            angle_.next(in.velocity_deg_s[k], in.position_deg.empty() ? nullptr : &in.position_deg[k]);
            runner_.at(in.velocity_deg_s[k], angle_.turns());
            out[k] = runner_.ripple(angle_.turns(), angle_.step_turns());
        }
    }

  private:
    MapRunner runner_;
    MotorAngle angle_;
};

}  // namespace

std::unique_ptr<CausalFilter> map_prediction(const RippleMap& map, Hertz sample_rate) {
    return std::make_unique<MapPrediction>(map, sample_rate);
}

std::vector<double> map_along(const RippleMap& map, const TraceView& log) {
    MapPrediction prediction(map, log.sample_rate);
    std::vector<double> ripple(log.size());
    for (const SampleRun& rows : whole_runs(log.size(), log.run_starts)) {
        const TraceView run = log.part(rows.first, rows.size());
        prediction.restart();
        prediction.process({run.velocity_deg_s, run.torque_nm, run.position_deg},
                           std::span(ripple).subspan(rows.first, rows.size()));
    }
    return ripple;
}

MapFit fit_joint_map(std::span<const TraceView> logs, const GearAccount* own,
                     std::span<const OtherMotor> others, std::size_t pairs, double zero_deg) {
    if (others.empty() && own != nullptr) return fit_ripple_map(logs, *own, zero_deg);
    std::vector<Source> all;
    if (own != nullptr) all.push_back({*own, {logs.begin(), logs.end()}, true});
    for (const OtherMotor& other : others) {
        for (std::size_t l = 0; l < logs.size(); ++l)
            if (other.motion.size() != logs.size() || other.motion[l].size() != logs[l].size())
                raise<DataError>("joint {}: its rows are not those of the torque", other.joint);
        all.push_back({other.gear, other.motion});
    }
    fit_all(all, logs, zero_deg, pairs);
    const std::size_t first = own != nullptr ? 1 : 0;
    for (std::size_t j = first; j < all.size(); ++j) all[j].fit.map.joint = others[j - first].joint;
    for (std::size_t j = first; j < all.size(); ++j) {
        Source& one = all[j];
        if (!one.mapped()) continue;
        for (std::size_t i = 0; i < all.size(); ++i)
            if (i != j && have_positions(all[i].motion) && same_angle(one, all[i]))
                doubt(one.fit, all[i].is_own ? "the joint itself" : all[i].fit.map.joint);
        if (own == nullptr && have_positions(logs) && follows_own(one, logs))
            doubt(one.fit, "the joint itself, whose gear ratio is not known");
    }
    MapFit fit = own != nullptr ? std::move(all.front().fit) : MapFit{};
    for (std::size_t j = first; j < all.size(); ++j) {
        if (all[j].mapped() && all[j].fit.doubt.empty()) fit.map.others.push_back(all[j].fit.map);
        fit.others.push_back(std::move(all[j].fit));
    }
    return fit;
}

std::vector<std::vector<double>> without_other_motors(std::span<const TraceView> logs, const RippleMap& map,
                                                      std::span<const OtherMotor> others) {
    std::vector<std::vector<double>> torques;
    for (const TraceView& log : logs) torques.emplace_back(log.torque_nm.begin(), log.torque_nm.end());
    for (const RippleMap& other : map.others) {
        const auto motor = std::find_if(others.begin(), others.end(),
                                        [&](const OtherMotor& one) { return one.joint == other.joint; });
        for (std::size_t l = 0; motor != others.end() && l < logs.size(); ++l) {
            const std::vector<double> ripple = map_along(other, motor->motion[l]);
            for (std::size_t k = 0; k < ripple.size(); ++k) torques[l][k] -= ripple[k];
        }
    }
    return torques;
}

}  // namespace ripplenotch
