// SPDX-License-Identifier: MIT
#include "diagnose/beside/weighing/ground.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/vectors/dot.hpp"

namespace ripplenotch {

Ground::Ground(const Case& looked_at, const BesideRules& rules) : rules_(rules) {
    const double full_hz = looked_at.motion.sample_rate.value();
    const auto step =
        std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(full_hz / rules.most_rate_hz)));
    rate_hz_ = full_hz / static_cast<double>(step);
    std::size_t stretch = 0;
    for (std::size_t s = 0; s < looked_at.from.size(); ++s) {
        const std::size_t end = s + 1 < looked_at.from.size() ? looked_at.from[s + 1] : looked_at.size();
        stretch = 0;
        for (std::size_t k = looked_at.from[s]; k < end; k += step) {
            sample_.push_back(k);
            within_.push_back(stretch++);
            use_.push_back(looked_at.use[k]);
        }
    }
    // A colour of more coefficients than a tenth of the rows would follow chance.
    memory_ = std::min(static_cast<std::size_t>(rules.memory_s * rate_hz_), sample_.size() / 10);
    find_bridges(use_);
}

// A gap at an end of a stretch is as its one neighbour; a stretch of which nothing counts is 0.
void Ground::find_bridges(const std::vector<unsigned char>& use) {
    const std::size_t n = use.size();
    for (std::size_t k = 0; k < n; ++k) {
        if (use[k] != 0) continue;
        std::size_t end = k;
        while (end < n && use[end] == 0 && (end == k || within_[end] != 0)) ++end;
        const bool left = k > 0 && within_[k] != 0, right = end < n && within_[end] != 0;
        for (std::size_t i = k; i < end; ++i) {
            const double part = static_cast<double>(i - k + 1) / static_cast<double>(end - k + 1);
            if (left && right)
                bridges_.push_back({i, k - 1, end, part});
            else
                bridges_.push_back({i, left ? k - 1 : end, left ? k - 1 : end, left || right ? 0.0 : -1.0});
        }
        k = end - 1;
    }
}

std::vector<double> Ground::thinned(std::span<const double> column) const {
    std::vector<double> thin;
    thin.reserve(sample_.size());
    for (const std::size_t sample : sample_) thin.push_back(column[sample]);
    return thin;
}

void Ground::bridge(std::vector<double>& thin) const {
    for (const Bridge& bridge : bridges_) {
        thin[bridge.at] = bridge.part < 0.0
                              ? 0.0
                              : thin[bridge.left] + bridge.part * (thin[bridge.right] - thin[bridge.left]);
    }
}

std::vector<double> Ground::bridged(std::span<const double> column) const {
    std::vector<double> thin = thinned(column);
    bridge(thin);
    return thin;
}

void Ground::color(std::vector<double> coefficients) {
    color_ = std::move(coefficients);
    std::vector<std::size_t> counting;
    for (std::size_t k = 0; k < sample_.size(); ++k) {
        if (use_[k] != 0 && within_[k] >= color_.size()) counting.push_back(k);
    }
    cut(counting);
}

void Ground::cut(const std::vector<std::size_t>& counting) {
    // However slow the clock says that it is, a block has rows enough for a size.
    constexpr double fewest_rows = 20.0;
    const double length =
        std::max({rules_.block_s * rate_hz_, 5.0 * static_cast<double>(memory_), fewest_rows});
    const std::size_t n = counting.size();
    const std::size_t number =
        std::max(2 * rules_.folds, static_cast<std::size_t>(static_cast<double>(n) / length));
    row_.clear();
    folds_.clear();
    blocks_.assign(number, {});
    for (std::size_t fold = 0; fold < rules_.folds; ++fold) {
        const std::size_t first = row_.size();
        for (std::size_t block = fold; block < number; block += rules_.folds) {
            const std::size_t from = block * n / number, to = (block + 1) * n / number;
            blocks_[block] = {row_.size(), to - from};
            for (std::size_t k = from; k < to; ++k) row_.push_back(counting[k]);
        }
        folds_.push_back({first, row_.size() - first});
    }
}

std::vector<double> Ground::whitened(std::span<const double> bridged_column) const {
    std::vector<double> white(row_.size());
    // Rows that follow each other are worked out together.
    for (std::size_t from = 0, end; from < row_.size(); from = end) {
        end = from + 1;
        while (end < row_.size() && row_[end] == row_[end - 1] + 1) ++end;
        prediction_errors(bridged_column.data() + row_[from], end - from, color_.data(), color_.size(),
                          white.data() + from);
    }
    return white;
}

}  // namespace ripplenotch
