// SPDX-License-Identifier: MIT
#include "diagnose/case/noise_floor.hpp"

#include <algorithm>
#include <cmath>

#include "diagnose/case/lines.hpp"
#include "model/fit/fit_coordinates.hpp"
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

// Levinson's recursion; the order that the length of the log supports.
void color_of(const std::vector<double>& covariance, double samples, double lag_price, NoiseFloor& floor) {
    std::vector<double> a;  // e(k) = sum a[i] e(k-1-i) + white
    double variance = covariance[0];
    double best = samples * portable::log(variance);
    floor.color.clear();
    floor.white_nm = std::sqrt(variance);
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
            floor.color = a;
            floor.white_nm = std::sqrt(variance);
        }
    }
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
        covariance.push_back(sum / std::max(count, 1.0));
    }
    return covariance;
}

}  // namespace

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
    NoiseFloor floor;
    color_of(covariance, samples, rules.noise_floor.lag_price, floor);
    floor.rms_nm = std::sqrt(covariance[0] * spent);
    floor.white_nm *= std::sqrt(spent);
    // What is loud in some stretches only is not noise but something that none of these columns can follow,
    // such as a resonance. Its colour would hide it.
    const double quiet_nm = quiet_rms(left, c, rules.noise_floor);
    if (quiet_nm > 0.0 && quiet_nm < rules.noise_floor.unsteady * floor.rms_nm)
        floor = {quiet_nm, quiet_nm, {}};
    return floor;
}

NoiseFloor noise_floor(const Case& looked_at, const Model& model, const Model& open,
                       const DiagnosisRules& rules) {
    NoiseGround ground;
    return noise_floor(looked_at, model, open, rules, ground);
}

}  // namespace ripplenotch
