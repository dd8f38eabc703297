// SPDX-License-Identifier: MIT
#include "analysis/lines/line_scan.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "analysis/spectrum/running_median.hpp"
#include "core/functions/many_numbers.hpp"
#include "core/matrices/factorisations.hpp"
#include "core/process/two_cores.hpp"
#include "ripplenotch/analysis/stretches.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

constexpr double cycles_of_lowest = 5.0;     // in the longest sweep: fewer are the motion as well
constexpr double cycles_beside_trend = 3.0;  // in a sweep that counts: its trend follows up to one
// In a sweep in motion: slower tones are those of the motion.
constexpr double cycles_of_motion = 12.0;
constexpr double top_of_rate = 0.4;  // of the sample rate: an anti-alias filter leaves little above
// Orders above half the sample rate have images below, from which a sweep distinguishes them whose speed
// spreads one frequency so far. Up to here of the rate: the images of slow noise are above.
constexpr double distinct_cells = 2.5, top_folded_of_rate = 0.75;
constexpr double corner_s = 0.01;   // chosen, not derived: corners of the motion are no sharper in a torque
constexpr double step_cells = 0.3;  // of the sums, in 1 / longest sweep
constexpr double wide_cells = 20.0, near_cells = 5.0;
constexpr double humps_share = 0.05;    // of the places: chosen, not derived
constexpr double highest_hump = 4.6;    // ln 100
constexpr double own_cells = 1.5;       // to either side of a line, its own width, are no noise
constexpr double again_evidence = 4.6;  // -ln 0.01: what sweeps other than the best one must reach
constexpr double level_cells = 30.0;    // over which scores that are high everywhere are no lines
constexpr double same_line_cells = 2.5;
constexpr double cycles_with_course = 15.0;  // from so many in a sweep on an amplitude may change within it

/// -ln of the probability that the sum of n variables of Exp(1) exceeds s.
double tail_of_sum(double s, double n) {
    if (s <= n || n < 0.5) return 0.0;
    double term = 1.0, sum = 1.0;
    for (double j = n - 1.0; j > 0.5 && term > 1e-9 * sum; j -= 1.0) {
        term *= j / s;
        sum += term;
    }
    return s - (n - 1.0) * portable::log(s) + portable::lgamma(n) - portable::log(sum);
}

/// -ln of the survival of F(2, 2 m) at power over noise x: Exp(1) without a line although the noise is an
/// estimate.
double score_of(double x, double m) { return m * portable::log1p(x / m); }

/// Running median of odd width, the ends mirrored.
std::vector<double> running_median(std::span<const double> x, std::size_t width) {
    const std::size_t n = x.size(), half = std::min(width / 2, n - 1);
    std::vector<double> padded;
    padded.reserve(n + 2 * half);
    for (std::size_t i = half; i-- > 0;) padded.push_back(x[i]);
    padded.insert(padded.end(), x.begin(), x.end());
    for (std::size_t i = 0; i < half; ++i) padded.push_back(x[n - 1 - i]);
    RunningMedian median(padded);
    std::vector<double> y(n);
    for (std::size_t i = 0; i < n; ++i) y[i] = median.at(i, 2 * half + 1);
    return y;
}

std::size_t odd(double width) {
    return std::max<std::size_t>(5, static_cast<std::size_t>(std::lround(width))) / 2 * 2 + 1;
}

/// Value between the entries, which are `apart`.
double between(const std::vector<double>& values, std::size_t k, std::size_t apart) {
    const std::size_t i = std::min(k / apart, values.size() - 1), next = std::min(i + 1, values.size() - 1);
    const double part = static_cast<double>(k - i * apart) / static_cast<double>(apart);
    return next == i ? values[i] : values[i] + part * (values[next] - values[i]);
}

/// Of two splines in a cycle of the smooth part.
std::size_t splines_of(double length, double smooth) {
    return std::max<std::size_t>(5, static_cast<std::size_t>(length * smooth / cycles_of_lowest * 2.0) + 4);
}

/// The speed that nine of ten rows keep below.
double quick_of(std::span<const double> speed) {
    std::vector<double> sizes;
    for (const double v : speed) sizes.push_back(std::abs(v));
    const auto at = sizes.begin() + std::ssize(sizes) * 9 / 10;
    std::nth_element(sizes.begin(), at, sizes.end());
    return *at;
}

/// Adds cosine and sine of a line.
void add_wave(const Sweep& sweep, const KnownLine& line, std::vector<std::vector<double>>& columns) {
    const auto where = places(sweep, line.axis);
    std::vector<double> angle(where.size());
    for (std::size_t k = 0; k < where.size(); ++k) angle[k] = full_turn * line.place * where[k];
    std::vector<double> cosine(angle.size()), sine(angle.size());
    portable::phasors(angle, cosine, sine);
    columns.push_back(std::move(cosine));
    columns.push_back(std::move(sine));
}

std::vector<double> scaled(std::span<const double> values) {
    double most = 1e-300;
    for (const double v : values) most = std::max(most, std::abs(v));
    std::vector<double> part(values.begin(), values.end());
    for (double& v : part) v /= most;
    return part;
}

}  // namespace

LineScan::LineScan(std::span<const Sweep> sweeps, std::span<const TraceView> logs, Axis axis, ScanRange range)
    : axis_(axis) {
    double top = 0.0;
    for (const Sweep& sweep : sweeps) {
        if (axis == Axis::angle && sweep.rest()) continue;
        const std::size_t n = sweep.turns.size();
        Sweep copy = sweep;
        Piece piece;
        copy.torque_nm.assign(sweep.measured_nm.begin(), sweep.measured_nm.end());
        if (axis == Axis::time && !sweep.rest()) {  // its window is one over time then
            copy.length_turns = 0.0;
            copy.share_turns.assign(n, 1.0 / sweep.rate_hz);
        }
        copy = part_of(copy, 0, n);
        copy.first = sweep.first;
        if (!(copy.weight_sum > 0.0)) continue;
        const auto place = places(copy, axis);
        const auto [from, to] = std::minmax_element(place.begin(), place.end());
        piece.start = *from;
        piece.length = *to - *from;
        piece.forward = place.back() > place.front();
        piece.bottom =
            (axis == Axis::time && !sweep.rest() ? cycles_of_motion : cycles_beside_trend) / piece.length;
        const double rate =
            sweep.rate_hz * (axis == Axis::angle ? 360.0 / std::max(quick_of(sweep.speed_deg_s), 1e-9) : 1.0);
        piece.top = top_of_rate * rate;
        if (axis == Axis::angle) {
            const double spread = (sweep.quick_deg_s - sweep.slow_deg_s) / std::abs(sweep.mean_deg_s);
            piece.folded_from = std::max(piece.top, distinct_cells / std::max(1e-9, spread * piece.length));
            piece.folded_to =
                std::min(range.highest_folded, top_folded_of_rate * sweep.rate_hz * 360.0 / sweep.fast_deg_s);
        }
        if (axis == Axis::time) piece.origin = logs[sweep.log].time_s[sweep.first] - sweep.time_s.front();
        if (!sweep.rest()) {
            piece.speed = scaled(sweep.speed_deg_s);
            std::vector<double> bend(n);
            for (std::size_t k = 0; k < n; ++k)
                bend[k] = sweep.speed_deg_s[std::min(k + 1, n - 1)] - sweep.speed_deg_s[k > 0 ? k - 1 : 0];
            piece.bend = scaled(bend);
            // Of the velocity as it is: a corner of the motion is sharper than the smoothed speed.
            const auto quick = moving_mean(logs[sweep.log].velocity_deg_s,
                                           static_cast<std::size_t>(corner_s * sweep.rate_hz) | 1U);
            for (std::size_t k = 0; k < n; ++k) {
                const std::size_t at = sweep.first + k;
                bend[k] = quick[std::min(at + 1, quick.size() - 1)] - quick[at > 0 ? at - 1 : 0];
            }
            piece.corner = scaled(bend);
        }
        longest_ = std::max(longest_, piece.length);
        top = std::max({top, piece.top, piece.folded_from < piece.folded_to ? piece.folded_to : 0.0});
        pieces_.push_back(std::move(piece));
        sweeps_.push_back(std::move(copy));
    }
    if (pieces_.empty()) return;
    std::vector<double> lengths;
    for (const Piece& piece : pieces_) lengths.push_back(piece.length);
    const auto quarter = lengths.begin() + std::ssize(lengths) / 4;
    std::nth_element(lengths.begin(), quarter, lengths.end());
    usual_ = *quarter;
    highest_ = std::min(range.highest, top);
    lowest_ = std::max(range.lowest, cycles_of_lowest / longest_);
    if (!(highest_ > lowest_)) return;
    everywhere_.top = 1e300;
    everywhere_.length = longest_;
    step_ = step_cells / longest_;
    first_bin_ = static_cast<std::size_t>(std::ceil(1.0 / step_cells));
    first_ = static_cast<double>(first_bin_) * step_;
    count_ = static_cast<std::size_t>(highest_ / step_) + 1 - first_bin_;
    for (std::size_t k = 0; k < count_; ++k) ln_place_.push_back(place(k));
    portable::log(ln_place_, ln_place_);
    const double smooth = std::max(range.smooth, cycles_of_lowest / longest_);
    on_two_cores(pieces_.size(), [&](std::size_t i) {
        pieces_[i].splines = splines_of(pieces_[i].length, std::max(smooth, pieces_[i].bottom));
        pieces_[i].in_halves = 0.5 * pieces_[i].length * lowest_ > 2.0;
        take_off(i, {});
    });
}

double LineScan::threshold(double false_alarm) const {
    return portable::log((highest_ - lowest_) * longest_ * hann_cell / false_alarm);
}

double LineScan::deviation_nm() const {
    double squares = 0.0, weights = 0.0;
    for (const Sweep& sweep : sweeps_) {
        for (std::size_t k = 0; k < sweep.torque_nm.size(); ++k) {
            squares += sweep.share_turns[k] * sweep.torque_nm[k] * sweep.torque_nm[k];
            weights += sweep.share_turns[k];
        }
    }
    return std::sqrt(squares / std::max(weights, 1e-300));
}

LineScan::Sum LineScan::largest_sum(double from, double to, const LineNoise& noise) const {
    Sum most{0.5 * (from + to)};
    for (std::size_t k = from > first_ ? static_cast<std::size_t>((from - first_) / step_) : 0;
         k < count_ && place(k) <= to; ++k) {
        if (place(k) < std::max(from, lowest_)) continue;
        double sum = 0.0;
        for (std::size_t i = 0; i < pieces_.size(); ++i)
            if (noise.power[i] > 0.0) sum += whole_[i].power[k] / noise.power[i];
        if (sum > most.gain) most = {place(k), sum};
    }
    return most;
}

double LineScan::peak_near(double place) const {
    return largest_sum(place - 1.5 / longest_, place + 1.5 / longest_, noise_at(place)).place;
}

const Sweep& LineScan::strongest_at(double place) const {
    const std::size_t k = bin_of(place);
    double most = 0.0;
    std::size_t strongest = 0;
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
        const double ratio = pieces_[i].shows(place) ? whole_[i].power[k] / whole_[i].noise.power[k] : 0.0;
        if (ratio <= most) continue;
        most = ratio;
        strongest = i;
    }
    return sweeps_[strongest];
}

std::size_t LineScan::bin_of(double place) const {
    return static_cast<std::size_t>(
        std::lround(std::clamp((place - first_) / step_, 0.0, static_cast<double>(count_ - 1))));
}

std::size_t LineScan::octave(std::size_t k) const {
    return static_cast<std::size_t>(std::ilogb(place(k) / first_));
}

LineNoise LineScan::noise_at(double place) const {
    const std::size_t k = bin_of(place);
    LineNoise noise{axis_, hann_cell / longest_, std::vector<double>(pieces_.size())};
    for (std::size_t i = 0; i < pieces_.size(); ++i)
        if (pieces_[i].shows(place)) noise.power[i] = whole_[i].noise.power[k];
    return noise;
}

Eigen::VectorXd LineScan::fit_out(std::size_t number, std::span<const std::vector<double>> line,
                                  std::span<const double> weight, std::span<double> torque_nm) const {
    const Piece& piece = pieces_[number];
    const Sweep& sweep = sweeps_[number];
    const auto place = places(sweep, axis_);
    const std::size_t n = place.size(), splines = piece.splines;
    std::vector<const double*> columns;
    if (!piece.speed.empty()) columns = {piece.speed.data(), piece.bend.data(), piece.corner.data()};
    for (const std::vector<double>& column : line) columns.push_back(column.data());
    const auto size = static_cast<Eigen::Index>(splines + columns.size());
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(size, size);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(size);
    const double scale = static_cast<double>(splines - 3) * (1.0 - 1e-9) / piece.length;
    const auto basis = [&](std::size_t k, std::array<double, 4>& b) {
        const double x = std::max(0.0, (place[k] - piece.start) * scale);
        const double i = std::min(std::floor(x), static_cast<double>(splines - 4));
        const double u = x - i, v = 1.0 - u;
        b = {v * v * v / 6.0, (3.0 * u * u * u - 6.0 * u * u + 4.0) / 6.0,
             (3.0 * v * v * v - 6.0 * v * v + 4.0) / 6.0, u * u * u / 6.0};
        return static_cast<Eigen::Index>(i);
    };
    std::array<double, 4> b{};
    std::vector<double> x(columns.size());
    const auto first_column = static_cast<Eigen::Index>(splines);
    for (std::size_t k = 0; k < n; ++k) {
        const double w = weight[k], y = w * torque_nm[k];
        const Eigen::Index at = basis(k, b);
        for (std::size_t c = 0; c < columns.size(); ++c) x[c] = columns[c][k];
        for (Eigen::Index i = 0; i < 4; ++i) {
            const double wb = w * b[static_cast<std::size_t>(i)];
            right[at + i] += y * b[static_cast<std::size_t>(i)];
            for (Eigen::Index j = 0; j <= i; ++j)
                normal(at + i, at + j) += wb * b[static_cast<std::size_t>(j)];
            for (std::size_t c = 0; c < columns.size(); ++c)
                normal(first_column + static_cast<Eigen::Index>(c), at + i) += wb * x[c];
        }
        for (std::size_t c = 0; c < columns.size(); ++c) {
            const auto row = first_column + static_cast<Eigen::Index>(c);
            right[row] += y * x[c];
            for (std::size_t d = 0; d <= c; ++d)
                normal(row, first_column + static_cast<Eigen::Index>(d)) += w * x[c] * x[d];
        }
    }
    const Eigen::VectorXd found = ScaledDefiniteFactors(normal, 1e-9).solve(right);
    for (std::size_t k = 0; k < n; ++k) {
        double sum = 0.0;
        const Eigen::Index at = basis(k, b);
        for (Eigen::Index i = 0; i < 4; ++i) sum += b[static_cast<std::size_t>(i)] * found[at + i];
        for (std::size_t c = 0; c < columns.size(); ++c)
            sum += columns[c][k] * found[first_column + static_cast<Eigen::Index>(c)];
        torque_nm[k] -= sum;
    }
    return found.tail(std::ssize(line));
}

void LineScan::take_off(std::size_t number, std::span<const std::vector<double>> line) {
    Sweep& sweep = sweeps_[number];
    fit_out(number, line, sweep.share_turns, sweep.torque_nm);
    for (std::size_t k = 0; k < sweep.value.size(); ++k)
        sweep.value[k] = sweep.weight[k] * sweep.torque_nm[k];
}

LineScan::Together LineScan::together(std::span<const KnownLine> lines) const {
    Together fit{{lines.size(), std::vector<std::complex<double>>(pieces_.size())}, sweeps_};
    on_two_cores(pieces_.size(), [&](std::size_t i) {
        std::vector<std::vector<double>> columns;
        std::vector<std::size_t> shown;
        for (std::size_t l = 0; l < lines.size(); ++l) {
            const bool turning = lines[l].axis == Axis::angle;
            if ((turning && pieces_[i].speed.empty()) ||
                (lines[l].axis == axis_ && !pieces_[i].shows(lines[l].place)))
                continue;
            shown.push_back(l);
            add_wave(sweeps_[i], lines[l], columns);
        }
        Sweep& sweep = fit.rest[i];
        sweep.torque_nm.assign(sweep.measured_nm.begin(), sweep.measured_nm.end());
        const Eigen::VectorXd parts = fit_out(i, columns, sweep.weight, sweep.torque_nm);
        for (std::size_t s = 0; s < shown.size(); ++s) {
            const auto at = static_cast<Eigen::Index>(2 * s);
            fit.nm[shown[s]][i] = {parts[at], -parts[at + 1]};
        }
    });
    return fit;
}

bool LineScan::shows(const KnownLine& line, std::span<const std::complex<double>> nm) const {
    const LineNoise noise = noise_at(line.place);
    double free = 0.0, count = 0.0, locked = 0.0, directions = 0.0;
    for (const bool forward : {true, false}) {
        std::complex<double> sum;
        double information = 0.0;
        for (std::size_t i = 0; i < pieces_.size(); ++i) {
            if (!(noise.power[i] > 0.0) || pieces_[i].forward != forward) continue;
            const double certainty = 0.25 * sweeps_[i].weight_sum * sweeps_[i].weight_sum / noise.power[i];
            free += certainty * std::norm(nm[i]);
            count += 1.0;
            sum += certainty * nm[i];
            information += certainty;
        }
        if (!(information > 0.0)) continue;
        locked += std::norm(sum) / information;
        directions += 1.0;
    }
    return std::max(tail_of_sum(free, count), tail_of_sum(locked, directions)) > again_evidence;
}

double LineScan::refined_alone(const Together& fit, std::span<const KnownLine> lines,
                               std::size_t line) const {
    std::vector<Sweep> sweeps = fit.rest;
    for (std::size_t i = 0; i < sweeps.size(); ++i) {
        Sweep& sweep = sweeps[i];
        const std::complex<double> nm = fit.nm[line][i];
        std::vector<std::vector<double>> wave;
        add_wave(sweep, lines[line], wave);
        for (std::size_t k = 0; k < sweep.value.size(); ++k)
            sweep.value[k] =
                sweep.weight[k] * (sweep.torque_nm[k] + nm.real() * wave[0][k] - nm.imag() * wave[1][k]);
    }
    return refined(sweeps, noise_at(lines[line].place), lines[line].place, 1.0 / longest_);
}

void LineScan::remove(const KnownLine& line) {
    on_two_cores(pieces_.size(), [&](std::size_t i) {
        const Piece& piece = pieces_[i];
        const Sweep& sweep = sweeps_[i];
        if (line.axis == Axis::angle && piece.speed.empty()) return;
        const auto where = places(sweep, line.axis);
        const std::size_t n = where.size();
        std::vector<std::vector<double>> columns;
        add_wave(sweep, line, columns);
        if (std::abs(where.back() - where.front()) * line.place > cycles_with_course) {
            const auto along = places(sweep, axis_);
            for (const std::size_t c : {0U, 1U, 2U, 3U}) {
                columns.push_back(columns[c]);
                for (std::size_t k = 0; k < n; ++k)
                    columns.back()[k] *= (along[k] - piece.start) / piece.length - 0.5;
            }
        }
        take_off(i, columns);
    });
}

LineScan::Spectrum LineScan::spectrum_of(std::size_t number, std::size_t begin, std::size_t end) const {
    const Sweep& sweep = sweeps_[number];
    const auto place = places(sweep, axis_).subspan(begin, end - begin);
    const auto [from, to] = std::minmax_element(place.begin(), place.end());
    const double start = *from, length = *to - *from;
    std::vector<double> where(place.size()), value(place.size());
    for (std::size_t k = 0; k < place.size(); ++k) {
        where[k] = place[k] - start;
        value[k] = full_turn * where[k] / length;
    }
    portable::cos(value, value);
    Spectrum spectrum;
    for (std::size_t k = 0; k < place.size(); ++k) {
        const double weight = (0.5 - 0.5 * value[k]) * sweep.share_turns[begin + k];
        spectrum.weight += weight;
        value[k] = weight * sweep.torque_nm[begin + k];
    }
    spectrum.sum = nonuniform_fourier(where, value, step_, first_bin_ + count_);
    spectrum.sum.erase(spectrum.sum.begin(), spectrum.sum.begin() + static_cast<std::ptrdiff_t>(first_bin_));
    spectrum.power.resize(count_);
    for (std::size_t k = 0; k < count_; ++k) spectrum.power[k] = std::norm(spectrum.sum[k]);
    // What is slower belongs to the trend, which was taken off.
    spectrum.noise = noise_of(spectrum.power, length, 2.0 / length);
    return spectrum;
}

namespace {

/// Straight lines through ln power over ln place, from the cells on either side of a place.
class LocalLines {
  public:
    LocalLines(std::span<const double> x, std::span<const double> y) : x_(x) {
        const std::size_t n = x.size();
        for (auto* sums : {&x_sum_, &xx_sum_, &y_sum_, &xy_sum_}) sums->assign(n + 1, 0.0);
        for (std::size_t i = 0; i < n; ++i) {
            x_sum_[i + 1] = x_sum_[i] + x[i];
            xx_sum_[i + 1] = xx_sum_[i] + x[i] * x[i];
            y_sum_[i + 1] = y_sum_[i] + y[i];
            xy_sum_[i + 1] = xy_sum_[i] + x[i] * y[i];
        }
    }
    /// Value at entry i and its variance, from the entries that are more than `own` and at most `half` away,
    /// each of this variance.
    [[nodiscard]] std::pair<double, double> at(std::ptrdiff_t i, std::ptrdiff_t own, std::ptrdiff_t half,
                                               double entry_variance) const {
        const std::ptrdiff_t n = std::ssize(x_);
        const auto place = [n](std::ptrdiff_t k) {
            return static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(k, 0, n));
        };
        const std::size_t a = place(i - half), b = place(i - own), c = place(i + own + 1),
                          d = place(i + half + 1);
        const auto sum = [&](const std::vector<double>& s) { return s[b] - s[a] + s[d] - s[c]; };
        const auto count = static_cast<double>(b - a + d - c);
        if (count < 3.0) return {0.0, 1e9};
        const double mean = sum(x_sum_) / count, y_mean = sum(y_sum_) / count;
        const double xx = sum(xx_sum_) - count * mean * mean, xy = sum(xy_sum_) - count * mean * y_mean;
        const double away = x_[static_cast<std::size_t>(i)] - mean;
        return {y_mean + away * xy / xx, entry_variance * (1.0 / count + away * away / xx)};
    }

  private:
    std::span<const double> x_;
    std::vector<double> x_sum_, xx_sum_, y_sum_, xy_sum_;
};

}  // namespace

// The logarithm of the power of noise has the variance pi^2 / 6 whatever its spectrum, and lines, of which
// there may be many, count little in a mean of logarithms that are cut at three times the noise.
LineScan::Noise LineScan::noise_of(std::span<const double> power, double length, double bottom) const {
    constexpr double euler = 0.57722, cut = 3.0, bias_of_cut = 0.01305;  // of ln of Exp(1); E1(3)
    constexpr double ln_variance = 1.64493;
    const double cell = 1.0 / length / step_;
    const std::size_t apart = std::max<std::size_t>(1, static_cast<std::size_t>(cell / 3.0));
    std::vector<double> x, y;
    std::vector<std::size_t> from;
    for (std::size_t k = 0; k < power.size(); k += apart) {
        if (place(k) < bottom || !(power[k] > 0.0)) continue;
        x.push_back(ln_place_[k]);
        y.push_back(power[k]);
        from.push_back(k);
    }
    portable::log(y, y);
    const std::vector<double> zeros(power.size());
    Noise noise{std::vector<double>(power.size(), 1e300), zeros, zeros, zeros};
    if (x.empty()) return noise;
    const auto n = std::ssize(x);
    const double entries = cell / static_cast<double>(apart);  // per cell
    const auto own = std::lround(own_cells * entries);
    std::array<std::vector<std::pair<double, double>>, 2> fits;
    for (std::size_t s = 0; s < 2; ++s) {
        const auto half = own + std::lround((s == 0 ? wide_cells : near_cells) * entries);
        auto& fit = fits.at(s);
        fit.resize(x.size());
        const double variance = ln_variance * std::max(1.0, entries * hann_cell);
        const LocalLines all(x, y);
        std::vector<double> cut_y(y);
        for (std::ptrdiff_t i = 0; i < n; ++i) {
            const auto k = static_cast<std::size_t>(i);
            cut_y[k] = std::min(y[k], all.at(i, -1, half, variance).first + euler + portable::log(cut));
        }
        const LocalLines lines(x, cut_y);
        for (std::ptrdiff_t i = 0; i < n; ++i) {
            fit[static_cast<std::size_t>(i)] = lines.at(i, own, half, variance);
            fit[static_cast<std::size_t>(i)].first += euler + bias_of_cut;
        }
    }
    for (std::size_t k = from.front(); k < power.size(); ++k) {
        const std::size_t i = std::min((k - from.front()) / apart, x.size() - 1),
                          next = std::min(i + 1, x.size() - 1);
        const double part = next == i ? 0.0 : static_cast<double>(k - from[i]) / static_cast<double>(apart);
        const auto value = [&](std::size_t s) {
            return fits.at(s)[i].first + part * (fits.at(s)[next].first - fits.at(s)[i].first);
        };
        noise.power[k] = value(0);
        noise.variance[k] = fits[0][i].second;
        noise.rise[k] = value(1) - value(0);
        noise.rise_variance[k] = fits[1][i].second + fits[0][i].second;
    }
    portable::many_exp(std::span(noise.power).subspan(from.front()));
    return noise;
}

// Without a hump the rise is 0 but for its error; with one, anything up to highest_hump.
LineScan::Humps LineScan::humps_of(const Listed& list) const {
    const std::vector<double> zeros(count_);
    Humps humps{zeros, zeros, zeros};
    for (std::size_t k = 0; k < count_; ++k) {
        double weights = 0.0, sum = 0.0;
        for (std::size_t i = 0; i < list.pieces.size(); ++i) {
            const Noise& noise = *list.noises[i];
            if (!list.pieces[i]->shows(place(k)) || !(noise.rise_variance[k] > 0.0)) continue;
            weights += 1.0 / noise.rise_variance[k];
            sum += noise.rise[k] / noise.rise_variance[k];
        }
        if (!(sum > 0.0)) continue;
        humps.rise[k] = sum / weights;
        humps.variance[k] = 1.0 / weights;
        const double odds = humps_share / (1.0 - humps_share) / highest_hump *
                            std::sqrt(full_turn * humps.variance[k]) *
                            portable::exp(std::min(600.0, 0.5 * humps.rise[k] * sum));
        humps.chance[k] = odds / (1.0 + odds);
    }
    return humps;
}

// By likelihood under the law of F. Of powers above `large`, which may be those of lines, only the number
// counts, so that the bulk of the noise tells.
std::vector<double> LineScan::excess_of(const Listed& list, const Humps& humps) const {
    constexpr double large = 1.5;
    std::vector<Evidences> octaves(octave(count_ - 1) + 1);
    for (std::size_t i = 0; i < list.pieces.size(); ++i) {
        const Noise& noise = *list.noises[i];
        const auto stride = static_cast<std::size_t>(hann_cell / list.pieces[i]->length / step_);
        for (std::size_t k = 0; k < count_; k += std::max<std::size_t>(1, stride)) {
            if (!list.pieces[i]->shows(place(k)) || !(noise.variance[k] > 0.0)) continue;
            const double x =
                list.powers[i][k] / noise.power[k] * portable::exp(-humps.chance[k] * humps.rise[k]);
            for (std::size_t e = 0; e < excesses.size(); ++e) {
                const double m = 1.0 / (noise.variance[k] + excesses.at(e));
                octaves[octave(k)].at(e) -=
                    (m + (x < large ? 1.0 : 0.0)) * portable::log1p(std::min(x, large) / m);
            }
        }
    }
    std::vector<double> excess;
    for (std::size_t b = 0; b < octaves.size(); ++b) {
        Evidences sum = octaves[b];  // with half of what its neighbours say
        for (std::size_t e = 0; e < sum.size(); ++e) {
            if (b > 0) sum.at(e) += 0.5 * octaves[b - 1].at(e);
            if (b + 1 < octaves.size()) sum.at(e) += 0.5 * octaves[b + 1].at(e);
        }
        const double most = *std::max_element(sum.begin(), sum.end());
        double mean = 0.0, all = 0.0, prior = 1.0;
        for (std::size_t e = 0; e < sum.size();
             ++e, prior *= 0.5) {  // each half as probable as the one before
            const double p = prior * portable::exp(sum.at(e) - most);
            mean += p * excesses.at(e);
            all += p;
        }
        excess.push_back(mean / all);
    }
    return excess;
}

double LineScan::score_at(double power, const Noise& noise, const Humps& humps, std::size_t k,
                          double excess) {
    const double without = score_of(power / noise.power[k], 1.0 / (noise.variance[k] + excess));
    if (humps.chance[k] < 1e-6) return without;
    const double with = score_of(power / noise.power[k] * portable::exp(-humps.rise[k]),
                                 1.0 / (noise.variance[k] + humps.variance[k] + excess));
    const double least = std::min(without, with);
    return least - portable::log((1.0 - humps.chance[k]) * portable::exp(least - without) +
                                 humps.chance[k] * portable::exp(least - with));
}

// score_at() of all places, by many logarithms at once.
std::vector<double> LineScan::scores(std::span<const double> power, const Noise& noise,
                                     const Humps& humps) const {
    std::vector<double> without(count_), with(count_), part(count_);
    for (std::size_t k = 0; k < count_; ++k) part[k] = -humps.rise[k];
    portable::many_exp(part);
    for (std::size_t k = 0; k < count_; ++k) {
        const double x = power[k] / noise.power[k];
        without[k] = 1.0 + x * noise.variance[k];
        with[k] = 1.0 + x * part[k] * (noise.variance[k] + humps.variance[k]);
    }
    portable::log(without, without);
    portable::log(with, with);
    for (std::size_t k = 0; k < count_; ++k) {
        without[k] /= std::max(noise.variance[k], 1e-300);
        with[k] /= std::max(noise.variance[k] + humps.variance[k], 1e-300);
        part[k] = -std::min(std::abs(with[k] - without[k]), 600.0);
    }
    portable::many_exp(part);
    for (std::size_t k = 0; k < count_; ++k) {
        const double chance = humps.chance[k];
        part[k] = with[k] > without[k] ? 1.0 - chance + chance * part[k] : (1.0 - chance) * part[k] + chance;
    }
    portable::log(part, part);
    for (std::size_t k = 0; k < count_; ++k) part[k] = std::min(with[k], without[k]) - part[k];
    return part;
}

LineScan::Listed LineScan::listed(std::span<Spectrum> spectra, bool halves) const {
    Listed list;
    for (const Piece& piece : pieces_) {
        if (halves && !piece.in_halves) continue;
        for (int part = 0; part < (halves ? 2 : 1); ++part) {
            Spectrum& one = spectra[list.pieces.size()];
            list.powers.push_back(one.power);
            list.noises.push_back(&one.noise);
            list.pieces.push_back(&piece);
        }
    }
    return list;
}

LineScan::Summed LineScan::summed(std::span<Spectrum> spectra, bool halves) const {
    const std::vector<double> zeros(count_);
    Summed sum{zeros, zeros, zeros, zeros, {}, {}};
    sum.humps = humps_of(listed(spectra, halves));
    std::size_t next = 0;
    for (const Piece& piece : pieces_) {
        if (halves && !piece.in_halves) continue;
        for (int part = 0; part < (halves ? 2 : 1); ++part) {
            const Spectrum& one = spectra[next++];
            const std::vector<double> score = scores(one.power, one.noise, sum.humps);
            for (std::size_t k = 0; k < count_; ++k) {
                if (!piece.shows(place(k))) continue;
                sum.scores[k] += score[k];
                sum.best[k] = std::max(sum.best[k], score[k]);
                sum.sweeps[k] += 1.0;
            }
        }
    }
    const double width = level_cells / usual_ / step_;
    const std::size_t apart = std::max<std::size_t>(1, static_cast<std::size_t>(width / 60.0));
    std::vector<double> thinned;
    for (std::size_t k = 0; k < count_; k += apart) thinned.push_back(sum.scores[k]);
    const std::vector<double> median = running_median(thinned, odd(width / static_cast<double>(apart)));
    for (std::size_t k = 0; k < count_; ++k) {
        sum.level[k] = std::max(1.0, between(median, k, apart) / (std::max(1.0, sum.sweeps[k]) - 1.0 / 3.0));
        sum.scores[k] /= sum.level[k];
        sum.best[k] /= sum.level[k];
    }
    return sum;
}

/// By what the sum of a sweep is multiplied so that places count from where those of all sweeps do.
std::complex<double> LineScan::turned_to_origin(std::size_t piece, std::size_t k) const {
    return portable::phasor(-full_turn * place(k) * (pieces_[piece].start + pieces_[piece].origin));
}

LineScan::OnePhase LineScan::of_one_phase() const {
    OnePhase found{std::vector<double>(count_), {}, {}, {}, {}};
    double directions = 0.0;
    for (const bool forward : {true, false}) {
        std::vector<std::complex<double>> sum(count_);
        std::vector<double> information(count_), &power = found.power.at(forward ? 0 : 1);
        bool any = false;
        for (std::size_t i = 0; i < pieces_.size(); ++i) {
            if (pieces_[i].forward != forward) continue;
            any = true;
            const Spectrum& one = whole_[i];
            const double half = 0.5 * one.weight;
            for (std::size_t k = 0; k < count_; ++k) {
                if (!pieces_[i].shows(place(k))) continue;
                sum[k] += half / one.noise.power[k] * one.sum[k] * turned_to_origin(i, k);
                information[k] += half * half / one.noise.power[k];
            }
        }
        if (!any) continue;
        directions += 1.0;
        power.resize(count_);
        for (std::size_t k = 0; k < count_; ++k)
            power[k] = std::norm(sum[k]) / std::max(information[k], 1e-300);
        Noise& noise = found.noise.at(forward ? 0 : 1);
        noise = noise_of(power, longest_, 0.0);
        for (double& one : noise.power) one = std::max(one, 1.0);
        Humps& humps = found.humps.at(forward ? 0 : 1);
        humps = humps_of({{power}, {&noise}, {&everywhere_}});
        const std::vector<double> score = scores(power, noise, humps);
        for (std::size_t k = 0; k < count_; ++k) found.score[k] += score[k];
    }
    for (double& one : found.score) one = tail_of_sum(one, directions);
    return found;
}

void LineScan::measure_scatter() {
    free_.excess = excess_of(listed(whole_, false), free_.humps);
    varying_.excess = excess_of(listed(halves_, true), varying_.humps);
    for (std::size_t d = 0; d < 2; ++d)
        if (!locked_.power.at(d).empty())
            locked_.excess.at(d) = excess_of({{locked_.power.at(d)}, {&locked_.noise.at(d)}, {&everywhere_}},
                                             locked_.humps.at(d));
}

const std::vector<double>& LineScan::score() {
    whole_.resize(pieces_.size());
    std::vector<std::size_t> in_halves;
    for (std::size_t i = 0; i < pieces_.size(); ++i)
        if (pieces_[i].in_halves) in_halves.push_back(i);
    halves_.resize(2 * in_halves.size());
    on_two_cores(pieces_.size() + in_halves.size(), [&](std::size_t job) {
        if (job < pieces_.size()) {
            whole_[job] = spectrum_of(job, 0, sweeps_[job].value.size());
            return;
        }
        const std::size_t j = job - pieces_.size(), i = in_halves[j];
        const auto place = places(sweeps_[i], axis_);
        const double middle = pieces_[i].start + 0.5 * pieces_[i].length;
        std::size_t split = 1;
        while (split + 1 < place.size() && (place[split] < middle) == pieces_[i].forward) ++split;
        halves_[2 * j] = spectrum_of(i, 0, split);
        halves_[2 * j + 1] = spectrum_of(i, split, place.size());
    });
    free_ = summed(whole_, false);
    varying_ = summed(halves_, true);
    locked_ = of_one_phase();
    evidence_.assign(count_, 0.0);
    for (std::size_t k = 0; k < count_; ++k) {
        if (place(k) < lowest_) continue;
        const double n = free_.sweeps[k];
        if (n > 1.5 && tail_of_sum(free_.scores[k] - free_.best[k], n - 1.0) <= again_evidence) continue;
        const double best = std::max({tail_of_sum(free_.scores[k], n), locked_.score[k],
                                      tail_of_sum(varying_.scores[k], varying_.sweeps[k])});
        evidence_[k] = std::max(0.0, best - portable::log(3.0));
    }
    return evidence_;
}

// The test of score() at one place with a line added that has one phase in all sweeps.
double LineScan::evidence_with(std::size_t k, std::complex<double> added_nm, const Excess& excess) const {
    double free = 0.0, most = 0.0, halves = 0.0, in_halves = 0.0, sweeps = 0.0;
    std::array<std::complex<double>, 2> together{};
    std::array<double, 2> information{};
    std::size_t next = 0;
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
        const Piece& piece = pieces_[i];
        const bool seen = piece.shows(place(k));
        const std::complex<double> turn = turned_to_origin(i, k), line = 0.5 * added_nm * std::conj(turn);
        const auto score_with = [&](const Spectrum& one, const Humps& humps, double more) {
            return score_at(std::norm(one.sum[k] + one.weight * line), one.noise, humps, k, more);
        };
        if (piece.in_halves) {
            for (int part = 0; part < 2; ++part, ++next) {
                halves += seen ? score_with(halves_[next], varying_.humps, excess.varying) : 0.0;
                in_halves += seen ? 1.0 : 0.0;
            }
        }
        if (!seen) continue;
        const Spectrum& one = whole_[i];
        const double score = score_with(one, free_.humps, excess.free), half = 0.5 * one.weight;
        free += score;
        most = std::max(most, score);
        sweeps += 1.0;
        const std::size_t direction = piece.forward ? 0 : 1;
        together.at(direction) += half / one.noise.power[k] * (one.sum[k] + one.weight * line) * turn;
        information.at(direction) += half * half / one.noise.power[k];
    }
    const double level = free_.level[k];
    if (sweeps > 1.5 && tail_of_sum((free - most) / level, sweeps - 1.0) <= again_evidence) return 0.0;
    double locked = 0.0, directions = 0.0;
    for (std::size_t d = 0; d < 2; ++d) {
        const Noise& noise = locked_.noise.at(d);
        if (noise.power.empty()) continue;
        directions += 1.0;
        const double power = std::norm(together.at(d)) / std::max(information.at(d), 1e-300);
        locked += score_at(power, noise, locked_.humps.at(d), k, excess.locked.at(d));
    }
    return std::max({tail_of_sum(free / level, sweeps), tail_of_sum(locked, directions),
                     tail_of_sum(halves / varying_.level[k], in_halves)}) -
           portable::log(3.0);
}

double LineScan::once_nm(double from, double to, double false_alarm) const {
    double most_nm = 0.0;
    for (std::size_t k = 0; k < count_; ++k) {
        if (place(k) < lowest_ || evidence_[k] > 0.0 ||
            tail_of_sum(free_.scores[k], free_.sweeps[k]) < threshold(false_alarm))
            continue;
        for (std::size_t i = 0; i < pieces_.size(); ++i) {
            const Sweep& sweep = sweeps_[i];
            double first = place(k), last = place(k);
            if (axis_ == Axis::time) {
                if (!(sweep.slow_deg_s > 0.0)) continue;
                first *= 360.0 / sweep.fast_deg_s;
                last *= 360.0 / sweep.slow_deg_s;
            }
            if (!pieces_[i].shows(place(k)) || last < from || first >= to ||
                score_at(whole_[i].power[k], whole_[i].noise, free_.humps, k) < threshold(false_alarm))
                continue;
            most_nm = std::max(most_nm, 2.0 * std::abs(whole_[i].sum[k]) / whole_[i].weight);
        }
    }
    return most_nm;
}

LineScan::Excess LineScan::excess_at(std::size_t k) const {
    Excess e;
    e.free = free_.excess[octave(k)];
    if (!varying_.excess.empty()) e.varying = varying_.excess[octave(k)];
    for (std::size_t d = 0; d < 2; ++d)
        if (!locked_.excess.at(d).empty()) e.locked.at(d) = locked_.excess.at(d)[octave(k)];
    return e;
}

LineScan::Evidences LineScan::evidences_at(double place) const {
    const std::size_t k = bin_of(place);
    Evidences out{};
    for (std::size_t e = 0; e < out.size(); ++e) {
        const double x = excesses.at(e);
        out.at(e) = evidence_with(k, 0.0, {x, x, {x, x}});
    }
    return out;
}

double LineScan::false_alarm_of(double place, const Evidences& evidences) const {
    const double excess = excess_at(bin_of(place)).free;
    std::size_t i = 0;
    while (i + 2 < excesses.size() && excesses.at(i + 1) < excess) ++i;
    const double part = (excess - excesses.at(i)) / (excesses.at(i + 1) - excesses.at(i));
    const double evidence = evidences.at(i) + part * (evidences.at(i + 1) - evidences.at(i));
    return std::min(1.0, portable::exp(threshold(1.0) - evidence));
}

double LineScan::detectable_nm(double from, double to, double false_alarm,
                               std::span<const double> lines) const {
    constexpr std::size_t trials = 100, found_in = 95;
    constexpr double golden_turn = 0.618;  // phases that fill the circle evenly
    constexpr double least_errors = 2.0, most_errors = 512.0;
    const double needed = threshold(false_alarm);
    std::vector<double> amplitudes;
    for (std::size_t t = 0; t < trials; ++t) {
        const double at = from + (to - from) * (static_cast<double>(t) + 0.5) / trials;
        const std::size_t k = bin_of(at);
        if (std::any_of(lines.begin(), lines.end(),
                        [&](double line) { return std::abs(place(k) - line) < same_line_cells / longest_; }))
            continue;
        double information = 0.0;
        for (std::size_t i = 0; i < pieces_.size(); ++i)
            if (pieces_[i].shows(place(k)))
                information += 0.25 * whole_[i].weight * whole_[i].weight / whole_[i].noise.power[k];
        if (!(information > 0.0)) {  // no sweep shows it
            amplitudes.push_back(std::numeric_limits<double>::infinity());
            continue;
        }
        const double error = 1.0 / std::sqrt(2.0 * information);
        const auto phase = portable::phasor(full_turn * golden_turn * static_cast<double>(t));
        double low = least_errors, high = most_errors;
        while (high > 1.03 * low) {
            const double middle = std::sqrt(low * high);
            (evidence_with(k, middle * error * phase, excess_at(k)) > needed ? high : low) = middle;
        }
        amplitudes.push_back(high * error);
    }
    if (amplitudes.empty()) return 0.0;
    const auto rank = static_cast<std::ptrdiff_t>(amplitudes.size() * found_in / trials);
    std::nth_element(amplitudes.begin(), amplitudes.begin() + std::min(rank, std::ssize(amplitudes) - 1),
                     amplitudes.end());
    return amplitudes[static_cast<std::size_t>(std::min(rank, std::ssize(amplitudes) - 1))];
}

}  // namespace ripplenotch
