// SPDX-License-Identifier: MIT
#pragma once
// The many columns that leave nothing of a log but its noise, and what they leave. There are over a hundred,
// each as long as the log, and they come in turns: products that were summed up once are kept.

#include <concepts>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace ripplenotch {

class NoiseColumns {
  public:
    /// Rows with 0 in `use` count for nothing. It must outlive this.
    explicit NoiseColumns(std::span<const unsigned char> use) : use_(use) {}

    /// A column of a number a row, scaled to an rms of 1; nothing when it is 0 everywhere, or not finite.
    void add(std::vector<double> column);
    /// The same of value_at(row).
    template <class Function>
    requires std::invocable<Function, std::size_t>
    void add(const Function& value_at) {
        std::vector<double> column(use_.size());
        for (std::size_t k = 0; k < column.size(); ++k) column[k] = value_at(k);
        add(std::move(column));
    }
    /// Forgets all columns but the first `count`.
    void cut(std::size_t count);

    [[nodiscard]] std::size_t count() const { return columns_.size(); }

    /// The torque that no sum of the columns explains, by least squares with a touch of ridge; 0 in rows that
    /// do not count.
    [[nodiscard]] std::vector<double> left_of(std::span<const double> torque_nm);

  private:
    /// Rows at a time: of all columns they stay in the second cache.
    static constexpr std::size_t block_rows = 256;

    void sum_products();

    std::span<const unsigned char> use_;
    std::vector<std::vector<double>> columns_;
    std::vector<std::vector<double>> products_;  ///< of each column with those up to it
};

}  // namespace ripplenotch
