// SPDX-License-Identifier: MIT
#include "model/motion/motion.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "model/motions.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"
#include "ripplenotch/core/spec.hpp"
#include "ripplenotch/model/motion.hpp"

namespace ripplenotch {

namespace {

// A step longer than this part of the usual one may hold a lost row; one longer than so many is a gap.
constexpr double may_be_lost = 1.5, is_gap = 6.0;
// Fewer lost rows than this part of all are not worth another clock.
constexpr double worth_it = 1e-3;

// Median of steps at intervals along the log, which gaps do not change.
double middle_step_s(std::span<const double> time_s) {
    constexpr std::size_t looks = 200;  // chosen, not derived: bounds the time
    std::vector<double> steps;
    for (std::size_t k = 1; k < time_s.size(); k += std::max<std::size_t>(1, time_s.size() / looks))
        steps.push_back(time_s[k] - time_s[k - 1]);
    return median_in(steps);
}

// Steps that may hold more than one sample. Most logs lost none, and every delay calls this.
std::size_t long_steps(std::span<const double> time_s, double middle_s) {
    std::size_t found = 0;
    for (std::size_t k = 1; k < time_s.size(); ++k) {
        const double here = time_s[k] - time_s[k - 1];
        found += static_cast<std::size_t>((here > may_be_lost * middle_s) & (here < is_gap * middle_s));
    }
    return found;
}

// The clock common to the stamps: the mean of the steps that hold one sample; 0 where too few hold more.
double single_step_s(std::span<const double> time_s, double middle_s) {
    if (!(static_cast<double>(long_steps(time_s, middle_s)) > worth_it * static_cast<double>(time_s.size())))
        return 0.0;
    double single = 0.0, sum_s = 0.0;
    for (std::size_t k = 1; k < time_s.size(); ++k) {
        const double here = time_s[k] - time_s[k - 1];
        if (here > may_be_lost * middle_s) continue;
        single += 1.0;
        sum_s += here;
    }
    return sum_s / single;
}

// Mean delay of the stamps after the first stamp relative to it, in steps from -0.5 to 0.5: the first may
// itself be early or late by nearly half a step.
double first_lateness(std::span<const double> time_s, double step_s) {
    constexpr std::size_t looks = 50;  // chosen, not derived: bounds the time
    std::complex<double> sum{0.0, 0.0};
    for (std::size_t k = 0; k < std::min(looks, time_s.size()); ++k) {
        if (k > 0 && time_s[k] - time_s[k - 1] >= is_gap * step_s) break;
        sum += portable::polar(1.0, 2.0 * std::numbers::pi * (time_s[k] - time_s[0]) / step_s);
    }
    return portable::arg(sum) / (2.0 * std::numbers::pi);
}

// As std::round, which is a call on most builds; of so few steps there is always a long.
double nearest(double steps) {
    return static_cast<double>(static_cast<long>(steps < 0.0 ? steps - 0.5 : steps + 0.5));
}

std::vector<std::size_t> places_on(std::span<const double> time_s, double step_s) {
    // Delay of each stamp, and its moving average, in steps.
    constexpr double followed = 0.02;
    double late = 0.0, mean_late = first_lateness(time_s, step_s);
    std::vector<std::size_t> places{0};
    for (std::size_t k = 1; k < time_s.size(); ++k) {
        const double steps = (time_s[k] - time_s[k - 1]) / step_s;
        double whole = 1.0;
        if (steps < is_gap) {
            late += steps;
            whole = nearest(late - mean_late);
            if (whole < 1.0 && k > 1 && places[k - 1] - places[k - 2] > 1) {
                // The stamp before was later than a stamp may be: nothing is missing before it.
                --places[k - 1];
                whole += 1.0;
                late += 1.0;
                mean_late += followed;
            }
            whole = std::max(1.0, whole);
            late -= whole;
            mean_late += followed * (late - mean_late);
        }
        places.push_back(places.back() + static_cast<std::size_t>(whole));
    }
    return places;
}

// The step by which all stamps together go from place to place.
double step_over(std::span<const double> time_s, std::span<const std::size_t> places, double step_s) {
    double passed_s = 0.0, passed = 0.0;
    for (std::size_t k = 1; k < time_s.size(); ++k) {
        const double here = time_s[k] - time_s[k - 1];
        if (here >= is_gap * step_s) continue;
        passed_s += here;
        passed += static_cast<double>(places[k] - places[k - 1]);
    }
    return passed_s / passed;
}

std::vector<std::size_t> places_found(std::span<const double> time_s, double& step_s) {
    step_s = single_step_s(time_s, middle_step_s(time_s));
    if (step_s == 0.0) return {};
    // With jittered stamps the longest single steps look like lost rows, so the mean of the others is too
    // short.
    constexpr int passes = 2;
    for (int pass = 0; pass < passes; ++pass) step_s = step_over(time_s, places_on(time_s, step_s), step_s);
    return places_on(time_s, step_s);
}

}  // namespace

std::vector<std::size_t> places_of_rows(std::span<const double> time_s, double& step_s) {
    if (time_s.size() < 8) return {};
    // A diagnosis needs the positions of one clock a thousand times.
    struct Asked {
        std::vector<double> time_s;
        std::vector<std::size_t> places;
        double step_s = 0.0;
    };
    thread_local Asked last;
    if (!std::ranges::equal(last.time_s, time_s)) {
        last.time_s.assign(time_s.begin(), time_s.end());
        last.places = places_found(time_s, last.step_s);
    }
    step_s = last.step_s;
    return last.places;
}

std::vector<double> with_lost_rows(std::span<const double> values, std::span<const std::size_t> places) {
    std::vector<double> whole(places.back() + 1, 0.0);
    for (std::size_t k = 0; k < values.size(); ++k) whole[places[k]] = values[k];
    for (std::size_t k = 1; k < values.size(); ++k) {
        // The four samples about the gap, fewer at the ends.
        const std::size_t first = k > 1 ? k - 2 : 0, end = std::min(k + 2, values.size());
        for (std::size_t place = places[k - 1] + 1; place < places[k]; ++place) {
            double value = 0.0;
            for (std::size_t i = first; i < end; ++i) {
                double weight = 1.0;
                for (std::size_t j = first; j < end; ++j) {
                    if (j == i) continue;
                    weight *= (static_cast<double>(place) - static_cast<double>(places[j])) /
                              (static_cast<double>(places[i]) - static_cast<double>(places[j]));
                }
                value += weight * values[i];
            }
            whole[place] = value;
        }
    }
    return whole;
}

namespace {

constexpr const MotionKind* const all_motions[] = {
#define MOTION(name) &motions::name,
#include "model/motions/motions.def"
#undef MOTION
};

// Two pieces are joined when their positions agree within this: far below any encoder, far above rounding.
constexpr double joined_deg = 1e-6;

// A piece whose start falls within this many samples after a sample starts at that sample: the rounding of a
// sum of durations must not move it.
constexpr double same_sample = 1e-6;

struct Placed {
    MotionPiece piece;
    Seconds start;
    std::size_t first_sample;
};

std::size_t first_sample_at(Seconds time, Hertz sample_rate) {
    const double samples = std::ceil(time.value() * sample_rate.value() - same_sample);
    if (samples > static_cast<double>(most_samples)) {
        raise<UsageError>(
            "--motion: {} s at {} Hz are more than {} samples; shorten it or lower the sample rate",
            shortest(time.value()), shortest(sample_rate.value()), most_samples);
    }
    return static_cast<std::size_t>(std::max(samples, 0.0));
}

MotionPiece make_piece(const std::string& text, const std::optional<MotionState>& before) {
    const Spec spec = parse_spec(text);
    const MotionKind& kind = find_motion_kind(spec.name);
    return kind.make(Settings(fmt::format("motion {}", kind.name), spec, kind.keys), before);
}

void sample(const Placed& placed, std::size_t end, Motion& motion) {
    for (std::size_t k = placed.first_sample; k < end; ++k) {
        const double time_s = static_cast<double>(k) / motion.sample_rate.value();
        const double elapsed_s =
            std::clamp(time_s - placed.start.value(), 0.0, placed.piece.duration.value());
        const MotionState state = placed.piece.at(Seconds(elapsed_s));
        motion.time_s.push_back(time_s);
        motion.position_deg.push_back(state.position_deg);
        motion.velocity_deg_s.push_back(state.velocity_deg_s);
        motion.acceleration_deg_s2.push_back(state.acceleration_deg_s2);
    }
}

}  // namespace

std::span<const MotionKind* const> motion_kinds() { return all_motions; }

const MotionKind& find_motion_kind(std::string_view name) {
    return find_entry(motion_kinds(), "motion", "motions", name);
}

double start_position_deg(std::string_view kind, const Settings& settings,
                          const std::optional<MotionState>& before) {
    const double natural_deg = before ? before->position_deg : 0.0;
    if (!settings.has("from")) return natural_deg;
    const double from_deg = settings.number("from");
    if (before && std::abs(from_deg - natural_deg) > joined_deg) {
        raise<UsageError>(
            "motion {}: from={}deg, but the motion before it ends at {}deg; leave from= out, or move "
            "there first",
            kind, shortest(from_deg), shortest(natural_deg));
    }
    return from_deg;
}

Motion make_motion(std::span<const std::string> specs, Hertz sample_rate) {
    if (specs.empty())
        raise<UsageError>("no motion is given, for example --motion constant,speed=60deg/s,duration=5s");
    if (!(sample_rate.value() > 0.0) || !std::isfinite(sample_rate.value())) {
        raise<UsageError>("--sample-rate: {} Hz is not above 0", shortest(sample_rate.value()));
    }
    std::vector<Placed> pieces;
    std::optional<MotionState> before;
    Seconds end;
    for (const std::string& spec : specs) {
        Placed placed{make_piece(spec, before), end, first_sample_at(end, sample_rate)};
        end = end + placed.piece.duration;
        before = placed.piece.at(placed.piece.duration);
        pieces.push_back(std::move(placed));
    }
    Motion motion{.sample_rate = sample_rate,
                  .time_s = {},
                  .position_deg = {},
                  .velocity_deg_s = {},
                  .acceleration_deg_s2 = {}};
    const std::size_t count = first_sample_at(end, sample_rate);
    for (auto* column :
         {&motion.time_s, &motion.position_deg, &motion.velocity_deg_s, &motion.acceleration_deg_s2}) {
        column->reserve(count);
    }
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        sample(pieces[i], i + 1 < pieces.size() ? pieces[i + 1].first_sample : count, motion);
    }
    return motion;
}

Motion make_motion(std::string_view spec, Hertz sample_rate) {
    const std::string only[] = {std::string(spec)};
    return make_motion(only, sample_rate);
}

}  // namespace ripplenotch
