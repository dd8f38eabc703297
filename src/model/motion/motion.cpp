// SPDX-License-Identifier: MIT
#include "ripplenotch/model/motion.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "model/motions.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {
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
    std::vector<std::string> known;
    for (const MotionKind* kind : motion_kinds()) {
        if (kind->name == name) return *kind;
        known.emplace_back(kind->name);
    }
    const auto near = nearest_name(name, known);
    raise<UsageError>("there is no motion '{}'{}; motions: {}", name,
                      near ? fmt::format(" (did you mean {}?)", *near) : "", fmt::join(known, ", "));
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
