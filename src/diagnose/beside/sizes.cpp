// SPDX-License-Identifier: MIT
#include "diagnose/beside/sizes.hpp"

#include <algorithm>
#include <cmath>

#include "core/vectors/dot.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Columns of the linearised model: of each shape its sizes, then the logarithms of its scales.
struct Slopes {
    std::vector<std::vector<double>> columns;
    std::vector<Index> first;  ///< of each shape
    std::vector<double> left;  ///< whitened residual
};

Slopes slopes_of(const Sums& sums, const Names& names, const VectorXd& sizes) {
    // A scale is moved by this factor to see how the torque changes with it.
    constexpr double nudge = 1.02;
    const Lens& lens = sums.lens();
    Slopes slopes;
    slopes.left = lens.target();
    Index size = 0;
    for (const std::size_t name : names) {
        const Shape& shape = sums.shapes()[name];
        const auto& own = sums.weighed(name);
        slopes.first.push_back(static_cast<Index>(slopes.columns.size()));
        for (std::size_t c = 0; c < own.size(); ++c) {
            add_scaled(-sizes[size + static_cast<Index>(c)], own[c].data(), slopes.left.data(),
                       slopes.left.size());
            slopes.columns.push_back(own[c]);
        }
        for (const std::size_t p : scales_of(*shape.term.effect)) {
            Shape up = shape, down = shape;
            up.term.values[p] = *shape.term.values[p] * nudge;
            down.term.values[p] = *shape.term.values[p] / nudge;
            const auto above = lens.weighed(up).columns, below = lens.weighed(down).columns;
            std::vector<double> slope(slopes.left.size(), 0.0);
            const double per_unit = 0.5 / portable::log(nudge);
            for (std::size_t c = 0; c < own.size(); ++c) {
                const double factor = sizes[size + static_cast<Index>(c)] * per_unit;
                add_scaled(factor, above[c].data(), slope.data(), slope.size());
                add_scaled(-factor, below[c].data(), slope.data(), slope.size());
            }
            slopes.columns.push_back(std::move(slope));
        }
        size += static_cast<Index>(own.size());
    }
    return slopes;
}

// The larger, value by value, of what white noise makes and what blocks of the log pull.
MatrixXd covariance_of(const Slopes& slopes, const Lens& lens) {
    const auto m = static_cast<Index>(slopes.columns.size());
    MatrixXd products(m, m), scores = MatrixXd::Zero(m, m);
    const auto at = [&](Index i) -> const std::vector<double>& {
        return slopes.columns[static_cast<std::size_t>(i)];
    };
    VectorXd scale(m);
    for (Index r = 0; r < m; ++r) scale[r] = std::sqrt(dot(at(r).data(), at(r).data(), at(r).size()) + 1e-30);
    for (Index r = 0; r < m; ++r) {
        for (Index c = 0; c <= r; ++c)
            products(r, c) = products(c, r) =
                dot(at(r).data(), at(c).data(), at(r).size()) / (scale[r] * scale[c]) + (r == c ? 1e-9 : 0.0);
    }
    for (const RowRange& block : lens.ground().blocks()) {
        VectorXd score(m);
        for (Index r = 0; r < m; ++r)
            score[r] =
                dot(at(r).data() + block.first, slopes.left.data() + block.first, block.count) / scale[r];
        scores += score * score.transpose();
    }
    const MatrixXd inverse = products.llt().solve(MatrixXd::Identity(m, m));
    const MatrixXd pulled = inverse * scores * inverse, white = lens.sigma() * lens.sigma() * inverse;
    MatrixXd larger = pulled;
    for (Index r = 0; r < m; ++r) {
        const double factor = white(r, r) > pulled(r, r) ? std::sqrt(white(r, r) / pulled(r, r)) : 1.0;
        larger.row(r) *= factor;
        larger.col(r) *= factor;
    }
    return larger.cwiseQuotient(scale * scale.transpose());
}

FittedValue told(std::size_t term, std::size_t parameter, double value, double error, double plain) {
    FittedValue fitted{term, parameter, value, error, Interval{}, false};
    fitted.ci95 = Interval{std::min(value - normal_95_errors * error, plain),
                           std::max(value + normal_95_errors * error, plain)};
    return fitted;
}

struct Sized {
    const double *size, *plain;  ///< a number per column
    MatrixXd covariance;         ///< of sizes and logarithms of scales
    double widened;
};

void tell_polar(BesideValues& told_values, const Polar& polar, std::size_t place, const Sized& sized) {
    const double x = sized.size[0], y = sized.size[1], amount = portable::hypot(x, y);
    const double cosine = amount > 0.0 ? x / amount : 1.0, sine = amount > 0.0 ? y / amount : 0.0;
    const auto& v = sized.covariance;
    const double along = v(0, 0) * cosine * cosine + 2.0 * v(0, 1) * cosine * sine + v(1, 1) * sine * sine;
    const double across = v(0, 0) * sine * sine - 2.0 * v(0, 1) * cosine * sine + v(1, 1) * cosine * cosine;
    const double phase_deg = portable::atan2(y, x) * degrees_per_radian;
    const double px = sized.plain[0], py = sized.plain[1];
    const double turned_deg =
        portable::atan2(py * cosine - px * sine, px * cosine + py * sine) * degrees_per_radian;
    told_values.term.values[polar.size] = amount;
    told_values.term.values[polar.phase] = phase_deg;
    told_values.values.push_back(told(
        place, polar.size, amount, sized.widened * std::sqrt(std::max(along, 0.0)), portable::hypot(px, py)));
    told_values.values.push_back(
        told(place, polar.phase, phase_deg,
             sized.widened * std::sqrt(std::max(across, 0.0)) / std::max(amount, 1e-300) * degrees_per_radian,
             phase_deg + turned_deg));
}

void tell_scales(BesideValues& told_values, std::size_t place, const Sized& sized, Index first) {
    const Effect& effect = *told_values.term.effect;
    for (const std::size_t p : scales_of(effect)) {
        const double value = *told_values.term.values[p];
        const double error = sized.widened * std::sqrt(std::max(sized.covariance(first, first), 0.0));
        ++first;
        FittedValue fitted{place, p, value, value * error, Interval{}, false};
        // Beyond a factor of e^3 nothing is told.
        if (error < 3.0) {
            fitted.ci95 = Interval{value * portable::exp(-normal_95_errors * error),
                                   value * portable::exp(normal_95_errors * error)};
        } else {
            fitted.standard_error.reset();
            fitted.ci95.reset();
        }
        told_values.values.push_back(fitted);
    }
}

}  // namespace

std::vector<BesideValues> values_beside(Sums& sums, const std::vector<Shape>& believed) {
    std::vector<BesideValues> told_all;
    if (believed.empty()) return told_all;
    Names names;
    std::vector<Shape> plain_shapes;
    for (Shape shape : believed) {
        shape.swelling = false;
        plain_shapes.push_back(shape);
        names.push_back(sums.place_of(shape));
    }
    const VectorXd sizes = sums.sizes(names);
    const std::vector<double> plain = sums.lens().plain_sizes(plain_shapes);
    const Slopes slopes = slopes_of(sums, names, sizes);
    const MatrixXd covariance = covariance_of(slopes, sums.lens());
    std::size_t size = 0;
    for (std::size_t place = 0; place < names.size(); ++place) {
        const Shape& shape = plain_shapes[place];
        const Effect& effect = *shape.term.effect;
        const auto columns = static_cast<Index>(columns_of(shape));
        const Index all = columns + static_cast<Index>(scales_of(effect).size());
        BesideValues told_values{shape.term, {}};
        const Sized sized{sizes.data() + size, plain.data() + size,
                          covariance.block(slopes.first[place], slopes.first[place], all, all),
                          sums.lens().rules().beside.interval_factor};
        if (effect.polar) {
            tell_polar(told_values, *effect.polar, place, sized);
        } else {
            for (std::size_t p = 0; p < effect.parameters.size(); ++p) {
                if (!effect.parameters[p].linear) continue;
                told_values.term.values[p] = sized.size[0];
                told_values.values.push_back(
                    told(place, p, sized.size[0],
                         sized.widened * std::sqrt(std::max(sized.covariance(0, 0), 0.0)), sized.plain[0]));
            }
        }
        tell_scales(told_values, place, sized, columns);
        std::sort(told_values.values.begin(), told_values.values.end(),
                  [](const FittedValue& a, const FittedValue& b) { return a.parameter < b.parameter; });
        told_all.push_back(std::move(told_values));
        size += static_cast<std::size_t>(columns);
    }
    return told_all;
}

}  // namespace ripplenotch
