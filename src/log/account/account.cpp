// SPDX-License-Identifier: MIT
#include "log/account/account.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "log/clock/clock_check.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {

double Unwrapper::next(double position_deg) {
    if (before_) turns_ -= std::round((position_deg + turns_ * period_ - *before_) / period_);
    before_ = position_deg + turns_ * period_;
    return *before_;
}

// A wrapped angle never exceeds its turn, and steps over the seam in one row: other steps are much smaller.
void WrapWatch::look_at(double step, Turn& turn) const {
    const double magnitude = std::abs(step);
    if (magnitude > 0.5 * turn.period) {
        if (turn.unwrapper) return;
        turn.unwrapper.emplace(turn.period, before_);
        turn.sum = sum_;
    } else if (magnitude >= 0.25 * turn.period) {
        turn.ruled_out = true;
    }
}

void WrapWatch::follow(std::span<const double> position_deg) {
    constexpr double harmless = 0.25 * 2.0 * std::numbers::pi;  // no turn is ruled out by less, none begun
    for (const double angle : position_deg) {
        const double step = count_++ > 0 ? angle - before_ : 0.0;
        low_ = std::min(low_, angle);
        high_ = std::max(high_, angle);
        if (jumped_ || std::abs(step) >= harmless) {
            for (Turn& turn : turns_) {
                turn.ruled_out = turn.ruled_out || high_ - low_ > 1.0001 * turn.period;
                if (turn.ruled_out) continue;
                look_at(step, turn);
                if (!turn.unwrapper) continue;
                jumped_ = true;
                turn.sum += turn.unwrapper->next(angle);
            }
        }
        sum_ += angle;
        before_ = angle;
    }
}

const WrapWatch::Turn* WrapWatch::found() const {
    const double range = high_ - low_;
    const auto fits = [&](const Turn& turn) {
        // It fills its turn nearly.
        return count_ >= 3 && !turn.ruled_out && turn.unwrapper && range >= 0.9 * turn.period &&
               range <= 1.0001 * turn.period;
    };
    const auto turn = std::ranges::find_if(turns_, fits);
    return turn == turns_.end() ? nullptr : &*turn;
}

std::optional<double> WrapWatch::period() const {
    return found() != nullptr ? std::optional<double>(found()->period) : std::nullopt;
}

std::string wrap_in_words(double period_deg) {
    return fmt::format("the position starts again at {:.4g} deg; it was made continuous", period_deg);
}

std::optional<double> wrap_period(std::span<const double> position_deg) {
    WrapWatch watch;
    watch.follow(position_deg);
    return watch.period();
}

namespace {

constexpr double moving_deg_s = 0.2;           // by hand: slower is a rest
constexpr std::size_t judged_changes = 16384;  ///< enough to know how coarse a torque is
constexpr std::size_t fewest_changes = 8;      // by hand
constexpr double coarse_steps = 10.0;          ///< a usual change of fewer smallest ones
/// Of the torque's changes; by chance half of them at most meet those of a channel that changes less often.
constexpr double changing_together = 0.9;

constexpr double piece_deg = 2.0;         ///< far more than a step of an encoder
constexpr double longest_piece_s = 10.0;  ///< what takes longer is drift at rest
// By hand: then, at least, and at most.
constexpr std::size_t pieces_judged = 16, fewest_pieces = 6, most_pieces_of_angle = 4096;
constexpr double standing_share = 0.02;  ///< of the other's motion
constexpr double frozen_share = 1e-5;  ///< the same for a velocity: a motor's position goes 300 times as far
constexpr double alike_share = 0.6;    ///< of the pieces have to be near the median's ratio ...
constexpr double alike_within = 0.5;   ///< ... by this share of it
constexpr double farthest_factor = 2.0;  ///< a clock may be wrong by as much

// By hand: fewer repeated rows are lost messages; a sample that is written twice gives half.
constexpr double repeated_by_rule = 0.4;

std::string update_rate_text(const Recording& recording) {
    const Hertz rate = recording.update_rate();
    if (!(rate < recording.clock.nominal_rate)) return "";
    return fmt::format(
        "; the signals are updated at {:.4g} Hz and written at {:.4g} Hz: nothing above {:.4g} Hz is "
        "measured",
        rate.value(), recording.clock.nominal_rate.value(), 0.5 * rate.value());
}

bool has_values(const std::vector<double>& values) {
    return !values.empty() && std::isfinite(values.front());
}

/// Compares position with velocity over pieces of motion of 2 deg and more, sixteen at a time, by the median
/// of their ratios, which neither spikes nor jumps move. All of the opening decide, from six on, or else
/// the first sixteen; later ones can only contradict. A position is unwrapped at half turns.
class JointAngle {
  public:
    /// What the log has.
    JointAngle(bool velocity, bool position) {
        using Verdict = AngleFacts::Verdict;
        facts_.verdict = !position   ? Verdict::no_position
                         : !velocity ? Verdict::no_velocity
                                     : Verdict::too_little_motion;
    }
    /// Consecutive rows of the opening, before all rows are taken: what they say holds from the first row on.
    void look(const TraceView& rows, bool begins_run) {
        looking_ = true;
        add(rows, begins_run);
    }
    /// The opening has been seen.
    void decide() {
        if (facts_.verdict == AngleFacts::Verdict::too_little_motion && pieces_.size() >= fewest_pieces)
            conclude();
        looking_ = any_ = false;
        rows_ = skipped_ = 0;
        pieces_.clear();
        piece_ = {};
    }
    /// Consecutive rows; `begins_run`: the row before is no past of theirs.
    void follow(const TraceView& rows, bool begins_run) {
        add(rows, begins_run);
        rows_ += rows.size();
    }
    /// Rows that are not used.
    void skip(std::size_t rows) {
        rows_ += rows;
        skipped_ += rows;
    }
    [[nodiscard]] const AngleFacts& facts() const { return facts_; }

  private:
    struct Piece {
        double velocity_deg = 0.0, position_deg = 0.0;
    };
    struct Row {
        double time_s = 0.0, velocity_deg_s = 0.0, position_deg = 0.0;
    };
    struct Judgement {
        AngleFacts::Verdict verdict;
        std::optional<double> factor;
    };
    static Judgement judge(const std::vector<Piece>& pieces) {
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
        const auto alike = std::ranges::count_if(
            ratios, [=](double ratio) { return std::abs(ratio - factor) <= alike_within * magnitude; });
        if (magnitude > 0.0 &&
            static_cast<double>(alike) >= alike_share * static_cast<double>(ratios.size())) {
            if (magnitude < 1.0 / farthest_factor || magnitude > farthest_factor)
                return {Verdict::scaled, factor};
            return {factor > 0.0 ? Verdict::agrees : Verdict::reversed, factor};
        }
        return {position < standing_share * velocity ? Verdict::stands : Verdict::unrelated, std::nullopt};
    }
    void add(const TraceView& rows, bool begins_run) {
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
    void end_piece() {
        if (pieces_.size() < most_pieces_of_angle) pieces_.push_back(piece_);
        piece_ = {};
        piece_begin_s_ = last_.time_s;
    }
    void conclude() {
        const Judgement found = judge(pieces_);
        pieces_.clear();
        if (facts_.verdict == AngleFacts::Verdict::too_little_motion) {
            facts_.verdict = found.verdict;
            facts_.factor = found.factor;
            return;
        }
        if (facts_.contradicted || facts_.verdict == AngleFacts::Verdict::stands ||
            facts_.source() == AngleFacts::Source::velocity)
            return;
        if (found.verdict != facts_.verdict) facts_.contradicted = {rows_, rows_ - skipped_};
    }

    AngleFacts facts_;
    bool any_ = false, looking_ = false;
    std::size_t rows_ = 0, skipped_ = 0;  ///< so far
    Row last_;
    Piece piece_;
    double piece_begin_s_ = 0.0;
    std::vector<Piece> pieces_;
};

}  // namespace

HeldCounter::Row HeldCounter::row_of(const TraceView& rows, std::size_t k) {
    return {rows.velocity_deg_s[k], rows.torque_nm[k], rows.has_position() ? rows.position_deg[k] : 0.0,
            rows.time_s[k]};
}

void HeldCounter::count(const TraceView& rows, bool begins_run) {
    if (rows.size() == 0) return;
    has_position_ = rows.has_position();
    if (by_position_ && has_position_) {
        std::size_t k = 0;
        if (!any_ || begins_run) {
            last_ = row_of(rows, k++);
            stretch_ = {.since_s = last_.time_s};
            any_ = true;
        }
        for (; k < rows.size(); ++k) {
            const Row before = std::exchange(last_, row_of(rows, k));
            count_by_position(before, last_);
        }
        return;
    }
    if (any_ && !begins_run) {
        const Row now = row_of(rows, 0);
        const std::array velocity = {last_.velocity, now.velocity}, torque = {last_.torque, now.torque},
                         position = {last_.position, now.position};
        count_pairs({velocity.data(), torque.data(), has_position_ ? position.data() : nullptr}, 1);
    } else {
        run_ = {};
    }
    count_pairs({rows.velocity_deg_s.data(), rows.torque_nm.data(),
                 has_position_ ? rows.position_deg.data() : nullptr},
                rows.size() - 1);
    last_ = row_of(rows, rows.size() - 1);
    any_ = true;
}

void HeldCounter::count_pairs(const RowChannels& rows, std::size_t pairs) {
    const RepeatCounts counts = count_repeats(rows, pairs, moving_deg_s);
    counts_ += counts;
    if (counts.torque > 0)
        measure_runs(rows, pairs);
    else if (pairs > 0)
        run_ = {};
    if (changes_.size() < judged_changes) note_changes(rows, pairs);
}

void HeldCounter::count_by_position(const Row& before, const Row& now) {
    const bool torque = before.torque == now.torque, position = before.position == now.position;
    if (!torque && changes_.size() < judged_changes) changes_.push_back(std::abs(now.torque - before.torque));
    for (const Way way : {torque_alone, with_position}) {
        run_[way] = torque && (position || way == torque_alone) ? run_[way] + 1 : 0;
        if (way == with_position) stretch_.longest = std::max(stretch_.longest, run_[way]);
    }
    if (position) {
        ++stretch_.pairs;
        stretch_.torque += torque ? 1 : 0;
        return;
    }
    const double passed_s = now.time_s - stretch_.since_s;
    if (std::abs(now.position - before.position) > moving_deg_s * passed_s) {
        counts_.moving += stretch_.pairs + 1;
        counts_.position += stretch_.pairs;
        counts_.torque += stretch_.torque + (torque ? 1 : 0);
        counts_.position_and_torque += stretch_.torque;
        counts_.velocity = counts_.moving;  // which says nothing of its own
        counts_.velocity_and_torque = counts_.torque;
        longest_[with_position] = std::max(longest_[with_position], stretch_.longest);
        longest_[torque_alone] = std::max(longest_[torque_alone], run_[torque_alone]);
    }
    stretch_ = {.since_s = now.time_s};
}

void HeldCounter::measure_runs(const RowChannels& rows, std::size_t pairs) {
    const auto same = [](const double* values, std::size_t k) {
        return values != nullptr && values[k] == values[k + 1];
    };
    for (std::size_t k = 0; k < pairs; ++k) {
        const double speed = std::min(std::abs(rows.velocity_deg_s[k]), std::abs(rows.velocity_deg_s[k + 1]));
        const bool torque = speed > moving_deg_s && same(rows.torque_nm, k);
        const bool velocity = torque && same(rows.velocity_deg_s, k);
        const bool position = torque && same(rows.position_deg, k);
        const std::array held = {torque, velocity, position, velocity && position};
        for (std::size_t way = 0; way < held.size(); ++way) {
            run_[way] = held[way] ? run_[way] + 1 : 0;
            longest_[way] = std::max(longest_[way], run_[way]);
        }
    }
}

void HeldCounter::note_changes(const RowChannels& rows, std::size_t pairs) {
    for (std::size_t k = 0; k < pairs && changes_.size() < judged_changes; ++k) {
        const double speed = std::min(std::abs(rows.velocity_deg_s[k]), std::abs(rows.velocity_deg_s[k + 1]));
        const double change = std::abs(rows.torque_nm[k + 1] - rows.torque_nm[k]);
        if (speed > moving_deg_s && change > 0.0) changes_.push_back(change);
    }
}

// Of a sample written several times, all channels change in one row or in none.
bool HeldCounter::is_evidence(std::size_t repeats, std::size_t with_torque) const {
    const std::size_t changes = counts_.moving - repeats, of_torque = counts_.moving - counts_.torque;
    if (2 * repeats < counts_.moving) return true;
    const auto both = static_cast<double>(changes + with_torque) - static_cast<double>(counts_.torque);
    return of_torque >= fewest_changes && both >= changing_together * static_cast<double>(of_torque);
}

HeldCounter::Way HeldCounter::way() const {
    const bool velocity_is_evidence = is_evidence(counts_.velocity, counts_.velocity_and_torque);
    const bool position_is_evidence =
        has_position_ && is_evidence(counts_.position, counts_.position_and_torque);
    if (velocity_is_evidence) return position_is_evidence ? with_both : with_velocity;
    return position_is_evidence ? with_position : torque_alone;
}

bool HeldCounter::torque_is_coarse() const {
    if (changes_.size() < fewest_changes) return true;
    std::vector<double> changes = changes_;
    return median_in(changes) < coarse_steps * *std::ranges::min_element(changes);
}

HeldSamples HeldCounter::held() const {
    const std::array counts = {counts_.torque, counts_.velocity_and_torque, counts_.position_and_torque,
                               counts_.all};
    const Way chosen = way();
    if (chosen == torque_alone && counts_.torque > 0 && torque_is_coarse()) return {};
    return {counts[chosen], longest_[chosen], counts_.moving};
}

AngleFacts::Source AngleFacts::source() const {
    const bool none =
        verdict == Verdict::no_position || verdict == Verdict::scaled || verdict == Verdict::unrelated;
    return none ? Source::velocity : Source::position;
}

std::string_view source_name(AngleFacts::Source source) {
    return source == AngleFacts::Source::position ? "position" : "velocity";
}

std::string AngleFacts::reason() const {
    constexpr std::array<std::string_view, 8> reasons = {
        "the log has no position of this joint",
        "no velocity is logged to check the position against",
        "the joint moves too little to check the position against the velocity",
        "the position agrees with the velocity",
        "velocity and position have opposite signs: the sign of the position is inverted",
        "the position is constant: the joint is at rest, whatever its velocity says; a position that was not "
        "recorded is left out with --columns",
        "",
        "the position does not agree with the velocity: it may be another joint's"};
    return verdict == Verdict::scaled ? factor_in_words(*factor)
                                      : std::string(reasons[static_cast<std::size_t>(verdict)]);
}

std::string AngleFacts::warning() const {
    std::string text;
    if (verdict == Verdict::reversed || verdict == Verdict::stands) text = reason();
    if (verdict != Verdict::no_position && source() == Source::velocity)
        text = fmt::format("{}; the angle is taken from the velocity", reason());
    if (!contradicted) return text;
    const std::string later = fmt::format(
        "from data row {} on the position no longer agrees with the velocity; from there the angle is taken "
        "from the velocity",
        contradicted->row + 1);
    return text.empty() ? later : fmt::format("{}; {}", text, later);
}

Hertz Recording::update_rate() const {
    const auto held_share =
        static_cast<double>(held.count) / static_cast<double>(std::max<std::size_t>(held.moving, 1));
    return held_share < repeated_by_rule ? clock.nominal_rate
                                         : ripplenotch::nominal_rate((1.0 - held_share) * clock.nominal_rate);
}

std::vector<LogWarning> recording_warnings(const Recording& recording, const std::string& clock_check) {
    std::vector<LogWarning> warnings = clock_warnings(recording.clock);
    const double held = 100.0 * static_cast<double>(recording.held.count) /
                        static_cast<double>(recording.rows() > 0 ? recording.rows() : 1);
    if (held >= 0.1) {
        warnings.push_back(
            {"held samples",
             fmt::format(
                 "{} rows ({} %) repeat the previous sample while the joint moves, up to {} in a row{}",
                 recording.held.count, percent_text(held), recording.held.longest,
                 update_rate_text(recording)),
             true});
    }
    using Verdict = AngleFacts::Verdict;
    const Verdict verdict = recording.angle.verdict;
    if (const std::string angle = recording.angle.warning(); !angle.empty())
        warnings.push_back({"angle", angle, true});
    if ((verdict == Verdict::agrees || verdict == Verdict::too_little_motion) && !clock_check.empty())
        warnings.push_back({"clock against motion", clock_check, true});
    return warnings;
}

TraceView view_of(const RowBlock& block, std::size_t joint, std::size_t first, std::size_t count) {
    const JointRows& rows = block.joints[joint];
    const auto part = [&](const std::vector<double>& values) {
        return values.empty() ? std::span<const double>{} : std::span(values).subspan(first, count);
    };
    return {{}, part(block.time_s), part(rows.velocity_deg_s), part(rows.torque_nm), part(rows.position_deg)};
}

struct Account::Joint {
    HeldCounter held;
    JointAngle angle;
};

Account::~Account() = default;
Account::Account(Account&&) noexcept = default;

Account::Account(const Layout& layout, const Opening& opening)
    : clock_(layout.source, opening.time_s, layout.stated_rate) {
    const std::size_t joints = opening.blocks.empty() ? 1 : opening.blocks.front().joints.size();
    for (std::size_t j = 0; j < joints; ++j) {
        const JointRows* const rows = opening.blocks.empty() ? nullptr : &opening.blocks.front().joints[j];
        const bool velocity = rows != nullptr && has_values(rows->velocity_deg_s);
        const bool position = rows != nullptr && has_values(rows->position_deg);
        joints_.push_back({HeldCounter(layout.velocity_from_position),
                           {velocity && !layout.velocity_from_position, position}});
    }
    judged_ = clock_.facts().refusal.empty();
    Clock clock = clock_;
    for (std::size_t b = 0; b < opening.blocks.size(); ++b) {
        const RowBlock& block = opening.blocks[b];
        for (const RunPart& part : clock.add(std::span(block.time_s).first(opening.counts[b]))) {
            for (std::size_t j = 0; j < joints_.size() && part.usable && judged_; ++j)
                joints_[j].angle.look(view_of(block, j, part.first, part.count), part.begins_run);
        }
    }
    for (Joint& joint : joints_) joint.angle.decide();
}

const AngleFacts& Account::angle(std::size_t joint) const { return joints_[joint].angle.facts(); }

std::span<const RunPart> Account::add(const RowBlock& block) {
    const std::span<const RunPart> parts = clock_.add(block.time_s);
    for (const RunPart& part : parts) {
        for (std::size_t j = 0; j < joints_.size(); ++j) {
            const TraceView rows = view_of(block, j, part.first, part.count);
            if (part.usable) joints_[j].held.count(rows, part.begins_run);
            if (part.usable && judged_)
                joints_[j].angle.follow(rows, part.begins_run);
            else
                joints_[j].angle.skip(part.count);
        }
    }
    return parts;
}

Recording Account::recording(const Layout& layout, std::size_t place, std::size_t joint) const {
    Recording recording;
    recording.source = layout.source;
    recording.joint = layout.all_chosen()[place].joint;
    const auto torque = layout.all_chosen()[place].torque;
    if (torque && layout.columns[*torque].current) recording.torque_unit = "A";
    recording.clock = clock_.facts();
    recording.held = joints_[joint].held.held();
    recording.angle = joints_[joint].angle.facts();
    recording.assumptions = layout.assumptions;
    recording.inferences = layout.inferences;
    if (layout.outside) recording.outside = *layout.outside;
    recording.warnings = recording_warnings(recording);
    return recording;
}

std::span<const double> JointsPosition::of(const AngleFacts& angle, const TraceView& rows) {
    const std::size_t first = std::exchange(rows_, rows_ + rows.size());
    if (angle.source() == AngleFacts::Source::velocity || !rows.has_position()) return {};
    const std::size_t parting = std::min(angle.contradicted ? angle.contradicted->used_row : rows_, rows_);
    const bool reversed = angle.verdict == AngleFacts::Verdict::reversed;
    if (!reversed && parting == rows_) {
        last_deg_ = rows.position_deg.back();
    } else {
        room_.resize(rows.size());
        for (std::size_t k = 0; k < rows.size(); ++k) {
            const double speed =
                0.5 * (rows.velocity_deg_s[k] + (k > 0 ? rows.velocity_deg_s[k - 1] : last_deg_s_));
            const double step = rows.time_s[k] - (k > 0 ? rows.time_s[k - 1] : last_s_);
            if (first + k < parting)
                last_deg_ = reversed ? -rows.position_deg[k] : rows.position_deg[k];
            else
                last_deg_ += speed * step;
            room_[k] = last_deg_;
        }
    }
    last_s_ = rows.time_s.back();
    last_deg_s_ = rows.velocity_deg_s.back();
    return !reversed && parting == rows_ ? rows.position_deg : room_;
}

}  // namespace ripplenotch
