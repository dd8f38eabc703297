// SPDX-License-Identifier: MIT
#include "ripplenotch/log/joint_angle.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "log/clock/clock_check.hpp"
#include "ripplenotch/core/median.hpp"

namespace ripplenotch {
namespace {

constexpr double piece_deg = 2.0;         ///< far more than a step of an encoder
constexpr double longest_piece_s = 10.0;  ///< what takes longer is drift at rest
// By hand: then, at least, and at most.
constexpr std::size_t pieces_judged = 16, fewest_pieces = 6, most_pieces_of_angle = 4096;
constexpr double standing_share = 0.02;  ///< of the other's motion
constexpr double frozen_share = 1e-5;  ///< the same for a velocity: a motor's position goes 300 times as far
constexpr double alike_share = 0.6;    ///< of the pieces have to be near the median's ratio ...
constexpr double alike_within = 0.5;   ///< ... by this share of it
constexpr double farthest_factor = 2.0;  ///< a clock may be wrong by as much

}  // namespace

AngleFacts::Source AngleFacts::source() const {
    switch (verdict) {
        case Verdict::no_velocity:
        case Verdict::too_little_motion:
        case Verdict::agrees:
        case Verdict::reversed:
            return Source::position;
        case Verdict::no_position:
        case Verdict::stands:
        case Verdict::scaled:
        case Verdict::unrelated:
            break;
    }
    return Source::velocity;
}

std::string_view source_name(AngleFacts::Source source) {
    return source == AngleFacts::Source::position ? "position" : "velocity";
}

std::string AngleFacts::reason() const {
    switch (verdict) {
        case Verdict::no_position:
            return "the log has no position of this joint";
        case Verdict::no_velocity:
            return "no velocity is logged that the position could be held against";
        case Verdict::too_little_motion:
            return "the joint moves too little to hold the position against the velocity";
        case Verdict::agrees:
            return "the position moves as the velocity says";
        case Verdict::reversed:
            return "velocity and position have opposite signs: the position is taken with its sign turned";
        case Verdict::stands:
            return "the position stands still while the velocity says that the joint moves";
        case Verdict::scaled:
            return factor_in_words(*factor);
        case Verdict::unrelated:
            break;
    }
    return "the position does not move as the velocity says: it may be another joint's";
}

std::string AngleFacts::warning() const {
    std::string text;
    if (verdict == Verdict::reversed) text = reason();
    if (verdict != Verdict::no_position && source() == Source::velocity)
        text = fmt::format("{}; the angle is taken from the velocity", reason());
    if (!contradicted) return text;
    const std::string later = fmt::format(
        "from data row {} on the position no longer moves as the velocity says; from there the angle is "
        "taken from "
        "the velocity",
        contradicted->row + 1);
    return text.empty() ? later : fmt::format("{}; {}", text, later);
}

JointAngle::Judgement JointAngle::judge(const std::vector<Piece>& pieces) {
    std::vector<double> ratios, velocities, positions;
    for (const Piece& piece : pieces) {
        const double far = std::copysign(std::numeric_limits<double>::max(), piece.position_deg);
        ratios.push_back(piece.velocity_deg != 0.0 ? piece.position_deg / piece.velocity_deg : far);
        velocities.push_back(std::abs(piece.velocity_deg));
        positions.push_back(std::abs(piece.position_deg));
    }
    const double velocity = median_in(velocities), position = median_in(positions);
    using Verdict = AngleFacts::Verdict;
    if (velocity < frozen_share * position) return {Verdict::unrelated, std::nullopt};
    const double factor = median_of(ratios), magnitude = std::abs(factor);
    const auto alike = std::count_if(ratios.begin(), ratios.end(), [=](double ratio) {
        return std::abs(ratio - factor) <= alike_within * magnitude;
    });
    if (magnitude > 0.0 && static_cast<double>(alike) >= alike_share * static_cast<double>(ratios.size())) {
        if (magnitude < 1.0 / farthest_factor || magnitude > farthest_factor)
            return {Verdict::scaled, factor};
        return {factor > 0.0 ? Verdict::agrees : Verdict::reversed, factor};
    }
    return {position < standing_share * velocity ? Verdict::stands : Verdict::unrelated, std::nullopt};
}

JointAngle::JointAngle(bool velocity, bool position) {
    using Verdict = AngleFacts::Verdict;
    facts_.verdict = !position   ? Verdict::no_position
                     : !velocity ? Verdict::no_velocity
                                 : Verdict::too_little_motion;
}

void JointAngle::look(const TraceView& rows, bool begins_run) {
    looking_ = true;
    add(rows, begins_run);
}

void JointAngle::decide() {
    if (facts_.verdict == AngleFacts::Verdict::too_little_motion && pieces_.size() >= fewest_pieces)
        conclude();
    looking_ = any_ = false;
    rows_ = skipped_ = 0;
    pieces_.clear();
    piece_ = {};
}

void JointAngle::follow(const TraceView& rows, bool begins_run) {
    add(rows, begins_run);
    rows_ += rows.size();
}

void JointAngle::add(const TraceView& rows, bool begins_run) {
    using Verdict = AngleFacts::Verdict;
    if (facts_.verdict == Verdict::no_position || facts_.verdict == Verdict::no_velocity) return;
    for (std::size_t k = 0; k < rows.size(); ++k) {
        const Row row{rows.time_s[k], rows.velocity_deg_s[k], rows.position_deg[k]};
        if (!any_ || (k == 0 && begins_run)) {
            any_ = true;
            piece_ = {};
            piece_begin_s_ = row.time_s;
            last_ = row;
            continue;
        }
        double moved = row.position_deg - last_.position_deg;
        if (std::abs(moved) > 180.0) moved -= 360.0 * std::round(moved / 360.0);
        piece_.position_deg += moved;
        piece_.velocity_deg +=
            0.5 * (row.velocity_deg_s + last_.velocity_deg_s) * (row.time_s - last_.time_s);
        last_ = row;
        if (std::max(std::abs(piece_.position_deg), std::abs(piece_.velocity_deg)) >= piece_deg) {
            end_piece();
            if (!looking_ && pieces_.size() == pieces_judged) {
                rows_ += k;
                conclude();
                rows_ -= k;
            }
        } else if (row.time_s - piece_begin_s_ > longest_piece_s) {
            piece_ = {};
            piece_begin_s_ = row.time_s;
        }
    }
}

void JointAngle::end_piece() {
    if (pieces_.size() < most_pieces_of_angle) pieces_.push_back(piece_);
    piece_ = {};
    piece_begin_s_ = last_.time_s;
}

void JointAngle::conclude() {
    const Judgement found = judge(pieces_);
    pieces_.clear();
    if (facts_.verdict == AngleFacts::Verdict::too_little_motion) {
        facts_.verdict = found.verdict;
        facts_.factor = found.factor;
        return;
    }
    if (facts_.contradicted || facts_.source() == AngleFacts::Source::velocity) return;
    if (found.verdict != facts_.verdict) facts_.contradicted = {rows_, rows_ - skipped_};
}

}  // namespace ripplenotch
