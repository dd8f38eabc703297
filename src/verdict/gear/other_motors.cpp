// SPDX-License-Identifier: MIT
#include "ripplenotch/verdict/other_motors.hpp"

#include <stdio.h>
#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/files/byte_sink.hpp"
#include "ripplenotch/analysis/identification.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/gear_account.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/visible_text.hpp"
#include "ripplenotch/filter/map_fit.hpp"
#include "ripplenotch/filter/method.hpp"
#include "ripplenotch/verdict/readings.hpp"

namespace ripplenotch {

namespace {

bool same_rows(const Log& one, const Log& other) {
    return one.trace.time_s == other.trace.time_s && one.trace.run_starts == other.trace.run_starts;
}

// A line n (Kg + 1) of the second comb is at n (1 + 1 / Kg) turns of the motor: a map has both combs of n.
std::vector<Order> orders_of(const std::vector<Line>& lines, double ratio) {
    constexpr double a_tooth_and_a_half = 1.5;  // between a tooth of the second comb and no tooth
    std::vector<Order> found;
    for (const Line& line : lines) {
        if (!line.order_output) continue;
        const double order = *line.order_output / ratio, whole = std::round(order);
        const bool on_comb = whole > 0.0 && std::abs(order - whole) * ratio <= a_tooth_and_a_half * whole;
        found.emplace_back(on_comb ? whole : order);
    }
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
}

}  // namespace

std::optional<GearAccount> gear_of_motor(const Identification& found, const StatedMotors& stated) {
    const GearRatioFit& fit = found.gear_ratio;
    GearAccount gear{GearRatio(0.0), stated.orders, {}, {}, "identified in its own torque"};
    const bool agrees =
        stated.ratio &&
        (!fit.value || (fit.ci95_low <= stated.ratio->value() && stated.ratio->value() <= fit.ci95_high));
    // Where 50 and 100 are both possible the lines are the same, and the angle of either map.
    if (agrees) {
        gear.ratio = *stated.ratio;
        gear.source = "--gear-ratio";
    } else if (fit.value) {
        gear.ratio = GearRatio(*fit.value);
    } else if (found.doubts.empty() && !fit.candidates.empty()) {
        gear.ratio = GearRatio(fit.candidates.front().value);
        gear.source = "the most probable ratio in its own torque";
    } else {
        return std::nullopt;
    }
    if (gear.orders.empty()) gear.orders = orders_of(found.lines, gear.ratio.value());
    if (gear.orders.empty()) gear.orders = default_orders();
    return gear;
}

std::vector<JointLogs> read_arm(std::span<const std::string> paths, const Layout& layout,
                                const ReadOptions& options, std::size_t most_rows) {
    std::vector<JointLogs> joints;
    if (layout.joints.size() < 2) return joints;
    for (std::size_t l = 0; l < paths.size(); ++l) {
        std::vector<Log> all;
        try {
            all = read_joints_at_once(paths[l], options, most_rows);
        } catch (const Error&) {
            return {};  // the joint that is looked at could be read, and its answer does not need the others
        }
        for (Log& log : all) {
            if (!log.trace.view().has_position()) continue;
            const auto same = std::find_if(joints.begin(), joints.end(), [&](const JointLogs& one) {
                return one.joint == log.trace.joint;
            });
            if (same != joints.end())
                same->logs.push_back(std::move(log));
            else if (l == 0)
                joints.push_back({log.trace.joint, {std::move(log)}});
        }
    }
    std::erase_if(joints, [&](const JointLogs& one) { return one.logs.size() != paths.size(); });
    return joints;
}

OtherMotors motors_of(std::span<const JointLogs> arm, std::span<const Log> own, const GearOfJoint& gear_of) {
    OtherMotors others;
    for (const JointLogs& joint : arm) {
        if (joint.joint == own.front().trace.joint || joint.logs.size() != own.size() ||
            !std::equal(own.begin(), own.end(), joint.logs.begin(), same_rows))
            continue;
        ++others.looked_at;
        const std::optional<GearAccount> gear = gear_of(joint);
        if (!gear) {
            others.not_known.push_back(joint.joint);
            continue;
        }
        OtherMotor& motor = others.motors.emplace_back(OtherMotor{joint.joint, *gear, {}});
        for (const Log& log : joint.logs) motor.motion.push_back(log.trace.view());
    }
    return others;
}

namespace {

std::string names_of(std::span<const RippleMap> maps) {
    return joined(maps, ",", [](const RippleMap& map) { return map.joint; });
}

void require_joints(std::span<const RippleMap> maps, const Spool& log, ReadOptions options) {
    options.joint.reset();
    options.check_joint = {};
    const std::vector<std::string> names = asked_joints(log, options).names;
    for (const RippleMap& map : maps)
        if (std::find(names.begin(), names.end(), map.joint) == names.end())
            raise<DataError>(
                "{}: the map also holds ripple of the motor of {}, and the log has no joint of that name",
                log.open()->name(), map.joint);
}

// Each joint by its own gear, where it is measured before the gear.
ReadOptions reading_of(std::span<const RippleMap> maps, const ReadOptions& options) {
    ReadOptions read = options;
    read.joint = names_of(maps);
    read.every_joint = true;
    read.torque_of_each = false;
    read.needs_torque = false;
    read.check_joint = {};
    read.gear_ratio_of = [maps](const std::string& joint) -> std::optional<double> {
        for (const RippleMap& map : maps)
            if (map.joint == joint && map.gear_ratio != no_ratio) return map.gear_ratio.value();
        return std::nullopt;
    };
    return read;
}

/// Takes what the filters of the joints make of each row.
class SumOfJoints final : public LogWriter {
  public:
    explicit SumOfJoints(std::FILE* file) : file_(file) {}
    void put(const RowBlock& block, Torques ripple_nm, std::string_view /*bytes*/) override {
        sum_.assign(block.size(), 0.0);
        for (const std::vector<double>& one : ripple_nm)
            for (std::size_t k = 0; k < sum_.size(); ++k) sum_[k] += one[k];
        if (std::fwrite(sum_.data(), sizeof(double), sum_.size(), file_) != sum_.size())
            raise<FileError>("the temporary file of the other joints' ripple: {}", std::strerror(errno));
    }
    void finish() override {}

  private:
    std::FILE* file_;
    std::vector<double> sum_;
};

}  // namespace

OtherRipple::OtherRipple(std::span<const RippleMap> maps, const Spool& log, const ReadOptions& options)
    : file_(
          ::fdopen(
              TemporaryFile(temporary_folder() + "/ripplenotch-ripple", std::nullopt).release_without_name(),
              "w+b"),
          &std::fclose) {
    if (file_ == nullptr)
        raise<FileError>("cannot make a temporary file for the other joints' ripple: {}",
                         std::strerror(errno));
    require_joints(maps, log, options);
    LogStream stream(open_log(log.open(), reading_of(maps, options)));
    std::vector<std::unique_ptr<CausalFilter>> filters;
    std::vector<JointRun> runs;
    for (const JointColumns& joint : stream.reader().layout().all_chosen()) {
        const auto map = std::find_if(maps.begin(), maps.end(),
                                      [&](const RippleMap& one) { return one.joint == joint.joint; });
        filters.push_back(map_prediction(*map, stream.design_rate()));
        runs.push_back({filters.back().get()});
    }
    if (runs.size() != maps.size())
        raise<DataError>(
            "{}: the map also holds ripple of the motors of {}, and not all of them have a motion",
            stream.reader().layout().source, names_of(maps));
    SumOfJoints sum(file_.get());
    static_cast<void>(stream.run(runs, &sum));
    std::rewind(file_.get());
}

std::span<const double> OtherRipple::next(std::size_t count) {
    values_.resize(count);
    if (std::fread(values_.data(), sizeof(double), count, file_.get()) != count)
        raise<DataError>(
            "the log has grown since its other joints were read; read a copy that nobody writes to");
    return values_;
}

}  // namespace ripplenotch
