// SPDX-License-Identifier: MIT
#pragma once
// Fewer points that look the same: per bucket of consecutive points the lowest and the highest are kept, so
// no peak is hidden however many points there were.

#include <cstddef>
#include <span>
#include <vector>

#include "ripplenotch/figure/figure.hpp"

namespace ripplenotch {

/// Enough for a screen three times as wide as most, and for zooming in.
inline constexpr std::size_t shown_buckets = 2000;

/// Takes points in order of x, any number of them, in memory for at most 2 * `buckets` buckets. Every point
/// given out is one that was taken in; the highest and the lowest of any stretch as long as a bucket or
/// longer are among them.
class MinMaxCourse {
  public:
    explicit MinMaxCourse(std::size_t buckets = shown_buckets);

    /// A y that is not finite is left out, and breaks the line there.
    void add(double x, double y);
    /// The next point is not joined to the last (a gap in time).
    void break_here();

    /// As a curve's points: at most four for each of 2 * `buckets` buckets (first, lowest, highest, last),
    /// with a nan where the line breaks.
    [[nodiscard]] Curve curve(std::string name, Ink ink) const;

  private:
    struct Point {
        double x, y;
    };
    struct Bucket {
        Point first, low, high, last;
        bool broken_before = false;
    };
    void halve();

    std::size_t most_;
    std::size_t per_bucket_ = 1, in_last_ = 0;
    bool break_next_ = false;
    std::vector<Bucket> buckets_;
};

/// A curve's points through a MinMaxCourse; a curve that is short enough stays as it is.
[[nodiscard]] Curve thinned(const Curve& curve, std::size_t buckets = shown_buckets);

/// How many cells a raster has along each axis.
struct RasterSize {
    std::size_t columns = 1, rows = 1;
};
/// A map on so many cells, at most, of equal size along each axis as it is drawn; a cell takes the
/// highest of the cells that reach into it, so that no line is lost.
[[nodiscard]] HeatMap rasterised(const HeatMap& map, const PlotRange& x, PlotScale x_scale,
                                 const PlotRange& y, PlotScale y_scale, const RasterSize& size);

}  // namespace ripplenotch
