// SPDX-License-Identifier: MIT
#include "analysis/track/envelope_solver.hpp"

#include <Eigen/Sparse>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "core/matrices/linear_algebra.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/phasor.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

using Sparse = Eigen::SparseMatrix<double>;
using Factors = Eigen::SimplicialLDLT<Sparse, Eigen::Lower, Eigen::NaturalOrdering<int>>;

constexpr std::size_t section_points = 8000;  ///< without overlap
/// Pull towards 0 against a sample's own weight: decides only what no sample says, as where the joint rests.
constexpr double ridge = 1e-9;

/// Differences of order 1 to 4 as they act on neighbouring points.
std::vector<double> difference_row(int order) {
    std::vector<double> row{1.0};
    for (int i = 0; i < order; ++i) {
        row.push_back(0.0);
        for (std::size_t j = row.size() - 1; j > 0; --j) row[j] -= row[j - 1];
    }
    return row;
}

/// Normal equations of one section. Unknown number point * components + component, so that the matrix is a
/// narrow band and the natural order fills it least.
class Section {
  public:
    Section(std::size_t points, std::size_t components)
        : components_(components),
          same_(points, Eigen::MatrixXd::Zero(count(), count())),
          next_(points, Eigen::MatrixXd::Zero(count(), count())),
          right_(Eigen::VectorXd::Zero(static_cast<Eigen::Index>(points * components))) {}

    /// A sample between `point` and the next, at `share` of the way.
    void add_sample(std::size_t point, double share, const Eigen::VectorXd& row, double torque) {
        const double before = 1.0 - share;
        product_.noalias() = row * row.transpose();
        const auto place = static_cast<Eigen::Index>(point) * count();
        same_[point] += before * before * product_;
        right_.segment(place, count()) += before * torque * row;
        if (share == 0.0) return;
        next_[point] += before * share * product_;
        same_[point + 1] += share * share * product_;
        right_.segment(place + count(), count()) += share * torque * row;
    }

    /// Half of the normal equations of the samples, the lower one.
    [[nodiscard]] Sparse data() const {
        std::vector<Eigen::Triplet<double>> entries;
        for (std::size_t j = 0; j < same_.size(); ++j) {
            const auto place = static_cast<Eigen::Index>(j) * count();
            for (Eigen::Index c = 0; c < count(); ++c) {
                for (Eigen::Index d = 0; d < count(); ++d) {
                    if (d <= c) push(entries, place + c, place + d, same_[j](c, d));
                    if (j + 1 < same_.size()) push(entries, place + count() + c, place + d, next_[j](c, d));
                }
            }
        }
        return lower_half(entries);
    }

    /// The same with smoothness and ridge.
    [[nodiscard]] Sparse equations(const EnvelopeSettings& settings) const {
        const std::vector<double> row = difference_row(settings.poles);
        std::vector<Eigen::Triplet<double>> entries;
        for (Eigen::Index i = 0; i < right_.size(); ++i)
            push(entries, i, i, ridge * settings.samples_per_point);
        for (std::size_t j = 0; j + row.size() <= same_.size(); ++j) {
            for (std::size_t c = 0; c < components_; ++c) {
                const bool trend = settings.trend && c + 1 == components_;
                const double weight =
                    settings.samples_per_point * (trend ? settings.trend_weight * settings.trend_weight
                                                        : 0.5 * settings.weight * settings.weight);
                for (std::size_t a = 0; a < row.size(); ++a) {
                    for (std::size_t b = 0; b <= a; ++b) {
                        push(entries, static_cast<Eigen::Index>((j + a) * components_ + c),
                             static_cast<Eigen::Index>((j + b) * components_ + c), weight * row[a] * row[b]);
                    }
                }
            }
        }
        return data() + lower_half(entries);
    }

    [[nodiscard]] Eigen::VectorXd solve(const EnvelopeSettings& settings) const {
        const Factors solver(equations(settings));
        const Eigen::VectorXd found = solver.solve(right_);
        if (solver.info() != Eigen::Success || !found.allFinite()) {
            raise<DataError>(
                "the Vold-Kalman equations of this log have no unique solution: lines that are alike, or "
                "too few samples; leave lines out or use a wider bandwidth");
        }
        return found;
    }

  private:
    [[nodiscard]] Eigen::Index count() const { return static_cast<Eigen::Index>(components_); }

    [[nodiscard]] Sparse lower_half(const std::vector<Eigen::Triplet<double>>& entries) const {
        Sparse matrix(right_.size(), right_.size());
        matrix.setFromTriplets(entries.begin(), entries.end());
        return matrix;
    }

    static void push(std::vector<Eigen::Triplet<double>>& entries, Eigen::Index i, Eigen::Index j,
                     double value) {
        entries.emplace_back(static_cast<int>(i), static_cast<int>(j), value);
    }

    std::size_t components_;
    std::vector<Eigen::MatrixXd> same_, next_;
    Eigen::VectorXd right_;
    Eigen::MatrixXd product_;
};

/// Regressors of one sample: cosine and minus sine of each line, 1 for the trend.
void fill_row(const TrackedSignal& signal, std::size_t sample, bool trend, Eigen::VectorXd& row) {
    for (std::size_t i = 0; i < signal.lines.size(); ++i) {
        const double angle = 2.0 * std::numbers::pi * signal.lines[i].order * signal.lines[i].turns[sample];
        const std::complex<double> phasor = portable::phasor(angle);
        row[static_cast<Eigen::Index>(2 * i)] = phasor.real();
        row[static_cast<Eigen::Index>(2 * i + 1)] = -phasor.imag();
    }
    if (trend) row[row.size() - 1] = 1.0;
}

/// The equations of one line that is alone: each sample of its shaft's turning counts half, in the mean.
Section lone_line(std::size_t points, double samples_per_point) {
    Section section(points, 1);
    const Eigen::VectorXd row = Eigen::VectorXd::Constant(1, std::sqrt(0.5));
    for (std::size_t point = 0; point < points; ++point) {
        for (double sample = 0.0; sample < samples_per_point; sample += 1.0)
            if (point + 1 < points || sample == 0.0)
                section.add_sample(point, sample / samples_per_point, row, 0.0);
    }
    return section;
}

/// |sum of values times a rotation of `turn` a point|.
double envelope_gain(const Eigen::VectorXd& values, double turn) {
    std::complex<double> sum;
    for (Eigen::Index j = 0; j < values.size(); ++j)
        sum += values[j] * portable::polar(1.0, turn * static_cast<double>(j));
    return std::abs(sum);
}

/// First turn a point at which the gain falls to 1 / sqrt 2, searched upwards from 0.
double half_width(const Eigen::VectorXd& values, double about) {
    const double level = 1.0 / std::numbers::sqrt2;
    double below = 0.0, above = 0.0;
    do {
        below = above;
        above += 0.05 * about;
    } while (above < std::numbers::pi && envelope_gain(values, above) > level);
    for (int i = 0; i < 50; ++i) {
        const double middle = 0.5 * (below + above);
        (envelope_gain(values, middle) > level ? below : above) = middle;
    }
    return 0.5 * (below + above);
}

struct Place {
    std::size_t point = 0;
    double share = 0.0;
};

Place place_of(const EnvelopeGrid& grid, double time_s) {
    const double at = std::max(0.0, (time_s - grid.start_s) / grid.step_s);
    const auto point = std::min(static_cast<std::size_t>(at), grid.points - 1);
    const double share = at - static_cast<double>(point);
    // Within a rounding error of a point: a regular clock at one sample a point has no second neighbour.
    if (share < 1e-6 || point + 1 == grid.points) return {point, 0.0};
    if (share > 1.0 - 1e-6) return {point + 1, 0.0};
    return {point, share};
}

}  // namespace

EnvelopeGrid make_grid(std::span<const double> time_s, double step_s) {
    const double steps = (time_s.back() - time_s.front()) / step_s;
    return {time_s.front(), step_s, static_cast<std::size_t>(std::ceil(steps - 1e-6)) + 1};
}

double Envelopes::at(std::size_t component, double time_s) const {
    const Place place = place_of(grid, time_s);
    const auto& values = value[component];
    if (place.share == 0.0) return values[place.point];
    return (1.0 - place.share) * values[place.point] + place.share * values[place.point + 1];
}

Envelopes solve_envelopes(const TrackedSignal& signal, const SampleRun& run, const EnvelopeGrid& grid,
                          const EnvelopeSettings& settings) {
    const std::size_t components = 2 * signal.lines.size() + (settings.trend ? 1 : 0);
    Envelopes envelopes{grid,
                        std::vector<std::vector<double>>(components, std::vector<double>(grid.points, 0.0))};
    Eigen::VectorXd row(static_cast<Eigen::Index>(components));
    std::size_t sample = run.first;  // first sample at or after the section's first point
    for (std::size_t core = 0; core < grid.points; core += section_points) {
        const std::size_t core_end = std::min(core + section_points, grid.points);
        const std::size_t first = core > settings.overlap_points ? core - settings.overlap_points : 0;
        const std::size_t end = std::min(core_end + settings.overlap_points, grid.points);
        Section section(end - first, components);
        while (sample > run.first && place_of(grid, signal.time_s[sample - 1]).point >= first) --sample;
        for (; sample < run.end; ++sample) {
            const Place place = place_of(grid, signal.time_s[sample]);
            if (place.point < first) continue;
            if (place.point >= end || (place.share > 0.0 && place.point + 1 >= end)) break;
            fill_row(signal, sample, settings.trend, row);
            section.add_sample(place.point - first, place.share, row, signal.torque_nm[sample]);
        }
        const Eigen::VectorXd found = section.solve(settings);
        for (std::size_t j = core; j < core_end; ++j) {
            for (std::size_t c = 0; c < components; ++c) {
                envelopes.value[c][j] = found[static_cast<Eigen::Index>((j - first) * components + c)];
            }
        }
    }
    return envelopes;
}

EnvelopeResponse envelope_response(EnvelopeSettings settings, double duration_s, Hertz asked_bandwidth) {
    // Twice the overlap: from there on a longer run changes nothing in its middle.
    const double wanted = std::ceil(duration_s / settings.step_s) + 1.0;
    const auto points =
        static_cast<Eigen::Index>(std::min(wanted, 2.0 * static_cast<double>(settings.overlap_points) + 1.0));
    settings.trend = false;
    const Section section = lone_line(static_cast<std::size_t>(points), settings.samples_per_point);
    const Sparse data = section.data();
    const Factors solver(section.equations(settings));
    // What a point makes of samples, and how samples see that, straight lines between points included.
    const auto kernel_of = [&](Eigen::Index point) {
        Eigen::VectorXd unit = Eigen::VectorXd::Zero(points);
        unit[point] = 0.5 * settings.samples_per_point;
        return Eigen::VectorXd(solver.solve(unit));
    };
    const auto seen = [&](const Eigen::VectorXd& kernel) {
        return Eigen::VectorXd(data.selfadjointView<Eigen::Lower>() * kernel /
                               (0.5 * settings.samples_per_point));
    };
    EnvelopeResponse response;
    const Eigen::VectorXd middle = kernel_of(points / 2);
    const double about = std::numbers::pi * asked_bandwidth.value() * settings.step_s;
    response.bandwidth = Hertz(half_width(seen(middle), about) / (std::numbers::pi * settings.step_s));
    response.freedom_per_sample = seen(middle)[points / 2] / settings.samples_per_point;
    const Eigen::Index ends = std::min<Eigen::Index>(
        points / 2, static_cast<Eigen::Index>(2.0 / (asked_bandwidth.value() * settings.step_s)));
    for (Eigen::Index j = 0; j <= ends; ++j) {
        const Eigen::VectorXd kernel = j == ends ? middle : kernel_of(j);
        response.error_factors.push_back(
            std::sqrt(2.0 / settings.samples_per_point * kernel.dot(seen(kernel))));
    }
    return response;
}

}  // namespace ripplenotch
