// SPDX-License-Identifier: MIT
// The sweeps of a log on one axis: what is taken off them, and their sums.
#include "analysis/lines/line_scan.hpp"

#include <algorithm>
#include <cmath>

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
// Orders above half the sample rate are searched up to here of it, in sweeps whose speed spreads one
// frequency over the width of a line, which distinguishes an order from its image below. Chosen, not derived:
// above are the images of noise slower than a quarter of the rate, which rises towards the motion.
constexpr double top_folded_of_rate = 0.75;
constexpr double corner_s = 0.01;   // chosen, not derived: corners of the motion are no sharper in a torque
constexpr double step_cells = 0.3;  // of the sums, in 1 / longest sweep
constexpr double cycles_with_course = 15.0;  // from so many in a sweep on an amplitude may change within it

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
            piece.folded_from = std::max(piece.top, line_cells / std::max(1e-9, spread * piece.length));
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

}  // namespace ripplenotch
