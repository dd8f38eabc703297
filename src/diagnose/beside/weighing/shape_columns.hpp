// SPDX-License-Identifier: MIT
#pragma once
// What shapes are when they are weighed, of which no more is held than memory allows.

#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "diagnose/beside/weighing/lens.hpp"

namespace ripplenotch {

/// Shapes by their places: first all of the lens, which stay, then refined ones.
class ShapeColumns {
  public:
    /// Empty. `lens` must outlive it.
    explicit ShapeColumns(const Lens& lens) : lens_(lens) {}

    [[nodiscard]] const std::vector<Shape>& shapes() const { return shapes_; }
    void add(const Shape& shape);
    /// Only these places, in their order, become places 0, 1, ...; first of them are all listed ones.
    void keep(std::span<const std::size_t> places);

    /// Of a ripple that rings the place of the plain one, if that is listed: its columns come before the
    /// ringing one's own.
    [[nodiscard]] std::optional<std::size_t> plain_of(std::size_t shape) const { return plain_of_[shape]; }
    /// Of the whitened columns what is outside the always-on ones.
    [[nodiscard]] double part(std::size_t shape) const { return part_[shape]; }

    /// Shared, so that who asks keeps it.
    using Column = std::shared_ptr<const std::vector<double>>;
    /// Without those of the plain one. Until the next call of whatever of this class: of refined shapes only
    /// those asked for last are held, the others are weighed once more.
    [[nodiscard]] const std::vector<Column>& own(std::size_t shape) const;

  private:
    [[nodiscard]] std::size_t listed() const { return lens_.shapes().size(); }
    [[nodiscard]] Lens::Weighed weigh(std::size_t shape) const;
    void hold(std::size_t shape) const;

    const Lens& lens_;
    std::vector<Shape> shapes_;
    std::vector<std::optional<std::size_t>> plain_of_;
    std::vector<double> part_;
    mutable std::vector<std::vector<Column>> columns_;  ///< none of a shape that is not held
    mutable std::deque<std::size_t> held_;              ///< refined shapes, the last one asked for last
    /// The plain ripple whose ringing was weighed last: a search asks for many in a row.
    mutable struct {
        Term term;
        std::vector<std::vector<double>> torque_nm;  ///< at the ground's samples
    } plain_;
};

}  // namespace ripplenotch
