// SPDX-License-Identifier: MIT
#include "fleet/trend/joint_history.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "core/matrices/least_squares.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {

namespace {

constexpr double least_left = 0.05;  // share of a column's squares outside the others

double dot_product(const std::vector<double>& a, const std::vector<double>& b) {
    return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

double squares_about_mean(const std::vector<double>& column) {
    const auto n = static_cast<double>(column.size());
    const double mean = std::accumulate(column.begin(), column.end(), 0.0) / n;
    return std::max(0.0, dot_product(column, column) - n * mean * mean);
}

}  // namespace

Regression::Regression(std::span<const double> value, const std::vector<std::vector<double>>& columns)
    : residual_(value.begin(), value.end()) {
    std::vector<std::vector<double>> kept;
    for (const auto& column : columns) {
        std::vector<double> left(column);
        project(left);
        project(left);  // once more, for what rounding left
        const double size = std::sqrt(dot_product(left, left));
        if (!(size * size > 1e-6 * dot_product(column, column))) continue;
        for (double& number : left) number /= size;
        basis_.push_back(std::move(left));
        kept.push_back(column);
    }
    if (!kept.empty()) first_value_ = least_squares(kept, residual_).front();
    project(residual_);
    project(residual_);
}

void Regression::project(std::vector<double>& numbers) const {
    for (const auto& axis : basis_) {
        const double along = dot_product(axis, numbers);
        for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] -= along * axis[i];
    }
}

double Regression::freedom() const {
    return static_cast<double>(residual_.size()) - static_cast<double>(basis_.size());
}

double Regression::deviation() const {
    return std::sqrt(dot_product(residual_, residual_) / std::max(freedom(), 1.0));
}

std::optional<Extra> Regression::extra(std::vector<double> column) const {
    const double whole = squares_about_mean(column);
    project(column);
    const double squares = dot_product(column, column);
    if (!(squares > least_left * whole) || !(freedom() > 1.5)) return std::nullopt;
    const double along = dot_product(column, residual_), rss = dot_product(residual_, residual_);
    const double rest = std::max(rss - along * along / squares, 1e-12 * rss);
    Extra found;
    found.size = along / squares;
    found.error = std::sqrt(rest / (freedom() - 1.0) / squares);
    found.t_squared = rest > 0.0 ? along * along / squares / (rest / (freedom() - 1.0)) : 0.0;
    return found;
}

std::vector<double> change_column(const JointHistory& history, const FoundChange& change,
                                  std::span<const std::size_t> rows) {
    const double first = history.day.front(), span = std::max(history.day.back() - first, 1e-9);
    std::vector<double> column;
    column.reserve(rows.size());
    for (const std::size_t row : rows)
        column.push_back(change.drift ? (history.day[row] - first) / span : row >= change.row ? 1.0 : 0.0);
    return column;
}

Regression regression_of(const JointHistory& history, const Series& series,
                         std::span<const FoundChange> known) {
    std::vector<std::vector<double>> columns = {std::vector<double>(series.rows.size(), 1.0)};
    for (const Condition& condition : history.conditions) {
        std::vector<double>& column = columns.emplace_back();
        for (const std::size_t row : series.rows) column.push_back(condition.value[row]);
    }
    for (const FoundChange& change : known) columns.push_back(change_column(history, change, series.rows));
    return {series.value, columns};
}

namespace {

constexpr std::size_t fewest_before = 5, fewest_after = 3;  // chosen, not derived
constexpr double hardly_chance = 16.0;     // t squared that chance has in one series of fifty
constexpr std::size_t enough_exceed = 10;  // orders that show as much, after which p is known well enough

/// The largest statistic of one series over all places of a step, and of a drift, for its residuals in any
/// order.
class Scan {
  public:
    Scan(const JointHistory& history, const Series& series, Regression regression);
    [[nodiscard]] double largest() const { return best_.t_squared; }  ///< in the order of time
    [[nodiscard]] bool is_drift() const { return best_.drift; }
    [[nodiscard]] std::size_t row() const { return rows_[best_.place]; }
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
    [[nodiscard]] Found look(const std::vector<double>& residual) const;
    void leave_chance();

    const std::vector<std::size_t>& rows_;
    std::vector<std::size_t> place_of_row_;  ///< in rows_; rows without the series have rows_.size()
    Regression regression_;
    /// Squares of the remainder of a step before each position; 0: it is not tested.
    std::vector<double> norm_;
    std::vector<double> slope_;   ///< the remainder of a drift
    std::vector<double> chance_;  ///< residual without the best change, if it is one
    double slope_norm_ = 0.0, memory_ = 0.0;
    Found best_;
};

Scan::Scan(const JointHistory& history, const Series& series, Regression regression)
    : rows_(series.rows),
      place_of_row_(history.lines.size(), rows_.size()),
      regression_(std::move(regression)),
      norm_(rows_.size(), 0.0) {
    for (std::size_t i = 0; i < rows_.size(); ++i) place_of_row_[rows_[i]] = i;
    const auto rest_of = [&](const FoundChange& change, std::vector<double>& column) {
        column = change_column(history, change, rows_);
        const double whole = squares_about_mean(column);
        regression_.project(column);
        const double left = dot_product(column, column);
        return left > least_left * whole ? left : 0.0;
    };
    std::vector<double> column;
    for (std::size_t place = fewest_before; place + fewest_after <= rows_.size(); ++place)
        norm_[place] = rest_of({false, rows_[place]}, column);
    slope_norm_ = rest_of({true}, slope_);
    best_ = look(regression_.residual());
    leave_chance();
}

Scan::Found Scan::look(const std::vector<double>& residual) const {
    const double squares = dot_product(residual, residual);
    double most = 0.0, behind = 0.0;
    Found found;
    for (std::size_t place = residual.size(); place-- > 0;) {
        behind += residual[place];
        if (norm_[place] > 0.0 && behind * behind > most * norm_[place]) {
            most = behind * behind / norm_[place];
            found.place = place;
        }
    }
    const double along = slope_norm_ > 0.0 ? dot_product(slope_, residual) : 0.0;
    if (along * along > most * slope_norm_) {
        most = along * along / slope_norm_;
        found.drift = true;
    }
    const double rest = std::max(squares - most, 1e-12 * squares);
    if (rest > 0.0) found.t_squared = most / rest * (regression_.freedom() - 1.0);
    return found;
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
void Scan::leave_chance() {
    std::vector<double> column = slope_;
    if (!best_.drift) {
        column.assign(rows_.size(), 0.0);
        std::fill(column.begin() + static_cast<std::ptrdiff_t>(best_.place), column.end(), 1.0);
        regression_.project(column);
    }
    chance_ = regression_.residual();
    std::vector<double> left = chance_;
    const double along = dot_product(column, left), norm = dot_product(column, column);
    for (std::size_t i = 0; i < left.size() && norm > 0.0; ++i) left[i] -= along / norm * column[i];
    const double squares = dot_product(left, left);
    if (squares > 0.0)
        memory_ = std::inner_product(left.begin() + 1, left.end(), left.begin(), 0.0) / squares;
    const bool change = best_.t_squared > hardly_chance;
    if (change) chance_ = std::move(left);
    // The regression took its share of chance, and takes it of every order once more.
    const double freedom = regression_.freedom() - (change ? 1.0 : 0.0);
    for (double& one : chance_) one *= std::sqrt(static_cast<double>(chance_.size()) / freedom);
}

// Blocks of rows that stand together stay together; where they are cut is chance.
std::vector<std::size_t> shuffled(std::size_t rows, std::size_t block, std::mt19937_64& engine) {
    const std::size_t offset = block > 1 ? engine() % block : 0;
    std::vector<std::size_t> starts;
    for (std::size_t at = 0; at < rows; at = at == 0 && offset > 0 ? offset : at + block)
        starts.push_back(at);
    starts.push_back(rows);
    std::vector<std::size_t> blocks(starts.size() - 1);
    std::iota(blocks.begin(), blocks.end(), std::size_t{0});
    for (std::size_t i = blocks.size(); i > 1; --i) std::swap(blocks[i - 1], blocks[engine() % i]);
    std::vector<std::size_t> order;
    order.reserve(rows);
    for (const std::size_t b : blocks)
        for (std::size_t row = starts[b]; row < starts[b + 1]; ++row) order.push_back(row);
    return order;
}

// Carlstein's length for an autoregression of first order: residuals that remember need longer blocks.
std::size_t block_length(const std::vector<Scan>& scans, std::size_t rows) {
    double sum = 0.0;
    for (const Scan& scan : scans) sum += scan.memory();
    const auto series = static_cast<double>(scans.size()), n = static_cast<double>(rows);
    const double memory = sum / series, noise = 2.0 / std::sqrt(n * std::max(1.0, 0.5 * series));
    if (memory < noise) return 1;
    const double r = std::min(memory, 0.9);
    const double length = portable::pow(2.0 * r / (1.0 - r * r), 2.0 / 3.0) * portable::cbrt(n);
    return std::clamp<std::size_t>(static_cast<std::size_t>(length + 0.5), 1,
                                   std::max<std::size_t>(rows / 6, 1));
}

// Chance of a statistic as large, from as many orders as it takes (Besag and Clifford, 1991).
double chance_of(const std::vector<Scan>& scans, double seen, std::size_t rows, double limit,
                 std::uint64_t seed) {
    const auto most = static_cast<std::size_t>(std::ceil(static_cast<double>(enough_exceed) / limit));
    const std::size_t block = block_length(scans, rows);
    std::mt19937_64 engine(seed);
    std::vector<double> room;
    std::size_t exceed = 0;
    for (std::size_t tried = 1; tried <= most; ++tried) {
        const std::vector<std::size_t> order = shuffled(rows, block, engine);
        exceed += std::any_of(scans.begin(), scans.end(),
                              [&](const Scan& scan) { return scan.largest_of(order, room) >= seen; });
        if (exceed >= enough_exceed) return static_cast<double>(exceed) / static_cast<double>(tried);
    }
    return (static_cast<double>(exceed) + 1.0) / (static_cast<double>(most) + 1.0);
}

}  // namespace

std::optional<FoundChange> next_change(const JointHistory& history, std::span<const FoundChange> known,
                                       double limit, std::uint64_t seed) {
    std::vector<Scan> scans;
    for (const Series& series : history.series)
        if (Regression regression = regression_of(history, series, known); regression.freedom() >= 4.0)
            scans.emplace_back(history, series, std::move(regression));
    const auto best = std::max_element(
        scans.begin(), scans.end(), [](const Scan& a, const Scan& b) { return a.largest() < b.largest(); });
    if (best == scans.end() || !(best->largest() > 0.0)) return std::nullopt;
    FoundChange found{best->is_drift(), best->row(), 1.0, limit};
    found.p = chance_of(scans, best->largest(), history.lines.size(), limit, seed);
    return found.p <= limit ? std::optional(found) : std::nullopt;
}

}  // namespace ripplenotch
