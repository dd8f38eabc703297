// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/design/candidate_table.hpp"
#include "ripplenotch/design/notch.hpp"

namespace ripplenotch {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// A range next to a band's edge, under the rule for speeds that no band covers.
SpeedRegion outside(double from, double to, OutsideRule rule, int edge_candidate, double edge,
                    double fade_end) {
    SpeedRegion region{from, to};
    if (rule == OutsideRule::hold) region.holds = true;
    if (rule == OutsideRule::fade) {
        region.candidate = edge_candidate;
        region.full_deg_s = edge;
        region.none_deg_s = fade_end;
    }
    return region;
}

}  // namespace

double SpeedRegion::share(double speed_deg_s) const noexcept {
    if (!fades()) return 1.0;
    return std::clamp((speed_deg_s - none_deg_s) / (full_deg_s - none_deg_s), 0.0, 1.0);
}

std::vector<SpeedRegion> speed_regions(std::span<const std::pair<DegPerSec, DegPerSec>> bands,
                                       OutsideRule below, OutsideRule above) {
    std::vector<SpeedRegion> regions;
    double reached = -infinity;
    for (std::size_t i = 0; i < bands.size(); ++i) {
        const double from = bands[i].first.value(), to = bands[i].second.value();
        const int candidate = static_cast<int>(i);
        if (i == 0) {
            regions.push_back(outside(reached, from, below, candidate, from, from / 2.0));
        } else if (from > reached) {
            // Each half of a hole belongs to the band it touches; with `fade` both are at 0 where they meet.
            const double middle = (reached + from) / 2.0;
            regions.push_back(outside(reached, middle, below, candidate - 1, reached, middle));
            regions.push_back(outside(middle, from, below, candidate, from, middle));
        }
        regions.push_back({from, to, candidate});
        reached = to;
    }
    const int last = static_cast<int>(bands.size()) - 1;
    regions.push_back(outside(reached, infinity, above, last, reached, 1.5 * reached));
    return regions;
}

std::vector<SpeedRegion> speed_regions(std::span<const Band> bands, OutsideRule below, OutsideRule above) {
    std::vector<std::pair<DegPerSec, DegPerSec>> edges;
    for (const Band& band : bands) edges.emplace_back(band.from, band.to);
    return speed_regions(edges, below, above);
}

namespace {

// About half a second each. A response is taken at 257 speeds of a band, of each line through each notch.
constexpr double max_responses = 60000.0;  // lines times notches, over all bands
constexpr double most_steps = 2e8;         // samples of a step response times notches, over all bands

}  // namespace

void TableWork::add(const Band& band, double settle_band_percent) {
    const auto notches = static_cast<double>(band.notches.size());
    if (band.notches.size() > most_orders) {
        raise<UsageError>("{} notches in a band, expected at most {}; leave orders out", band.notches.size(),
                          most_orders);
    }
    if (++bands_ > max_bands) raise<UsageError>("more than {} bands; make them wider", max_bands);
    responses_ += notches * notches;
    if (responses_ > max_responses) {
        raise<UsageError>(
            "bands 1 to {} have too many notches to be measured ({} in this one); make the bands wider, or "
            "leave orders out",
            bands_, band.notches.size());
    }
    const Cascade cascade = band.cascade();
    steps_ += notches * static_cast<double>(samples_to_settle(cascade, settle_band_percent / 100.0));
    if (steps_ > most_steps) {
        raise<UsageError>(
            "bands 1 to {} settle too slowly to be measured together; make the bands wider, start them "
            "higher, or lower the Q or the sample rate",
            bands_);
    }
}

namespace {

constexpr int grid_points = 256;  // over one band, for the worst attenuation

// 12 significant digits: 100 * 27 / 360 stays 7.5, and 0.1 + 2 * 0.1 becomes 0.3.
double without_dust(double value) { return *parse_number(fmt::format("{:.12g}", value)); }

std::string band_label(int number, DegPerSec from, DegPerSec to) {
    return fmt::format("band {} ({}-{} deg/s)", number, shortest(from.value()), shortest(to.value()));
}

void check_bands(const std::vector<std::pair<DegPerSec, DegPerSec>>& bands) {
    for (std::size_t i = 0; i < bands.size(); ++i) {
        const auto [from, to] = bands[i];
        const std::string label = band_label(static_cast<int>(i) + 1, from, to);
        if (!(from.value() >= 0.0))
            raise<UsageError>("{}: bands are on |v|, so they start at 0 or above", label);
        if (!(from < to) || !std::isfinite(to.value())) {
            raise<UsageError>("{}: it must end above its start", label);
        }
        if (i > 0 && from < bands[i - 1].second) {
            raise<UsageError>(
                "{} overlaps {}; bands go upward, each starting where the one before ends or later", label,
                band_label(static_cast<int>(i), bands[i - 1].first, bands[i - 1].second));
        }
    }
}

// A row that was read rather than designed.
void check_stored(const Band& band, int number, const TableSpec& spec) {
    const std::string label = band_label(number, band.from, band.to);
    if (band.number != number) {
        raise<UsageError>("{}: it is numbered {}; numbers run 1, 2, 3, ...", label, band.number);
    }
    if (band.notches.size() != spec.orders.size()) {
        raise<UsageError>("{}: it has {} notches for {} orders", label, band.notches.size(),
                          spec.orders.size());
    }
    for (std::size_t n = 0; n < band.notches.size(); ++n) {
        const CandidateNotch& notch = band.notches[n];
        if (notch.order != spec.orders[n]) {
            raise<UsageError>("{}: notch {} is for order {}, expected order {}", label, n + 1,
                              shortest(notch.order.value()), shortest(spec.orders[n].value()));
        }
        if (!(notch.notch.center.value() > 0.0) || !(notch.notch.center < 0.5 * spec.sample_rate)) {
            raise<UsageError>("{}: notch centre {} Hz is not between 0 and half the sample rate, {} Hz",
                              label, shortest(notch.notch.center.value()),
                              shortest(0.5 * spec.sample_rate.value()));
        }
        if (!(notch.notch.q > 0.0))
            raise<UsageError>("{}: notch Q {} is not above 0", label, shortest(notch.notch.q));
        if (!(pole_radius(notch.section) < 1.0)) {
            raise<UsageError>("{}: the section for order {} is unstable", label,
                              shortest(notch.order.value()));
        }
    }
}

// The remaining gain of the lines while the joint speed runs through the band, both edges included, and the
// gear ratio through its interval: a ratio that is 1 % higher looks like a joint that is 1 % faster.
struct Left {
    std::vector<double> largest_gain;  // per order
    // Gain of all orders by their amplitudes; without them, of the weakest line.
    double largest_together = 0.0;
};

Left largest_left(std::span<const Biquad> cascade, const TableSpec& spec, const Band& band) {
    const std::size_t lines = band.notches.size();
    const bool weighed = spec.amplitude_nm.size() == lines && lines > 0;
    double all = 0.0;
    for (const double amplitude : spec.amplitude_nm) all += amplitude * amplitude;
    const auto [from, to] = speeds_in_force(spec, band.from.value(), band.to.value());
    Left left{std::vector<double>(lines)};
    for (int i = 0; i <= grid_points; ++i) {
        const double speed = from + (to - from) * static_cast<double>(i) / grid_points;
        double together = 0.0;
        for (std::size_t n = 0; n < lines; ++n) {
            const Hertz at = ripple_frequency(band.notches[n].order, spec.gear_ratio, DegPerSec(speed));
            const double gain = std::abs(response(cascade, at, SampledAt(spec.sample_rate)));
            left.largest_gain[n] = std::max(left.largest_gain[n], gain);
            if (weighed) {
                together += portable::pow(spec.amplitude_nm[n] * gain, 2) / all;
            } else {
                together = std::max(together, gain * gain);
            }
        }
        left.largest_together = std::max(left.largest_together, std::sqrt(together));
    }
    return left;
}

}  // namespace

std::pair<double, double> speeds_in_force(const TableSpec& spec, double from_deg_s, double to_deg_s) {
    const double beyond = spec.hysteresis.value();
    return {std::max(from_deg_s - beyond, 0.0) * (1.0 - spec.ratio_error),
            (to_deg_s + beyond) * (1.0 + spec.ratio_error)};
}

void check_ripple(const TableSpec& spec) {
    if (!(spec.gear_ratio.value() > 0.0) || !std::isfinite(spec.gear_ratio.value())) {
        raise<UsageError>("gear ratio {} is not above 0", shortest(spec.gear_ratio.value()));
    }
    if (!(spec.sample_rate.value() > 0.0) || !std::isfinite(spec.sample_rate.value())) {
        raise<UsageError>("the sample rate is {} Hz; it must be known and above 0 Hz",
                          shortest(spec.sample_rate.value()));
    }
    if (spec.orders.empty()) raise<UsageError>("no orders to notch; the paper's are 1 and 2");
    for (std::size_t i = 0; i < spec.orders.size(); ++i) {
        if (!(spec.orders[i].value() > 0.0) || !std::isfinite(spec.orders[i].value())) {
            raise<UsageError>("order {} is not above 0", shortest(spec.orders[i].value()));
        }
        if (i > 0 && !(spec.orders[i - 1] < spec.orders[i])) {
            raise<UsageError>("order {} does not come after order {}; each order once, lowest first",
                              shortest(spec.orders[i].value()), shortest(spec.orders[i - 1].value()));
        }
    }
    if (!(spec.settle_band_percent > 0.0 && spec.settle_band_percent < 100.0)) {
        raise<UsageError>("settling band {} % is outside 0 to 100 %", shortest(spec.settle_band_percent));
    }
    if (!(spec.ratio_error >= 0.0 && spec.ratio_error < 0.5)) {
        raise<UsageError>("an error of {} % of the gear ratio is outside 0 to 50 %",
                          shortest(100.0 * spec.ratio_error));
    }
    if (!(spec.hysteresis.value() >= 0.0) || !std::isfinite(spec.hysteresis.value()))
        raise<UsageError>("a hysteresis of {} deg/s is below 0", shortest(spec.hysteresis.value()));
    if (!spec.amplitude_nm.empty() && spec.amplitude_nm.size() != spec.orders.size()) {
        raise<UsageError>("{} ripple amplitudes for {} orders", spec.amplitude_nm.size(), spec.orders.size());
    }
    for (const double amplitude : spec.amplitude_nm) {
        if (!(amplitude > 0.0) || !std::isfinite(amplitude))
            raise<UsageError>("ripple amplitude {} Nm is not above 0", shortest(amplitude));
    }
}

std::string_view outside_rule_name(OutsideRule rule) {
    constexpr std::array<std::string_view, 3> names{"pass", "hold", "fade"};
    return names[static_cast<std::size_t>(rule)];
}

Cascade Band::cascade() const {
    Cascade sections;
    for (const CandidateNotch& notch : notches) sections.push_back(notch.section);
    return sections;
}

std::vector<std::pair<DegPerSec, DegPerSec>> bands_by_spacing(const SpeedSpan& speeds, DegPerSec spacing) {
    const double a = speeds.from.value(), b = speeds.to.value(), width = spacing.value();
    if (!std::isfinite(a) || !std::isfinite(b) || !std::isfinite(width)) {
        raise<UsageError>("speed range {}:{}:{} is not finite", shortest(a), shortest(b), shortest(width));
    }
    if (!(a >= 0.0))
        raise<UsageError>("speed range starts at {} deg/s; bands are on |v|, so 0 or above", shortest(a));
    if (!(a < b)) {
        raise<UsageError>("speed range {}:{} deg/s is empty; it must end above its start, as {}:{} does",
                          shortest(a), shortest(b), shortest(b), shortest(a > b ? a : b + 1.0));
    }
    if (!(width > 0.0)) raise<UsageError>("band width {} deg/s is not above 0", shortest(width));
    const double exact = (b - a) / width;
    const double count = std::round(exact);
    if (!(exact < static_cast<double>(max_bands))) {
        raise<UsageError>("speed range {}:{}:{} makes more than {} bands", shortest(a), shortest(b),
                          shortest(width), max_bands);
    }
    if (count < 1.0 || std::abs(exact - count) > 1e-9 * exact) {
        const double upward = std::ceil(exact);
        raise<UsageError>(
            "speed range {}:{}:{} deg/s does not divide into whole bands ({:.6g} of them); a width of {:.6g} "
            "deg/s gives {:.0f}",
            shortest(a), shortest(b), shortest(width), exact, (b - a) / upward, upward);
    }
    std::vector<std::pair<DegPerSec, DegPerSec>> bands;
    double start = a;
    for (double i = 1.0; i <= count; ++i) {
        const double end = i == count ? b : without_dust(a + (b - a) * (i / count));
        bands.emplace_back(DegPerSec(start), DegPerSec(end));
        start = end;
    }
    return bands;
}

void measure_band(Band& band, const TableSpec& spec) {
    const Cascade cascade = band.cascade();
    const StepFigures figures = measure_step(cascade, spec.sample_rate, spec.settle_band_percent);
    band.dc_delay = group_delay(cascade, Hertz(0.0), SampledAt(spec.sample_rate));
    band.settle = figures.settle;
    band.settle_band_percent = spec.settle_band_percent;
    band.overshoot_percent = figures.overshoot_percent;
    const Left left = largest_left(cascade, spec, band);
    band.held_attenuation_db = -20.0 * portable::log10(left.largest_together);
    band.worst_attenuation_db.clear();
    band.predicted_residual_nm.clear();
    for (std::size_t n = 0; n < left.largest_gain.size(); ++n) {
        band.worst_attenuation_db.push_back(-20.0 * portable::log10(left.largest_gain[n]));
        if (spec.amplitude_nm.size() == left.largest_gain.size())
            band.predicted_residual_nm.push_back(spec.amplitude_nm[n] * left.largest_gain[n]);
    }
}

CandidateTable CandidateTable::design(const TableSpec& spec) {
    check_ripple(spec);
    if (spec.bands.empty()) raise<UsageError>("no speed bands to design for");
    check_bands(spec.bands);
    CandidateTable table;
    table.spec_ = spec;
    TableWork work;
    for (const auto& [from, to] : spec.bands) {
        Band band;
        band.number = static_cast<int>(table.bands_.size()) + 1;
        band.from = from;
        band.to = to;
        const DegPerSec middle = 0.5 * (from + to);
        try {
            for (const Order order : spec.orders) {
                const Hertz center(without_dust(ripple_frequency(order, spec.gear_ratio, middle).value()));
                const NotchSpec notch{center, spec.q, spec.depth_db, spec.width};
                band.notches.push_back({order, notch, design_notch(notch, spec.sample_rate)});
            }
            work.add(band, spec.settle_band_percent);
            measure_band(band, spec);
        } catch (const UsageError& error) {
            raise<UsageError>("{}: {}", band_label(band.number, from, to), error.what());
        }
        table.bands_.push_back(std::move(band));
    }
    return table;
}

CandidateTable CandidateTable::from_bands(TableSpec spec, std::vector<Band> bands) {
    spec.bands.clear();
    for (const Band& band : bands) spec.bands.emplace_back(band.from, band.to);
    check_ripple(spec);
    if (spec.bands.empty()) raise<UsageError>("no speed bands to design for");
    check_bands(spec.bands);
    TableWork work;
    for (std::size_t i = 0; i < bands.size(); ++i) {
        check_stored(bands[i], static_cast<int>(i) + 1, spec);
        work.add(bands[i], spec.settle_band_percent);
    }
    CandidateTable table;
    table.spec_ = std::move(spec);
    table.bands_ = std::move(bands);
    return table;
}

int CandidateTable::find(DegPerSec speed) const noexcept {
    const DegPerSec magnitude = abs(speed);
    const auto band = std::lower_bound(bands_.begin(), bands_.end(), magnitude,
                                       [](const Band& b, DegPerSec v) { return b.to < v; });
    if (band == bands_.end()) return -2;
    // Written so that a speed that is not a number finds no band.
    return band->from < magnitude ? static_cast<int>(band - bands_.begin()) : -1;
}

}  // namespace ripplenotch
