// SPDX-License-Identifier: MIT
#pragma once
// The rows on which names are weighed beside a leftover: thinned, bridged where they do not count, whitened,
// and cut into blocks and folds.

#include <cstddef>
#include <span>
#include <vector>

#include "diagnose/case/case.hpp"

namespace ripplenotch {

using BesideRules = DiagnosisRules::BesideRules;

/// A range of places.
struct RowRange {
    std::size_t first = 0, count = 0;
};

class Ground {
  public:
    /// Every sample up to rules.most_rate_hz; of a faster log every second, third, ...
    Ground(const Case& looked_at, const BesideRules& rules);

    [[nodiscard]] double rate_hz() const { return rate_hz_; }
    [[nodiscard]] std::size_t samples() const { return sample_.size(); }
    /// Lags of the leftover's colour: rules.memory_s, less on a log that is too short for so many.
    [[nodiscard]] std::size_t memory() const { return memory_; }

    /// A column of the case, samples() values: where a sample does not count, the straight line between its
    /// neighbours that do. All columns and the torque are bridged alike, so that what holds between them
    /// still does.
    [[nodiscard]] std::vector<double> bridged(std::span<const double> column) const;
    /// Its two steps.
    [[nodiscard]] std::vector<double> thinned(std::span<const double> column) const;
    void bridge(std::vector<double>& thinned_column) const;

    /// Takes the colour up; rows() are those that count, with enough rows of their stretch before them.
    void color(std::vector<double> coefficients);
    /// A bridged column whitened, a value per row: folds one after the other, in each its blocks in order.
    [[nodiscard]] std::vector<double> whitened(std::span<const double> bridged_column) const;
    [[nodiscard]] std::size_t rows() const { return row_.size(); }
    /// Sample of the case that stands for a row.
    [[nodiscard]] std::size_t sample_of(std::size_t row) const { return sample_[row_[row]]; }
    [[nodiscard]] const std::vector<RowRange>& folds() const { return folds_; }
    /// In order of time; places in rows().
    [[nodiscard]] const std::vector<RowRange>& blocks() const { return blocks_; }

  private:
    struct Bridge {
        std::size_t at, left, right;
        double part;  ///< of the right one
    };
    void find_bridges(const std::vector<unsigned char>& use);
    void cut(const std::vector<std::size_t>& counting);

    double rate_hz_ = 0.0;
    BesideRules rules_;
    std::size_t memory_ = 0;
    std::vector<std::size_t> sample_;  ///< of the case, a thinned row each
    std::vector<std::size_t> within_;  ///< rows of its stretch before it
    std::vector<unsigned char> use_;
    std::vector<Bridge> bridges_;
    std::vector<double> color_;
    std::vector<std::size_t> row_;  ///< thinned places
    std::vector<RowRange> folds_, blocks_;
};

}  // namespace ripplenotch
