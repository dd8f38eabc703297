// SPDX-License-Identifier: MIT
#include "ripplenotch/model/motion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/portable_math.hpp"

namespace ripplenotch {
namespace {

// Limits of any motion; wide enough for any joint, narrow enough that no product overflows.
constexpr double longest_duration_s = 1e6, largest_angle_deg = 1e7, largest_speed_deg_s = 1e5;

// Rows of the tables of keys.

Key duration_key() {
    return {.name = "duration",
            .dimension = Dimension::time,
            .required = true,
            .above = 0.0,
            .at_most = longest_duration_s,
            .help = "how long it takes"};
}

Key angle_key(std::string_view name, std::string_view default_text, std::string_view help) {
    return {.name = name,
            .dimension = Dimension::angle,
            .default_text = default_text,
            .at_least = -largest_angle_deg,
            .at_most = largest_angle_deg,
            .help = help};
}

Key from_key() {
    return angle_key("from", "",
                     "position at its beginning; without it, where the motion before ended, or 0deg");
}

Key amplitude_key(std::string_view help) {
    return {.name = "amplitude",
            .dimension = Dimension::angle,
            .required = true,
            .above = 0.0,
            .at_most = largest_angle_deg,
            .help = help};
}

Key frequency_key(std::string_view name, std::string_view help) {
    return {.name = name,
            .dimension = Dimension::frequency,
            .required = true,
            .above = 0.0,
            .at_most = 1000.0,
            .help = help};
}

Key speed_key(std::string_view name, std::string_view help) {
    return {.name = name,
            .dimension = Dimension::speed,
            .at_least = -largest_speed_deg_s,
            .at_most = largest_speed_deg_s,
            .help = help};
}

Key required(Key key) {
    key.required = true;
    return key;
}

Key listed(Key key) {
    key.kind = KeyKind::list;
    return key;
}

// Two pieces are joined when their positions agree within this: far below any encoder, far above rounding.
constexpr double joined_deg = 1e-6;

// The state in which the piece before ended; empty for the first.
using Before = std::optional<MotionState>;

// Position at which a piece begins. Throws UsageError when `from` contradicts the piece before.
double start_position_deg(std::string_view kind, const Settings& settings, const Before& before) {
    const double natural_deg = before ? before->position_deg : 0.0;
    if (!settings.has("from")) return natural_deg;
    const double from_deg = settings.number("from");
    if (before && std::abs(from_deg - natural_deg) > joined_deg) {
        raise<UsageError>(
            "motion {}: from={}deg, but the motion before it ends at {}deg; leave from= out, or move there "
            "first",
            kind, shortest(from_deg), shortest(natural_deg));
    }
    return from_deg;
}

const MotionKind rest_motion{
    .name = "rest",
    .summary = "stand still",
    .equation = "q(t) = from",
    .source = "the paper's run at 0 deg/s, which shows the sensor's noise alone",
    .keys = {duration_key(), from_key()},
    .make = [](const Settings& settings, const Before& before) -> MotionPiece {
        const MotionState state{.position_deg = start_position_deg("rest", settings, before)};
        return {Seconds(settings.number("duration")), [state](Seconds) { return state; }};
    }};

const MotionKind constant_motion{
    .name = "constant",
    .summary = "turn at one speed, at that speed from the first sample",
    .equation = "q(t) = from + speed * t",
    .source = "the paper's runs at 60, 120 and 180 deg/s (Kim, Kim, Song, Trans. KSME A, 2011, fig. 1)",
    .keys = {required(speed_key("speed", "speed of the joint; negative turns it the other way")),
             duration_key(), from_key()},
    .make = [](const Settings& settings, const Before& before) -> MotionPiece {
        const double from_deg = start_position_deg("constant", settings, before);
        const double speed_deg_s = settings.number("speed");
        return {Seconds(settings.number("duration")), [=](Seconds elapsed) {
                    return MotionState{from_deg + speed_deg_s * elapsed.value(), speed_deg_s, 0.0};
                }};
    }};

const MotionKind ramp_motion{
    .name = "ramp",
    .summary = "change the speed evenly",
    .equation = "q(t) = from + from-speed * t + (to-speed - from-speed) * t^2 / (2 * duration)",
    .source = "uniform acceleration (Galilei)",
    .keys = {required(speed_key("to-speed", "speed at its end")),
             speed_key(
                 "from-speed",
                 "speed at its beginning; without it, the speed at which the motion before ended, or 0deg/s"),
             duration_key(), from_key()},
    .make = [](const Settings& settings, const Before& before) -> MotionPiece {
        const double from_deg = start_position_deg("ramp", settings, before);
        const double natural_deg_s = before ? before->velocity_deg_s : 0.0;
        const double from_deg_s = settings.has("from-speed") ? settings.number("from-speed") : natural_deg_s;
        const double to_deg_s = settings.number("to-speed");
        const double duration_s = settings.number("duration");
        const double rate_deg_s2 = (to_deg_s - from_deg_s) / duration_s;
        return {Seconds(duration_s), [=](Seconds elapsed) {
                    const double t = elapsed.value();
                    // Weighted, so that the end is to-speed to the last bit.
                    const double part = t / duration_s;
                    return MotionState{from_deg + from_deg_s * t + 0.5 * rate_deg_s2 * t * t,
                                       (1.0 - part) * from_deg_s + part * to_deg_s, rate_deg_s2};
                }};
    }};

// A polynomial with position, speed and acceleration given at both ends (here: standstill) has six
// coefficients and degree five. A seventh coefficient adds a multiple of u^3 (1 - u)^3, the one polynomial of
// degree six that changes none of the six end values; it moves the moment of greatest speed off the middle.
// docs/motions/README.md has the figures.
struct Shape {
    double position, velocity, acceleration;  ///< a move from 0 to 1 in unit time
};

Shape shape(double u, double asymmetry) {
    const double w = 1.0 - u;
    const double bump = u * w;
    const double lean = 1.0 - 2.0 * u;
    return {
        u * u * u * (10.0 - 15.0 * u + 6.0 * u * u) + 10.0 * asymmetry * bump * bump * bump,
        30.0 * bump * bump * (1.0 + asymmetry * lean),
        60.0 * bump * (lean * (1.0 + asymmetry * lean) - asymmetry * bump),
    };
}

const MotionKind poly6_motion{
    .name = "poly6",
    .summary = "move from rest to rest on a smooth polynomial",
    .equation =
        "q(t) = from + (to - from) * (10 u^3 - 15 u^4 + 6 u^5 + 10 asymmetry u^3 (1 - u)^3), u = t / "
        "duration",
    .source =
        "the paper's move (Kim, Kim, Song, Trans. KSME A, 2011, fig. 11); degree five: Flash and Hogan, 1985",
    .keys = {required(angle_key("to", "", "position at its end")),
             duration_key(),
             from_key(),
             {.name = "asymmetry",
              .default_text = "0",
              .at_least = -1.0,  // beyond, the joint would turn back on its way
              .at_most = 1.0,
              .help = "-1 to 1: above 0 the greatest speed comes early, below 0 late; 0 is the polynomial of "
                      "degree five"}},
    .make = [](const Settings& settings, const Before& before) -> MotionPiece {
        const double from_deg = start_position_deg("poly6", settings, before);
        const double travel_deg = settings.number("to") - from_deg;
        const double duration_s = settings.number("duration");
        const double asymmetry = settings.number("asymmetry");
        return {Seconds(duration_s), [=](Seconds elapsed) {
                    const Shape s = shape(elapsed.value() / duration_s, asymmetry);
                    return MotionState{from_deg + travel_deg * s.position,
                                       travel_deg * s.velocity / duration_s,
                                       travel_deg * s.acceleration / (duration_s * duration_s)};
                }};
    }};

// Back and forth, from one frequency to another.
MotionPiece swing(double from_deg, const Settings& settings, double from_hz, double to_hz) {
    const double amplitude_deg = settings.number("amplitude"), phase_deg = settings.number("phase");
    const double duration_s = settings.number("duration"), rate_hz_s = (to_hz - from_hz) / duration_s;
    const double center_deg = from_deg - amplitude_deg * portable::sin_degrees(phase_deg);
    return {Seconds(duration_s), [=](Seconds elapsed) {
                const double t = elapsed.value();
                const double angle_deg = 360.0 * (from_hz + 0.5 * rate_hz_s * t) * t + phase_deg;
                const double sine = portable::sin_degrees(angle_deg),
                             cosine = portable::cos_degrees(angle_deg);
                const double rad_s = 2.0 * std::numbers::pi * (from_hz + rate_hz_s * t);
                const double rad_s2 = 2.0 * std::numbers::pi * rate_hz_s;
                return MotionState{center_deg + amplitude_deg * sine, amplitude_deg * rad_s * cosine,
                                   amplitude_deg * (rad_s2 * cosine - rad_s * rad_s * sine)};
            }};
}

const MotionKind sine_motion{
    .name = "sine",
    .summary = "swing back and forth",
    .equation = "q(t) = from + amplitude * (sin(360deg * frequency * t + phase) - sin(phase))",
    .source =
        "the usual excitation for friction and reversal, e.g. Olsson et al., European Journal of Control 4, "
        "1998",
    .keys = {amplitude_key("zero to peak"), frequency_key("frequency", "swings per second"),
             angle_key("phase", "-90deg", "phase of the sine at its beginning; -90deg starts from rest"),
             duration_key(), from_key()},
    .make = [](const Settings& settings, const Before& before) -> MotionPiece {
        const double hz = settings.number("frequency");
        return swing(start_position_deg("sine", settings, before), settings, hz, hz);
    }};

const MotionKind sweep_motion{
    .name = "sweep",
    .summary = "swing back and forth ever faster, or ever slower",
    .equation =
        "q(t) = from + amplitude * (sin(360deg * (f0 t + (f1 - f0) t^2 / (2 duration)) + phase) - "
        "sin(phase)), f0 = from-frequency, f1 = to-frequency",
    .source = "the linear chirp of system identification, e.g. Ljung, System Identification, 1999",
    .keys = {amplitude_key("zero to peak, the same at every frequency"),
             frequency_key("from-frequency", "swings per second at its beginning"),
             frequency_key("to-frequency", "swings per second at its end"),
             angle_key("phase", "-90deg", "phase of the sine at its beginning; -90deg starts from rest"),
             duration_key(), from_key()},
    .make = [](const Settings& settings, const Before& before) -> MotionPiece {
        return swing(start_position_deg("sweep", settings, before), settings,
                     settings.number("from-frequency"), settings.number("to-frequency"));
    }};

struct Sine {
    double amplitude_deg, frequency_hz, phase_deg;
};

// Amplitudes in proportion to 1 / k, so that each sine has the same peak speed; Schroeder's phases keep their
// peaks apart.
std::vector<Sine> make_sines(const Settings& settings) {
    const double count = settings.number("count");
    double sum = 0.0;
    for (double k = 1.0; k <= count; ++k) sum += 1.0 / k;
    std::vector<Sine> sines;
    for (double k = 1.0; k <= count; ++k) {
        sines.push_back({settings.number("amplitude") / (k * sum), k * settings.number("frequency"),
                         settings.number("phase") - 180.0 * k * (k - 1.0) / count});
    }
    return sines;
}

const MotionKind multisine_motion{
    .name = "multisine",
    .summary = "swing at several frequencies at once",
    .equation =
        "q(t) = from + sum over k = 1 ... count of a_k * (sin(360deg * k * frequency * t + p_k) - sin(p_k)), "
        "a_k = amplitude / k / (1 + 1/2 + ... + 1/count), p_k = phase - 180deg * k * (k - 1) / count",
    .source = "Schroeder, IEEE Transactions on Information Theory 16, 1970, for the phases",
    .keys = {amplitude_key("sum of the amplitudes of the sines; the joint stays within it"),
             frequency_key("frequency",
                           "swings per second of the slowest sine; the others are its multiples"),
             {.name = "count",
              .default_text = "5",
              .above = 0.0,
              .at_most = 1000.0,
              .whole = true,
              .help = "number of sines, a whole number"},
             angle_key("phase", "0deg", "added to the phase of every sine; 180deg turns the motion round"),
             duration_key(),
             from_key()},
    .make = [](const Settings& settings, const Before& before) -> MotionPiece {
        const auto sines = make_sines(settings);
        double center_deg = start_position_deg("multisine", settings, before);
        for (const Sine& sine : sines)
            center_deg -= sine.amplitude_deg * portable::sin_degrees(sine.phase_deg);
        return {Seconds(settings.number("duration")), [=](Seconds elapsed) {
                    MotionState state{.position_deg = center_deg};
                    for (const Sine& sine : sines) {
                        const double angle_deg = 360.0 * sine.frequency_hz * elapsed.value() + sine.phase_deg;
                        const double rad_s = 2.0 * std::numbers::pi * sine.frequency_hz;
                        const double value = sine.amplitude_deg * portable::sin_degrees(angle_deg);
                        state.position_deg += value;
                        state.velocity_deg_s += sine.amplitude_deg * rad_s * portable::cos_degrees(angle_deg);
                        state.acceleration_deg_s2 -= rad_s * rad_s * value;
                    }
                    return state;
                }};
    }};

const MotionKind fourier_motion{
    .name = "fourier",
    .summary = "from rest to rest by any sum of half-waves of the speed",
    .equation =
        "q(t) = from + sum over k = 1 ... of s_k * T / (pi * k) * (1 - cos(180deg * k * t / T)), T = "
        "duration",
    .source =
        "Swevers et al., IEEE Transactions on Robotics and Automation 13, 1997, for exciting motions of such "
        "sums",
    .keys = {required(listed(speed_key(
                 "speeds",
                 "sizes of the half-waves that the speed is made of, the slowest first, parted by a colon"))),
             duration_key(), from_key()},
    .make = [](const Settings& settings, const Before& before) -> MotionPiece {
        const std::vector<double> speeds = settings.list("speeds");
        constexpr std::size_t max_waves = 100;  // chosen, not derived: bounds the time
        if (speeds.size() > max_waves)
            raise<UsageError>("motion fourier: speeds has {} entries, at most {} are taken", speeds.size(),
                              max_waves);
        const double from_deg = start_position_deg("fourier", settings, before);
        const double duration_s = settings.number("duration");
        return {Seconds(duration_s), [=](Seconds elapsed) {
                    MotionState state{.position_deg = from_deg};
                    for (std::size_t k = 0; k < speeds.size(); ++k) {
                        const double half_turns = static_cast<double>(k + 1);
                        const double angle_deg = 180.0 * half_turns * elapsed.value() / duration_s;
                        const double rad_s = std::numbers::pi * half_turns / duration_s;
                        const double cosine = portable::cos_degrees(angle_deg);
                        state.position_deg += speeds[k] / rad_s * (1.0 - cosine);
                        state.velocity_deg_s += speeds[k] * portable::sin_degrees(angle_deg);
                        state.acceleration_deg_s2 += speeds[k] * rad_s * cosine;
                    }
                    return state;
                }};
    }};

constexpr const MotionKind* const all_motions[] = {&rest_motion,      &constant_motion, &ramp_motion,
                                                   &poly6_motion,     &sine_motion,     &sweep_motion,
                                                   &multisine_motion, &fourier_motion};

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

MotionPiece make_piece(const std::string& text, const Before& before) {
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

Motion make_motion(std::span<const std::string> specs, Hertz sample_rate) {
    if (specs.empty())
        raise<UsageError>("no motion is given, for example --motion constant,speed=60deg/s,duration=5s");
    if (!(sample_rate.value() > 0.0) || !std::isfinite(sample_rate.value())) {
        raise<UsageError>("--sample-rate: {} Hz is not above 0", shortest(sample_rate.value()));
    }
    std::vector<Placed> pieces;
    Before before;
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
