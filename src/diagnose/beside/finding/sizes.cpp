// SPDX-License-Identifier: MIT
#include "diagnose/beside/finding/sizes.hpp"

#include <algorithm>
#include <cmath>
#include <complex>

#include "core/matrices/factorisations.hpp"
#include "core/vectors/dot.hpp"
#include "diagnose/beside/weighing/ringing_torque.hpp"
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
            add_scaled(-sizes[size + static_cast<Index>(c)], own[c]->data(), slopes.left.data(),
                       slopes.left.size());
            slopes.columns.push_back(*own[c]);
        }
        for (const Scale& scale : scales_of(shape)) {
            const double value = value_of(shape, scale);
            const auto above = lens.weighed(moved(shape, scale, value * nudge)).columns,
                       below = lens.weighed(moved(shape, scale, value / nudge)).columns;
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
    const MatrixXd inverse = DefiniteFactors(products).solve(MatrixXd(MatrixXd::Identity(m, m)));
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

using Complex = std::complex<double>;

Complex pair_at(const double* sizes, Index first) { return {sizes[first], sizes[first + 1]}; }

// Deviation of a number that depends on sizes so: Re of the sum of c * dA over pairs A of columns.
double deviation_of(const Sized& sized, const std::vector<Complex>& slopes) {
    VectorXd row = VectorXd::Zero(sized.covariance.rows());
    for (std::size_t pair = 0; pair < slopes.size(); ++pair) {
        row[static_cast<Index>(2 * pair)] = slopes[pair].real();
        row[static_cast<Index>(2 * pair + 1)] = -slopes[pair].imag();
    }
    return sized.widened * std::sqrt(std::max(row.dot(sized.covariance * row), 0.0));
}

// A complex number as size and phase: `slopes` are its own by each pair of columns, `plain` is what plain
// least squares makes of it.
void tell_complex(std::vector<FittedValue>& values, std::size_t place, const Polar& polar, Complex number,
                  Complex plain, const Sized& sized, std::vector<Complex> slopes) {
    const double amount = portable::hypot(number.real(), number.imag());
    const Complex back = amount > 0.0 ? std::conj(number) / amount : Complex(1.0);
    const Complex turned = plain * back;
    const double phase_deg = portable::arg(number) * degrees_per_radian;
    for (Complex& slope : slopes) slope *= back;
    values.push_back(told(place, polar.size, amount, deviation_of(sized, slopes),
                          portable::hypot(plain.real(), plain.imag())));
    // Im z is Re -iz.
    for (Complex& slope : slopes) slope *= Complex(0.0, -1.0);
    values.push_back(told(place, polar.phase, phase_deg,
                          deviation_of(sized, slopes) / std::max(amount, 1e-300) * degrees_per_radian,
                          phase_deg + portable::arg(turned) * degrees_per_radian));
}

bool holds_0(const FittedValue& size) { return size.ci95->low <= 0.0 && size.ci95->high >= 0.0; }

void tell_polar(BesideValues& told_values, const Polar& polar, std::size_t place, const Sized& sized) {
    const Complex all = pair_at(sized.size, 0);
    tell_complex(told_values.values, place, polar, all, pair_at(sized.plain, 0), sized, {1.0});
    told_values.is_told = !holds_0(told_values.values.front());
    told_values.term.values[polar.size] = told_values.values[0].value;
    told_values.term.values[polar.phase] = told_values.values[1].value;
}

// The second pair of columns rings, the first does not.
void tell_ringing(BesideValues& told_values, const Shape& shape, std::size_t place, const Sized& sized) {
    const Polar& polar = *shape.term.effect->polar;
    const Complex passing = pair_at(sized.size, 2), direct = pair_at(sized.size, 0);
    const Complex plain_passing = pair_at(sized.plain, 2), plain_direct = pair_at(sized.plain, 0);
    tell_complex(told_values.values, place, polar, passing, plain_passing, sized, {0.0, 1.0});
    told_values.term.values[polar.size] = told_values.values[0].value;
    told_values.term.values[polar.phase] = told_values.values[1].value;
    told_values.is_told = !holds_0(told_values.values[0]);
    const Complex part = direct / passing;
    told_values.ringing = ringing_term(shape, part);
    tell_complex(told_values.ringing_values, place, direct_of(*shape.ringing->effect), part,
                 plain_direct / plain_passing, sized, {1.0 / passing, -part / passing});
}

void tell_scales(BesideValues& told_values, const Shape& shape, std::size_t place, const Sized& sized,
                 Index first) {
    for (const Scale& scale : scales_of(shape)) {
        const double value = value_of(shape, scale);
        const double error = sized.widened * std::sqrt(std::max(sized.covariance(first, first), 0.0));
        ++first;
        FittedValue fitted{place, scale.parameter, value, value * error, Interval{}, false};
        // Beyond a factor of e^3 nothing is told.
        if (error < 3.0) {
            fitted.ci95 = Interval{value * portable::exp(-normal_95_errors * error),
                                   value * portable::exp(normal_95_errors * error)};
        } else {
            fitted.standard_error.reset();
            fitted.ci95.reset();
        }
        (scale.of_ringing ? told_values.ringing_values : told_values.values).push_back(fitted);
    }
}

void put_values_in_order(std::vector<FittedValue>& values) {
    std::sort(values.begin(), values.end(),
              [](const FittedValue& a, const FittedValue& b) { return a.parameter < b.parameter; });
}

}  // namespace

std::vector<BesideValues> values_beside(Sums& sums, const std::vector<Shape>& believed) {
    std::vector<BesideValues> told_all;
    if (believed.empty()) return told_all;
    Names names;
    for (const Shape& shape : believed) names.push_back(sums.place_of(shape));
    const VectorXd sizes = sums.sizes(names);
    const std::vector<double> plain = sums.lens().plain_sizes(believed);
    const Slopes slopes = slopes_of(sums, names, sizes);
    const MatrixXd covariance = covariance_of(slopes, sums.lens());
    std::size_t size = 0;
    for (std::size_t place = 0; place < names.size(); ++place) {
        const Shape& shape = believed[place];
        const Effect& effect = *shape.term.effect;
        const auto columns = static_cast<Index>(columns_of(shape));
        const Index all = columns + static_cast<Index>(scales_of(shape).size());
        BesideValues told_values{shape.term, {}};
        const Sized sized{sizes.data() + size, plain.data() + size,
                          covariance.block(slopes.first[place], slopes.first[place], all, all),
                          sums.lens().rules().beside.interval_factor};
        if (shape.ringing) {
            tell_ringing(told_values, shape, place, sized);
        } else if (effect.polar) {
            tell_polar(told_values, *effect.polar, place, sized);
        } else {
            for (std::size_t p = 0; p < effect.parameters.size(); ++p) {
                if (!effect.parameters[p].linear) continue;
                told_values.term.values[p] = sized.size[0];
                told_values.values.push_back(
                    told(place, p, sized.size[0],
                         sized.widened * std::sqrt(std::max(sized.covariance(0, 0), 0.0)), sized.plain[0]));
                told_values.is_told = !holds_0(told_values.values.back());
            }
        }
        tell_scales(told_values, shape, place, sized, columns);
        put_values_in_order(told_values.values);
        put_values_in_order(told_values.ringing_values);
        told_all.push_back(std::move(told_values));
        size += static_cast<std::size_t>(columns);
    }
    return told_all;
}

std::vector<double> torque_of(const BesideValues& values, const Model& beside, const Motion& motion) {
    if (!values.ringing) return Prediction(beside, motion).added(values.term);
    Model with = beside;
    with.terms.push_back(*values.ringing);
    return Prediction(with, motion).added(values.term);
}

}  // namespace ripplenotch
