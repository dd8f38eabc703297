// SPDX-License-Identifier: MIT
#include "log/columns/infer_motion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "log/account/account.hpp"
#include "log/clock/clock_check.hpp"
#include "log/columns/units.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {

namespace {

// The largest but a thousandth: one wild value decides no unit.
double nearly_largest(std::vector<double> values) {
    if (values.empty()) return 0.0;
    for (double& value : values) value = std::abs(value);
    const auto at = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) * 999 / 1000);
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

// Over stretches of rows: from one row to the next it would be the noise that is fastest.
std::vector<double> slopes(const std::vector<double>& time_s, const std::vector<double>& position) {
    const std::size_t stride = std::max<std::size_t>(1, time_s.size() / 200);
    std::vector<double> found;
    for (std::size_t i = stride; i < time_s.size(); i += stride) {
        const double passed = time_s[i] - time_s[i - stride];
        if (passed > 0.0) found.push_back((position[i] - position[i - stride]) / passed);
    }
    return found;
}

// Piece by piece: long enough to average noise, many enough for a median. A step of ten usual ones ends a
// piece: the velocity within is not known.
std::vector<MotionPieces::Piece> pieces_of(const std::vector<double>& t, const std::vector<double>& v,
                                           const std::vector<double>& q) {
    std::vector<double> steps;
    for (std::size_t i = 1; i < t.size(); ++i) steps.push_back(t[i] - t[i - 1]);
    const double gap = 10.0 * std::max(median_of(steps), 0.0);
    std::vector<std::size_t> run_starts;
    for (std::size_t i = 0; i < steps.size(); ++i)
        if (gap > 0.0 && steps[i] > gap) run_starts.push_back(i + 1);
    MotionPieces motion(t.size());
    motion.add({{}, t, v, v, q, run_starts});
    return motion.pieces();
}

// The median of the pieces' ratios, where most of them say the same: neither spikes nor jumps move it.
std::optional<double> scale_of(const std::vector<MotionPieces::Piece>& pieces) {
    constexpr std::size_t fewest = 6;          // by hand
    constexpr double alike = 0.1, most = 0.7;  // by hand: of the ratio, and of the pieces
    if (pieces.size() < fewest) return std::nullopt;
    std::vector<double> moved, ratios;
    for (const auto& piece : pieces) moved.push_back(piece.integrated_velocity);
    const double usual = nearly_largest(moved);
    for (const auto& piece : pieces) {
        if (std::abs(piece.integrated_velocity) > 0.2 * usual)
            ratios.push_back(piece.position_change / piece.integrated_velocity);
    }
    if (!(usual > 0.0) || ratios.size() < fewest) return std::nullopt;
    const double middle = median_of(ratios);
    const auto same = std::ranges::count_if(
        ratios, [middle](double ratio) { return std::abs(ratio - middle) < alike * std::abs(middle); });
    if (static_cast<double>(same) < most * static_cast<double>(ratios.size())) return std::nullopt;
    return std::abs(middle);
}

// 1667 rpm, eight times the fastest joint behind a gear and twice a direct drive of an arm; 20000 rpm of a
// motor, before the gear.
constexpr double no_joint_deg_s = 10000.0, no_motor_deg_s = 120000.0;
constexpr double same_speed = 0.02;  // readings whose speeds differ by less are one
constexpr double never_meant = 4.6;  // dearer by more than two conventions broken: not worth a word

class Inference {
  public:
    Inference(const ColumnFacts& facts, const ReadOptions& options, const std::vector<MotionColumns>& joints,
              MotionsSeen& seen, Layout& layout)
        : facts_(facts), options_(options), joints_(joints), seen_(seen), layout_(layout) {}

    void run() {
        if (joints_.empty()) return;
        subject_ = &joints_.front();
        gather();
        const MotionQuestion question{*subject_, evidence_, layout_, known_ratio(*subject_)};
        std::vector<MotionReading> fitting = motion_readings(question, true);
        const bool fits = !fitting.empty() && !fitting.front().against_header;
        std::vector<MotionReading> readings = fits ? fitting : motion_readings(question, false);
        const auto best = likeliest(readings);
        if (best == readings.end()) return;  // --side says what cannot be
        best_ = *best;
        if (!fits) readings.insert(readings.end(), fitting.begin(), fitting.end());
        if (options_.needs_torque) refuse_counts();
        refuse_no_speed();
        settle_on_best();
        refuse_motor_units();
        const std::vector<OtherReading> possible = others(readings, open_margin);
        if (!stated() || best_.of_motor() || !possible.empty())
            say(possible, others(readings, never_meant), motion_readings(question, false));
    }

  private:
    // All joints of a file are written alike: the one whose position and velocity agree best speaks for them.
    void gather() {
        if (!facts_.motion_sample) return;
        for (const std::size_t bytes : {std::size_t{0}, longer_opening, longest_opening}) {
            const bool settled = measure(bytes);
            if (settled || (bytes == longer_opening && all_stated_)) break;
        }
    }

    /// Looks at those that have not been looked at.
    const MotionsSeen::Opening& look_at(std::size_t bytes) {
        std::vector<MotionPlace> places;
        MotionsSeen::Opening& opening = seen_.openings[bytes];
        for (const MotionColumns& joint : joints_)
            if (opening.of.count(joint.place()) == 0) places.push_back(joint.place());
        if (places.empty()) return opening;
        MotionSample rows = facts_.motion_sample(layout_, places, bytes);
        opening.whole = rows.whole;
        const double factor = layout_.chosen.time   ? layout_.columns[*layout_.chosen.time].factor
                              : layout_.stated_rate ? 1.0 / layout_.stated_rate->value()
                                                    : 1.0;
        for (double& time : rows.time) time *= factor;
        for (std::size_t j = 0; j < places.size(); ++j) {
            const MotionPlace& place = places[j];
            if (place.velocity) {
                const Column& column = layout_.columns[*place.velocity];
                for (double& value : rows.joints[j].velocity) value += column.shift / column.factor;
            }
            opening.of[place] = motion_evidence(rows.time, rows.joints[j].velocity, rows.joints[j].position);
        }
        return opening;
    }

    /// True when nothing is left to be asked of a longer sample.
    bool measure(std::size_t bytes) {
        const MotionsSeen::Opening& opening = look_at(bytes);
        all_stated_ = true;
        evidence_ = {};
        for (const MotionColumns& joint : joints_) {
            for (const MotionColumn& column : joint.all())
                all_stated_ = all_stated_ && column.unit_is_stated && !column.named_motor;
            const MotionEvidence& one = opening.of.at(joint.place());
            evidence_.fastest = std::max(evidence_.fastest, one.fastest);
            evidence_.farthest = std::max(evidence_.farthest, one.farthest);
            evidence_.velocity_counts = evidence_.velocity_counts || one.velocity_counts;
            evidence_.position_counts = evidence_.position_counts || one.position_counts;
            if (!evidence_.wrap) evidence_.wrap = one.wrap;
            if (one.scale && (!evidence_.scale || joint.chosen)) {
                evidence_.scale = one.scale;
                subject_ = &joint;
            }
        }
        const bool comparable = subject_->velocity && subject_->position;
        return opening.whole || (all_stated_ && (evidence_.scale || !comparable));
    }

    /// Told by the user, for this joint or for all.
    [[nodiscard]] std::optional<double> known_ratio(const MotionColumns& joint) const {
        if (!options_.gear_ratio_of || !joint.chosen) return options_.gear_ratio;
        const std::optional<double> own = options_.gear_ratio_of(joint.joint);
        return own ? own : options_.gear_ratio;
    }

    [[nodiscard]] bool stated() const {
        return std::ranges::all_of(subject_->all(), &MotionColumn::unit_is_stated);
    }

    void settle_on_best() {
        for (const MotionColumns& joint : joints_) {
            const std::optional<double> known = known_ratio(joint);
            const std::optional<double> ratio = known ? known : best_.ratio;
            for (const MotionColumn& column : joint.all()) settle(column, best_.of(column), ratio);
        }
        const bool motor = best_.of_motor();
        layout_.motor_units = motor && !best_.ratio;
    }

    // A speed alone, without a name that says so, is no reason to refuse a log: a motor's stays possible
    // then.
    std::vector<MotionReading>::const_iterator likeliest(const std::vector<MotionReading>& readings) const {
        const bool named = options_.takes_motor_units || side_is_said();
        return std::ranges::find_if(
            readings, [named](const MotionReading& one) { return named || !one.of_motor() || one.ratio; });
    }

    // Counts that did not show in the first rows, at rest.
    void refuse_counts() const {
        for (const MotionColumn& column : subject_->all()) {
            const bool counts =
                column.role == Role::velocity ? evidence_.velocity_counts : evidence_.position_counts;
            if (!counts || column.unit_is_stated || column.convention != nullptr) continue;
            ask("{}: read {} in whole numbers throughout, as counts are, and no unit, expected quantities; "
                "state what 1 is, as in {} (or --unit {}={})",
                layout_.source, label(column), scale_example(column.role), role_name(column.role),
                base_unit(dimension_of(column.role)));
        }
    }

    // Whatever unit was taken, nothing turns so fast: the numbers are those of a device.
    void refuse_no_speed() const {
        const MotionColumn& column = subject_->of_speed();
        const ReadColumn& read = best_.of(column);
        const bool motor = read.side == Shaft::motor && !best_.ratio;
        const double deg_s = evidence_.fastest * (motor ? read.unit_factor : read.factor);
        if (!options_.needs_torque || column.unit_is_stated ||
            deg_s <= (motor ? no_motor_deg_s : no_joint_deg_s))
            return;
        const bool both = subject_->velocity && subject_->position && !subject_->position->unit_is_stated;
        ask("{}: read {:.4g} in {}, of which no unit is stated: in {} the {} would turn at {:.3g} deg/s, "
            "expected at most {:g}; state what 1 is, as in {}{}, or --unit if that is the speed",
            layout_.source, evidence_.fastest, label(column), read.unit, motor ? "motor" : "joint", deg_s,
            motor ? no_motor_deg_s : no_joint_deg_s, scale_example(column.role),
            both ? " " + scale_example(Role::position) : "");
    }

    void refuse_motor_units() const {
        if (!layout_.motor_units || !options_.needs_torque || options_.takes_motor_units) return;
        raise<DataError>(
            "{}: {} is measured before the gear (named so, or too fast for a joint), and no ratio is known "
            "to bring it to the joint; use --gear-ratio, or --side joint if it is the joint's",
            layout_.source, label(subject_->of_speed()));
    }

    void settle(const MotionColumn& known, const ReadColumn& read, std::optional<double> ratio) {
        Column& column = layout_.columns[known.column];
        column.side = read.side;
        if (!known.unit_is_stated) {
            column.unit = read.unit;
            column.factor = read.unit_factor;
            column.unit_assumed = false;
        }
        if (read.side != Shaft::motor) return;
        column.motor_ratio = ratio;
        column.factor /= ratio.value_or(1.0);
        column.shift /= ratio.value_or(1.0);
    }

    /// Readings that cost less than `margin` more and say another speed, each once, the likeliest first.
    std::vector<OtherReading> others(const std::vector<MotionReading>& readings, double margin) const {
        std::vector<OtherReading> found;
        for (const MotionReading& one : readings) {
            if (one.cost - best_.cost >= margin) continue;
            OtherReading other{words_of(one),
                               option_of(one),
                               1.0,
                               one.velocity.factor / best_.velocity.factor,
                               one.position.factor / best_.position.factor,
                               one.speed_in_motor_units() != best_.speed_in_motor_units()};
            const auto same = [&](const OtherReading& known) {
                return known.changes_side == other.changes_side &&
                       std::abs(known.velocity_factor / other.velocity_factor - 1.0) < same_speed;
            };
            if (same(OtherReading{}) || std::ranges::any_of(found, same)) continue;
            found.push_back(std::move(other));
        }
        return found;
    }

    std::string words_of(const MotionReading& reading) const {
        if (reading.velocity.side == Shaft::motor && best_.velocity.side != Shaft::motor)
            return fmt::format("the speed is the motor's, before the gear, in {}", speed_unit(reading));
        if (reading.velocity.side != Shaft::motor && best_.velocity.side == Shaft::motor)
            return fmt::format("the speed is the joint's, in {}", speed_unit(reading));
        return fmt::format("the speed is in {}", speed_unit(reading));
    }

    std::string speed_unit(const MotionReading& reading) const {
        if (subject_->velocity) return std::string(reading.velocity.unit);
        return fmt::format("{}/s", reading.position.unit);
    }

    std::string option_of(const MotionReading& reading) const {
        const std::string side = reading.velocity.side == best_.velocity.side ? ""
                                 : reading.velocity.side == Shaft::motor      ? "--side motor"
                                                                              : "--side joint";
        const bool same_unit = speed_unit(reading) == speed_unit(best_);
        if (!side.empty()) return same_unit ? side : unit_option_of(reading) + " " + side;
        return unit_option_of(reading);
    }

    std::string unit_option_of(const MotionReading& reading) const {
        if (!subject_->velocity) return fmt::format("--unit position={}", reading.position.unit);
        std::string option = fmt::format("--unit velocity={}", reading.velocity.unit);
        const bool position_too = subject_->position && !evidence_.scale &&
                                  !subject_->position->unit_is_stated &&
                                  reading.position.unit != best_.position.unit;
        return position_too ? fmt::format("{},position={}", option, reading.position.unit) : option;
    }

    std::string label(const MotionColumn& column) const { return column_label(facts_.names, column.column); }

    void say(const std::vector<OtherReading>& possible, const std::vector<OtherReading>& thinkable,
             const std::vector<MotionReading>& without_position) {
        std::string about, assumed, option;
        for (const MotionColumn& column : subject_->all()) {
            const ReadColumn& read = best_.of(column);
            const bool motor = read.side == Shaft::motor;
            if (column.unit_is_stated && !motor && possible.empty()) continue;
            about += fmt::format("{}{}", about.empty() ? "" : " and ", label(column));
            assumed +=
                fmt::format("{}{}{}", assumed.empty() ? "" : " and ", read.unit, motor ? ", motor side" : "");
            if (!column.unit_is_stated)
                option += fmt::format("{}{}={}", option.empty() ? "--unit " : ",", role_name(column.role),
                                      read.unit);
        }
        const bool motor = best_.of_motor();
        if (motor) option += fmt::format("{}--side {}", option.empty() ? "" : " ", side_words());
        if (option.empty() && !possible.empty())
            option = possible.front().changes_side ? "--side joint" : possible.front().option;
        Assumption read{fmt::format("unit{} of {}", motor ? " and side" : "", about), assumed,
                        reason(possible, without_position), option, possible.empty() ? thinkable : possible};
        if (possible.empty()) {
            layout_.inferences.push_back(std::move(read));
            return;
        }
        for (const MotionColumns& joint : joints_) {
            for (const MotionColumn& column : joint.all())
                if (!column.unit_is_stated) layout_.columns[column.column].unit_assumed = true;
        }
        layout_.assumptions.push_back(std::move(read));
    }

    /// The convention of a name that decided on the unit; null where none did.
    const Convention* by_convention() const {
        for (const MotionColumn& column : subject_->all())
            if (!column.unit_is_stated && column.convention != nullptr &&
                best_.of(column).unit == column.convention->unit)
                return column.convention;
        return nullptr;
    }

    /// By --side, or by a name that is a motor's.
    bool side_is_said() const {
        return std::ranges::any_of(subject_->all(), [](const MotionColumn& column) {
            return names_motor(column) || column.stated_side.has_value();
        });
    }

    std::string side_words() const {
        if (best_.velocity.side == best_.position.side) return "motor";
        return best_.velocity.side == Shaft::motor ? "velocity=motor" : "position=motor";
    }

    std::string reason(const std::vector<OtherReading>& possible,
                       const std::vector<MotionReading>& without_position) const {
        if (!possible.empty()) {
            return fmt::format("not stated in the log; the largest values read are {:.3g}{}",
                               evidence_.fastest,
                               subject_->position ? fmt::format(" and {:.3g}", evidence_.farthest) : "");
        }
        if (layout_.motor_units)
            return "named as the motor's, or too fast for a joint, and no ratio is known";
        if (best_.of_motor()) {
            return evidence_.scale && best_.velocity.side != best_.position.side
                       ? fmt::format("position and velocity differ by {:.5g}, which is a gear ratio",
                                     *best_.ratio)
                   : side_is_said()
                       ? fmt::format("named as the motor's; divided by the ratio {:.5g}", *best_.ratio)
                       : fmt::format("too fast for a joint; divided by the ratio {:.5g}", *best_.ratio);
        }
        if (const Convention* convention = by_convention()) return std::string(convention->source);
        if (evidence_.wrap) return fmt::format("the position starts again at {:.5g}", *evidence_.wrap);
        const bool by_position = evidence_.scale && without_position.size() > 1 &&
                                 without_position[1].cost - without_position[0].cost < open_margin;
        if (by_position) {
            return fmt::format("the position goes on by {:.5g} of velocity times time, as in no other units",
                               *evidence_.scale);
        }
        return fmt::format("the largest value is {:.4g}, too fast for a joint in other units",
                           evidence_.fastest);
    }

    const ColumnFacts& facts_;
    const ReadOptions& options_;
    const std::vector<MotionColumns>& joints_;
    MotionsSeen& seen_;
    Layout& layout_;
    MotionEvidence evidence_;
    const MotionColumns* subject_ = nullptr;
    bool all_stated_ = true;
    MotionReading best_;
};

// Which columns of a file are a joint's motion, and what is known of their units before any value is looked
// at.

// The measured column for a role where nobody has to choose between several.
std::optional<std::size_t> only_column(const KnownColumns& known, const JointGroup& group, Role role) {
    std::optional<std::size_t> only;
    for (const std::size_t c : group.of(role)) {
        if (known.names[c].reference) continue;
        if (only) return std::nullopt;
        only = c;
    }
    return only;
}

}  // namespace

MotionEvidence motion_evidence(const std::vector<double>& time_s, const std::vector<double>& velocity,
                               const std::vector<double>& position) {
    std::vector<double> t, v, q;
    for (std::size_t i = 0; i < std::max(velocity.size(), position.size()); ++i) {
        const bool good = (time_s.empty() || std::isfinite(time_s[i])) &&
                          (velocity.empty() || std::isfinite(velocity[i])) &&
                          (position.empty() || std::isfinite(position[i]));
        if (!good) continue;
        if (!time_s.empty()) t.push_back(time_s[i]);
        if (!velocity.empty()) v.push_back(velocity[i]);
        if (!position.empty()) q.push_back(position[i]);
    }
    MotionEvidence evidence;
    evidence.velocity_counts = counts_only(v);
    evidence.position_counts = counts_only(q);
    evidence.farthest = nearly_largest(q);
    evidence.wrap = wrap_period(q);
    if (evidence.wrap) Unwrapper(*evidence.wrap).apply(q);
    evidence.fastest = nearly_largest(velocity.empty() && !t.empty() ? slopes(t, q) : v);
    if (t.size() < 2 || v.empty() || q.empty()) return evidence;
    evidence.scale = scale_of(pieces_of(t, v, q));
    return evidence;
}

void infer_motion(const ColumnFacts& facts, const ReadOptions& options,
                  const std::vector<MotionColumns>& joints, MotionsSeen& seen, Layout& layout) {
    Inference(facts, options, joints, seen, layout).run();
}

std::vector<MotionColumns> motions_of(const KnownColumns& known, const std::vector<JointGroup>& groups,
                                      const std::vector<bool>& unit_is_stated, const ReadOptions& options,
                                      const Layout& layout) {
    const auto column = [&](std::optional<std::size_t> c, Role role) -> std::optional<MotionColumn> {
        if (!c || layout.columns[*c].role != role) return std::nullopt;
        const auto side = options.sides.find(role);
        std::optional<Shaft> stated_side;
        if (side != options.sides.end())
            stated_side = side->second;
        else if (is_linear_unit(role, layout.columns[*c].unit))
            stated_side = Shaft::joint;  // the screw's, however fast it turns
        return MotionColumn{
            role,       *c, unit_is_stated[*c], known.names[*c].motor_side, known.names[*c].convention(role),
            stated_side};
    };
    std::vector<MotionColumns> motions;
    const auto add = [&](const std::string& joint, std::optional<std::size_t> velocity,
                         std::optional<std::size_t> position, bool chosen) {
        MotionColumns motion{joint, column(velocity, Role::velocity), column(position, Role::position),
                             chosen};
        if (motion.velocity || motion.position) motions.push_back(motion);
    };
    const std::vector<JointColumns> all = layout.all_chosen();
    for (const JointColumns& joint : all) add(joint.joint, joint.velocity, joint.position, true);
    for (const JointGroup& group : groups) {
        const bool chosen =
            std::ranges::any_of(all, [&](const JointColumns& joint) { return joint.joint == group.name; });
        if (!chosen)
            add(group.name, only_column(known, group, Role::velocity),
                only_column(known, group, Role::position), false);
    }
    return motions;
}

}  // namespace ripplenotch
