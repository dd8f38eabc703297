// SPDX-License-Identifier: MIT
#include "ripplenotch/figure/min_max.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace ripplenotch {
namespace {

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

// The cells of a raster between a and b along one axis: [first, last).
struct CellRange {
    std::size_t first, last;
};
CellRange cells_between(double a, double b, std::size_t count) {
    const double scale = static_cast<double>(count);
    // An edge that falls on the edge of a pixel but for rounding does not reach into the next.
    const double first = std::clamp(std::floor(a * scale + 1e-6), 0.0, scale);
    const double last = std::clamp(std::ceil(b * scale - 1e-6), 0.0, scale);
    return {static_cast<std::size_t>(first), static_cast<std::size_t>(std::max(first, last))};
}

std::vector<double> even_edges(const PlotRange& range, PlotScale scale, std::size_t count) {
    std::vector<double> edges(count + 1);
    for (std::size_t i = 0; i <= count; ++i)
        edges[i] = value_at(range, scale, static_cast<double>(i) / static_cast<double>(count));
    return edges;
}

}  // namespace

MinMaxCourse::MinMaxCourse(std::size_t buckets) : most_(2 * std::max<std::size_t>(buckets, 1)) {}

void MinMaxCourse::add(double x, double y) {
    if (!std::isfinite(y) || !std::isfinite(x)) {
        break_here();
        return;
    }
    const Point point{x, y};
    if (!buckets_.empty() && !break_next_ && in_last_ < per_bucket_) {
        Bucket& last = buckets_.back();
        if (y < last.low.y) last.low = point;
        if (y > last.high.y) last.high = point;
        last.last = point;
        ++in_last_;
        return;
    }
    if (buckets_.size() == most_) halve();
    buckets_.push_back({point, point, point, point, break_next_});
    in_last_ = 1;
    break_next_ = false;
}

void MinMaxCourse::break_here() { break_next_ = !buckets_.empty(); }

// Neighbours become one; a break between two that become one is too narrow to be seen.
void MinMaxCourse::halve() {
    std::size_t to = 0;
    for (std::size_t from = 0; from < buckets_.size(); from += 2, ++to) {
        Bucket merged = buckets_[from];
        if (from + 1 < buckets_.size()) {
            const Bucket& next = buckets_[from + 1];
            if (next.low.y < merged.low.y) merged.low = next.low;
            if (next.high.y > merged.high.y) merged.high = next.high;
            merged.last = next.last;
        }
        buckets_[to] = merged;
    }
    buckets_.resize(to);
    per_bucket_ *= 2;
}

Curve MinMaxCourse::curve(std::string name, Ink ink) const {
    Curve curve{std::move(name), ink, CurveStyle::line, {}, {}};
    const auto give = [&curve](double x, double y) {
        curve.x.push_back(x);
        curve.y.push_back(y);
    };
    for (const Bucket& bucket : buckets_) {
        if (bucket.broken_before) give(bucket.first.x, nothing);
        const bool low_first = bucket.low.x <= bucket.high.x;
        double last_x = nothing;
        for (const Point& point : {bucket.first, low_first ? bucket.low : bucket.high,
                                   low_first ? bucket.high : bucket.low, bucket.last}) {
            if (point.x == last_x) continue;
            give(point.x, point.y);
            last_x = point.x;
        }
    }
    return curve;
}

Curve thinned(const Curve& curve, std::size_t buckets) {
    if (curve.x.size() <= 4 * buckets) return curve;
    MinMaxCourse course(buckets);
    for (std::size_t i = 0; i < curve.x.size(); ++i) course.add(curve.x[i], curve.y[i]);
    Curve fewer = course.curve(curve.name, curve.ink);
    fewer.style = curve.style;
    return fewer;
}

HeatMap rasterised(const HeatMap& map, const PlotRange& x, PlotScale x_scale, const PlotRange& y,
                   PlotScale y_scale, const RasterSize& size) {
    const auto [columns, rows] = size;
    HeatMap raster{map.label,
                   map.unit,
                   map.scale,
                   map.lowest,
                   map.highest,
                   even_edges(x, x_scale, columns),
                   even_edges(y, y_scale, rows),
                   std::vector<double>(columns * rows, nothing)};
    const std::size_t across = map.x_edges.size() - 1;
    for (std::size_t row = 0; row + 1 < map.y_edges.size(); ++row) {
        const auto [y_first, y_last] = cells_between(share_along(y, y_scale, map.y_edges[row]),
                                                     share_along(y, y_scale, map.y_edges[row + 1]), rows);
        for (std::size_t column = 0; column < across; ++column) {
            const double value = map.cells[row * across + column];
            if (std::isnan(value)) continue;
            const auto [x_first, x_last] =
                cells_between(share_along(x, x_scale, map.x_edges[column]),
                              share_along(x, x_scale, map.x_edges[column + 1]), columns);
            for (std::size_t r = y_first; r < y_last; ++r) {
                for (std::size_t c = x_first; c < x_last; ++c) {
                    double& cell = raster.cells[r * columns + c];
                    cell = std::isnan(cell) ? value : std::max(cell, value);
                }
            }
        }
    }
    return raster;
}

}  // namespace ripplenotch
