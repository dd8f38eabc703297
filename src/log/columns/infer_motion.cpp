// SPDX-License-Identifier: MIT
#include "log/columns/infer_motion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "log/columns/motion_reading.hpp"
#include "ripplenotch/core/error.hpp"

namespace ripplenotch::layout_detail {
namespace {

constexpr double same_speed = 0.02;  // readings whose speeds differ by less are one
constexpr double never_meant = 4.6;  // dearer by more than two conventions broken: not worth a word

class Inference {
  public:
    Inference(const ColumnFacts& facts, const ReadOptions& options, const std::vector<MotionColumns>& joints,
              Layout& layout)
        : facts_(facts), options_(options), joints_(joints), layout_(layout) {}

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
        settle_on_best();
        refuse_motor_units();
        const std::vector<OtherReading> possible = others(readings, open_margin);
        if (!stated() || best_.velocity.side == Shaft::motor || best_.position.side == Shaft::motor ||
            !possible.empty())
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

    /// True when nothing is left to be asked of a longer sample.
    bool measure(std::size_t bytes) {
        bool scale = false;
        all_stated_ = true;
        evidence_ = {};
        for (const MotionColumns& joint : joints_) {
            for (const auto* column : {&joint.velocity, &joint.position})
                all_stated_ =
                    all_stated_ && (!*column || ((*column)->unit_is_stated && !(*column)->named_motor));
            const MotionEvidence one = evidence_of(joint, bytes);
            evidence_.fastest = std::max(evidence_.fastest, one.fastest);
            evidence_.farthest = std::max(evidence_.farthest, one.farthest);
            if (!evidence_.wrap) evidence_.wrap = one.wrap;
            if (one.scale && (!scale || joint.chosen)) {
                evidence_.scale = one.scale;
                subject_ = &joint;
                scale = true;
            }
        }
        const bool comparable = subject_->velocity && subject_->position;
        return all_stated_ && (scale || !comparable);
    }

    MotionEvidence evidence_of(const MotionColumns& joint, std::size_t bytes) const {
        const auto place = [](const std::optional<MotionColumn>& column) {
            return column ? std::optional<std::size_t>(column->column) : std::nullopt;
        };
        MotionSample rows =
            facts_.motion_sample({layout_, place(joint.velocity), place(joint.position)}, bytes);
        const double factor = layout_.chosen.time   ? layout_.columns[*layout_.chosen.time].factor
                              : layout_.stated_rate ? 1.0 / layout_.stated_rate->value()
                                                    : 1.0;
        for (double& time : rows.time) time *= factor;
        return motion_evidence(rows.time, rows.velocity, rows.position);
    }

    /// Told by the user, for this joint or for all.
    [[nodiscard]] std::optional<double> known_ratio(const MotionColumns& joint) const {
        if (!options_.gear_ratio_of || !joint.chosen) return options_.gear_ratio;
        const std::optional<double> own = options_.gear_ratio_of(joint.joint);
        return own ? own : options_.gear_ratio;
    }

    [[nodiscard]] bool stated() const {
        return (!subject_->velocity || subject_->velocity->unit_is_stated) &&
               (!subject_->position || subject_->position->unit_is_stated);
    }

    void settle_on_best() {
        for (const MotionColumns& joint : joints_) {
            const std::optional<double> known = known_ratio(joint);
            const std::optional<double> ratio = known ? known : best_.ratio;
            if (joint.velocity) settle(*joint.velocity, best_.velocity, ratio);
            if (joint.position) settle(*joint.position, best_.position, ratio);
        }
        const bool motor = best_.velocity.side == Shaft::motor || best_.position.side == Shaft::motor;
        layout_.motor_units = motor && !best_.ratio;
    }

    // A speed alone, without a name that says so, is no reason to refuse a log: a motor's stays possible
    // then.
    std::vector<MotionReading>::const_iterator likeliest(const std::vector<MotionReading>& readings) const {
        bool named = options_.takes_motor_units;
        for (const auto* column : {&subject_->velocity, &subject_->position}) {
            named = named ||
                    (*column &&
                     ((*column)->named_motor || (*column)->stated_side.has_value() ||
                      ((*column)->convention != nullptr && (*column)->convention->side == Shaft::motor)));
        }
        return std::find_if(readings.begin(), readings.end(), [named](const MotionReading& one) {
            const bool motor = one.velocity.side == Shaft::motor || one.position.side == Shaft::motor;
            return named || !motor || one.ratio;
        });
    }

    void refuse_motor_units() const {
        if (!layout_.motor_units || !options_.needs_torque || options_.takes_motor_units) return;
        const auto& column = subject_->velocity ? subject_->velocity : subject_->position;
        raise<DataError>(
            "{}: {} is measured before the gear (named so, or too fast for a joint), and no ratio is known "
            "to "
            "bring it to the joint; say --gear-ratio, or --side joint if it is the joint's",
            layout_.source, label(*column));
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
    }

    /// Readings that cost less than `margin` more and say another speed, each once, the likeliest first.
    std::vector<OtherReading> others(const std::vector<MotionReading>& readings, double margin) const {
        std::vector<OtherReading> found;
        for (const MotionReading& one : readings) {
            if (one.cost - best_.cost >= margin) continue;
            const bool motor_now = best_.velocity.side == Shaft::motor && !best_.ratio;
            const bool motor_then = one.velocity.side == Shaft::motor && !one.ratio;
            OtherReading other{words_of(one), option_of(one), 1.0,
                               one.velocity.factor / best_.velocity.factor,
                               one.position.factor / best_.position.factor};
            if (motor_then != motor_now) other.changes_side = true;
            const auto same = [&](const OtherReading& known) {
                return known.changes_side == other.changes_side &&
                       std::abs(known.velocity_factor / other.velocity_factor - 1.0) < same_speed;
            };
            if (same(OtherReading{}) || std::any_of(found.begin(), found.end(), same)) continue;
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
        for (const auto& [column, read, role] :
             {std::tuple(&subject_->velocity, &best_.velocity, Role::velocity),
              std::tuple(&subject_->position, &best_.position, Role::position)}) {
            if (!*column) continue;
            const bool motor = read->side == Shaft::motor;
            if ((*column)->unit_is_stated && !motor && possible.empty()) continue;
            about += fmt::format("{}{}", about.empty() ? "" : " and ", label(**column));
            assumed += fmt::format("{}{}{}", assumed.empty() ? "" : " and ", read->unit,
                                   motor ? ", motor side" : "");
            if (!(*column)->unit_is_stated)
                option +=
                    fmt::format("{}{}={}", option.empty() ? "--unit " : ",", role_name(role), read->unit);
        }
        const bool motor = best_.velocity.side == Shaft::motor || best_.position.side == Shaft::motor;
        if (motor) option += fmt::format("{}--side {}", option.empty() ? "" : " ", side_words());
        if (option.empty() && !possible.empty()) option = possible.front().option;
        Assumption read{fmt::format("unit{} of {}", motor ? " and side" : "", about), assumed,
                        reason(possible, without_position), option, possible.empty() ? thinkable : possible};
        if (possible.empty()) {
            layout_.inferences.push_back(std::move(read));
            return;
        }
        for (const MotionColumns& joint : joints_) {
            for (const auto* column : {&joint.velocity, &joint.position}) {
                if (*column && !(*column)->unit_is_stated)
                    layout_.columns[(*column)->column].unit_assumed = true;
            }
        }
        layout_.assumptions.push_back(std::move(read));
    }

    /// The convention of a name that decided on the unit; null where none did.
    const Convention* by_convention() const {
        for (const auto* column : {&subject_->velocity, &subject_->position}) {
            if (!*column || (*column)->unit_is_stated || (*column)->convention == nullptr) continue;
            const auto& read = column == &subject_->velocity ? best_.velocity : best_.position;
            if (read.unit == (*column)->convention->unit) return (*column)->convention;
        }
        return nullptr;
    }

    std::string side_words() const {
        if (best_.velocity.side == best_.position.side) return "motor";
        return best_.velocity.side == Shaft::motor ? "velocity=motor" : "position=motor";
    }

    std::string reason(const std::vector<OtherReading>& possible,
                       const std::vector<MotionReading>& without_position) const {
        if (!possible.empty()) {
            return fmt::format("nothing in the log says it; the largest values read are {:.3g}{}",
                               evidence_.fastest,
                               subject_->position ? fmt::format(" and {:.3g}", evidence_.farthest) : "");
        }
        if (layout_.motor_units)
            return "named as the motor's, or too fast for a joint, and no ratio is known";
        if (best_.velocity.side == Shaft::motor || best_.position.side == Shaft::motor) {
            return evidence_.scale
                       ? fmt::format("position and velocity differ by {:.5g}, which is a gear ratio",
                                     *best_.ratio)
                       : fmt::format("named as the motor's; divided by the ratio {:.5g}", *best_.ratio);
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
    Layout& layout_;
    MotionEvidence evidence_;
    const MotionColumns* subject_ = nullptr;
    bool all_stated_ = true;
    MotionReading best_;
};

}  // namespace

void infer_motion(const ColumnFacts& facts, const ReadOptions& options,
                  const std::vector<MotionColumns>& joints, Layout& layout) {
    Inference(facts, options, joints, layout).run();
}

}  // namespace ripplenotch::layout_detail
