// SPDX-License-Identifier: MIT
#include "diagnose/engine/saturated_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/matrices/factorisations.hpp"
#include "core/vectors/dot.hpp"
#include "diagnose/engine/gram.hpp"
#include "ripplenotch/analysis/fourier.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch::engine {
namespace {

using Columns = std::vector<std::vector<double>>;

// Splines a quantity: enough that no smooth law leaves more than the noise, few enough to leave the noise.
constexpr std::size_t position_splines = 13, speed_splines = 18, time_splines = 16;
constexpr std::array loop_widths_deg = {0.1, 0.5, 2.0};
// A load on a spring, damped by a tenth, so that the next frequency is within the width of the last.
constexpr std::array ringing_hz = {1.6, 2.0, 2.5, 3.1, 3.9, 4.9, 6.1, 7.6};
constexpr std::size_t noise_order = 12;  // residual correlation beyond it was within its own error
constexpr std::size_t most_lines = 4;
// Power over the median at which a line or tone is taken; a line of white noise is at 10 or 15.
constexpr double line_power = 30.0;
constexpr double tone_share = 0.1;  // of the squares, that no line of a noise has
constexpr double lowest_tone_hz = 5.0;
constexpr std::size_t fewest_spikes = 4;
constexpr std::size_t spike_neighbours = 25;  // samples to each side
constexpr double highest_unknown = 1000.0;    // cycles per turn of lines where no gear ratio is known

double quantile(std::vector<double> values, double share) {
    const double place = share * static_cast<double>(values.size() - 1);
    const auto below = static_cast<std::ptrdiff_t>(place);
    std::nth_element(values.begin(), values.begin() + below, values.end());
    const double low = values[static_cast<std::size_t>(below)];
    if (static_cast<std::size_t>(below) + 1 == values.size()) return low;
    const double high = *std::min_element(values.begin() + below + 1, values.end());
    return low + (place - static_cast<double>(below)) * (high - low);
}

// Clamped cubic B-splines of a quantity between its quantiles of 0.1 and 99.9 %.
Columns splines(const std::vector<double>& x, std::size_t count) {
    constexpr std::size_t degree = 3;
    const double low = quantile(x, 0.001), high = std::max(quantile(x, 0.999), low + 1e-9);
    const std::size_t cells = count - degree;
    const double width = (high - low) / static_cast<double>(cells);
    const auto knot = [&](std::ptrdiff_t i) {
        return low + width * static_cast<double>(
                                 std::clamp<std::ptrdiff_t>(i, 0, static_cast<std::ptrdiff_t>(cells)));
    };
    Columns columns(count, std::vector<double>(x.size(), 0.0));
    for (std::size_t k = 0; k < x.size(); ++k) {
        const double at = std::clamp(x[k], low, high);
        const auto cell =
            std::min(static_cast<std::ptrdiff_t>((at - low) / width), static_cast<std::ptrdiff_t>(cells) - 1);
        // De Boor's recursion for the splines that are not zero in this cell.
        std::array<double, degree + 1> basis{1.0};
        for (std::size_t d = 1; d <= degree; ++d) {
            double saved = 0.0;
            for (std::size_t r = 0; r < d; ++r) {
                const auto step = static_cast<std::ptrdiff_t>(r);
                const double right = knot(cell + 1 + step) - at;
                const double left = at - knot(cell + 1 + step - static_cast<std::ptrdiff_t>(d));
                const double share = basis[r] / (right + left);
                basis[r] = saved + right * share;
                saved = left * share;
            }
            basis[d] = saved;
        }
        for (std::size_t i = 0; i <= degree; ++i) columns[static_cast<std::size_t>(cell) + i][k] = basis[i];
    }
    return columns;
}

std::vector<double> product(const std::vector<double>& a, const std::vector<double>& b) {
    std::vector<double> found(a.size());
    for (std::size_t k = 0; k < a.size(); ++k) found[k] = a[k] * b[k];
    return found;
}

void append(Columns& columns, Columns more) {
    for (auto& column : more) columns.push_back(std::move(column));
}

// cos and sin of cycles per output revolution times the angle.
Columns waves_over_angle(const Motion& motion, double cycles) {
    return ripple_columns(motion, std::array{cycles}, GearRatio(1.0));
}

// Frequencies of the strongest lines over the angle.
std::vector<double> strongest_lines(const RecordedMotion& recorded, const Baseline& base,
                                    const std::vector<double>& residual) {
    const double turns_per_s = recorded.fastest_deg_s() / 360.0;
    const double highest_of_ratio = base.ratio.value() > 0.0 ? 8.0 * base.ratio.value() : highest_unknown;
    const double highest = std::min(highest_of_ratio, 0.35 / recorded.step_s() / turns_per_s);
    AngleSpectrum spectrum = angle_spectrum(recorded, residual, 3.0, highest);
    std::vector<double> found;
    if (spectrum.power.empty()) return found;
    const double background = median_of(spectrum.power) / std::numbers::ln2;
    for (std::size_t line = 0; line < most_lines; ++line) {
        const auto top = std::max_element(spectrum.power.begin(), spectrum.power.end());
        if (*top < line_power * background) break;
        const double at = spectrum.cycles_per_turn[static_cast<std::size_t>(top - spectrum.power.begin())];
        found.push_back(at);
        for (std::size_t k = 0; k < spectrum.power.size(); ++k)
            if (std::abs(spectrum.cycles_per_turn[k] - at) < 2.0 / spectrum.turns) spectrum.power[k] = 0.0;
    }
    return found;
}

std::vector<double> masked(std::vector<double> values, const std::vector<unsigned char>& use) {
    for (std::size_t k = 0; k < values.size(); ++k)
        if (use[k] == 0) values[k] = 0.0;
    return values;
}

// Autoregression of a residual by Yule and Walker's equations.
void estimate_whitening(SaturatedFit& fit, const std::vector<unsigned char>& use) {
    const std::vector<double> z = masked(fit.residual_nm, use);
    std::array<double, noise_order + 1> correlation{};
    for (std::size_t lag = 0; lag <= noise_order; ++lag)
        correlation[lag] = dot(z.data(), z.data() + lag, z.size() - lag);
    const double power = std::max(correlation[0], 1e-300);
    for (double& value : correlation) value /= power;
    const auto order = static_cast<Eigen::Index>(noise_order);
    Eigen::MatrixXd matrix(order, order);
    Eigen::VectorXd right(order);
    for (Eigen::Index i = 0; i < order; ++i) {
        right[i] = correlation[static_cast<std::size_t>(i) + 1];
        for (Eigen::Index j = 0; j < order; ++j)
            matrix(i, j) = correlation[static_cast<std::size_t>(std::abs(i - j))] + (i == j ? 1e-6 : 0.0);
    }
    const Eigen::VectorXd weights = DefiniteFactors(matrix).solve(right);
    fit.whitening.assign(1, 1.0);
    for (Eigen::Index i = 0; i < order; ++i) fit.whitening.push_back(-weights[i]);
    std::vector<double> white = fit.residual_nm;
    filter_in_place(white, fit.whitening);
    double mean = 0.0, count = 0.0;
    for (std::size_t k = 0; k < white.size(); ++k)
        if (use[k] != 0) mean += white[k], count += 1.0;
    mean /= std::max(count, 1.0);
    for (double& value : white) value -= mean;
    fit.innovation_nm = std::max(rms_where(white, use), 1e-300);
}

}  // namespace

double rounded(double value, int digits) {
    if (value == 0.0) return 0.0;
    const double exponent = std::floor(portable::log10(std::abs(value)));
    const double unit = portable::pow(10.0, exponent - (digits - 1));
    return std::nearbyint(value / unit) * unit;
}

void filter_in_place(std::vector<double>& values, std::span<const double> filter) {
    std::vector<double> padded(filter.size() - 1 + values.size(), 0.0);
    const std::size_t memory = filter.size() - 1;
    std::copy(values.begin(), values.end(), padded.begin() + static_cast<std::ptrdiff_t>(memory));
    std::vector<double> weights;
    for (std::size_t i = 1; i < filter.size(); ++i) weights.push_back(-filter[i]);
    prediction_errors(padded.data() + memory, values.size(), weights.data(), memory, values.data());
}

AngleSpectrum angle_spectrum(const RecordedMotion& recorded, const std::vector<double>& residual,
                             double lowest, double highest, double spacing) {
    const std::vector<double>& position = recorded.motion().position_deg;
    const double low_deg = *std::min_element(position.begin(), position.end());
    AngleSpectrum found;
    found.turns = recorded.travel_deg() / 360.0;
    const double from = std::max(lowest, 2.0 / std::max(found.turns, 0.02));
    const double points = (highest - from) / (spacing / std::max(found.turns, 0.05));
    if (found.turns < 0.05 || points < 3.0 || points > 40000.0) return found;
    const auto bins = static_cast<std::size_t>(6.0 * highest * found.turns) + 64;
    std::size_t length = 1;
    while (static_cast<double>(length) < static_cast<double>(bins) / spacing) length *= 2;
    RealTransform transform(length);
    std::span<double> input = transform.in();
    std::fill(input.begin(), input.end(), 0.0);
    const double per_deg = static_cast<double>(bins) / (recorded.travel_deg() + 1e-9);
    for (std::size_t k = 0; k < position.size(); ++k) {
        const auto bin = static_cast<std::size_t>(per_deg * (position[k] - low_deg));
        input[std::min(bin, bins - 1)] += residual[k];
    }
    const auto sums = transform.run();
    const double unit = static_cast<double>(bins) / (static_cast<double>(length) * found.turns);
    for (std::size_t k = 0; k < sums.size(); ++k) {
        const double cycles = static_cast<double>(k) * unit;
        if (cycles < std::max(lowest, 2.0 / found.turns) || cycles > highest) continue;
        found.cycles_per_turn.push_back(cycles);
        found.power.push_back(std::norm(sums[k]));
    }
    return found;
}

std::optional<double> find_tone(const RecordedMotion& recorded, const std::vector<double>& residual) {
    double squares = 0.0, used = 0.0;
    for (const double r : residual) {
        squares += r * r;
        used += r != 0.0 ? 1.0 : 0.0;
    }
    const auto sums = real_fourier(residual);
    const double unit_hz = 1.0 / (recorded.step_s() * static_cast<double>(residual.size()));
    std::vector<double> power(sums.size());
    for (std::size_t k = 0; k < sums.size(); ++k)
        power[k] = static_cast<double>(k) * unit_hz < lowest_tone_hz ? 0.0 : std::norm(sums[k]);
    const auto top = static_cast<std::size_t>(std::max_element(power.begin(), power.end()) - power.begin());
    const std::size_t from = top - std::min<std::size_t>(top, 200), to = std::min(top + 201, power.size());
    const double usual = median_of(
        {power.begin() + static_cast<std::ptrdiff_t>(from), power.begin() + static_cast<std::ptrdiff_t>(to)});
    // Stretches that do not count spread a tone over its neighbours: then its share of the squares tells.
    const double explained = 2.0 * power[top] / std::max(used, 1.0);
    const bool stands_out = power[top] > line_power * usual || explained > tone_share * squares;
    if (!stands_out || power[top] == 0.0) return std::nullopt;
    // The peak is between the two largest values, at the share of their sizes.
    const double below = std::sqrt(power[top - 1]), at = std::sqrt(power[top]);
    const double above = top + 1 < power.size() ? std::sqrt(power[top + 1]) : 0.0;
    const double off = above > below ? above / (above + at) : -below / (below + at);
    const double hz = (static_cast<double>(top) + off) * unit_hz;
    return rounded(refine_peak(recorded.motion().time_s, residual, {hz, 0.5 * unit_hz}), 7);
}

SaturatedFit fit_saturated(const RecordedMotion& recorded, const Baseline& base, const SearchedTerms& terms,
                           const SaturatedFit* before) {
    const Motion& motion = recorded.motion();
    const std::vector<unsigned char>& use = recorded.usable();
    const std::size_t count = motion.size();
    SearchedTerms with_stated = base.stated;
    with_stated.insert(with_stated.end(), terms.begin(), terms.end());
    const MotorAngle angle = motor_angle(with_stated, base.ratio);
    const GearRatio ratio = angle.ratio;
    const Motion at_motor = angle.errors.empty() ? Motion{} : without_errors(motion, angle.errors);
    const Motion& of_ripple = angle.errors.empty() ? motion : at_motor;
    const Transforms transforms(with_stated);
    const auto sensed = [&](std::vector<double> column) {
        return transformed(std::move(column), transforms.all(), motion);
    };
    std::vector<double> forward(count), root_speed(count), speed(count), drag(count);
    for (std::size_t k = 0; k < count; ++k) {
        const double v = motion.velocity_deg_s[k];
        forward[k] = v > 0.0 ? 1.0 : 0.0;
        speed[k] = std::abs(v);
        root_speed[k] = std::copysign(v != 0.0 ? std::sqrt(speed[k]) : 0.0, v);
        drag[k] = v * speed[k];
    }
    const Columns over_position = splines(motion.position_deg, position_splines);
    const Columns over_time = splines(motion.time_s, time_splines);
    Columns loops;
    for (const double width_deg : loop_widths_deg)
        loops.push_back(friction_loop(motion.position_deg, width_deg * recorded.angle_scale()));

    Columns columns;
    for (const BaseColumn& column : base.columns) columns.push_back(column.torque_nm);
    columns.emplace_back(count, 1.0);
    for (const auto& spline : over_position) {
        columns.push_back(product(spline, forward));
        columns.push_back(spline);
        for (std::size_t k = 0; k < count; ++k) columns.back()[k] *= 1.0 - forward[k];
    }
    append(columns, splines(root_speed, speed_splines));
    append(columns, over_time);
    append(columns, loops);
    // What swings is found with all else; the smoothing is chosen without, as both take a delay for their
    // own.
    for (std::size_t i = 0; before && i < ringing_hz.size(); ++i) {
        const SearchedTerm ringing{&term_kind("start-stop-ringing"), {ringing_hz[i], 1.6 / ringing_hz[i]}};
        append(columns,
               unit_columns(*ringing.kind->effect, unit_values(ringing), {.motion = motion, .ratio = ratio}));
    }
    const std::size_t first_ripple = columns.size();
    const Columns ripple = base.ripple_waves(of_ripple, ratio);
    append(columns, ripple);
    const Columns turn = waves_over_angle(motion, 1.0);
    for (const auto& wave : ripple)
        for (const std::vector<double>* factor :
             std::array<const std::vector<double>*, 4>{&speed, &base.direction, &turn[0], &turn[1]})
            columns.push_back(product(wave, *factor));
    for (const SearchedTerm& term : terms) {
        const Situation situation{.motion = term.kind->effect->ripple_order ? of_ripple : motion,
                                  .ratio = ratio,
                                  .load_nm = before->load_nm};
        const Situation on_ripple{.motion = motion, .ratio = ratio, .load_nm = before->sensed_nm};
        if (term.kind->role == Role::joint_torque || term.kind->role == Role::sensor_torque)
            append(columns, unit_columns(*term.kind->effect, unit_values(term), situation));
        if (term.kind->role == Role::ripple_change) {
            for (const auto& factor : ripple_factors(term, on_ripple)) {
                if (term.kind->effect->polar)
                    columns.push_back(product(before->ripple_nm, factor));
                else
                    for (const auto& wave : ripple) columns.push_back(product(wave, factor));
            }
        }
    }
    if (!transforms.all().empty()) {
        for (auto& column : columns) column = sensed(std::move(column));
        if (!transforms.elastic_joint.empty())
            for (const auto& wave : ripple) columns.push_back(transformed(wave, transforms.sensor, motion));
    }
    std::vector<double> known =
        base.known_nm.empty() ? std::vector<double>(count, 0.0) : sensed(base.known_nm);
    const bool has_scale = !base.columns.empty() && base.columns.front().name == "simulated";
    if (has_scale) {
        // Free with the inertia, its size would cancel the noise of the measured acceleration.
        const std::vector<double> scale =
            regress({columns.front(), std::vector<double>(count, 1.0)}, recorded.torque_nm(), use);
        add_scaled(scale[0], columns.front().data(), known.data(), count);
    }
    std::vector<double> target = recorded.torque_nm();
    add_scaled(-1.0, known.data(), target.data(), count);

    Eigen::MatrixXd gram;
    Eigen::VectorXd factors;
    std::vector<double> residual;
    const auto refit = [&] {
        std::vector<std::span<const double>> all = {target};
        all.insert(all.end(), columns.begin(), columns.end());
        extend_gram(gram, all, use);
        std::vector<double> weights(columns.size(), ridge);
        if (has_scale) weights.front() = 1.0 / ridge;
        factors = solve_normal_equations(gram, weights);
        residual = target;
        for (std::size_t c = 0; c < columns.size(); ++c)
            add_scaled(-factors[static_cast<Eigen::Index>(c)], columns[c].data(), residual.data(), count);
    };
    refit();
    const std::size_t fitted = columns.size();
    const std::vector<double> seen = masked(residual, use);
    for (const double cycles : strongest_lines(recorded, base, seen))
        for (auto& wave : waves_over_angle(motion, cycles)) columns.push_back(sensed(std::move(wave)));
    if (!contains(terms, "tone")) {
        if (const auto tone_hz = find_tone(recorded, seen)) {
            const SearchedTerm tone{&term_kind("tone"), {*tone_hz, 0.0}};
            append(columns,
                   unit_columns(*tone.kind->effect, unit_values(tone), {.motion = motion, .ratio = ratio}));
        }
    }
    if (columns.size() > fitted) refit();

    SaturatedFit found;
    found.residual_nm = residual;
    found.noise_nm = rms_where(residual, use);
    found.inertia_nm_per_deg_s2 =
        base.known_inertia_nm_per_deg_s2 + factors[static_cast<Eigen::Index>(base.inertia_place)];
    found.ripple_nm.assign(count, 0.0);
    for (std::size_t c = 0; c < ripple.size(); ++c)
        add_scaled(factors[static_cast<Eigen::Index>(first_ripple + c)], columns[first_ripple + c].data(),
                   found.ripple_nm.data(), count);
    std::vector<double> total = known;
    for (std::size_t c = 0; c < first_ripple; ++c)
        add_scaled(factors[static_cast<Eigen::Index>(c)], columns[c].data(), total.data(), count);
    // The load is all but what turns its sign with the speed: with that part friction would explain itself.
    Columns parts = {base.direction, motion.velocity_deg_s, drag, root_speed};
    append(parts, loops);
    const std::size_t odd = parts.size();
    for (std::size_t c = 0; c < base.columns.size(); ++c)
        if (base.columns[c].bears_load) parts.push_back(columns[c]);
    append(parts, over_position);
    append(parts, over_time);
    const std::vector<double> shares = regress(parts, total, use);
    found.load_nm = total;
    for (std::size_t c = 0; c < odd; ++c)
        add_scaled(-shares[c], parts[c].data(), found.load_nm.data(), count);
    found.sensed_nm = std::move(total);
    for (double& value : found.load_nm) value = std::abs(value);
    for (double& value : found.sensed_nm) value = std::abs(value);
    estimate_whitening(found, use);
    return found;
}

FarSamples find_spikes(const RecordedMotion& recorded, const SaturatedFit& fit) {
    const std::vector<unsigned char>& use = recorded.usable();
    std::vector<double> r = fit.residual_nm, sizes;
    for (std::size_t k = 0; k < r.size(); ++k) {
        if (use[k] == 0)
            r[k] = 0.0;
        else
            sizes.push_back(std::abs(r[k]));
    }
    if (sizes.empty()) return {};
    const double deviation_nm = deviations_of_median * median_of(sizes);
    FarSamples found;
    const std::vector<double>& velocity = recorded.motion().velocity_deg_s;
    // Between which samples friction changes its sign the log does not say.
    const auto is_reversal = [&](std::size_t k) { return velocity[k - 2] * velocity[k + 2] <= 0.0; };
    std::size_t alone = 0, in_motion = 0;
    for (std::size_t k = 2; k + 2 < r.size(); ++k) {
        if (std::abs(r[k]) <= 8.0 * deviation_nm) continue;
        found.slots.push_back(k);
        double squares = 0.0, count = 0.0;
        const std::size_t from = k - std::min(k, spike_neighbours);
        const std::size_t to = std::min(k + spike_neighbours, r.size());
        for (std::size_t i = from; i < to; ++i) {
            if (i + 1 >= k && i <= k + 1) continue;
            squares += r[i] * r[i];
            count += 1.0;
        }
        const bool stands_out = std::abs(r[k]) > 3.0 * std::max(std::abs(r[k - 1]), std::abs(r[k + 1])) &&
                                std::abs(r[k]) > 6.0 * std::sqrt(squares / count) &&
                                std::abs(r[k] - 0.5 * (r[k - 1] + r[k + 1])) > 7.0 * deviation_nm;
        alone += stands_out ? 1 : 0;
        in_motion += stands_out && !is_reversal(k) ? 1 : 0;
    }
    if (alone < fewest_spikes) found.slots.clear();
    found.are_spikes = in_motion >= fewest_spikes;
    return found;
}

}  // namespace ripplenotch::engine
