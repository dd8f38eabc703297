// SPDX-License-Identifier: MIT
#include "analysis/lines/disagreement.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numeric>
#include <optional>
#include <set>
#include <string>

#include "analysis/shared_limits.hpp"
#include "ripplenotch/analysis/alias.hpp"
#include "ripplenotch/analysis/spectrum.hpp"
#include "ripplenotch/analysis/sweeps.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {

namespace {

constexpr std::size_t most_samples = 20000;  // chosen, not derived: bounds the time
constexpr std::size_t most_folds = 40;       // chosen, not derived: bounds the time
constexpr double most_grid = 300.0;          // chosen, not derived: bounds the time

double rate_in_orders(Hertz rate, DegPerSec speed) {
    return 360.0 * rate.value() / std::max(std::abs(speed.value()), 1e-9);
}

/// Sweeps that vouch for the seen order, with the noise there; images share it.
struct Witness {
    const Sweep* sweep = nullptr;
    double noise = 0.0;
};

std::vector<Witness> witnesses_of(std::span<const Sweep> sweeps, const Stack& angle, double seen) {
    const auto bin = static_cast<std::size_t>(std::lround(std::max(0.0, seen / angle.spacing)));
    std::vector<std::size_t> by_weight(sweeps.size());
    std::iota(by_weight.begin(), by_weight.end(), std::size_t{0});
    std::stable_sort(by_weight.begin(), by_weight.end(), [&](std::size_t a, std::size_t b) {
        return angle.sweep_weights[a] > angle.sweep_weights[b];
    });
    std::vector<Witness> witnesses;
    std::size_t samples = 0;
    for (const std::size_t i : by_weight) {
        const auto& floors = angle.floors[i];
        if (bin >= floors.size() || floors[bin] <= 0.0F) continue;
        samples += sweeps[i].turns.size();
        if (samples > most_samples) break;
        witnesses.push_back({&sweeps[i], static_cast<double>(floors[bin])});
    }
    return witnesses;
}

double gain_of_comb(std::span<const Witness> witnesses, double order) {
    double most = 0.0, gain = 0.0;
    for (const Witness& witness : witnesses) {
        const double weight = witness.sweep->effective_samples();
        const double power =
            std::norm(fourier_point(witness.sweep->turns, witness.sweep->value, order).value);
        most = std::max(most, weight);
        gain += weight * (power / witness.noise - 1.0);
    }
    return most > 0.0 ? gain / most : 0.0;
}

/// Largest gain between two orders: a grid of a third of a resolution, then halved steps around its best.
Fold best_between(std::span<const Witness> witnesses, double from, double to, double step) {
    step = std::max(step, (to - from) / most_grid);
    Fold best{0.5 * (from + to), -1e300};
    for (double at = std::max(from, step); at <= to; at += step) {
        const double gain = gain_of_comb(witnesses, at);
        if (gain > best.gain) best = {at, gain};
    }
    for (double reach = step / 2.0; reach > step / 200.0; reach /= 2.0) {
        for (const double at : {best.order_output - reach, best.order_output + reach}) {
            const double gain = gain_of_comb(witnesses, at);
            if (gain > best.gain) best = {at, gain};
        }
    }
    return best;
}

}  // namespace

std::vector<Fold> folds_of(std::span<const Sweep> sweeps, const Stack& angle, const SeenOrder& order) {
    const auto [seen, highest] = order;
    const std::vector<Witness> witnesses = witnesses_of(sweeps, angle, seen);
    std::vector<Fold> folds;
    if (witnesses.empty()) return folds;
    const Sweep& heaviest = *witnesses.front().sweep;
    const double slow = rate_in_orders(Hertz(heaviest.rate_hz), DegPerSec(heaviest.slow_deg_s));
    const double quick = rate_in_orders(Hertz(heaviest.rate_hz), DegPerSec(heaviest.quick_deg_s));
    const double step = 0.5 / heaviest.length_turns, reach = 6.0 * step;
    for (double k = 1.0; k * quick - seen <= highest && folds.size() < most_folds; k += 1.0) {
        for (const double side : {-1.0, 1.0}) {
            const double from = k * quick + side * seen - reach, to = k * slow + side * seen + reach;
            // An image that falls on the seen order itself carries no information.
            const bool on_itself = from < seen + 4.0 * angle.resolution && to > seen - 4.0 * angle.resolution;
            if (from < highest && !on_itself) folds.push_back(best_between(witnesses, from, to, step));
        }
    }
    std::stable_sort(folds.begin(), folds.end(),
                     [](const Fold& a, const Fold& b) { return a.gain > b.gain; });
    return folds;
}

double excess_scatter(double squares, double freedom) {
    if (!(freedom >= 1.0)) return 1.0;
    constexpr double normal_99 = 2.3263;  // 99 % quantile of a normal variable
    // 99 % quantile of chi-square by the cube root of Wilson and Hilferty, within 1 % of the exact one.
    const double share = 2.0 / (9.0 * freedom);
    const double limit = freedom * portable::pow(1.0 - share + normal_99 * std::sqrt(share), 3.0);
    return squares > limit ? std::sqrt(squares / freedom) : 1.0;
}

namespace {

constexpr int highest_multiple = 12;          // chosen, not derived
constexpr std::size_t fewest_multiples = 3;   // two frequencies are multiples of something always
constexpr double lowest_hz = 1.0;             // chosen, not derived: below is motion
constexpr double same_family_share = 0.0025;  // largest deviation of tones of one source from their multiples

/// A fixed tone and the standard error of its frequency.
struct Tone {
    double hz = 0.0, error_hz = 0.0;
};

struct FoundFamily {
    double hz = 0.0, hz_error = 0.0;
    std::vector<int> multiples;  // ascending
    double nats = 0.0;           // how much likelier than chance, tries counted
};

double allowance_hz(const Tone& tone) { return 4.0 * tone.error_hz + same_family_share * tone.hz; }

/// The family of one frequency, which is fitted to all tones near its multiples.
FoundFamily matched_family(std::span<const Tone> tones, double hz) {
    FoundFamily family;
    std::vector<int> multiple(tones.size());
    for (int round = 0; round < 2; ++round) {
        double top = 0.0, bottom = 0.0;
        for (std::size_t i = 0; i < tones.size(); ++i) {
            const double n = std::round(tones[i].hz / hz), allowed = allowance_hz(tones[i]);
            const bool fits = n >= 1.0 && n <= highest_multiple &&
                              std::abs(tones[i].hz - n * hz) <= allowed * (round == 0 ? n + 1.0 : 1.0);
            multiple[i] = fits ? static_cast<int>(n) : 0;
            if (!fits) continue;
            top += n * tones[i].hz / (allowed * allowed);
            bottom += n * n / (allowed * allowed);
        }
        if (!(bottom > 0.0)) return {};
        hz = top / bottom;
        family.hz_error = 0.25 / std::sqrt(bottom);
    }
    family.hz = hz;
    double most = 0.0;
    int common = 0;
    std::set<int> multiples;
    for (std::size_t i = 0; i < tones.size(); ++i) {
        if (multiple[i] == 0) continue;
        const double nats = -portable::log(std::min(1.0, 2.0 * allowance_hz(tones[i]) / hz));
        family.nats += nats;
        most = std::max(most, nats);
        multiples.insert(multiple[i]);
        common = std::gcd(common, multiple[i]);
    }
    // One tone and the choice of its multiple make the frequency: that one is no evidence.
    const double tries = portable::log(static_cast<double>(tones.size()) * highest_multiple);
    const bool one_source = multiples.size() >= fewest_multiples && common == 1;
    family.nats = one_source ? family.nats - most - tries : 0.0;
    family.multiples.assign(multiples.begin(), multiples.end());
    return family;
}

}  // namespace

std::vector<ToneFamily> families_among(std::span<const Reported> reported) {
    std::vector<Tone> tones;
    for (const Reported& one : reported) {
        if (one.line.kind == LineKind::tone && one.line.hz) tones.push_back({*one.line.hz, one.hz_error});
    }
    FoundFamily best;
    for (const Tone& tone : tones) {
        for (int n = 1; n <= highest_multiple && tone.hz / n >= lowest_hz; ++n) {
            FoundFamily family = matched_family(tones, tone.hz / n);
            if (family.nats > best.nats) best = std::move(family);
        }
    }
    if (best.nats < decisive_nats) return {};
    return {{best.hz, best.hz_error, best.multiples}};
}

namespace {

/// Which multiple of the mains frequency a tone is; 0: none.
int mains_multiple(const Line& line, double mains_hz) {
    constexpr double tolerance = 0.004;  // mains keep within 1 %, nearly always within a fifth of that
    if (line.kind != LineKind::tone || !line.hz) return 0;
    const double n = std::round(*line.hz / mains_hz);
    const bool near = n >= 1.0 && n <= 6.0 && std::abs(*line.hz - n * mains_hz) <= tolerance * n * mains_hz;
    return near ? static_cast<int>(n) : 0;
}

}  // namespace

void name_mains(std::span<Reported> reported) {
    const auto support = [&](double mains_hz) {
        double sum = 0.0;
        for (const Reported& one : reported) {
            if (const int n = mains_multiple(one.line, mains_hz)) sum += one.line.snr / n;
        }
        return sum;
    };
    const double mains_hz = support(60.0) > support(50.0) ? 60.0 : 50.0;
    for (Reported& one : reported) {
        const int n = mains_multiple(one.line, mains_hz);
        if (n == 0) continue;
        const std::string name = n == 1 ? fmt::format("mains {:.0f} Hz", mains_hz)
                                        : fmt::format("{} times mains {:.0f} Hz", n, mains_hz);
        one.line.note = one.line.note.empty() ? name : name + ", " + one.line.note;
    }
}

namespace {

constexpr std::size_t most_hums = 3;  // chosen, not derived: a list that a person reads

/// Keeps the hump with the most torque among those that overlap.
void add(const SpectralHump& hump, std::vector<Hum>& hums) {
    const Hum hum{hump.from_hz, hump.to_hz, hump.peak_hz, hump.rms_nm};
    const auto same = std::find_if(hums.begin(), hums.end(), [&](const Hum& known) {
        return known.from_hz <= hum.to_hz && hum.from_hz <= known.to_hz;
    });
    if (same == hums.end()) {
        hums.push_back(hum);
    } else if (hum.rms_nm > same->rms_nm) {
        *same = hum;
    }
}

}  // namespace

std::vector<Hum> hums_beside(const MotionLines& motion, const std::vector<Line>& lines) {
    double ripple_nm = 0.0;
    for (const Line& line : lines) {
        if (line.kind != LineKind::tone) ripple_nm = std::max(ripple_nm, line.amplitude_nm);
    }
    std::vector<Hum> hums;
    // The residual of lines in a sweep has no single speed: humps due to them are smaller than the lines.
    for (const SpectralHump& hump : motion.humps) add(hump, hums);
    // A sine of this amplitude has as much torque in it.
    std::erase_if(hums, [&](const Hum& hum) { return std::sqrt(2.0) * hum.rms_nm <= ripple_nm; });
    std::stable_sort(hums.begin(), hums.end(),
                     [](const Hum& a, const Hum& b) { return a.rms_nm > b.rms_nm; });
    if (hums.size() > most_hums) hums.resize(most_hums);
    return hums;
}

namespace {

constexpr double least_spread = 0.1;  // scatter of amplitudes as a share of their mean
// Scatter of amplitudes from run to run of a joint that has not changed.
constexpr double usual_scatter = 0.03;
constexpr double like_speed_share = 0.05;                          // chosen, not derived
constexpr double like_order_share = 0.01, like_ratio_share = 0.1;  // chosen, not derived
constexpr double least_chance = 0.001;         // recordings that agree differ by as much less often than this
constexpr std::size_t fewest_for_scatter = 3;  // recordings: fewer have no median
constexpr double least_apart_deg = 20.0;       // chosen, not derived: difference of phases
constexpr double usual_turn_deg = 0.05;        // rotation of the joint by the load's torsion, from run to run
constexpr double coherent = 0.7;               // |sum| over sum of magnitudes of a line's phasors
constexpr double least_above_noise = 4.0;      // in amplitude

using Value = Disagreement::Value;

/// Chance that chi-square with so many degrees of freedom is larger: Wilson and Hilferty's cube root.
double chance_of(double chi_square, double freedom) {
    const double spread = 2.0 / (9.0 * freedom);
    const double normal = (portable::cbrt(chi_square / freedom) - (1.0 - spread)) / std::sqrt(spread);
    return 0.5 * std::erfc(normal / std::sqrt(2.0));
}

/// The chance that values which are one differ by as much of their errors.
double chance_of_alike(const std::vector<Value>& values) {
    double top = 0.0, bottom = 0.0, misfit = 0.0;
    for (const Value& one : values) {
        top += one.value / (one.error * one.error);
        bottom += 1.0 / (one.error * one.error);
    }
    for (const Value& one : values) {
        const double off = (one.value - top / bottom) / one.error;
        misfit += off * off;
    }
    return chance_of(misfit, static_cast<double>(values.size()) - 1.0);
}

/// Signed speeds.
bool like_speed(double speed, double other) {
    return std::abs(speed - other) <= like_speed_share * std::abs(other);
}

const Line* same_line(const Identification& one, double order_output) {
    const Line* nearest = nullptr;
    for (const Line& line : one.lines) {
        if (!line.order_output || line.kind == LineKind::tone) continue;
        const double off = std::abs(*line.order_output - order_output);
        if (off > like_order_share * order_output) continue;
        if (nearest == nullptr || off < std::abs(*nearest->order_output - order_output)) nearest = &line;
    }
    return nearest;
}

/// Mean amplitude of a line near a speed, signed, with its error: of noise, or of the scatter where there are
/// enough.
std::optional<Value> amplitude_at(std::size_t recording, const Line& line, double speed_deg_s) {
    double sum = 0.0, noise = 0.0, count = 0.0, square = 0.0;
    for (const AmplitudeAtSpeed& at : line.by_speed) {
        if (!like_speed(at.speed_deg_s, speed_deg_s)) continue;
        // Half of the noise power near a line is in quadrature and changes its phase.
        const double error = at.amplitude_nm / std::max(at.snr, 1.0) / std::sqrt(2.0);
        sum += at.amplitude_nm;
        square += at.amplitude_nm * at.amplitude_nm;
        noise += error * error;
        count += 1.0;
    }
    if (count == 0.0) return std::nullopt;
    const double mean = sum / count;
    double variance = noise / (count * count);
    if (count >= static_cast<double>(fewest_for_scatter))
        variance = std::max(variance, (square / count - mean * mean) / (count - 1.0));
    return Value{recording, mean, portable::hypot(std::sqrt(std::max(variance, 0.0)), usual_scatter * mean)};
}

/// The speeds at which most recordings show the line, and what each of these shows there.
std::vector<Value> amplitudes_at_like_speed(std::span<const Identification> each, double order_output) {
    std::vector<Value> best;
    for (const Identification& one : each) {
        const Line* line = same_line(one, order_output);
        if (line == nullptr) continue;
        for (const AmplitudeAtSpeed& at : line->by_speed) {
            std::vector<Value> values;
            for (std::size_t i = 0; i < each.size(); ++i) {
                const Line* other = same_line(each[i], order_output);
                if (other == nullptr) continue;
                if (const auto value = amplitude_at(i, *other, at.speed_deg_s)) values.push_back(*value);
            }
            if (values.size() > best.size()) best = std::move(values);
        }
    }
    return best;
}

std::optional<Disagreement> about_amplitude(const Line& line, std::span<const Identification> each) {
    std::vector<Value> values = amplitudes_at_like_speed(each, *line.order_output);
    if (values.size() < 2) return std::nullopt;
    const auto by_value = [](const Value& a, const Value& b) { return a.value < b.value; };
    const auto [least, most] = std::minmax_element(values.begin(), values.end(), by_value);
    const double chance = chance_of_alike(values);
    if (chance > least_chance || most->value < (1.0 + least_spread) * least->value) return std::nullopt;
    return Disagreement{Disagreement::About::amplitude, line.order, line.order_output, std::move(values),
                        chance};
}

/// Compares ratios near the common one only: half of it is another interpretation of the same lines.
std::optional<Disagreement> about_ratio(const Identification& together,
                                        std::span<const Identification> each) {
    std::vector<Value> values;
    if (!together.gear_ratio.value) return std::nullopt;
    const double common = *together.gear_ratio.value;
    for (std::size_t i = 0; i < each.size(); ++i) {
        const GearRatioFit& fit = each[i].gear_ratio;
        if (fit.value && std::abs(*fit.value - common) < like_ratio_share * common)
            values.push_back({i, *fit.value, std::max(0.25 * (fit.ci95_high - fit.ci95_low), 1e-9)});
    }
    if (values.size() < 2) return std::nullopt;
    const double chance = chance_of_alike(values);
    if (chance > least_chance) return std::nullopt;
    return Disagreement{Disagreement::About::ratio, {}, {}, std::move(values), chance};
}

/// The line in one sweep: amplitude * exp(i phase) over the angle of the joint.
struct Phasor {
    double speed_deg_s = 0.0, middle_turns = 0.0;
    std::complex<double> value;
    double noise_power = 0.0;  ///< noise power in |value|^2, from the cells near the line
};

/// The line in one recording near a speed.
struct Phase {
    std::size_t number = 0;
    double deg = 0.0, error_deg = 0.0, middle_turns = 0.0;
};

/// The sweeps of a recording with a position: phases of others cannot be compared.
struct Recording {
    std::size_t number = 0;  ///< as handed over, from 0
    std::vector<Sweep> sweeps;
};

double turned_to_half(double deg) { return deg - 360.0 * std::round(deg / 360.0); }

double degrees_of(std::complex<double> value) { return portable::arg(value) * degrees_per_radian; }

/// Variance of the mean of phases that differ from it by these, where there are enough to determine it.
double scatter_of(std::span<const double> off_deg) {
    if (off_deg.size() < fewest_for_scatter) return 0.0;
    double square = 0.0;
    for (const double off : off_deg) square += off * off;
    const auto count = static_cast<double>(off_deg.size());
    return square / (count * (count - 1.0));
}

/// Values about their common phase, so that none stands a turn apart.
void unwrap_about_mean(std::vector<Disagreement::Value>& values) {
    std::complex<double> sum;
    for (const auto& one : values)
        sum += std::complex(portable::cos_degrees(one.value), portable::sin_degrees(one.value)) /
               (one.error * one.error);
    const double mean = degrees_of(sum);
    for (auto& one : values) one.value = mean + turned_to_half(one.value - mean);
}

double farthest_apart(const std::vector<Disagreement::Value>& values) {
    double apart = 0.0;
    for (const auto& a : values) {
        for (const auto& b : values) apart = std::max(apart, std::abs(turned_to_half(a.value - b.value)));
    }
    return apart;
}

Phasor phasor_of(const Sweep& sweep, double order_output) {
    const auto at = [&](double order) {
        return 2.0 / sweep.weight_sum * fourier_point(sweep.turns, sweep.value, order).value;
    };
    Phasor seen{sweep.mean_deg_s, 0.5 * (sweep.turns.front() + sweep.turns.back()), at(order_output), 0.0};
    // The window of a line ends two cells from it.
    double count = 0.0;
    for (const double cells : {-5.0, -4.0, -3.0, 3.0, 4.0, 5.0}) {
        const double near = order_output + cells / sweep.length_turns;
        if (near < 1.0 / sweep.length_turns) continue;
        seen.noise_power += std::norm(at(near));
        count += 1.0;
    }
    seen.noise_power /= std::max(count, 1.0);
    return seen;
}

std::optional<Phase> phase_at(std::size_t number, std::span<const Phasor> seen, double speed_deg_s) {
    std::complex<double> sum;
    double lengths = 0.0, noise = 0.0, middle = 0.0, count = 0.0;
    std::vector<double> phases_deg;
    for (const Phasor& one : seen) {
        if (!like_speed(one.speed_deg_s, speed_deg_s)) continue;
        sum += one.value;
        lengths += std::abs(one.value);
        noise += one.noise_power;
        middle += one.middle_turns;
        count += 1.0;
        phases_deg.push_back(degrees_of(one.value));
    }
    const double length = std::abs(sum);
    if (count == 0.0 || length < coherent * lengths || length < least_above_noise * std::sqrt(noise))
        return std::nullopt;
    const double mean_deg = degrees_of(sum);
    for (double& phase : phases_deg) phase = turned_to_half(phase - mean_deg);
    // Half of the noise lies across the line.
    const double by_noise = degrees_per_radian * std::sqrt(0.5 * noise) / length;
    return Phase{number, mean_deg, std::sqrt(by_noise * by_noise + scatter_of(phases_deg)), middle / count};
}

/// At the speed at which most recordings show the line.
std::vector<Phase> phases_of(std::span<const Recording> recordings, double order_output) {
    std::vector<std::vector<Phasor>> seen;
    std::vector<double> speeds;
    for (const Recording& one : recordings) {
        auto& phasors = seen.emplace_back();
        for (const Sweep& sweep : one.sweeps) {
            phasors.push_back(phasor_of(sweep, order_output));
            const auto near = [&](double speed) { return like_speed(speed, phasors.back().speed_deg_s); };
            if (std::none_of(speeds.begin(), speeds.end(), near))
                speeds.push_back(phasors.back().speed_deg_s);
        }
    }
    std::vector<Phase> most;
    for (const double speed : speeds) {
        std::vector<Phase> phases;
        for (std::size_t i = 0; i < seen.size(); ++i) {
            const auto phase = phase_at(recordings[i].number, seen[i], speed);
            if (phase) phases.push_back(*phase);
        }
        if (phases.size() > most.size()) most = std::move(phases);
    }
    return most;
}

std::optional<Disagreement> about_phase(const Line& line, std::span<const Recording> recordings) {
    if (recordings.size() < 2 || !line.order_output_stderr) return std::nullopt;
    const std::vector<Phase> phases = phases_of(recordings, *line.order_output);
    if (phases.size() < 2) return std::nullopt;
    double middle = 0.0;
    for (const Phase& one : phases) middle += one.middle_turns / static_cast<double>(phases.size());
    const double by_load = usual_turn_deg * *line.order_output;
    std::vector<Disagreement::Value> values;
    for (const Phase& one : phases) {
        const double by_order = 360.0 * *line.order_output_stderr * (one.middle_turns - middle);
        values.push_back({one.number, one.deg, portable::hypot(one.error_deg, by_order, by_load)});
    }
    unwrap_about_mean(values);
    const double chance = chance_of_alike(values);
    if (chance > least_chance || farthest_apart(values) < least_apart_deg) return std::nullopt;
    return Disagreement{Disagreement::About::phase, line.order, line.order_output, std::move(values), chance};
}

}  // namespace

std::vector<Disagreement> disagreements(const Identification& together, std::span<const Identification> each,
                                        std::span<const TraceView> logs) {
    std::vector<Disagreement> found;
    if (each.size() < 2) return found;
    if (auto ratio = about_ratio(together, each)) found.push_back(std::move(*ratio));
    std::vector<Recording> recordings;
    for (std::size_t i = 0; i < logs.size(); ++i) {
        if (logs[i].has_position()) recordings.push_back({i, cut_sweeps(logs.subspan(i, 1), {}).pieces});
    }
    for (const Line& line : together.lines) {
        if (!line.order_output || line.kind == LineKind::tone) continue;
        if (auto amplitude = about_amplitude(line, each)) found.push_back(std::move(*amplitude));
        if (auto phase = about_phase(line, recordings)) found.push_back(std::move(*phase));
    }
    return found;
}

}  // namespace ripplenotch
