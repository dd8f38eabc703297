// SPDX-License-Identifier: MIT
#include "diagnose/setup/setup.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/matrices/factorisations.hpp"
#include "diagnose/setup/hypotheses.hpp"
#include "diagnose/setup/lag.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/diagnose/setup.hpp"

namespace ripplenotch {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Columns may be combinations of each other (a joint that moves one way only): a pull towards 0 of a
// billionth of a column's own squares.
VectorXd solve_squares(const MatrixXd& products, const VectorXd& side) {
    VectorXd scale = products.diagonal();
    for (double& each : scale) each = each > 0.0 ? 1.0 / std::sqrt(each) : 0.0;
    MatrixXd scaled = scale.asDiagonal() * products * scale.asDiagonal();
    for (Index k = 0; k < scaled.rows(); ++k) scaled(k, k) += scale[k] > 0.0 ? 1e-9 : 1.0;
    return scale.cwiseProduct(SymmetricFactors(scaled).solve(VectorXd(scale.cwiseProduct(side))));
}

}  // namespace

double BlockedSquares::Sums::left(const VectorXd& values) const {
    return std::max(squares - 2.0 * values.dot(side) + values.dot(products * values), 0.0);
}

BlockedSquares::BlockedSquares(const std::vector<std::vector<double>>& columns,
                               std::span<const double> target, std::span<const std::size_t> block) {
    const auto count = static_cast<Index>(columns.size());
    const std::size_t blocks = block.empty() ? 0 : *std::max_element(block.begin(), block.end()) + 1;
    sums_.assign(blocks, {MatrixXd::Zero(count, count), VectorXd::Zero(count), 0.0});
    VectorXd row(count);
    for (std::size_t k = 0; k < target.size(); ++k) {
        for (Index c = 0; c < count; ++c) row[c] = columns[static_cast<std::size_t>(c)][k];
        Sums& sums = sums_[block[k]];
        sums.products += row * row.transpose();
        sums.side += target[k] * row;
        sums.squares += target[k] * target[k];
    }
    Sums all{MatrixXd::Zero(count, count), VectorXd::Zero(count), 0.0};
    for (const Sums& sums : sums_) {
        all.products += sums.products;
        all.side += sums.side;
    }
    values_ = solve_squares(all.products, all.side);
    for (const Sums& sums : sums_)
        without_.push_back(solve_squares(all.products - sums.products, all.side - sums.side));
}

double BlockedSquares::jackknife_error(std::size_t value) const {
    const auto at = static_cast<Index>(value);
    const auto count = static_cast<double>(without_.size());
    double mean = 0.0, squares = 0.0;
    for (const VectorXd& values : without_) mean += values[at] / count;
    for (const VectorXd& values : without_) squares += (values[at] - mean) * (values[at] - mean);
    return std::sqrt(squares * (count - 1.0) / count);
}

std::vector<double> BlockedSquares::held_out() const {
    std::vector<double> squares;
    for (std::size_t b = 0; b < sums_.size(); ++b) squares.push_back(sums_[b].left(without_[b]));
    return squares;
}

std::vector<double> BlockedSquares::left() const {
    std::vector<double> squares;
    for (const Sums& sums : sums_) squares.push_back(sums.left(values_));
    return squares;
}

std::vector<std::size_t> equal_blocks(std::span<const double> weight, std::size_t blocks) {
    const double all = std::accumulate(weight.begin(), weight.end(), 0.0);
    std::vector<std::size_t> numbers;
    double before = 0.0;
    for (const double each : weight) {
        const double share = all > 0.0 ? before / all : 0.0;
        numbers.push_back(
            std::min(static_cast<std::size_t>(share * static_cast<double>(blocks)), blocks - 1));
        before += each;
    }
    return numbers;
}

namespace {

// A column of the log over the window.
std::vector<double> smoothed_column(std::span<const double> time_s, std::span<const double> values,
                                    const NuisanceColumns::Window& window) {
    const SmoothedSeries series(time_s, values, window.smoothing_s);
    std::vector<double> column;
    for (const double at_s : window.at_s) column.push_back(series.mean(at_s));
    return column;
}

// The position of the log, or else the integral of its velocity.
std::vector<double> angle_of(const TraceView& log) {
    if (log.has_position()) return {log.position_deg.begin(), log.position_deg.end()};
    std::vector<double> angle_deg(log.velocity_deg_s.size());
    for (std::size_t k = 1; k < angle_deg.size(); ++k)
        angle_deg[k] = angle_deg[k - 1] + 0.5 * (log.time_s[k] - log.time_s[k - 1]) *
                                              (log.velocity_deg_s[k - 1] + log.velocity_deg_s[k]);
    return angle_deg;
}

// The state of Dahl's friction along a position: it turns from -1 to 1 within about the width.
std::vector<double> dahl_state(std::span<const double> angle_deg, double width_deg) {
    std::vector<double> state(angle_deg.size());
    for (std::size_t k = 1; k < state.size(); ++k) {
        const double way = (angle_deg[k] - angle_deg[k - 1]) / width_deg;
        const double end = way > 0.0 ? 1.0 : -1.0;
        state[k] = end + (state[k - 1] - end) * portable::exp(-std::abs(way));
    }
    return state;
}

}  // namespace

NuisanceColumns::NuisanceColumns(const TraceView& log, std::optional<GearRatio> gear_ratio,
                                 const AlignmentOptions& options, const Window& window)
    : rows_(window.at_s.size()) {
    const auto smoothed = [&](std::span<const double> values) {
        return smoothed_column(log.time_s, values, window);
    };
    const std::span<const double> velocity = log.velocity_deg_s;
    if (log.has_position()) {
        std::vector<double> cosine(log.size()), sine(log.size());
        portable::cos_degrees(log.position_deg, cosine);
        portable::sin_degrees(log.position_deg, sine);
        gravity_ = {smoothed(cosine), smoothed(sine)};
    }
    if (velocity.empty()) return;
    std::vector<double> side(velocity.size());
    for (const double width_deg_s : {options.slow_width_deg_s, options.fast_width_deg_s}) {
        for (std::size_t k = 0; k < side.size(); ++k) side[k] = portable::tanh(velocity[k] / width_deg_s);
        friction_.push_back(smoothed(side));
    }
    friction_.push_back(smoothed(velocity));
    const SmoothedSeries speed(log.time_s, velocity, window.smoothing_s);
    inertia_.emplace_back();
    for (const double at_s : window.at_s) inertia_.back().push_back(speed.slope(at_s));
    const std::vector<double> angle_deg = angle_of(log);
    for (std::size_t k = 0; k < side.size(); ++k)
        side[k] = std::abs(log.torque_nm[k]) * portable::tanh(velocity[k] / options.slow_width_deg_s);
    load_ = {smoothed(side), smoothed(dahl_state(angle_deg, options.hysteresis_width_deg))};
    if (!gear_ratio) return;
    std::vector<double> wave(angle_deg.size()), swelling(angle_deg.size());
    for (const double order : {1.0, 2.0}) {
        for (const double quarter_deg : {0.0, 90.0}) {
            for (std::size_t k = 0; k < wave.size(); ++k) {
                wave[k] = portable::cos_degrees(order * gear_ratio->value() * angle_deg[k] - quarter_deg);
                swelling[k] = wave[k] * std::abs(velocity[k]);
            }
            ripple_.push_back(smoothed(wave));
            ripple_.push_back(smoothed(swelling));
        }
    }
}

std::vector<std::vector<double>> NuisanceColumns::of(const NuisanceChoice& choice) const {
    std::vector<std::vector<double>> columns{std::vector<double>(rows_, 1.0)};
    const auto add = [&](bool chosen, const std::vector<std::vector<double>>& more) {
        if (chosen) columns.insert(columns.end(), more.begin(), more.end());
    };
    add(choice.friction, friction_);
    add(choice.inertia, inertia_);
    add(choice.gravity, gravity_);
    add(choice.ripple, ripple_);
    add(choice.load, load_);
    return columns;
}

std::optional<MistakenFactor> nearest_factor(double scale, const std::vector<MistakenFactor>& factors,
                                             double tolerance) {
    if (scale == 0.0 || !std::isfinite(scale)) return {};
    const auto distance = [scale](double factor) {
        return scale * factor > 0.0 ? std::abs(portable::log(scale / factor))
                                    : std::numeric_limits<double>::infinity();
    };
    std::optional<MistakenFactor> nearest;
    double least = std::min(distance(1.0), portable::log(tolerance));
    for (const MistakenFactor& one : factors) {
        if (distance(one.factor) >= least) continue;
        least = distance(one.factor);
        nearest = one;
    }
    return nearest;
}

void add_evidence(const BlockEvidence& evidence, SetupFault& fault) {
    const auto sum = [](const std::vector<double>& squares) {
        return std::accumulate(squares.begin(), squares.end(), 0.0);
    };
    const double total = sum(evidence.total);
    fault.explained_before = total > 0.0 ? 1.0 - sum(evidence.before) / total : 0.0;
    fault.explained_after = total > 0.0 ? 1.0 - sum(evidence.after) / total : 0.0;
    fault.blocks = evidence.before.size();
    for (std::size_t b = 0; b < evidence.before.size(); ++b)
        if (evidence.after[b] < evidence.before[b]) ++fault.blocks_improved;
}

bool is_clear(const BlockEvidence& evidence, const SetupLimits& limits) {
    SetupFault fault;
    add_evidence(evidence, fault);
    return 1.0 - fault.explained_before >= limits.least_ratio * (1.0 - fault.explained_after) &&
           fault.explained_after >= limits.least_explained &&
           static_cast<double>(fault.blocks_improved) >=
               limits.least_blocks * static_cast<double>(fault.blocks);
}

std::string joint_text(const std::string& name) { return name.empty() ? "this joint" : "joint " + name; }

const SimulationLag* SetupAnswer::lag() const {
    if (motion_lag && motion_lag->identifiable) return &*motion_lag;
    if (torque_lag && torque_lag->identifiable) return &*torque_lag;
    return nullptr;
}

SetupAnswer suspect_setup(const TraceView& log, const SimulatedMotion& simulation,
                          const SetupContext& context) {
    SetupAnswer answer;
    const bool has_motion = simulation.has_motion() && (log.has_position() || !log.velocity_deg_s.empty());
    if (has_motion) answer.motion_lag = lag_by_motion(log, simulation, context.alignment);
    if (!simulation.torque_nm.empty() && log.size() > 0)
        answer.torque_lag = lag_by_torque(log, simulation, context.gear_ratio, context.alignment);
    if (has_motion) {
        answer.faults = motion_faults(log, simulation, *answer.motion_lag, context);
        const bool void_otherwise =
            std::any_of(answer.faults.begin(), answer.faults.end(), [](const SetupFault& fault) {
                return fault.kind == SetupFaultKind::wrong_joint ||
                       fault.kind == SetupFaultKind::other_motion;
            });
        if (void_otherwise) return answer;
    }
    if (!answer.torque_lag) return answer;
    const bool is_same_motion =
        has_motion && std::abs(answer.motion_lag->correlation) >= context.limits.least_correlation;
    SimulationLag lag = *answer.torque_lag;
    if (answer.motion_lag && answer.motion_lag->identifiable) lag = *answer.motion_lag;
    lag.explained = answer.torque_lag->explained;
    if (!lag.identifiable) lag.delay_s = 0.0;
    const auto more = torque_faults(log, simulation, lag, context, is_same_motion);
    answer.faults.insert(answer.faults.end(), more.begin(), more.end());
    return answer;
}

}  // namespace ripplenotch
