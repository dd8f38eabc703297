// SPDX-License-Identifier: MIT
// Every way in which a joint's velocity and position could be written, and how much speaks against each.

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "log/columns/infer_motion.hpp"
#include "log/columns/units.hpp"
#include "ripplenotch/core/quantity.hpp"

namespace ripplenotch {

bool names_motor(const MotionColumn& column) {
    return column.named_motor || (column.convention != nullptr && column.convention->side == Shaft::motor);
}

namespace {

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

class Scoring {
  public:
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

}  // namespace

std::vector<MotionReading> motion_readings(const MotionQuestion& question, bool with_scale) {
    return Scoring(question, with_scale).run();
}

}  // namespace ripplenotch
