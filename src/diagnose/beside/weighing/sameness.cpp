// SPDX-License-Identifier: MIT
#include "diagnose/beside/weighing/sameness.hpp"

#include <algorithm>
#include <cmath>

#include "core/vectors/dot.hpp"

namespace ripplenotch {

using Eigen::Index;
using Eigen::VectorXd;

OwnColumns columns_at(const Sums& sums, const Names& names, std::size_t place) {
    OwnColumns columns;
    for (std::size_t i = 0; i <= place; ++i) {
        columns.first += columns.count;
        columns.count = static_cast<Index>(sums.weighed(names[i]).size());
    }
    return columns;
}

namespace {

// The size that each fold by itself gives the name, as a multiple of the whole fit's, the rest held.
void weigh_folds(const Sums& sums, const Names& names, std::size_t place, Sameness& found) {
    const OwnColumns own = columns_at(sums, names, place);
    const VectorXd all = sums.sizes(names), size = all.segment(own.first, own.count);
    VectorXd rest = all;
    rest.segment(own.first, own.count).setZero();
    const double variance = sums.lens().sigma() * sums.lens().sigma();
    std::vector<double> part, weight;
    double total = 0.0;
    for (std::size_t fold = 0; fold < sums.folds(); ++fold) {
        const auto products = sums.products(names, fold);
        const VectorXd open = sums.targets(names, fold) - products * rest;
        const double square = size.dot(products.block(own.first, own.first, own.count, own.count) * size);
        if (!(square > 0.0)) continue;
        part.push_back(size.dot(open.segment(own.first, own.count)) / square);
        weight.push_back(square);
        total += square;
    }
    double mean = 0.0, spread = 0.0;
    for (std::size_t i = 0; i < part.size(); ++i) mean += weight[i] / total * part[i];
    for (std::size_t i = 0; i < part.size(); ++i) {
        const double chance = variance / weight[i] * (1.0 - 1.0 / static_cast<double>(part.size()));
        spread += weight[i] / total * ((part[i] - mean) * (part[i] - mean) - chance);
        if (part[i] * mean > 0.0) found.same_sign += weight[i] / total;
    }
    found.uneven = mean != 0.0 ? std::sqrt(std::max(spread, 0.0)) / std::abs(mean) : 10.0;
}

// Of each row, which of the speeds it is among, in equal parts of the rows that move, each direction by
// itself; none for those that rest.
std::vector<std::size_t> speeds_of(const Lens& lens, std::size_t count) {
    const Case& c = lens.looked_at();
    std::vector<double> speeds;
    const auto speed_of = [&](std::size_t row) {
        return c.motion.velocity_deg_s[lens.ground().sample_of(row)];
    };
    for (std::size_t row = 0; row < lens.ground().rows(); ++row) {
        if (std::abs(speed_of(row)) > c.moving_deg_s) speeds.push_back(std::abs(speed_of(row)));
    }
    std::sort(speeds.begin(), speeds.end());
    std::vector<std::size_t> places;
    for (std::size_t row = 0; row < lens.ground().rows(); ++row) {
        const double speed = std::abs(speed_of(row));
        const auto rank =
            static_cast<std::size_t>(std::lower_bound(speeds.begin(), speeds.end(), speed) - speeds.begin());
        const bool moves = speed > c.moving_deg_s;
        places.push_back(moves ? std::min(rank * count / speeds.size(), count - 1) +
                                     (speed_of(row) > 0.0 ? count : 0)
                               : 2 * count);
    }
    return places;
}

// The size among each of the speeds that tell it, against that of the whole log.
void weigh_speeds(const Sums& sums, const Names& names, std::size_t place, Sameness& found) {
    const Lens& lens = sums.lens();
    const auto& rules = lens.rules().evenness;
    const OwnColumns own = columns_at(sums, names, place);
    const VectorXd sizes = sums.sizes(names);
    std::vector<double> left = lens.target(), torque(left.size(), 0.0);
    Index value = 0;
    for (std::size_t i = 0; i < names.size(); ++i) {
        for (const auto& column : sums.weighed(names[i])) {
            add_scaled(-sizes[value], column->data(), left.data(), left.size());
            if (value >= own.first && value < own.first + own.count)
                add_scaled(sizes[value], column->data(), torque.data(), torque.size());
            ++value;
        }
    }
    const std::vector<std::size_t> places = speeds_of(lens, rules.speeds);
    std::vector<double> both(2 * rules.speeds + 1, 0.0), square(both);
    for (std::size_t row = 0; row < left.size(); ++row) {
        both[places[row]] += left[row] * torque[row];
        square[places[row]] += torque[row] * torque[row];
    }
    const double variance = lens.sigma() * lens.sigma();
    double off = 0.0, telling = 0.0;
    for (std::size_t i = 0; i < both.size(); ++i) {
        if (square[i] < rules.telling_deviations * rules.telling_deviations * variance) continue;
        const double part = both[i] / square[i];
        off += std::max(part * part - variance / square[i], 0.0);
        telling += 1.0;
    }
    found.uneven_by_speed = telling > 1.0 ? std::sqrt(off / telling) : 0.0;
}

}  // namespace

Sameness sameness_of(const Sums& sums, const Names& names, std::size_t place) {
    Sameness found;
    weigh_folds(sums, names, place, found);
    weigh_speeds(sums, names, place, found);
    return found;
}

}  // namespace ripplenotch
