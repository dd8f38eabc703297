// SPDX-License-Identifier: MIT
#include "diagnose/case/tones.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <utility>

#include "ripplenotch/analysis/fourier.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

// What follows each other without a gap.
std::vector<LineSamples> pieces_of(const LineSamples& samples, double usual_step, const LineRules& rules) {
    std::vector<LineSamples> pieces(1);
    for (std::size_t k = 0; k < samples.where.size(); ++k) {
        if (k > 0 && samples.where[k] - samples.where[k - 1] > rules.gap_steps * usual_step) {
            if (pieces.back().where.size() < rules.fewest_samples) pieces.pop_back();
            pieces.emplace_back();
        }
        pieces.back().where.push_back(samples.where[k]);
        pieces.back().value.push_back(samples.value[k]);
    }
    if (pieces.back().where.size() < rules.fewest_samples) pieces.pop_back();
    return pieces;
}

}  // namespace

Tones::Tones(LineSamples samples, double rate_hz, const LineRules& rules)
    : rules_(rules), all_(std::move(samples)) {
    const double highest_hz = 0.5 * rate_hz;
    const double recorded_s = static_cast<double>(all_.where.size()) / rate_hz, range_s = range_of(all_);
    if (recorded_s < rules.recorded_part * range_s ||
        rules.oversampling * range_s * highest_hz > static_cast<double>(rules.most_cells))
        pieces_ = pieces_of(all_, 1.0 / rate_hz, rules);
    if (pieces_.empty()) {
        spectrum_ = spectrum_of(all_, highest_hz, rules);
        return;
    }
    double longest_s = 0.0, counted = 0.0;
    for (const LineSamples& piece : pieces_) {
        longest_s = std::max(longest_s, range_of(piece));
        counted += static_cast<double>(piece.where.size());
    }
    spectrum_.spacing = 1.0 / (rules.oversampling * longest_s);
    spectrum_.power.assign(
        std::min(static_cast<std::size_t>(highest_hz / spectrum_.spacing) + 1, rules.most_cells), 0.0);
    for (const LineSamples& piece : pieces_) {
        const LineSpectrum own = spectrum_of(piece, spectrum_.spacing, spectrum_.power.size());
        const double part = static_cast<double>(piece.where.size()) / counted;
        for (std::size_t k = 0; k < own.power.size(); ++k) spectrum_.power[k] += part * own.power[k];
    }
}

double Tones::refined_hz(std::size_t cell) const {
    const double about_hz = static_cast<double>(cell) * spectrum_.spacing;
    if (pieces_.empty())
        return refine_peak(all_.where, all_.value, {.frequency = about_hz, .reach = spectrum_.spacing});
    std::vector<double> own_hz, weight;
    double weights = 0.0, sum = 0.0, squares = 0.0;
    for (const LineSamples& piece : pieces_) {
        own_hz.push_back(
            refine_peak(piece.where, piece.value, {.frequency = about_hz, .reach = spectrum_.spacing}));
        weight.push_back(std::norm(fourier_point(piece.where, piece.value, own_hz.back()).value) + 1e-300);
        weights += weight.back();
        sum += weight.back() * own_hz.back();
    }
    const double mean_hz = sum / weights;
    for (std::size_t p = 0; p < pieces_.size(); ++p)
        squares += weight[p] * (own_hz[p] - mean_hz) * (own_hz[p] - mean_hz);
    const double error_hz = std::sqrt(squares / weights / static_cast<double>(pieces_.size()));
    return refine_peak(all_.where, all_.value,
                       {.frequency = agreed_hz(mean_hz, error_hz), .reach = 0.5 / range_of(all_)});
}

// Near a frequency, where the sums of the pieces are in step.
double Tones::agreed_hz(double mean_hz, double error_hz) const {
    // Sums about the middle of each piece, with their slopes: near the mean frequency they are a parabola.
    std::vector<FourierPoint> sums;
    std::vector<double> middle_s;
    for (const LineSamples& piece : pieces_) {
        const double middle = 0.5 * (piece.where.front() + piece.where.back());
        std::vector<double> about = piece.where;
        for (double& time : about) time -= middle;
        sums.push_back(fourier_point(about, piece.value, mean_hz));
        middle_s.push_back(middle - pieces_.front().where.front());
    }
    const double step_hz = 1.0 / (rules_.oversampling * range_of(all_));
    const auto reach = static_cast<int>(
        std::min(rules_.agreement_errors * error_hz / step_hz, static_cast<double>(rules_.agreement_cells)));
    double best_hz = mean_hz, most_power = -1.0;
    for (int i = -reach; i <= reach; ++i) {
        const double off_hz = i * step_hz;
        std::complex<double> sum;
        for (std::size_t p = 0; p < sums.size(); ++p) {
            const auto own = sums[p].value + off_hz * (sums[p].first + 0.5 * off_hz * sums[p].second);
            sum += own * portable::polar(1.0, -2.0 * std::numbers::pi * (mean_hz + off_hz) * middle_s[p]);
        }
        if (std::norm(sum) <= most_power) continue;
        most_power = std::norm(sum);
        best_hz = mean_hz + off_hz;
    }
    return best_hz;
}

}  // namespace ripplenotch
