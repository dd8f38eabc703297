// SPDX-License-Identifier: MIT
#include <Eigen/Sparse>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <span>
#include <vector>

#include "core/matrices/linear_algebra.hpp"
#include "ripplenotch/analysis/order_track.hpp"
#include "ripplenotch/analysis/sweeps.hpp"
#include "ripplenotch/analysis/vold_kalman.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {

namespace {

// The equations of the Vold-Kalman filter for one run of samples: envelopes on an even grid of points.

struct EnvelopeSettings {
    double samples_per_point = 1.0;
    double step_s = 0.0;  ///< between points
    int poles = 2;        ///< order of the differences that are kept small
    double weight = 0.0;  ///< r of those differences
    bool trend = true;
    double trend_weight = 0.0;         ///< r of the trend's differences
    std::size_t overlap_points = 400;  ///< sections of a long run share so many with each neighbour
};

struct EnvelopeGrid {
    double start_s = 0.0, step_s = 0.0;
    std::size_t points = 0;
};

/// Components are cosine and minus sine of line 0, of line 1, ..., then the trend.
struct Envelopes {
    EnvelopeGrid grid;
    std::vector<std::vector<double>> value;  ///< per component and point

    /// Between points along a straight line.
    [[nodiscard]] double at(std::size_t component, double time_s) const;
};

/// The response of the equations of an envelope to a signal of a single line, the data at their mean.
struct EnvelopeResponse {
    Hertz bandwidth;  ///< -3 dB width in the middle of the run, both sides together
    /// Standard error of an amplitude per unit of rms noise on the samples, by the distance to an end of the
    /// run in points; the last entry holds beyond.
    std::vector<double> error_factors;
    double freedom_per_sample = 0.0;  ///< degrees of freedom that one component takes from the data
};

using Sparse = Eigen::SparseMatrix<double>;
using Factors = Eigen::SimplicialLDLT<Sparse, Eigen::Lower, Eigen::NaturalOrdering<int>>;

constexpr std::size_t section_points = 8000;  ///< without overlap
/// Regularization towards 0 relative to a sample's own weight: decides only where samples carry no
/// information, as at standstill.
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
                "the Vold-Kalman equations of this log have no unique solution: lines that coincide, or too "
                "few samples; leave lines out or use a wider bandwidth");
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

/// The equations of one line that is alone: each sample of its shaft's turning counts half on average.
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

// Solved in sections of at most some thousand points that overlap by settings.overlap_points, so that memory
// stays bounded; the overlap is long enough for their ends not to matter.
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

// Response of the envelope in a run of `duration_s`.
EnvelopeResponse envelope_response(EnvelopeSettings settings, double duration_s, Hertz asked_bandwidth) {
    // Twice the overlap: from there on a longer run changes nothing in its middle.
    const double wanted = std::ceil(duration_s / settings.step_s) + 1.0;
    const auto points =
        static_cast<Eigen::Index>(std::min(wanted, 2.0 * static_cast<double>(settings.overlap_points) + 1.0));
    settings.trend = false;
    const Section section = lone_line(static_cast<std::size_t>(points), settings.samples_per_point);
    const Sparse data = section.data();
    const Factors solver(section.equations(settings));
    // The weights from samples to a point, and back to samples, straight lines between points included.
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

constexpr double points_per_width = 40.0;  ///< points of the envelope in 1/bandwidth
constexpr double rows_per_width = 8.0;     // chosen, not derived
constexpr double shortest_run = 1.5;       ///< in 1/bandwidth
constexpr double widest_share = 0.25;      ///< share of the sample rate
constexpr double worst_condition = 1e13;   // rounding shows in the third digit (docs/theory.md)
constexpr double trend_widths = 4.0;       ///< the trend's bandwidth over a line's
constexpr double close_share = 0.5;        ///< lines closer than this share of the bandwidth ...
constexpr std::size_t near_widths = 8;     ///< ... for most of so many times 1/bandwidth are one
/// Cycles of a line within 1/bandwidth, or it cannot be separated from its mirror image.
constexpr double fewest_cycles = 1.0;

void check_rule(const TrackedSignal& signal, const VoldKalmanRule& rule) {
    if (signal.lines.empty()) raise<UsageError>("there is no order to track");
    for (const TrackedLine& line : signal.lines) {
        if (!(line.order > 0.0)) raise<UsageError>("order {} is not above 0", shortest(line.order));
    }
    const double rate = signal.sample_rate.value(), width = rule.bandwidth.value();
    if (!(width > 0.0) || width > widest_share * rate) {
        raise<UsageError>(
            "a bandwidth of {} Hz is not above 0 and at most a quarter of the sample rate, {:.6g} Hz",
            shortest(width), rate);
    }
}

/// True at the points around which a line turns by fewer than `fewest` cycles within `width` points.
std::vector<bool> stands(const std::vector<double>& cycles, std::size_t width, double fewest) {
    std::vector<double> travelled(cycles.size(), 0.0);
    for (std::size_t j = 1; j < cycles.size(); ++j) {
        travelled[j] = travelled[j - 1] + std::abs(cycles[j] - cycles[j - 1]);
    }
    std::vector<bool> still(cycles.size());
    for (std::size_t j = 0; j < cycles.size(); ++j) {
        const std::size_t from = std::min(j > width / 2 ? j - width / 2 : 0, cycles.size() - 1 - width);
        still[j] = travelled[from + width] - travelled[from] < fewest;
    }
    return still;
}

/// True at the points around which two lines stay together. They may cross: their values before and after
/// separate them in between.
std::vector<bool> stay_together(const std::vector<double>& apart_cycles, std::size_t width) {
    const std::size_t n = apart_cycles.size(), reach = std::max<std::size_t>(1, width / 16);
    std::vector<std::size_t> near(n + 1, 0);  // how many points before this one are near
    for (std::size_t j = 0; j < n; ++j) {
        const std::size_t from = j > reach ? j - reach : 0, to = std::min(j + reach, n - 1);
        const double rate = std::abs(apart_cycles[to] - apart_cycles[from]) / static_cast<double>(to - from);
        near[j + 1] = near[j] + (rate * static_cast<double>(width) < close_share ? 1 : 0);
    }
    const std::size_t window = std::min(near_widths * width, n);
    std::vector<bool> together(n);
    for (std::size_t j = 0; j < n; ++j) {
        const std::size_t from = std::min(j > window / 2 ? j - window / 2 : 0, n - window);
        together[j] = 2 * (near[from + window] - near[from]) > window;
    }
    return together;
}

/// Per line and point: true where it cannot be distinguished from the trend or from another line. `cycles`:
/// turns of each line at the points of one grid, at least `width` + 1 of them. `width`: points in
/// 1/bandwidth. `fewest`: cycles of a line within them, below which it is one with the trend or its own
/// mirror image.
std::vector<std::vector<bool>> not_separable(const std::vector<std::vector<double>>& cycles,
                                             std::size_t width, double fewest) {
    std::vector<std::vector<bool>> unknown;
    for (const auto& line : cycles) unknown.push_back(stands(line, width, fewest));
    for (std::size_t i = 0; i < cycles.size(); ++i) {
        for (std::size_t other = 0; other < i; ++other) {
            for (const double sign : {-1.0, 1.0}) {  // a real line is a pair of turning ones
                std::vector<double> between(cycles[i]);
                for (std::size_t j = 0; j < between.size(); ++j) between[j] += sign * cycles[other][j];
                const auto still = stay_together(between, width);
                for (std::size_t j = 0; j < still.size(); ++j) {
                    if (still[j]) unknown[i][j] = unknown[other][j] = true;
                }
            }
        }
    }
    return unknown;
}

/// Where the cycles that a line has turned, against nothing or against another one, stand at each point.
std::vector<double> cycles_at_points(const EnvelopeGrid& grid, std::span<const double> time_s,
                                     std::span<const double> cycles) {
    std::vector<double> at(grid.points);
    std::size_t k = 0;
    for (std::size_t j = 0; j < grid.points; ++j) {
        const double t = grid.start_s + grid.step_s * static_cast<double>(j);
        while (k + 2 < time_s.size() && time_s[k + 1] < t) ++k;
        const double span = time_s[k + 1] - time_s[k];
        const double share = span > 0.0 ? std::clamp((t - time_s[k]) / span, 0.0, 1.0) : 0.0;
        at[j] = cycles[k] + share * (cycles[k + 1] - cycles[k]);
    }
    return at;
}

/// One run: solved, written into the per-sample results, its rows appended.
class RunTracker {
  public:
    RunTracker(const TrackedSignal& signal, const SampleRun& run, const EnvelopeSettings& settings)
        : signal_(signal),
          run_(run),
          time_s_(signal.time_s.subspan(run.first, run.size())),
          settings_(settings),
          grid_(make_grid(time_s_, settings.step_s)),
          envelopes_(solve_envelopes(signal, run, grid_, settings)) {}

    /// Returns the sum of squares of the residual.
    double write_samples(VoldKalmanTracks& result) const {
        double squares = 0.0;
        for (std::size_t k = 0; k < run_.size(); ++k) {
            const std::size_t at = run_.first + k;
            double left = signal_.torque_nm[at];
            for (std::size_t i = 0; i < signal_.lines.size(); ++i) {
                const TrackedLine& line = signal_.lines[i];
                const double angle = 2.0 * std::numbers::pi * line.order * line.turns[at];
                const std::complex<double> phasor = portable::phasor(angle);
                const double value = envelopes_.at(2 * i, time_s_[k]) * phasor.real() -
                                     envelopes_.at(2 * i + 1, time_s_[k]) * phasor.imag();
                result.waveform_nm[i][at] = value;
                left -= value;
            }
            const double trend = settings_.trend ? envelopes_.at(2 * signal_.lines.size(), time_s_[k]) : 0.0;
            result.trend_nm[at] = trend;
            squares += (left - trend) * (left - trend);
        }
        return squares;
    }

    /// `error_factor` by the distance, in points, to the nearer end of the run.
    void add_rows(OrderTracks& tracks, std::size_t stride, std::size_t width,
                  const std::vector<double>& error_factor) const {
        const std::size_t lines = signal_.lines.size();
        std::vector<std::vector<double>> cycles(lines);
        for (std::size_t i = 0; i < lines; ++i) cycles[i] = line_cycles(signal_.lines[i]);
        const auto unknown = not_separable(cycles, width, settings_.trend ? trend_widths : fewest_cycles);
        const double end = time_s_.back();
        for (std::size_t j = 0; j < grid_.points; j += stride) {
            const double t = grid_.start_s + grid_.step_s * static_cast<double>(j);
            if (t > end) break;
            const auto is_unknown = [&](const std::vector<bool>& line) { return line[j]; };
            if (std::any_of(unknown.begin(), unknown.end(), is_unknown)) ++tracks.rows_not_separable;
            if (std::all_of(unknown.begin(), unknown.end(), is_unknown)) continue;
            tracks.time_s.push_back(t);
            tracks.speed_deg_s.push_back(signal_.speed_deg_s[run_.first + nearest(t)]);
            const std::size_t from_end = std::min(j, grid_.points - 1 - j);
            const double error = error_factor[std::min(from_end, error_factor.size() - 1)];
            bool folded = false;
            for (std::size_t i = 0; i < lines; ++i) {
                const double hz = rate_at(cycles[i], j, width);
                folded = folded || hz > 0.5 * signal_.sample_rate.value();
                add_value(tracks.lines[i], i, j, hz, error, unknown[i][j]);
            }
            tracks.rows_folded += folded ? 1 : 0;
        }
    }

  private:
    [[nodiscard]] std::vector<double> line_cycles(const TrackedLine& line) const {
        std::vector<double> turned(run_.size());
        for (std::size_t k = 0; k < run_.size(); ++k) turned[k] = line.order * line.turns[run_.first + k];
        return cycles_at_points(grid_, time_s_, turned);
    }

    [[nodiscard]] double rate_at(const std::vector<double>& cycles, std::size_t j, std::size_t width) const {
        const std::size_t reach = std::max<std::size_t>(1, width / 16);
        const std::size_t from = j > reach ? j - reach : 0, to = std::min(j + reach, grid_.points - 1);
        return std::abs(cycles[to] - cycles[from]) / (grid_.step_s * static_cast<double>(to - from));
    }

    [[nodiscard]] std::size_t nearest(double t) const {
        const auto found = std::lower_bound(time_s_.begin(), time_s_.end(), t);
        return std::min(static_cast<std::size_t>(found - time_s_.begin()), time_s_.size() - 1);
    }

    void add_value(LineTrack& track, std::size_t line, std::size_t point, double hz, double error,
                   bool unknown) const {
        const double a = envelopes_.value[2 * line][point], b = envelopes_.value[2 * line + 1][point];
        track.amplitude_nm.push_back(unknown ? not_a_number : portable::hypot(a, b));
        track.phase_deg.push_back(unknown ? not_a_number : portable::atan2(b, a) * degrees_per_radian);
        track.standard_error_nm.push_back(unknown ? not_a_number : error);
        track.hz.push_back(hz);
    }

    const TrackedSignal& signal_;
    SampleRun run_;
    std::span<const double> time_s_;
    EnvelopeSettings settings_;
    EnvelopeGrid grid_;
    Envelopes envelopes_;
};

EnvelopeSettings settings_of(const TrackedSignal& signal, const VoldKalmanRule& rule) {
    const double rate = signal.sample_rate.value(), width = rule.bandwidth.value();
    const double automatic = std::max(1.0, std::floor(rate / (points_per_width * width)));
    EnvelopeSettings settings;
    settings.samples_per_point =
        rule.samples_per_point > 0 ? static_cast<double>(rule.samples_per_point) : automatic;
    settings.step_s = settings.samples_per_point / rate;
    settings.poles = rule.poles;
    settings.weight = vold_kalman_weight(width * settings.step_s, rule.poles);
    settings.trend = rule.trend;
    if (rule.trend) {
        settings.trend_weight =
            vold_kalman_weight(std::min(0.9, trend_widths * width * settings.step_s), rule.poles);
    }
    settings.overlap_points = static_cast<std::size_t>(std::ceil(10.0 / (width * settings.step_s)));
    return settings;
}

std::vector<SampleRun> long_runs(const TrackedSignal& signal, const VoldKalmanRule& rule,
                                 std::size_t& too_short) {
    const double needed = shortest_run / rule.bandwidth.value();
    double longest = 0.0;
    std::vector<SampleRun> runs;
    for (const SampleRun& run : whole_runs(signal.time_s.size(), signal.run_starts)) {
        const double duration = signal.time_s[run.end - 1] - signal.time_s[run.first];
        longest = std::max(longest, duration);
        if (duration >= needed) {
            runs.push_back(run);
        } else {
            ++too_short;
        }
    }
    if (runs.empty()) {
        const double widest = widest_share * signal.sample_rate.value();
        const double enough = 1.05 * shortest_run / std::max(longest, 1e-12);
        raise<DataError>(
            "a bandwidth of {} Hz needs {:.3g} s of torque without a gap, the longest run has {:.3g} s; use "
            "{}",
            shortest(rule.bandwidth.value()), needed, longest,
            enough < widest
                ? fmt::format("a bandwidth of at least {:.2g} Hz, or least squares (--method ls)", enough)
                : "least squares (--method ls)");
    }
    return runs;
}

}  // namespace

double vold_kalman_weight(double bandwidth_share, int poles) {
    if (poles < 1 || poles > 4) raise<UsageError>("a Vold-Kalman filter has 1 to 4 poles, not {}", poles);
    if (!(bandwidth_share > 0.0) || !(bandwidth_share < 1.0)) {
        raise<UsageError>("a bandwidth of {} times the sample rate is not between 0 and 1",
                          shortest(bandwidth_share));
    }
    const double gain = std::sqrt(std::numbers::sqrt2 - 1.0);
    const double weight =
        gain / portable::pow(2.0 * portable::sin(0.5 * std::numbers::pi * bandwidth_share), poles);
    const double condition = 1.0 + portable::pow(4.0, poles) * weight * weight;
    if (condition > worst_condition) {
        const double narrowest_sine =
            0.5 * portable::pow(gain * portable::pow(2.0, poles) / std::sqrt(worst_condition), 1.0 / poles);
        raise<UsageError>(
            "a bandwidth of {} times the sample rate with {} poles makes the equations ill-conditioned "
            "({:.1g}); use at least {:.2g} times the sample rate, or fewer poles",
            shortest(bandwidth_share), poles, condition,
            1.01 * 2.0 * portable::asin(narrowest_sine) / std::numbers::pi);
    }
    return weight;
}

VoldKalmanTracks track_vold_kalman(const TrackedSignal& signal, const VoldKalmanRule& rule) {
    check_rule(signal, rule);
    const EnvelopeSettings settings = settings_of(signal, rule);
    VoldKalmanTracks result;
    const std::vector<SampleRun> runs = long_runs(signal, rule, result.runs_too_short);
    result.envelope_step = Seconds(settings.step_s);
    result.waveform_nm.assign(signal.lines.size(), std::vector<double>(signal.time_s.size(), not_a_number));
    result.trend_nm.assign(signal.time_s.size(), not_a_number);
    result.tracks.lines.resize(signal.lines.size());

    std::vector<RunTracker> trackers;
    double squares = 0.0, longest_s = 0.0;
    std::size_t samples = 0;
    for (const SampleRun& run : runs) {
        trackers.emplace_back(signal, run, settings);
        squares += trackers.back().write_samples(result);
        samples += run.size();
        longest_s = std::max(longest_s, signal.time_s[run.end - 1] - signal.time_s[run.first]);
    }
    EnvelopeResponse alone = envelope_response(settings, longest_s, rule.bandwidth);
    const double unknowns = static_cast<double>(2 * signal.lines.size()) + (rule.trend ? trend_widths : 0.0);
    const double freedom =
        static_cast<double>(samples) * (1.0 - std::min(0.9, unknowns * alone.freedom_per_sample));
    result.tracks.residual_rms_nm = std::sqrt(squares / freedom);
    result.bandwidth = alone.bandwidth;
    for (double& error : alone.error_factors) error *= result.tracks.residual_rms_nm;
    const double width_points = 1.0 / (rule.bandwidth.value() * settings.step_s);
    const double rows = rule.rows_per_second.value() > 0.0 ? rule.rows_per_second.value()
                                                           : rows_per_width * rule.bandwidth.value();
    const auto stride = static_cast<std::size_t>(std::max(1.0, std::round(1.0 / (rows * settings.step_s))));
    for (const RunTracker& tracker : trackers) {
        tracker.add_rows(result.tracks, stride, static_cast<std::size_t>(std::ceil(width_points)),
                         alone.error_factors);
    }
    return result;
}

}  // namespace ripplenotch
