// SPDX-License-Identifier: MIT
#include "fleet/trend/change_test.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "core/matrices/least_squares.hpp"
#include "fleet/trend/joint_history.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {

namespace {

constexpr double least_left = 0.05;  // share of a column's squares outside the others

double dot_product(const std::vector<double>& a, const std::vector<double>& b) {
    double sum = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
    return sum;
}

}  // namespace

Regression::Regression(std::span<const double> value, std::span<const double> weights,
                       const std::vector<std::vector<double>>& columns)
    : weights_(weights.begin(), weights.end()) {
    std::vector<std::vector<double>> kept;
    for (const auto& column : columns) {
        std::vector<double> weighed(column);
        for (std::size_t i = 0; i < weighed.size(); ++i) weighed[i] *= weights_[i];
        const double before = dot_product(weighed, weighed);
        std::vector<double> left = weighed;
        project(left);
        project(left);  // once more, for what rounding left
        const double size = std::sqrt(dot_product(left, left));
        if (!(size * size > 1e-6 * before)) continue;
        for (double& number : left) number /= size;
        basis_.push_back(std::move(left));
        kept.push_back(std::move(weighed));
    }
    residual_.assign(value.begin(), value.end());
    for (std::size_t i = 0; i < residual_.size(); ++i) residual_[i] *= weights_[i];
    if (!kept.empty()) {
        const std::vector<double> values = least_squares(kept, residual_);
        first_value_ = values.front();
    }
    project(residual_);
    project(residual_);
}

void Regression::project(std::vector<double>& weighed) const {
    for (const auto& axis : basis_) {
        const double along = dot_product(axis, weighed);
        for (std::size_t i = 0; i < weighed.size(); ++i) weighed[i] -= along * axis[i];
    }
}

double Regression::freedom() const {
    return static_cast<double>(residual_.size()) - static_cast<double>(basis_.size());
}

double Regression::deviation() const {
    return std::sqrt(dot_product(residual_, residual_) / std::max(freedom(), 1.0));
}

std::vector<double> Regression::beside(std::span<const double> column) const {
    std::vector<double> left(column.begin(), column.end());
    for (std::size_t i = 0; i < left.size(); ++i) left[i] *= weights_[i];
    project(left);
    return left;
}

std::optional<Extra> Regression::extra(std::span<const double> column) const {
    double whole = 0.0, mean = 0.0;
    for (const double number : column) mean += number / static_cast<double>(column.size());
    for (std::size_t i = 0; i < column.size(); ++i)
        whole += (column[i] - mean) * (column[i] - mean) * weights_[i] * weights_[i];
    const std::vector<double> left = beside(column);
    const double squares = dot_product(left, left);
    if (!(squares > least_left * whole) || !(freedom() > 1.5)) return std::nullopt;
    const double along = dot_product(left, residual_), rss = dot_product(residual_, residual_);
    const double rest = std::max(rss - along * along / squares, 1e-12 * rss);
    Extra found;
    found.size = along / squares;
    found.error = std::sqrt(rest / (freedom() - 1.0) / squares);
    found.t_squared = rest > 0.0 ? along * along / squares / (rest / (freedom() - 1.0)) : 0.0;
    return found;
}

namespace {

class Scan {
  public:
    Scan(const JointHistory& history, const Series& series, const Regression& regression);
    /// All torques together, each by its relative residual: a change of the sensor's gain affects all at
    /// once, each of them below its own limit. Empty where fewer than three torques are present in every
    /// line.
    [[nodiscard]] static std::optional<Scan> of_sensor_gain(const JointHistory& history,
                                                            const std::vector<Regression>& known);

    [[nodiscard]] const std::string& name() const { return name_; }
    [[nodiscard]] double unit() const { return unit_; }  ///< unit_of(), 1 of all torques together
    [[nodiscard]] const Scatter& scatter() const { return scatter_; }  ///< scatter of its own lines
    /// From here on a statistic is compared with its own scatter and this one together.
    void lean_on(const Scatter& known);

    [[nodiscard]] double largest() const { return largest_; }  ///< t squared, in the order of time
    [[nodiscard]] bool is_drift() const { return drift_; }
    /// Index among the joint's lines: first after the step.
    [[nodiscard]] std::size_t row() const { return row_; }
    /// Autocorrelation from row to row, without the best change.
    [[nodiscard]] double memory() const { return memory_; }
    /// The same for a permutation of the series, in another order of the joint's rows.
    [[nodiscard]] double largest_of(const std::vector<std::size_t>& order, std::vector<double>& room) const;

  private:
    struct Found {
        double t_squared = 0.0;
        bool drift = false;
        std::size_t place = 0;
    };
    Scan(const JointHistory& history, std::string name, std::vector<std::size_t> rows, double unit,
         Regression regression);
    [[nodiscard]] Found look(const std::vector<double>& residual) const;
    void leave_chance(const Found& found);

    std::string name_;
    double unit_ = 0.0;
    Scatter scatter_;
    Scatter known_;  ///< scatter of other joints, in the series' unit
    std::vector<std::size_t> rows_;
    std::vector<std::size_t> place_of_row_;  ///< in rows_; rows without the series have rows_.size()
    Regression regression_;
    /// Squares of the remainder of a step before each position; 0: it is not tested.
    std::vector<double> norm_;
    std::vector<double> chance_;  ///< weighted residual without the best change, if it is one
    std::vector<double> slope_;
    double slope_norm_ = 0.0, largest_ = 0.0, memory_ = 0.0;
    bool drift_ = false;
    std::size_t row_ = 0;
};

constexpr std::size_t fewest_before = 5, fewest_after = 3;  // chosen, not derived
constexpr double least_left_of_step = 0.05;  // share of a step outside conditions and other changes
constexpr std::size_t fewest_torques = 3;    // chosen, not derived
constexpr double hardly_chance = 16.0;       // t squared that chance has in one series of fifty

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

namespace {

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

// A change would bias its own null distribution (Ter Braak, 1992), so it is removed from the residuals that
// are permuted. Random variation has to stay, or the null distribution would be too narrow.
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

constexpr std::size_t enough_exceed = 10;  // orders that show as much, after which p is known well enough
constexpr double hardly_worse = 3.84;      // fall of twice the log-likelihood, 95 % of one degree of freedom
constexpr double takes_part = 4.0;         // t squared
constexpr double least_error = 0.7;        // share of the usual error of a line

using RowOrder = std::vector<std::size_t>;

// Blocks of rows that stand together stay together; where they are cut is chance.
RowOrder shuffled(std::size_t rows, std::size_t block, std::mt19937_64& engine) {
    const std::size_t offset = block > 1 ? engine() % block : 0;
    std::vector<std::size_t> starts;
    for (std::size_t at = 0; at < rows; at = at == 0 && offset > 0 ? offset : at + block)
        starts.push_back(at);
    std::vector<std::size_t> blocks(starts.size());
    std::iota(blocks.begin(), blocks.end(), std::size_t{0});
    for (std::size_t i = blocks.size(); i > 1; --i) std::swap(blocks[i - 1], blocks[engine() % i]);
    RowOrder order;
    order.reserve(rows);
    for (const std::size_t b : blocks) {
        const std::size_t end = b + 1 < starts.size() ? starts[b + 1] : rows;
        for (std::size_t row = starts[b]; row < end; ++row) order.push_back(row);
    }
    return order;
}

// Carlstein's length for an autoregression of first order: residuals that remember need longer blocks.
std::size_t block_length(const std::vector<Scan>& scans, std::size_t rows) {
    double sum = 0.0;
    for (const Scan& scan : scans) sum += scan.memory();
    const double memory = scans.empty() ? 0.0 : sum / static_cast<double>(scans.size());
    const double noise =
        2.0 / std::sqrt(static_cast<double>(rows) * std::max(1.0, 0.5 * static_cast<double>(scans.size())));
    if (memory < noise) return 1;
    const double r = std::min(memory, 0.9);
    const double length =
        portable::pow(2.0 * r / (1.0 - r * r), 2.0 / 3.0) * portable::cbrt(static_cast<double>(rows));
    return std::clamp<std::size_t>(static_cast<std::size_t>(length + 0.5), 1,
                                   std::max<std::size_t>(rows / 6, 1));
}

double largest(const std::vector<Scan>& scans, const RowOrder& order, std::vector<double>& room) {
    double most = 0.0;
    for (const Scan& scan : scans) most = std::max(most, scan.largest_of(order, room));
    return most;
}

// Chance of a statistic as large, from as many orders as it takes (Besag and Clifford, 1991).
double chance_of(const std::vector<Scan>& scans, double seen, std::size_t rows, std::size_t block,
                 double limit, std::uint64_t seed) {
    const auto most = static_cast<std::size_t>(std::ceil(static_cast<double>(enough_exceed) / limit));
    std::mt19937_64 engine(seed);
    std::vector<double> room;
    std::size_t exceed = 0;
    for (std::size_t tried = 1; tried <= most; ++tried) {
        if (largest(scans, shuffled(rows, block, engine), room) >= seen) ++exceed;
        if (exceed >= enough_exceed) return static_cast<double>(exceed) / static_cast<double>(tried);
    }
    return (static_cast<double>(exceed) + 1.0) / (static_cast<double>(most) + 1.0);
}

// Twice the log-likelihood that a step at each row gains, of all series that take part.
std::vector<double> gains_by_row(const JointHistory& history, const std::vector<Regression>& known,
                                 std::size_t row) {
    std::vector<double> gains(history.lines.size(), -1.0);
    for (std::size_t at = 0; at < gains.size(); ++at) {
        for (std::size_t s = 0; s < known.size(); ++s) {
            const auto& rows = history.series[s].rows;
            const auto here = known[s].extra(change_column(history, {false, row, row, row}, rows));
            if (!here || here->t_squared < takes_part) continue;
            const auto there = known[s].extra(change_column(history, {false, at, at, at}, rows));
            if (!there) continue;
            const auto n = static_cast<double>(rows.size());
            gains[at] = std::max(gains[at], 0.0) +
                        n * portable::log1p(there->t_squared / std::max(known[s].freedom() - 1.0, 1.0));
        }
    }
    return gains;
}

void settle_row(const JointHistory& history, const std::vector<Regression>& known, FoundChange& found) {
    const std::vector<double> gains = gains_by_row(history, known, found.row);
    const auto best = std::max_element(gains.begin(), gains.end());
    found.earliest = found.latest = found.row;
    if (!(*best > 0.0)) return;
    found.earliest = found.latest = found.row = static_cast<std::size_t>(best - gains.begin());
    for (std::size_t row = 0; row < gains.size(); ++row) {
        if (gains[row] < *best - hardly_worse) continue;
        found.earliest = std::min(found.earliest, row);
        found.latest = std::max(found.latest, row);
    }
}

// Scatter of lines in addition to their stated errors, as a variance (DerSimonian and Laird, 1986).
double variance_beside(const Series& series, const std::vector<double>& errors,
                       const std::vector<std::vector<double>>& columns) {
    std::vector<double> weights;
    double sum = 0.0, squares = 0.0, seen = 0.0;
    for (const double error : errors) {
        weights.push_back(1.0 / error);
        sum += 1.0 / (error * error);
        squares += 1.0 / (error * error * error * error);
    }
    const Regression stated(series.value, weights, columns);
    for (const double left : stated.residual()) seen += left * left;
    const double room = sum - squares / sum;
    return room > 0.0 ? std::max(0.0, (seen - stated.freedom()) / room) : 0.0;
}

// Weights from the stated error of a line and the additional scatter of joints. A line with a stated error
// near zero does not count more than twice as much as the usual one.
std::vector<double> weights_of(const Series& series, const std::vector<std::vector<double>>& columns) {
    std::vector<double> errors = series.error;
    const double usual = median_in(errors);
    if (!(usual > 0.0)) return std::vector<double>(series.error.size(), 1.0);
    errors = series.error;
    for (double& error : errors) error = std::max(error > 0.0 ? error : usual, least_error * usual);
    const double beside = variance_beside(series, errors, columns);
    std::vector<double> weights;
    for (const double error : errors)
        weights.push_back(std::sqrt((usual * usual + beside) / (error * error + beside)));
    return weights;
}

}  // namespace

std::vector<double> change_column(const JointHistory& history, const FoundChange& change,
                                  std::span<const std::size_t> rows) {
    const double first = history.day.front(), span = std::max(history.day.back() - first, 1e-9);
    std::vector<double> column;
    column.reserve(rows.size());
    for (const std::size_t row : rows)
        column.push_back(change.drift ? (history.day[row] - first) / span : row >= change.row ? 1.0 : 0.0);
    return column;
}

std::vector<Regression> regressions(const JointHistory& history, std::span<const FoundChange> known) {
    std::vector<Regression> all;
    for (const Series& series : history.series) {
        std::vector<std::vector<double>> columns = {std::vector<double>(series.rows.size(), 1.0)};
        for (const Condition& condition : history.conditions) {
            std::vector<double> column;
            for (const std::size_t row : series.rows) column.push_back(condition.value[row]);
            columns.push_back(std::move(column));
        }
        for (const FoundChange& change : known)
            columns.push_back(change_column(history, change, series.rows));
        all.emplace_back(series.value, weights_of(series, columns), columns);
    }
    return all;
}

namespace {

// Every series that has enough lines, and all torques together.
std::vector<Scan> scans_of(const JointHistory& history, const std::vector<Regression>& known) {
    std::vector<Scan> scans;
    for (std::size_t s = 0; s < known.size(); ++s)
        if (known[s].freedom() >= 4.0) scans.emplace_back(history, history.series[s], known[s]);
    if (auto gain = Scan::of_sensor_gain(history, known)) scans.push_back(std::move(*gain));
    return scans;
}

}  // namespace

std::optional<FoundChange> next_change(const JointHistory& history, const std::vector<Regression>& known,
                                       const ScatterOfSeries& scatter, double limit, std::uint64_t seed) {
    std::vector<Scan> scans = scans_of(history, known);
    for (Scan& scan : scans)
        if (const auto found = scatter.find(scan.name()); found != scatter.end()) scan.lean_on(found->second);
    const Scan* best = nullptr;
    for (const Scan& scan : scans)
        if (best == nullptr || scan.largest() > best->largest()) best = &scan;
    if (best == nullptr || !(best->largest() > 0.0)) return std::nullopt;
    const std::size_t rows = history.lines.size();
    FoundChange found{best->is_drift(), best->row(), best->row(), best->row(), 1.0, limit};
    found.p = chance_of(scans, best->largest(), rows, block_length(scans, rows), limit, seed);
    if (!(found.p <= limit)) return std::nullopt;
    if (found.drift)
        found.latest = rows - 1;
    else
        settle_row(history, known, found);
    return found;
}

namespace {

constexpr double fewest_others = 4.0;  // chosen, not derived
constexpr double most_worth = 100.0;   // lines, however alike the joints are

/// One joint's scatter as a number that is about normal among joints: its logarithm, without the bias that
/// few lines have.
struct LogScatter {
    std::size_t history = 0;
    double value = 0.0, own_variance = 0.0;
};

// Sums over joints, from which one of them is easily subtracted.
struct Sums {
    double count = 0.0, value = 0.0, squares = 0.0, own_variance = 0.0;

    void add(const LogScatter& one, double sign) {
        count += sign;
        value += sign * one.value;
        squares += sign * one.value * one.value;
        own_variance += sign * one.own_variance;
    }
};

// Logarithms of chi square over its freedom d have the mean -1/d and the variance 2/d + 2/d^2, to a few
// percent from four on.
LogScatter log_scatter(std::size_t history, const Scatter& own) {
    return {history, portable::log(own.variance) + 1.0 / own.freedom,
            2.0 / own.freedom + 2.0 / (own.freedom * own.freedom)};
}

// The difference between joints beyond the sampling error of few lines determines the weight of one for
// another.
Scatter scatter_of(const Sums& others) {
    const double mean = others.value / others.count;
    const double variance = std::max(others.squares - others.count * mean * mean, 0.0) / (others.count - 1.0);
    const double apart = variance - others.own_variance / others.count;
    const double freedom = apart > 0.0 ? (1.0 + std::sqrt(1.0 + 2.0 * apart)) / apart : most_worth;
    const double worth = std::min(freedom, most_worth);
    return {worth, portable::exp(mean - 1.0 / worth)};
}

}  // namespace

std::vector<ScatterOfSeries> scatter_of_kin(std::span<const JointHistory> histories) {
    std::map<std::pair<std::string, std::string>, std::vector<LogScatter>> all;
    for (std::size_t h = 0; h < histories.size(); ++h) {
        if (histories[h].series.empty()) continue;
        for (const Scan& scan : scans_of(histories[h], regressions(histories[h], {})))
            if (scan.unit() > 0.0 && scan.scatter().variance > 0.0)
                all[{histories[h].joint, scan.name()}].push_back(log_scatter(h, scan.scatter()));
    }
    std::vector<ScatterOfSeries> told(histories.size());
    for (const auto& [name, joints] : all) {
        Sums sums;
        for (const LogScatter& one : joints) sums.add(one, 1.0);
        for (const LogScatter& one : joints) {
            Sums others = sums;
            others.add(one, -1.0);
            if (others.count >= fewest_others) told[one.history][name.second] = scatter_of(others);
        }
    }
    return told;
}

}  // namespace ripplenotch
