// SPDX-License-Identifier: MIT
#include "fleet/trend/change_test.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "ripplenotch/core/median.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

constexpr std::size_t enough_exceed = 10;  // orders that show as much, after which p is known well enough
constexpr double hardly_worse = 3.84;      // fall of twice the log-likelihood, 95 % of one degree of freedom
constexpr double takes_part = 4.0;         // t squared
constexpr double least_error = 0.7;        // of a line, of the usual one

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

// How much lines scatter beside what they state, as a variance (DerSimonian and Laird, 1986).
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

// By the error that a line states and by what joints scatter beside it. A line that states next to none does
// not count more than twice as much as the usual one.
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

std::vector<Scan> scans_of(const JointHistory& history, const std::vector<Regression>& known) {
    std::vector<Scan> scans;
    for (std::size_t s = 0; s < known.size(); ++s)
        if (known[s].freedom() >= 4.0) scans.emplace_back(history, history.series[s], known[s]);
    if (auto gain = Scan::of_sensor_gain(history, known)) scans.push_back(std::move(*gain));
    return scans;
}

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

}  // namespace ripplenotch
