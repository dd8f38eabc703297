// SPDX-License-Identifier: MIT
#include "diagnose/case/noise_floor.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/functions/many_numbers.hpp"
#include "core/matrices/factorisations.hpp"
#include "core/vectors/dot.hpp"
#include "diagnose/case/lines.hpp"
#include "diagnose/limits.hpp"
#include "model/fit/weighing.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/model/prediction.hpp"

namespace ripplenotch {

void NoiseColumns::add(std::vector<double> column) {
    const double squares = dot(column.data(), column.data(), column.size());
    if (!(squares > 0.0) || !std::isfinite(squares)) return;
    const double scale = std::sqrt(static_cast<double>(column.size()) / squares);
    for (std::size_t k = 0; k < column.size(); ++k) column[k] = use_[k] != 0 ? scale * column[k] : 0.0;
    columns_.push_back(std::move(column));
}

void NoiseColumns::cut(std::size_t count) {
    columns_.resize(std::min(count, columns_.size()));
    products_.resize(std::min(count, products_.size()));
}

// Adds the products of the columns that are new since the last call, two by two.
void NoiseColumns::sum_products() {
    const std::size_t begin = products_.size(), end = columns_.size(), rows = use_.size();
    for (std::size_t i = begin; i < end; ++i) products_.emplace_back(i + 1, 0.0);
    for (std::size_t row = 0; row < rows; row += block_rows) {
        const std::size_t count = std::min(block_rows, rows - row);
        for (std::size_t i = begin; i < end; i += 2) {
            const std::size_t next = std::min(i + 1, end - 1);
            const double* const a[2] = {columns_[i].data() + row, columns_[next].data() + row};
            for (std::size_t j = 0; j <= next; j += 2) {
                const std::size_t after = std::min(j + 1, next);
                const double* const b[2] = {columns_[j].data() + row, columns_[after].data() + row};
                double sums[4] = {};
                add_dots(a, b, count, sums);
                if (j <= i) products_[i][j] += sums[0];
                if (j < after && after <= i) products_[i][after] += sums[1];
                if (next == i) continue;
                products_[next][j] += sums[2];
                if (j < after) products_[next][after] += sums[3];
            }
        }
    }
}

std::vector<double> NoiseColumns::left_of(std::span<const double> torque_nm) {
    sum_products();
    const std::size_t rows = use_.size();
    std::vector<double> left(torque_nm.begin(), torque_nm.end());
    for (std::size_t k = 0; k < rows; ++k) left[k] = use_[k] != 0 ? left[k] : 0.0;
    const auto n = static_cast<Eigen::Index>(columns_.size());
    Eigen::MatrixXd gram(n, n);
    Eigen::VectorXd target(n);
    for (std::size_t i = 0; i < columns_.size(); ++i) {
        const auto row = static_cast<Eigen::Index>(i);
        for (std::size_t j = 0; j <= i; ++j) gram(row, static_cast<Eigen::Index>(j)) = products_[i][j];
        gram(row, row) += 1e-7 * static_cast<double>(rows);
        target[row] = dot(columns_[i].data(), left.data(), rows);
    }
    const Eigen::VectorXd theta = SymmetricFactors(gram).solve(target);
    for (std::size_t row = 0; row < rows; row += block_rows) {
        const std::size_t count = std::min(block_rows, rows - row);
        for (std::size_t i = 0; i < columns_.size(); ++i) {
            add_scaled(-theta[static_cast<Eigen::Index>(i)], columns_[i].data() + row, left.data() + row,
                       count);
        }
    }
    return left;
}

NoiseWave::NoiseWave(std::span<const double> where, double cycles)
    : cosine(where.size()), sine(where.size()) {
    std::vector<double> angle(where.size());
    for (std::size_t k = 0; k < angle.size(); ++k) angle[k] = 2.0 * std::numbers::pi * (cycles * where[k]);
    portable::phasors(angle, cosine, sine);
}

void add_wave(NoiseColumns& columns, const NoiseWave& wave) {
    columns.add(wave.cosine);
    columns.add(wave.sine);
}

namespace {

// Cubic B-spline number i, at u in units of the distance of two, from the middle of the second on.
double spline(double u, std::size_t i) {
    const double d = std::abs(u - (static_cast<double>(i) - 1.0));
    if (d >= 2.0) return 0.0;
    return d < 1.0 ? (4.0 - 6.0 * d * d + 3.0 * d * d * d) / 6.0 : (2.0 - d) * (2.0 - d) * (2.0 - d) / 6.0;
}

// `count` cubic B-splines over [low, high] of what place_at(row) is, in rows that counts(row) lets in. At one
// place no more than four are not 0.
template <class Place, class Counts>
void add_splines(NoiseColumns& columns, const Case& c, std::size_t count, double low, double high,
                 const Place& place_at, const Counts& counts) {
    std::vector<std::vector<double>> splines(count, std::vector<double>(c.size(), 0.0));
    for (std::size_t k = 0; k < c.size(); ++k) {
        if (!counts(k)) continue;
        const double part = std::clamp((place_at(k) - low) / std::max(high - low, 1e-12), 0.0, 1.0);
        const double u = part * (static_cast<double>(count) - 3.0);
        const auto first = static_cast<std::size_t>(u);
        for (std::size_t i = first; i < std::min(first + 4, count); ++i) splines[i][k] = spline(u, i);
    }
    for (std::vector<double>& column : splines) columns.add(std::move(column));
}

void add_swelling_wave(NoiseColumns& columns, const NoiseWave& wave, const std::vector<double>& size) {
    columns.add([&](std::size_t k) { return size[k] * wave.cosine[k]; });
    columns.add([&](std::size_t k) { return size[k] * wave.sine[k]; });
}

// tanh of the speed over the width of a step of direction, at every sample.
std::vector<double> unit_direction(const Case& c) {
    const double width_deg_s = limits::noise_floor::step_part * c.moving_deg_s;
    std::vector<double> direction = c.motion.velocity_deg_s;
    for (double& value : direction) value /= width_deg_s;
    portable::many_tanh(direction);
    return direction;
}

// With what ripple may swell.
std::vector<std::vector<double>> swells_of(const Case& c) {
    const Motion& m = c.motion;
    const double middle_s = 0.5 * (m.time_s.front() + m.time_s.back()), half_s = m.time_s.back() - middle_s;
    std::vector<std::vector<double>> swells(8);
    for (std::size_t k = 0; k < c.size(); ++k) {
        const double v = m.velocity_deg_s[k], elapsed = (m.time_s[k] - middle_s) / half_s;
        swells[0].push_back(std::abs(v));
        swells[1].push_back(v);
        swells[2].push_back(v * v);
        swells[4].push_back(std::abs(m.acceleration_deg_s2[k]));
        swells[5].push_back(elapsed);
        swells[6].push_back(elapsed * elapsed);
        swells[7].push_back(m.position_deg[k]);
    }
    swells[3] = unit_direction(c);
    return swells;
}

// Ripple of the model and of its neighbourhood, each swelling with whatever the motion shows.
void add_ripple(NoiseColumns& columns, const Case& c, double ratio, const std::vector<double>& orders) {
    const Motion& m = c.motion;
    const auto wave = [&](double cycles_per_turn) {
        return NoiseWave(m.position_deg, cycles_per_turn / 360.0);
    };
    std::vector<double> all = orders;
    for (double order = 1.0; order <= 6.0; ++order) {
        if (std::find(all.begin(), all.end(), order) == all.end()) all.push_back(order);
    }
    std::vector<NoiseWave> own;
    for (const double order : all) {
        NoiseWave found = wave(order * ratio);
        add_wave(columns, found);
        if (own.size() < orders.size()) own.push_back(std::move(found));
    }
    const auto swells = swells_of(c);
    for (std::size_t i = 0; i < orders.size(); ++i) {
        for (const auto& swell : swells) add_swelling_wave(columns, own[i], swell);
        for (const double side : {-2.0, -1.0, 1.0, 2.0}) add_wave(columns, wave(orders[i] * ratio + side));
    }
}

void add_smooth(NoiseColumns& columns, const Case& c) {
    const Motion& m = c.motion;
    const double width_deg_s = limits::noise_floor::step_part * c.moving_deg_s;
    const auto span = std::minmax_element(m.position_deg.begin(), m.position_deg.end());
    const double low_deg = *span.first, high_deg = *span.second;
    double fastest = 0.0;
    for (const double v : m.velocity_deg_s) fastest = std::max(fastest, std::abs(v));
    for (const double direction : {-1.0, 1.0}) {
        const auto moves = [&](std::size_t k) { return m.velocity_deg_s[k] * direction > width_deg_s; };
        const auto position = [&](std::size_t k) { return m.position_deg[k]; };
        add_splines(columns, c, limits::noise_floor::position_splines, low_deg, high_deg, position, moves);
        // Closer where it is slow: friction changes most there.
        const auto speed = [&](std::size_t k) { return std::sqrt(std::abs(m.velocity_deg_s[k])); };
        add_splines(columns, c, limits::noise_floor::speed_splines, 0.0, std::sqrt(fastest), speed, moves);
    }
    add_splines(
        columns, c, limits::noise_floor::time_splines, m.time_s.front(), m.time_s.back(),
        [&](std::size_t k) { return m.time_s[k]; }, [](std::size_t) { return true; });
    columns.add([&](std::size_t k) { return m.acceleration_deg_s2[k]; });
    columns.add([&](std::size_t k) { return std::abs(m.acceleration_deg_s2[k]); });
    const std::vector<double> direction = unit_direction(c);
    columns.add([&](std::size_t k) { return direction[k]; });
    columns.add([&](std::size_t k) { return std::abs(m.acceleration_deg_s2[k]) * direction[k]; });
}

}  // namespace

NoiseColumns& NoiseGround::columns(const Case& looked_at, const StatedRipple& ripple) {
    if (columns_ && ripple.orders == ripple_.orders && ripple.ratio == ripple_.ratio) {
        columns_->cut(count_);
        return *columns_;
    }
    ripple_ = ripple;
    columns_.emplace(looked_at.use);
    add_ripple(*columns_, looked_at, ripple.ratio.value(), ripple.orders);
    add_smooth(*columns_, looked_at);
    count_ = columns_->count();
    return *columns_;
}

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
double quiet_rms(const std::vector<double>& left, const Case& c) {
    const std::size_t length = std::max<std::size_t>(left.size() / limits::noise_floor::quiet_stretches, 50);
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
    const auto middle = powers.begin() + static_cast<std::ptrdiff_t>(limits::noise_floor::quiet_part *
                                                                     static_cast<double>(powers.size()));
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

// Lines that rise above their surroundings are no noise: they become columns, two at a time.
std::vector<double> left_without_lines(NoiseColumns& columns, const Case& c,
                                       const std::vector<double>& torque_nm) {
    std::vector<double> left = columns.left_of(torque_nm);
    for (std::size_t line = 0; line < limits::noise_floor::most_lines; line += 2) {
        const auto found = standing_out(c, left, limits::noise_floor::stands_out, 2);
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

NoiseFloor noise_floor(const Case& looked_at, const Model& model, const Model& open, NoiseGround& ground) {
    const Case& c = looked_at;
    std::vector<double> torque_nm = c.torque_nm;
    const auto predicted = predict_nm(model, c.motion);
    for (std::size_t k = 0; k < torque_nm.size(); ++k) torque_nm[k] -= predicted[k];
    const StatedRipple ripple = stated_ripple(model);
    NoiseColumns& columns = ground.columns(c, ripple);
    add_slopes(columns, c, model, open);
    for (const Nuisance& nuisance : motion_errors(c, model)) columns.add(nuisance.torque_nm);
    const std::vector<double> left = left_without_lines(columns, c, torque_nm);
    std::vector<double> covariance = autocovariance(left, c, limits::noise_floor::most_lags);
    const double samples = static_cast<double>(c.used());
    const double spent = samples / std::max(samples - static_cast<double>(columns.count()), 0.2 * samples);
    covariance[0] = std::max(covariance[0], 1e-24);
    NoiseFloor floor = modelled(std::move(covariance), samples, limits::noise_floor::lag_price, spent);
    floor.material_nm = floor.rms_nm;
    // A residual that is large in some stretches only is not noise but something that none of these columns
    // can follow, such as a resonance. Its colour would mask it.
    const double quiet_nm = quiet_rms(left, c);
    if (quiet_nm > 0.0 && quiet_nm < limits::noise_floor::unsteady * floor.rms_nm)
        floor = {quiet_nm, quiet_nm, {}, quiet_nm, {quiet_nm * quiet_nm}};
    return floor;
}

NoiseFloor noise_of_residual(const Case& looked_at, const std::vector<double>& residual_nm,
                             const NoiseFloor& floor) {
    const double samples = static_cast<double>(looked_at.used());
    const auto lags = static_cast<std::size_t>(
        std::min(limits::residual::memory_s * looked_at.motion.sample_rate.value(), samples / 10.0));
    std::vector<double> covariance = autocovariance(residual_nm, looked_at, lags);
    covariance[0] *= 1.0 + limits::residual::color_floor;
    NoiseFloor noise = modelled(std::move(covariance), samples, limits::noise_floor::lag_price, 1.0);
    noise.material_nm = floor.rms_nm;
    return noise;
}

NoiseFloor noise_floor(const Case& looked_at, const Model& model, const Model& open) {
    NoiseGround ground;
    return noise_floor(looked_at, model, open, ground);
}

}  // namespace ripplenotch
