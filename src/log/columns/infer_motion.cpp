// SPDX-License-Identifier: MIT
#include "log/columns/infer_motion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

#include "log/account/account.hpp"
#include "log/clock/clock_check.hpp"
#include "log/columns/units.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/quantity.hpp"

namespace ripplenotch {

namespace {

// Every way in which a joint's velocity and position could be written, and how much speaks against each.

/// One column's unit and side under a reading.
struct ReadColumn {
    std::string_view unit;
    double unit_factor = 1.0;  ///< to deg/s or deg
    Shaft side = Shaft::joint;
    double factor = 1.0;  ///< to the joint's deg/s or deg: by unit and ratio
};

struct MotionReading {
    ReadColumn velocity, position;
    std::optional<double> ratio;  ///< between the motor and the joint, where a side is the motor's
    bool against_header = false;  ///< a unit that the log states is wrong
    double cost = 0.0;            ///< the likeliest has the least

    [[nodiscard]] const ReadColumn& of(const MotionColumn& column) const {
        return column.role == Role::velocity ? velocity : position;
    }
    [[nodiscard]] bool of_motor() const {
        return velocity.side == Shaft::motor || position.side == Shaft::motor;
    }
    [[nodiscard]] bool speed_in_motor_units() const { return velocity.side == Shaft::motor && !ratio; }
};

/// A reading is as possible as the likeliest when it costs less than this much more.
constexpr double open_margin = 1.0;

/// The columns that a motion has, with the factors of stated units in `layout`.
struct MotionQuestion {
    const MotionColumns& columns;
    const MotionEvidence& evidence;
    const Layout& layout;
    std::optional<double> gear_ratio;
};

// Whether the column's name says that it is measured before the gear.
bool names_motor(const MotionColumn& column) {
    return column.named_motor || (column.convention != nullptr && column.convention->side == Shaft::motor);
}

constexpr double within_family = 0.5;                         // by hand
constexpr double scale_agreement = 0.03;                      // scales within 3 % are one
constexpr double lowest_ratio = 20.0, highest_ratio = 400.0;  // of gears that a position may tell
constexpr double fastest_joint_deg_s = 1200.0;                // 200 rpm behind the gear
constexpr double slowest_motor_deg_s = 600.0, fastest_motor_deg_s = 72000.0;  // 100 to 12000 rpm
// Speeds and angles of joints in radians stay below these; in degrees such a joint would hardly move.
constexpr double usual_rad_s = 7.0, usual_rad = 6.6;

// By hand: what speaks against a reading, in nats, by what would have to be so. Below open_margin alone it
// settles nothing. Whoever states no unit does not state the side either: a motor is nearly as likely then,
// where it turns as motors do and its speed is not in degrees, which are those of joints.
struct Costs {
    double unusual_size = 0.25;        ///< degrees of a joint that hardly moves, radians beyond a joint's
    double motor_without_unit = 0.75;  ///< a motor's, and neither a unit nor a convention is there
    double motor_in_degrees = 1.0;     ///< in addition
    double joint_side_of_motor_name = 1.0;  ///< named after the motor, measured at the joint
    double families_mixed = 1.0;            ///< degrees in one column, radians in the other
    double motor_side_unnamed = 1.5;  ///< a motor's, though a unit is stated or a convention is a joint's
    double header_wrong = 1.5;        ///< a stated unit is another one
    double against_convention = 2.0;  ///< another unit than whoever writes such names has
    double against_wrap = 3.0;        ///< the position starts again elsewhere than at a turn
    double too_fast = 3.0;            ///< for a joint
    double motor_out_of_range = 3.0;  ///< too slow or too fast for a motor
};
constexpr Costs costs;

enum class Family { degrees, radians, turns };
struct MotionUnit {
    std::string_view name;
    double factor;
    Family family;
    double cost;  ///< turns are rare where nothing names them
    bool against_header = false;
};
constexpr std::array velocity_units = {MotionUnit{"deg/s", 1.0, Family::degrees, 0.0},
                                       MotionUnit{"rad/s", degrees_per_radian, Family::radians, 0.0},
                                       MotionUnit{"rpm", 6.0, Family::turns, 0.8},
                                       MotionUnit{"rev/s", 360.0, Family::turns, 1.5}};
constexpr std::array position_units = {MotionUnit{"deg", 1.0, Family::degrees, 0.0},
                                       MotionUnit{"rad", degrees_per_radian, Family::radians, 0.0},
                                       MotionUnit{"rev", 360.0, Family::turns, 1.0}};

// The units that a column may have.
std::vector<MotionUnit> candidates(const std::optional<MotionColumn>& column, const Layout& layout,
                                   std::span<const MotionUnit> units) {
    if (!column) return {{"", 1.0, Family::degrees, 0.0}};
    std::vector<MotionUnit> found;
    const Column& read = layout.columns[column->column];
    const auto known = std::ranges::find(units, std::string_view(read.unit), &MotionUnit::name);
    if (column->unit_is_stated)
        found.push_back(
            {read.unit, read.factor, known == units.end() ? Family::degrees : known->family, 0.0});
    // Whoever states what 1 is does not mean another unit, nor does a linear axis.
    if (!read.scale.empty() || is_linear_unit(read.role, read.unit)) return found;
    for (MotionUnit unit : units) {
        if (column->unit_is_stated && unit.name == read.unit) continue;
        unit.against_header = column->unit_is_stated;
        if (column->unit_is_stated) unit.cost = costs.header_wrong;
        if (column->convention != nullptr)
            unit.cost = column->convention->unit == unit.name ? 0.0 : unit.cost + costs.against_convention;
        found.push_back(unit);
    }
    return found;
}

Family family_of(const ReadColumn& column) {
    const std::string_view unit = column.unit;
    return unit.find("deg") != std::string_view::npos   ? Family::degrees
           : unit.find("rad") != std::string_view::npos ? Family::radians
                                                        : Family::turns;
}

bool allowed(const std::optional<MotionColumn>& column, Shaft side) {
    if (!column) return true;
    return !column->stated_side || *column->stated_side == side;
}

/// All readings that fit the evidence, the likeliest first; those against the header come last.
class Scoring {
  public:
    /// `with_scale` false: position and velocity need not belong together.
    Scoring(const MotionQuestion& question, bool with_scale)
        : question_(question), scale_(with_scale ? question.evidence.scale : std::nullopt) {}

    std::vector<MotionReading> run() {
        const MotionColumns& columns = question_.columns;
        for (const MotionUnit& v : candidates(columns.velocity, question_.layout, velocity_units)) {
            for (const MotionUnit& q : candidates(columns.position, question_.layout, position_units)) {
                for (const Shaft vs : {Shaft::joint, Shaft::motor}) {
                    for (const Shaft qs : {Shaft::joint, Shaft::motor}) add(v, q, vs, qs);
                }
            }
        }
        std::ranges::stable_sort(found_, [](const MotionReading& a, const MotionReading& b) {
            return a.against_header != b.against_header ? b.against_header : a.cost < b.cost;
        });
        return std::move(found_);
    }

  private:
    // The velocity of a log without one is the slope of its position.
    void add(const MotionUnit& v, const MotionUnit& q, Shaft vs, Shaft qs) {
        const MotionColumns& columns = question_.columns;
        if ((!columns.velocity && vs != qs) || (!columns.position && qs != vs)) return;
        if (!allowed(columns.velocity, vs) || !allowed(columns.position, qs)) return;
        if (v.against_header && q.against_header) return;
        MotionReading reading;
        reading.against_header = v.against_header || q.against_header;
        if (reading.against_header && !scale_) return;
        reading.velocity = {v.name, columns.velocity ? v.factor : q.factor, vs, 1.0};
        reading.position = {q.name, q.factor, qs, 1.0};
        if (!find_ratio(reading)) return;
        for (ReadColumn* column : {&reading.velocity, &reading.position})
            column->factor =
                column->unit_factor / (column->side == Shaft::motor ? reading.ratio.value_or(1.0) : 1.0);
        reading.cost =
            v.cost + q.cost + side_cost(reading) + mixture(v, q, vs != qs) + magnitude_cost(reading, v, q);
        found_.push_back(reading);
    }

    double side_cost(const MotionReading& reading) const {
        double cost = 0.0;
        bool unnamed = false;
        for (const MotionColumn& column : question_.columns.all()) {
            const bool motor = reading.of(column).side == Shaft::motor;
            if (!motor && names_motor(column)) cost += costs.joint_side_of_motor_name;
            unnamed = unnamed || (motor && !names_motor(column));
        }
        return unnamed ? cost + unnamed_motor_cost(reading) : cost;
    }

    double unnamed_motor_cost(const MotionReading& reading) const {
        const MotionColumn& speed = question_.columns.of_speed();
        const bool one_side = reading.velocity.side == reading.position.side;
        // A convention of names is one of joints, unless it says motor: for the angle as for the speed.
        const auto& angle = question_.columns.position;
        const bool by_convention =
            speed.convention != nullptr || (angle && angle->convention != nullptr && !angle->unit_is_stated);
        if (speed.unit_is_stated || by_convention || !one_side) return costs.motor_side_unnamed;
        const double deg_s = question_.evidence.fastest * reading.velocity.unit_factor;
        if (deg_s < slowest_motor_deg_s || deg_s > fastest_motor_deg_s) return costs.motor_out_of_range;
        return costs.motor_without_unit +
               (family_of(reading.velocity) == Family::degrees ? costs.motor_in_degrees : 0.0);
    }

    /// False where the scale is neither 1 nor a gear's.
    bool find_ratio(MotionReading& reading) const {
        if (reading.of_motor()) reading.ratio = question_.gear_ratio;
        if (!scale_) return true;
        const double faster = *scale_ * reading.position.unit_factor / reading.velocity.unit_factor;
        if (reading.velocity.side == reading.position.side) {
            // Within one family of units, neither a unit nor a gear makes a small factor: a clock does, or a
            // short log.
            const bool alike = family_of(reading.velocity) == family_of(reading.position);
            return std::abs(faster - 1.0) < (alike ? within_family : scale_agreement);
        }
        const double ratio = reading.position.side == Shaft::motor ? faster : 1.0 / faster;
        if (question_.gear_ratio) return std::abs(ratio / *question_.gear_ratio - 1.0) < scale_agreement;
        reading.ratio = ratio;
        return ratio >= lowest_ratio && ratio <= highest_ratio;
    }

    // Where position and velocity agree in these units, that they are of one family says nothing more.
    double mixture(const MotionUnit& v, const MotionUnit& q, bool through_gear) const {
        const MotionColumns& columns = question_.columns;
        if (!columns.velocity || !columns.position || (scale_ && !through_gear)) return 0.0;
        return v.family == q.family ? 0.0 : costs.families_mixed;
    }

    double magnitude_cost(const MotionReading& reading, const MotionUnit& v, const MotionUnit& q) const {
        const MotionEvidence& evidence = question_.evidence;
        double cost = 0.0;
        const double by_motor =
            question_.gear_ratio ? fastest_motor_deg_s / *question_.gear_ratio : fastest_joint_deg_s;
        if (!reading.speed_in_motor_units() &&
            evidence.fastest * reading.velocity.factor > std::max(by_motor, fastest_joint_deg_s))
            cost += costs.too_fast;
        if (evidence.wrap && question_.columns.position) {
            const double turn = *evidence.wrap * reading.position.unit_factor;
            if (std::abs(turn / 360.0 - 1.0) > scale_agreement) cost += costs.against_wrap;
        }
        const bool small = evidence.fastest <= usual_rad_s && evidence.farthest <= usual_rad;
        const Family family = question_.columns.velocity ? v.family : q.family;
        if (family == Family::degrees && small) cost += costs.unusual_size;
        if (family == Family::radians && !small && reading.velocity.side == Shaft::joint)
            cost += costs.unusual_size;
        return cost;
    }

    const MotionQuestion& question_;
    std::optional<double> scale_;
    std::vector<MotionReading> found_;
};

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

// Of vectors of equal length, in seconds and file units; velocity or position may be empty. Rows with a
// not-a-number are left out.
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
        std::vector<MotionReading> fitting = Scoring(question, true).run();
        const bool fits = !fitting.empty() && !fitting.front().against_header;
        std::vector<MotionReading> readings = fits ? fitting : Scoring(question, false).run();
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
            say(possible, others(readings, never_meant), Scoring(question, false).run());
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
        std::vector<const MotionColumns*> joints;
        std::vector<std::size_t> columns;
        MotionsSeen::Opening& opening = seen_.openings[bytes];
        for (const MotionColumns& joint : joints_) {
            if (opening.of.count(joint.place()) > 0) continue;
            joints.push_back(&joint);
            for (const MotionColumn& column : joint.all()) columns.push_back(column.column);
        }
        if (joints.empty()) return opening;
        MotionSample rows = facts_.motion_sample(layout_, columns, bytes);
        opening.whole = rows.whole;
        const double factor = layout_.chosen.time   ? layout_.columns[*layout_.chosen.time].factor
                              : layout_.stated_rate ? 1.0 / layout_.stated_rate->value()
                                                    : 1.0;
        for (double& time : rows.time) time *= factor;
        auto values = rows.values.begin();
        for (const MotionColumns* joint : joints) {
            std::vector<double> velocity, position;
            if (joint->velocity) {
                const Column& column = layout_.columns[joint->velocity->column];
                velocity = std::move(*values++);
                for (double& value : velocity) value += column.shift / column.factor;
            }
            if (joint->position) position = std::move(*values++);
            opening.of[joint->place()] = motion_evidence(rows.time, velocity, position);
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
