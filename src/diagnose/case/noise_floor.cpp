// SPDX-License-Identifier: MIT
#include "diagnose/case/noise_floor.hpp"

#include <algorithm>
#include <cmath>

#include "diagnose/case/lines.hpp"
#include "model/fit/weighing.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/model/prediction.hpp"

namespace ripplenotch {
namespace {

void add_slopes(NoiseColumns& columns, const Case& c, const Model& model, const Model& open) {
    const Coordinates coordinates(open, &model);
    std::vector<double> point;
    for (const Coordinate& coordinate : coordinates.list()) point.push_back(coordinate.start);
    const Prediction prediction(coordinates.at(point), c.motion);
    for (std::size_t i = 0; i < point.size(); ++i) {
        const auto slope = slope_nm(prediction, coordinates, point, i);
        columns.add(slope);
    }
}

struct Autoregression {
    std::vector<double> color;
    double white_nm = 0.0;
};

// Levinson's recursion; the order that the length of the log supports.
Autoregression autoregression_of(const std::vector<double>& covariance, double samples, double lag_price) {
    std::vector<double> a;  // e(k) = sum a[i] e(k-1-i) + white
    double variance = covariance[0];
    double best = samples * portable::log(variance);
    Autoregression chosen{{}, std::sqrt(variance)};
    for (std::size_t p = 1; p < covariance.size(); ++p) {
        double reflection = covariance[p];
        for (std::size_t i = 0; i < a.size(); ++i) reflection -= a[i] * covariance[p - 1 - i];
        reflection /= variance;
        if (std::abs(reflection) >= 0.9999) break;
        std::vector<double> next = a;
        for (std::size_t i = 0; i < a.size(); ++i) next[i] -= reflection * a[a.size() - 1 - i];
        next.push_back(reflection);
        a = next;
        variance *= 1.0 - reflection * reflection;
        const double score = samples * portable::log(variance) + lag_price * static_cast<double>(p);
        if (score < best) {
            best = score;
            chosen = {a, std::sqrt(variance)};
        }
    }
    return chosen;
}

// rms of a stretch of the log that is quieter than most.
double quiet_rms(const std::vector<double>& left, const Case& c, const DiagnosisRules::NoiseRules& rules) {
    const std::size_t length = std::max<std::size_t>(left.size() / rules.quiet_stretches, 50);
    std::vector<double> powers;
    for (std::size_t first = 0; first + length <= left.size(); first += length) {
        double sum = 0.0, count = 0.0;
        for (std::size_t k = first; k < first + length; ++k) {
            if (c.use[k] == 0) continue;
            sum += left[k] * left[k];
            count += 1.0;
        }
        if (count > 0.5 * static_cast<double>(length)) powers.push_back(sum / count);
    }
    if (powers.empty()) return 0.0;
    const auto middle =
        powers.begin() + static_cast<std::ptrdiff_t>(rules.quiet_part * static_cast<double>(powers.size()));
    std::nth_element(powers.begin(), middle, powers.end());
    return std::sqrt(*middle);
}

}  // namespace

double NoiseFloor::of_sums() const {
    double sum = 1.0;
    for (const double a : color) sum -= a;
    const double white_share = white_nm / rms_nm * (white_nm / rms_nm);
    return std::max(1.0, white_share / std::max(sum * sum, 1e-3));
}

namespace {

// Lines that stand out of what is about them are no noise: they become columns, two at a time.
std::vector<double> left_without_lines(NoiseColumns& columns, const Case& c,
                                       const std::vector<double>& torque_nm, const DiagnosisRules& rules) {
    std::vector<double> left = columns.left_of(torque_nm);
    for (std::size_t line = 0; line < rules.noise_floor.most_lines; line += 2) {
        const auto found = standing_out(c, left, rules.noise_floor.stands_out, 2, rules.lines);
        if (found.empty()) break;
        for (const ResidualLine& strong : found) {
            const auto& where = strong.by_angle ? c.motion.position_deg : c.motion.time_s;
            add_wave(columns, NoiseWave(where, strong.frequency));
        }
        left = columns.left_of(torque_nm);
    }
    return left;
}

// At lags 0 to most_lags, over pairs of samples that both count.
std::vector<double> autocovariance(const std::vector<double>& left, const Case& c, std::size_t most_lags) {
    std::vector<double> covariance;
    for (std::size_t lag = 0; lag <= most_lags; ++lag) {
        double sum = 0.0, count = 0.0;
        for (std::size_t k = lag; k < left.size(); ++k) {
            if (c.use[k] == 0 || c.use[k - lag] == 0) continue;
            sum += left[k] * left[k - lag];
            count += 1.0;
        }
        // The taper keeps every power spectrum above 0.
        const double taper = 1.0 - static_cast<double>(lag) / static_cast<double>(left.size());
        covariance.push_back(taper * sum / std::max(count, 1.0));
    }
    return covariance;
}

}  // namespace

namespace {

// `spent`: by how much the columns that were fitted have made the variance smaller.
NoiseFloor modelled(std::vector<double> covariance, double samples, double lag_price, double spent) {
    for (double& value : covariance) value *= spent;
    Autoregression found = autoregression_of(covariance, samples, lag_price);
    NoiseFloor floor{std::sqrt(covariance[0]), found.white_nm, std::move(found.color)};
    floor.covariance_nm2 = std::move(covariance);
    return floor;
}

}  // namespace

NoiseFloor::Thinned NoiseFloor::thinned(std::size_t step, std::size_t most_lags, double samples,
                                        double lag_price) const {
    std::vector<double> covariance;
    for (std::size_t lag = 0; lag < covariance_nm2.size() && covariance.size() <= most_lags; lag += step)
        covariance.push_back(covariance_nm2[lag]);
    if (covariance.empty()) covariance.push_back(rms_nm * rms_nm);
    Autoregression found = autoregression_of(covariance, samples, lag_price);
    double sum = 1.0;
    for (const double a : found.color) sum -= a;
    const double density =
        found.white_nm * found.white_nm * static_cast<double>(step) / std::max(sum * sum, 1e-6);
    return {std::move(found.color), found.white_nm, density};
}

NoiseFloor noise_floor(const Case& looked_at, const Model& model, const Model& open,
                       const DiagnosisRules& rules, NoiseGround& ground) {
    const Case& c = looked_at;
    std::vector<double> torque_nm = c.torque_nm;
    const auto predicted = predict_nm(model, c.motion);
    for (std::size_t k = 0; k < torque_nm.size(); ++k) torque_nm[k] -= predicted[k];
    const StatedRipple ripple = stated_ripple(model);
    NoiseColumns& columns = ground.columns(c, ripple, rules.noise_floor);
    add_slopes(columns, c, model, open);
    for (const Nuisance& nuisance : motion_errors(c, model, rules.recording)) columns.add(nuisance.torque_nm);
    const std::vector<double> left = left_without_lines(columns, c, torque_nm, rules);
    std::vector<double> covariance = autocovariance(left, c, rules.noise_floor.most_lags);
    const double samples = static_cast<double>(c.used());
    const double spent = samples / std::max(samples - static_cast<double>(columns.count()), 0.2 * samples);
    covariance[0] = std::max(covariance[0], 1e-24);
    NoiseFloor floor = modelled(std::move(covariance), samples, rules.noise_floor.lag_price, spent);
    floor.material_nm = floor.rms_nm;
    // What is loud in some stretches only is not noise but something that none of these columns can follow,
    // such as a resonance. Its colour would hide it.
    const double quiet_nm = quiet_rms(left, c, rules.noise_floor);
    if (quiet_nm > 0.0 && quiet_nm < rules.noise_floor.unsteady * floor.rms_nm)
        floor = {quiet_nm, quiet_nm, {}, quiet_nm, {quiet_nm * quiet_nm}};
    return floor;
}

NoiseFloor noise_of_residual(const Case& looked_at, const std::vector<double>& residual_nm,
                             const NoiseFloor& floor, const DiagnosisRules& rules) {
    const double samples = static_cast<double>(looked_at.used());
    const auto lags = static_cast<std::size_t>(
        std::min(rules.residual.memory_s * looked_at.motion.sample_rate.value(), samples / 10.0));
    std::vector<double> covariance = autocovariance(residual_nm, looked_at, lags);
    covariance[0] *= 1.0 + rules.residual.color_floor;
    NoiseFloor noise = modelled(std::move(covariance), samples, rules.noise_floor.lag_price, 1.0);
    noise.material_nm = floor.rms_nm;
    return noise;
}

NoiseFloor noise_floor(const Case& looked_at, const Model& model, const Model& open,
                       const DiagnosisRules& rules) {
    NoiseGround ground;
    return noise_floor(looked_at, model, open, rules, ground);
}

}  // namespace ripplenotch
