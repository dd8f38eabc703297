// SPDX-License-Identifier: MIT
#include "fleet/trend/scan.hpp"

#include <algorithm>
#include <cmath>

#include "fleet/trend/change_test.hpp"
#include "ripplenotch/core/median.hpp"

namespace ripplenotch {
namespace {

constexpr std::size_t fewest_before = 5, fewest_after = 3;  // by hand
constexpr double least_left_of_step = 0.05;                 // of a step, beside conditions and other changes
constexpr std::size_t fewest_torques = 3;                   // by hand
constexpr double hardly_chance = 16.0;  // t squared that chance has in one series of fifty

double squares_of(const std::vector<double>& values) {
    double sum = 0.0;
    for (const double value : values) sum += value * value;
    return sum;
}

}  // namespace

double unit_of(const Series& series, const Regression& regression) {
    std::vector<double> errors = series.error;
    const double usual = median_in(errors);
    return usual > 0.0 ? usual : std::abs(regression.first_value());
}

Scan::Scan(const JointHistory& history, const Series& series, const Regression& regression)
    : Scan(history, series.name, series.rows, unit_of(series, regression), regression) {}

Scan::Scan(const JointHistory& history, std::string name, std::vector<std::size_t> rows, double unit,
           Regression regression)
    : name_(std::move(name)),
      unit_(unit),
      rows_(std::move(rows)),
      place_of_row_(history.lines.size(), rows_.size()),
      regression_(std::move(regression)),
      norm_(rows_.size(), 0.0) {
    for (std::size_t i = 0; i < rows_.size(); ++i) place_of_row_[rows_[i]] = i;
    const std::size_t n = rows_.size();
    const auto& weights = regression_.weights();
    double all = 0.0;
    for (const double weight : weights) all += weight * weight;
    double behind = 0.0;
    for (std::size_t place = n; place-- > fewest_before;) {
        behind += weights[place] * weights[place];
        if (n - place < fewest_after) continue;
        FoundChange step;
        step.row = rows_[place];
        const double left = squares_of(regression_.beside(change_column(history, step, rows_)));
        if (left > least_left_of_step * behind * (all - behind) / all) norm_[place] = left;
    }
    FoundChange drift;
    drift.drift = true;
    slope_ = regression_.beside(change_column(history, drift, rows_));
    slope_norm_ = squares_of(slope_);
    double spread = 0.0, middle = 0.0;
    const auto column = change_column(history, drift, rows_);
    for (const double value : column) middle += value / static_cast<double>(n);
    for (std::size_t i = 0; i < n; ++i)
        spread += (column[i] - middle) * (column[i] - middle) * weights[i] * weights[i];
    if (!(slope_norm_ > least_left_of_step * spread)) slope_norm_ = 0.0;
    const Found found = look(regression_.residual());
    largest_ = found.t_squared;
    drift_ = found.drift;
    row_ = rows_[found.place];
    leave_chance(found);
}

Scan::Found Scan::look(const std::vector<double>& residual) const {
    const std::size_t n = residual.size();
    const auto& weights = regression_.weights();
    const double squares = squares_of(residual);
    double most = 0.0, behind = 0.0, along_slope = 0.0;
    Found found;
    for (std::size_t place = n; place-- > 0;) {
        behind += weights[place] * residual[place];
        along_slope += slope_[place] * residual[place];
        if (norm_[place] > 0.0 && behind * behind > most * norm_[place]) {
            most = behind * behind / norm_[place];
            found.place = place;
        }
    }
    if (slope_norm_ > 0.0 && along_slope * along_slope > most * slope_norm_) {
        most = along_slope * along_slope / slope_norm_;
        found.drift = true;
    }
    const double rest = std::max(squares - most, 1e-12 * squares) + known_.freedom * known_.variance;
    if (rest > 0.0) found.t_squared = most / rest * (regression_.freedom() - 1.0 + known_.freedom);
    return found;
}

void Scan::lean_on(const Scatter& known) {
    known_ = {known.freedom, known.variance * unit_ * unit_};
    largest_ = look(regression_.residual()).t_squared;
}

double Scan::largest_of(const std::vector<std::size_t>& order, std::vector<double>& room) const {
    room.clear();
    for (const std::size_t row : order)
        if (place_of_row_[row] < chance_.size()) room.push_back(chance_[place_of_row_[row]]);
    regression_.project(room);
    return look(room).t_squared;
}

// A change would spoil its own yardstick (Ter Braak, 1992), so it is taken out of what chance makes of this
// series. What chance made itself has to stay, or the yardstick would be too short.
void Scan::leave_chance(const Found& found) {
    std::vector<double> column = slope_;
    const std::size_t n = column.size();
    if (!found.drift) {
        column.assign(n, 0.0);
        for (std::size_t i = found.place; i < n; ++i) column[i] = regression_.weights()[i];
        regression_.project(column);
    }
    chance_ = regression_.residual();
    std::vector<double> left = chance_;
    double along = 0.0;
    for (std::size_t i = 0; i < n; ++i) along += column[i] * left[i];
    const double norm = squares_of(column);
    if (norm > 0.0)
        for (std::size_t i = 0; i < n; ++i) left[i] -= along / norm * column[i];
    double products = 0.0;
    for (std::size_t i = 1; i < n; ++i) products += left[i] * left[i - 1];
    const double squares = squares_of(left);
    memory_ = squares > 0.0 ? products / squares : 0.0;
    const bool change = found.t_squared > hardly_chance;
    if (change) chance_ = std::move(left);
    const double freedom = regression_.freedom() - (change ? 1.0 : 0.0);
    scatter_ = {freedom, squares_of(chance_) / freedom / (unit_ * unit_)};
    // The regression took its share of chance, and takes it of every order once more.
    const double share = std::sqrt(static_cast<double>(n) / freedom);
    for (double& one : chance_) one *= share;
}

std::optional<Scan> Scan::of_sensor_gain(const JointHistory& history, const std::vector<Regression>& known) {
    std::vector<double> sum(history.lines.size(), 0.0);
    double weight = 0.0;
    std::size_t torques = 0;
    for (std::size_t s = 0; s < known.size(); ++s) {
        const Series& series = history.series[s];
        const double base = known[s].first_value();
        if (!series.torque || series.rows.size() != sum.size() || series.name == "sensor_zero_nm") continue;
        const double deviation = known[s].deviation() / std::abs(base);
        if (!(std::abs(base) > 0.0) || !(deviation > 0.0) || !(deviation < 0.5)) continue;
        ++torques;
        weight += 1.0 / (deviation * deviation);
        for (std::size_t i = 0; i < sum.size(); ++i)
            sum[i] += known[s].residual()[i] / known[s].weights()[i] / base / (deviation * deviation);
    }
    if (torques < fewest_torques) return std::nullopt;
    for (double& value : sum) value /= weight;
    const std::vector<double> ones(sum.size(), 1.0);
    std::vector<std::vector<double>> columns = {ones};
    for (const Condition& condition : history.conditions) columns.push_back(condition.value);
    std::vector<std::size_t> rows(sum.size());
    for (std::size_t i = 0; i < rows.size(); ++i) rows[i] = i;
    return Scan(history, "all torques", rows, 1.0, Regression(sum, ones, columns));
}

}  // namespace ripplenotch
