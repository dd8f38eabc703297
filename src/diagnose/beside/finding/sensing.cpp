// SPDX-License-Identifier: MIT
#include "diagnose/beside/finding/sensing.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/matrices/normal_errors.hpp"
#include "core/vectors/dot.hpp"
#include "diagnose/beside/naming/evidence.hpp"
#include "diagnose/case/place.hpp"
#include "diagnose/search/hearing.hpp"
#include "diagnose/telling/summary.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/model/sensors.hpp"

namespace ripplenotch {
namespace {

// Both effects of the sensor have one parameter, a time in seconds.
Term sensor_of(const Effect& effect, double seconds) { return {&effect, {seconds}}; }

double square_of(const std::vector<double>& values) {
    return dot(values.data(), values.data(), values.size());
}

// Effects of the sensor that are examined, the delay first: it has no rival when the torque is early.
std::vector<const Effect*> sensors_among(std::span<const Effect* const> examined) {
    std::vector<const Effect*> sensors;
    for (const Effect* effect : examined) {
        if (effect->side == Side::sensor && effect->parameters.size() == 1) sensors.push_back(effect);
    }
    std::stable_sort(sensors.begin(), sensors.end(), [](const Effect* a, const Effect* b) {
        return a->parameters[0].lower < b->parameters[0].lower;
    });
    return sensors;
}

double price_of_sensor(const Sums& sums, const Effect& effect, std::size_t effects) {
    return portable::log(static_cast<double>(sums.lens().ground().rows())) +
           2.0 * portable::log(static_cast<double>(effect.parameters[0].tried.size())) +
           2.0 * portable::log(static_cast<double>(effects) / sums.lens().rules().screening.false_alarm);
}

// What is left out of fold by the same names with this sensor, made white as `like` does.
std::vector<double> left_with(const Unsensed& plain, const std::optional<Term>& sensor, const Lens& like,
                              const std::vector<Shape>& shapes) {
    const Lens lens(like, sensor ? with_sensor(plain.model, *sensor) : plain.model, plain.given, {});
    Sums sums(lens);
    Names names;
    for (const Shape& shape : shapes) names.push_back(sums.place_of(shape));
    return sums.residual_outside(names);
}

std::vector<Shape> shapes_at(const Sums& sums, const Names& names) {
    std::vector<Shape> shapes;
    for (const std::size_t name : names) shapes.push_back(sums.shapes()[name]);
    return shapes;
}

// A sensor's time, what is left there, and how that changes with it.
struct Tuned {
    double seconds = 0.0;
    std::vector<double> left, slope;
};

// One step of Gauss and Newton from `seconds`, at most by half of it.
Tuned tuned_once(const Unsensed& plain, const Effect& effect, double seconds, const Lens& like,
                 const std::vector<Shape>& shapes) {
    const double nudge = std::max(0.05 * std::abs(seconds), 0.05e-3);
    const auto at = [&](double s) { return left_with(plain, sensor_of(effect, s), like, shapes); };
    Tuned tuned{seconds, at(seconds), at(seconds + nudge)};
    const std::vector<double> below = at(seconds - nudge);
    add_scaled(-1.0, below.data(), tuned.slope.data(), tuned.slope.size());
    for (double& slope : tuned.slope) slope /= 2.0 * nudge;
    const double steepness = square_of(tuned.slope);
    if (!(steepness > 0.0)) return tuned;
    const double most = 0.5 * std::abs(seconds);
    const double step =
        std::clamp(-dot(tuned.slope.data(), tuned.left.data(), tuned.left.size()) / steepness, -most, most);
    tuned.seconds += step;
    add_scaled(step, tuned.slope.data(), tuned.left.data(), tuned.left.size());
    return tuned;
}

Tuned tuned_from(const Unsensed& plain, const Effect& effect, double seconds, const Lens& like,
                 const std::vector<Shape>& shapes) {
    const double first = tuned_once(plain, effect, seconds, like, shapes).seconds;
    return tuned_once(plain, effect, first, like, shapes);
}

// Squares that are left when the torque is taken to be late by so many samples.
double left_late(const Unsensed& plain, std::ptrdiff_t samples) {
    return square_of(plain.sums.residual_outside(plain.names, plain.sums.lens().target_earlier(samples)));
}

// The whole samples by which the torque is late that leave least; 0 where an end of the range does.
std::ptrdiff_t best_late(const Unsensed& plain, const Effect& delay) {
    const double rate_hz = plain.sums.lens().looked_at().motion.sample_rate.value();
    const auto& tried = delay.parameters[0].tried;
    const auto [low_s, high_s] = std::minmax_element(tried.begin(), tried.end());
    const auto low = static_cast<std::ptrdiff_t>(std::floor(*low_s * rate_hz)),
               high = static_cast<std::ptrdiff_t>(std::ceil(*high_s * rate_hz));
    // At a faster rate than most places need the best is found among some, then among their neighbours.
    const std::ptrdiff_t stride =
        std::max<std::ptrdiff_t>(1, (high - low) / static_cast<std::ptrdiff_t>(tried.size()));
    std::ptrdiff_t best = 0;
    double least = left_late(plain, 0);
    const auto look = [&](std::ptrdiff_t from, std::ptrdiff_t to, std::ptrdiff_t step) {
        for (std::ptrdiff_t samples = from; samples <= to; samples += step) {
            const double left = samples == 0 ? least : left_late(plain, samples);
            if (left >= least) continue;
            least = left;
            best = samples;
        }
    };
    look(low, high, stride);
    if (stride > 1) look(std::max(best - stride + 1, low), std::min(best + stride - 1, high), 1);
    return best == low || best == high ? 0 : best;
}

OutsideGain gain_of(const Sums& sums, const std::vector<double>& without, const std::vector<double>& with) {
    return outside_gain(without, with, sums.lens().ground().blocks(), sums.lens().sigma());
}

// The larger of what white noise and what blocks of the log make of the error.
double error_of(const Tuned& tuned, const Lens& lens) {
    const double steepness = std::max(square_of(tuned.slope), 1e-300);
    double scores = 0.0;
    for (const RowRange& block : lens.ground().blocks()) {
        const double score =
            dot(tuned.slope.data() + block.first, tuned.left.data() + block.first, block.count);
        scores += score * score;
    }
    return std::max(std::sqrt(scores) / steepness, lens.sigma() / std::sqrt(steepness));
}

// Spread of the time from fold to fold beyond its own noise, of the time.
double uneven(const Tuned& tuned, const Lens& lens) {
    double spread = 0.0, total = 0.0;
    for (const RowRange& fold : lens.ground().folds()) {
        const double* slope = tuned.slope.data() + fold.first;
        const double steepness = dot(slope, slope, fold.count);
        if (!(steepness > 0.0)) continue;
        const double off = dot(slope, tuned.left.data() + fold.first, fold.count) / steepness;
        spread += steepness * (off * off) - lens.sigma() * lens.sigma();
        total += steepness;
    }
    return total > 0.0 ? std::sqrt(std::max(spread / total, 0.0)) / std::abs(tuned.seconds) : 10.0;
}

// The other effect of the sensor that might do as well; a torque that is early has none.
const Effect* rival_of(const Term& sensor, std::span<const Effect* const> examined) {
    for (const Effect* effect : sensors_among(examined)) {
        if (effect != sensor.effect && *sensor.values[0] > effect->parameters[0].lower) return effect;
    }
    return nullptr;
}

FittedValue told_value(const Tuned& tuned, double error) {
    FittedValue value{0, 0, tuned.seconds, error, Interval{}, false};
    value.ci95 = Interval{tuned.seconds - normal_95_errors * error, tuned.seconds + normal_95_errors * error};
    return value;
}

// What the sensor changes of the given terms and of the model's own torque.
void measure(Finding& finding, const Unsensed& plain, const Lens& lens) {
    const Case& c = lens.looked_at();
    const std::vector<double> values = lens.plain_values(std::vector<double>(c.size(), 0.0));
    std::vector<double> at_joint_nm = predict_nm(plain.model.stated, c.motion);
    for (std::size_t i = 0; i < lens.columns().stated; ++i)
        add_scaled(values[i], lens.columns().at_joint_nm(i).data(), at_joint_nm.data(), at_joint_nm.size());
    std::vector<double> change_nm = at_joint_nm;
    through_sensors({plain.model.stated.gear_ratio, {finding.term}}, c.motion, change_nm);
    add_scaled(-1.0, at_joint_nm.data(), change_nm.data(), change_nm.size());
    finding.where = place_of(c, change_nm, finding.term, lens.rules().place);
    finding.evidence.share_nm = finding.evidence.own_nm = rms_of(change_nm, c.use);
}

void look_at_rival(const Unsensed& plain, const SensedLook& behind, const Effect& rival,
                   const std::vector<double>& left, SensorVerdict& told) {
    const Lens& lens = behind.sums.lens();
    const BesideRules& rules = lens.rules().beside;
    const Tuned other =
        tuned_from(plain, rival, *behind.sensor.values[0], lens, shapes_at(behind.sums, behind.names));
    const Term term = sensor_of(rival, other.seconds);
    const OutsideGain ahead =
        gain_of(behind.sums, left_with(plain, term, lens, shapes_at(behind.sums, behind.names)), left);
    told.finding.out_of_fold->rival = rival.name;
    told.finding.out_of_fold->rival_margin = ahead.gain;
    told.finding.alternatives.push_back({rival.name, ahead.gain});
    Hearing hearing(lens.rules(), told.finding.decisions);
    const bool tie = hearing.asked("beside.tie_margin", ahead.gain, ahead.gain < rules.tie_margin) ||
                     hearing.asked("beside.tie_t", ahead.t, ahead.t < rules.tie_t);
    if (ahead.gain < -rules.tie_margin && ahead.t < -rules.tie_t)
        told.ahead = term;
    else if (tie && told.finding.status == FindingStatus::confirmed)
        told.finding.status = FindingStatus::ambiguous;
}

}  // namespace

Candidate with_sensor(const Candidate& model, const Term& sensor) {
    Candidate with = model;
    with.open.terms.push_back(sensor);
    with.stated.terms.push_back(sensor);
    return with;
}

std::optional<Term> suspected_sensor(const Unsensed& plain, std::span<const Effect* const> examined,
                                     std::size_t effects) {
    const auto sensors = sensors_among(examined);
    if (sensors.empty() || has_sensors(plain.model.stated)) return std::nullopt;
    const Effect& delay = *sensors.front();
    if (delay.parameters[0].tried.empty() || delay.parameters[0].lower >= 0.0) return std::nullopt;
    const std::ptrdiff_t late = best_late(plain, delay);
    if (late == 0) return std::nullopt;
    const Lens& lens = plain.sums.lens();
    const OutsideGain gain = gain_of(plain.sums, plain.sums.residual_outside(plain.names),
                                     plain.sums.residual_outside(plain.names, lens.target_earlier(late)));
    if (!is_worth(gain, price_of_sensor(plain.sums, delay, effects), lens.rules().beside))
        return std::nullopt;
    const double seconds = static_cast<double>(late) / lens.looked_at().motion.sample_rate.value();
    return sensor_of(delay,
                     tuned_from(plain, delay, seconds, lens, shapes_at(plain.sums, plain.names)).seconds);
}

SensorVerdict judged_sensor(const Unsensed& plain, const SensedLook& behind,
                            std::span<const Effect* const> examined, std::size_t effects) {
    const Lens& lens = behind.sums.lens();
    const std::vector<double> left = behind.sums.residual_outside(behind.names);
    std::vector<double> without = left_with(plain, std::nullopt, lens, shapes_at(plain.sums, plain.names));
    std::vector<double> same_names =
        left_with(plain, std::nullopt, lens, shapes_at(behind.sums, behind.names));
    if (square_of(same_names) < square_of(without)) without = std::move(same_names);
    const OutsideGain gain = gain_of(behind.sums, without, left);
    const Tuned tuned = tuned_once(plain, *behind.sensor.effect, *behind.sensor.values[0], lens,
                                   shapes_at(behind.sums, behind.names));
    SensorVerdict told;
    Finding& finding = told.finding;
    finding.term = sensor_of(*behind.sensor.effect, tuned.seconds);
    finding.values.push_back(told_value(tuned, lens.rules().beside.interval_factor * error_of(tuned, lens)));
    finding.size_uncertain = true;
    finding.evidence.gain = gain.gain;
    finding.evidence.price = price_of_sensor(behind.sums, *behind.sensor.effect, effects);
    finding.evidence.elsewhere = gain.without_best(1) / std::max(gain.gain, 1e-300);
    const double unevenness = uneven(tuned, lens);
    finding.out_of_fold =
        OutOfFold{gain.gain, gain.t, lens.ground().blocks().size(), gain.positive(), unevenness, {}, 0.0};
    Hearing hearing(lens.rules(), finding.decisions);
    const bool worth = is_worth(gain, finding.evidence.price, lens.rules().beside);
    hearing.asked_price(gain.gain, finding.evidence.price, gain.gain < finding.evidence.price);
    hearing.asked("beside.least_t", gain.t, gain.t < lens.rules().beside.least_t);
    measure(finding, plain, lens);
    // What moves the steps of friction alone may be an error of the smoothed motion.
    const double least_nm = material_sigma(lens.looked_at(), lens.rules()) * lens.sigma();
    if (!worth) {
        finding.status = FindingStatus::tentative;
        finding.reason =
            "what it explains comes from a few parts of the log, or other names explain it as well";
    } else if (hearing.asked(material_rule(lens.looked_at()), finding.evidence.own_nm / lens.sigma(),
                             finding.evidence.own_nm < least_nm)) {
        finding.status = FindingStatus::tentative;
        finding.reason =
            "it hardly changes what is given and the model's own: it may mend the form of another finding";
    } else if (hearing.asked("beside.most_uneven", unevenness,
                             unevenness > lens.rules().beside.most_uneven)) {
        finding.status = FindingStatus::tentative;
        finding.reason = fmt::format("it differs by {:.0f} % from part to part of the log",
                                     100.0 * std::min(unevenness, 9.99));
    }
    if (const Effect* rival = rival_of(finding.term, examined))
        look_at_rival(plain, behind, *rival, left, told);
    return told;
}

}  // namespace ripplenotch
