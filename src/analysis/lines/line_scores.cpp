// SPDX-License-Identifier: MIT
// The test of a line over all sweeps, and the amplitude that it finds.
#include "analysis/lines/line_scan.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "analysis/spectrum/running_median.hpp"
#include "core/process/two_cores.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

constexpr double again_evidence = 4.6;  // -ln 0.01: what sweeps other than the best one must reach
constexpr double level_cells = 30.0;    // over which scores that are high everywhere are no lines

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

}  // namespace

double LineScan::threshold(double false_alarm) const {
    return portable::log((highest_ - lowest_) * longest_ * hann_cell / false_alarm);
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
                        [&](double line) { return std::abs(place(k) - line) < line_cells / longest_; }))
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
