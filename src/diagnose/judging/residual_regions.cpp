// SPDX-License-Identifier: MIT
#include "diagnose/judging/residual_regions.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>

#include "diagnose/case/lines.hpp"
#include "diagnose/limits.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

struct Window {
    std::size_t first = 0, end = 0;  ///< places in rows
    double score = 0.0;
};

class Residual {
  public:
    Residual(const ModelBench& bench, const Model& stated)
        : bench_(bench), raw_nm_(bench.raw_residual(stated)), white_(bench.residual(stated)) {
        // Errors of the measured motion are no disagreement.
        const auto cleared = bench.cleared_residual(stated);
        for (std::size_t r = 0; r < cleared.size(); ++r) raw_nm_[bench.rows()[r]] = cleared[r];
        // A torque that stays on a quantization step is off by up to half of it.
        const double step_nm = bench.looked_at().step_nm;
        matters_mean_ = std::max(limits::regions::matters_mean,
                                 limits::regions::matters_mean_steps * step_nm / bench.noise().rms_nm);
        matters_power_ =
            step_nm > 0.0 ? limits::regions::matters_power_steps : limits::regions::matters_power;
        inflation_ = bench.noise().of_sums();
    }

    [[nodiscard]] const std::vector<double>& raw_nm() const { return raw_nm_; }
    /// Part of the squared residual that `samples` of this rms are.
    [[nodiscard]] double part(double rms_nm, double samples) const {
        double all = 0.0;
        for (const std::size_t k : bench_.rows()) all += raw_nm_[k] * raw_nm_[k];
        return rms_nm * rms_nm * samples / std::max(all, 1e-300);
    }
    [[nodiscard]] double sigma_nm() const { return bench_.noise().rms_nm; }

    [[nodiscard]] std::vector<ResidualRegion> in_time() const {
        std::vector<Window> windows;
        const double rate = bench_.looked_at().motion.sample_rate.value();
        for (const double length_s : {limits::regions::shortest_window_s, limits::regions::short_window_s,
                                      limits::regions::long_window_s, limits::regions::longest_window_s}) {
            const auto length =
                std::max(limits::regions::fewest_in_window, static_cast<std::size_t>(length_s * rate));
            scan(length, windows);
        }
        std::sort(windows.begin(), windows.end(),
                  [](const Window& a, const Window& b) { return a.score > b.score; });
        std::vector<Window> kept;
        for (const Window& window : windows) {
            const bool apart = std::none_of(kept.begin(), kept.end(), [&](const Window& other) {
                return window.first < other.end && other.first < window.end;
            });
            if (apart) kept.push_back(window);
            if (kept.size() > limits::regions::most_windows) break;
        }
        std::sort(kept.begin(), kept.end(),
                  [](const Window& a, const Window& b) { return a.first < b.first; });
        return merged(kept);
    }

    // Mean in bins of a quantity, per direction.
    [[nodiscard]] std::vector<ResidualRegion> in_bins(const std::vector<double>& quantity, RegionKind kind,
                                                      std::size_t bins, double least_range) const {
        const auto [low, high] = std::minmax_element(quantity.begin(), quantity.end());
        std::vector<ResidualRegion> found;
        if (!(*high - *low > least_range)) return found;
        for (const Direction direction : {Direction::negative, Direction::positive}) {
            Bins all{*low, (*high - *low) / static_cast<double>(bins), {}, {}};
            all.sum.assign(bins, 0.0);
            all.count.assign(bins, 0.0);
            fill(all, quantity, *high - *low, direction);
            const ResidualRegion region = in_direction(all, kind, direction);
            if (region.rms_nm > 0.0) found.push_back(region);
        }
        return found;
    }

    [[nodiscard]] std::vector<ResidualRegion> in_lines(const GearRatio& ratio) const {
        std::vector<ResidualRegion> found;
        std::vector<double> left_nm = raw_nm_;
        for (std::size_t peeled = 0; peeled < limits::regions::most_lines; ++peeled) {
            // One at a time: a peak near a strong line is often its own leakage.
            const auto lines = standing_out(bench_.looked_at(), left_nm, limits::regions::line_prominence, 1);
            if (lines.empty()) break;
            const ResidualLine& line = lines[0];
            const double rms_nm = peel(line, left_nm);
            if (rms_nm < bench_.material_sigma() * sigma_nm()) break;
            ResidualRegion region{line.by_angle ? RegionKind::order : RegionKind::tone,
                                  {},
                                  rms_nm,
                                  part(rms_nm, bench_.samples())};
            if (line.by_angle && !(ratio.value() > 0.0)) {
                region.where.order_output.push_back(line.frequency * 360.0);
            } else if (line.by_angle) {
                region.where.order.push_back(line.frequency * 360.0 / ratio.value());
            } else {
                region.where.hz.push_back(line.frequency);
            }
            found.push_back(region);
        }
        return found;
    }

  private:
    struct Bins {
        double low = 0.0, width = 0.0;
        std::vector<double> sum, count;
    };

    void fill(Bins& bins, const std::vector<double>& quantity, double range, Direction direction) const {
        const Case& c = bench_.looked_at();
        const double sign = direction == Direction::positive ? 1.0 : -1.0;
        for (const std::size_t k : bench_.rows()) {
            if (c.motion.velocity_deg_s[k] * sign < c.moving_deg_s || c.edge[k] != 0) continue;
            const auto b = std::min(static_cast<std::size_t>((quantity[k] - bins.low) / range *
                                                             static_cast<double>(bins.sum.size())),
                                    bins.sum.size() - 1);
            bins.sum[b] += raw_nm_[k];
            bins.count[b] += 1.0;
        }
    }

    // The region of the bins whose mean is significant and matters; nothing when there are none.
    [[nodiscard]] ResidualRegion in_direction(const Bins& bins, RegionKind kind, Direction direction) const {
        ResidualRegion region{kind, {}, 0.0, 0.0};
        double squares = 0.0, total = 0.0;
        for (std::size_t b = 0; b < bins.sum.size(); ++b) {
            if (bins.count[b] < limits::regions::fewest_in_bin) continue;
            const double mean = bins.sum[b] / bins.count[b] / sigma_nm();
            if (std::abs(mean) * std::sqrt(bins.count[b] / inflation_) < limits::regions::significant ||
                std::abs(mean) < matters_mean_)
                continue;
            const double from = bins.low + static_cast<double>(b) * bins.width;
            auto& spans = kind == RegionKind::position ? region.where.position_deg : region.where.speed_deg_s;
            if (!spans.empty() && std::abs(spans.back().to - from) < 1e-9 * (1.0 + std::abs(from))) {
                spans.back().to = from + bins.width;
            } else {
                spans.push_back({from, from + bins.width});
            }
            squares += mean * mean * bins.count[b];
            total += bins.count[b];
        }
        if (total == 0.0) return region;
        region.where.direction = direction;
        region.rms_nm = sigma_nm() * std::sqrt(squares / total);
        region.part = part(region.rms_nm, total);
        return region;
    }

    // Takes the line out of the rows that count; its rms in them.
    [[nodiscard]] double peel(const ResidualLine& line, std::vector<double>& left_nm) const {
        const Motion& motion = bench_.looked_at().motion;
        const auto& where = line.by_angle ? motion.position_deg : motion.time_s;
        double cc = 0.0, cs = 0.0, ss = 0.0, cy = 0.0, sy = 0.0;
        const auto waves = [&](std::size_t k) {
            const double angle = 2.0 * std::numbers::pi * line.frequency * where[k];
            const std::complex<double> phasor = portable::phasor(angle);
            return std::pair(phasor.real(), phasor.imag());
        };
        for (const std::size_t k : bench_.rows()) {
            const auto [c, s] = waves(k);
            cc += c * c;
            cs += c * s;
            ss += s * s;
            cy += c * left_nm[k];
            sy += s * left_nm[k];
        }
        const double determinant = cc * ss - cs * cs;
        if (!(determinant > 1e-9 * cc * ss)) return 0.0;
        const double a = (ss * cy - cs * sy) / determinant, b = (cc * sy - cs * cy) / determinant;
        double sum = 0.0;
        for (const std::size_t k : bench_.rows()) {
            const auto [c, s] = waves(k);
            left_nm[k] -= a * c + b * s;
            sum += (a * c + b * s) * (a * c + b * s);
        }
        return std::sqrt(sum / bench_.samples());
    }

    void scan(std::size_t length, std::vector<Window>& windows) const {
        const auto& rows = bench_.rows();
        const auto& edge = bench_.looked_at().edge;
        if (rows.size() < 4 * length) return;
        std::vector<double> means, powers;
        std::vector<std::size_t> firsts;
        for (std::size_t first = 0; first + length <= rows.size(); first += length / 2) {
            double sum = 0.0, power = 0.0, count = 0.0;
            for (std::size_t r = first; r < first + length; ++r) {
                if (edge[rows[r]] != 0) continue;
                sum += raw_nm_[rows[r]];
                power += white_[r] * white_[r];
                count += 1.0;
            }
            if (count < 0.5 * static_cast<double>(length)) continue;
            means.push_back(sum / count / sigma_nm());
            powers.push_back(power / count);
            firsts.push_back(first);
        }
        if (powers.empty()) return;
        std::vector<double> sorted = powers;
        std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2),
                         sorted.end());
        const double typical = std::max(sorted[sorted.size() / 2], 1e-12);
        const double count = static_cast<double>(length);
        for (std::size_t w = 0; w < firsts.size(); ++w) {
            const double by_mean = std::abs(means[w]) * std::sqrt(count / inflation_);
            const double by_power = (powers[w] / typical - 1.0) * std::sqrt(0.5 * count / 2.0);
            const bool mean_out =
                by_mean > limits::regions::significant && std::abs(means[w]) > matters_mean_;
            const bool power_out =
                by_power > limits::regions::significant && powers[w] > matters_power_ * typical;
            if (!mean_out && !power_out) continue;
            windows.push_back({firsts[w], firsts[w] + length,
                               std::max(mean_out ? by_mean : 0.0, power_out ? by_power : 0.0)});
        }
    }

    [[nodiscard]] std::vector<ResidualRegion> merged(const std::vector<Window>& windows) const {
        const auto& rows = bench_.rows();
        const auto& motion = bench_.looked_at().motion;
        std::vector<ResidualRegion> found;
        std::size_t last = 0;
        std::vector<std::pair<std::size_t, std::size_t>> stretches;
        for (const Window& window : windows) {
            if (!stretches.empty() && window.first <= last + (window.end - window.first) / 2) {
                stretches.back().second = window.end;
            } else {
                stretches.emplace_back(window.first, window.end);
            }
            last = window.end;
        }
        for (const auto& [first, end] : stretches) {
            ResidualRegion region{RegionKind::time, {}, 0.0, 0.0};
            region.where.time_s.push_back({motion.time_s[rows[first]], motion.time_s[rows[end - 1]]});
            double squares = 0.0, slow = 1e300, fast = -1e300;
            for (std::size_t r = first; r < end; ++r) {
                squares += raw_nm_[rows[r]] * raw_nm_[rows[r]];
                slow = std::min(slow, motion.velocity_deg_s[rows[r]]);
                fast = std::max(fast, motion.velocity_deg_s[rows[r]]);
            }
            region.where.speed_deg_s.push_back({slow, fast});
            region.rms_nm = std::sqrt(squares / static_cast<double>(end - first));
            region.part = part(region.rms_nm, static_cast<double>(end - first));
            found.push_back(region);
        }
        return found;
    }

    const ModelBench& bench_;
    std::vector<double> raw_nm_, white_;
    double inflation_ = 1.0, matters_mean_ = 0.0, matters_power_ = 0.0;
};

}  // namespace

std::vector<ResidualRegion> residual_regions(const ModelBench& bench, const Model& stated) {
    const Residual residual(bench, stated);
    std::vector<ResidualRegion> found = residual.in_time();
    const Motion& motion = bench.looked_at().motion;
    const auto append = [&](std::vector<ResidualRegion> more) {
        found.insert(found.end(), more.begin(), more.end());
    };
    append(residual.in_lines(stated.gear_ratio));
    append(residual.in_bins(motion.position_deg, RegionKind::position, limits::regions::position_bins,
                            limits::regions::least_travel_deg));
    append(residual.in_bins(motion.velocity_deg_s, RegionKind::speed, limits::regions::speed_bins,
                            limits::regions::least_speeds * bench.looked_at().moving_deg_s));
    std::stable_sort(found.begin(), found.end(),
                     [](const ResidualRegion& a, const ResidualRegion& b) { return a.rms_nm > b.rms_nm; });
    return found;
}

bool is_confined(const ResidualRegion& region, const Case& looked_at) {
    if (region.kind != RegionKind::time) return false;
    const auto& time_s = looked_at.motion.time_s;
    double total_s = 0.0;
    for (const Span& span : region.where.time_s) total_s += span.to - span.from;
    return total_s < limits::regions::confined_part * (time_s.back() - time_s.front());
}

}  // namespace ripplenotch
