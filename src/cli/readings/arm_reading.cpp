// SPDX-License-Identifier: MIT
#include "cli/readings/arm_reading.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <utility>

#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/spec.hpp"

namespace ripplenotch {
namespace {

std::string lower_case(std::string text) {
    for (char& letter : text) letter = static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
    return text;
}

}  // namespace

ArmLog ArmReading::view() const {
    ArmLog arm;
    for (const Log& log : logs) {
        arm.joints.push_back(log.trace.view());
        arm.has_torque.push_back(log.layout.chosen.torque.has_value());
    }
    return arm;
}

std::size_t ArmReading::find(const Chain& chain, const std::string& joint) const {
    for (std::size_t j = 0; j < names.size(); ++j)
        if (lower_case(names[j]) == lower_case(joint)) return j;
    std::vector<std::string> known;
    for (std::size_t j = 0; j < chain.size(); ++j) {
        known.push_back(chain.joints[j].name);
        if (lower_case(known.back()) == lower_case(joint)) return j;
    }
    const auto near = nearest_name(joint, known);
    raise<UsageError>("arm: '{}' is no joint of {}; {}{}", joint, chain.source, joint_list(chain),
                      near ? fmt::format("; did you mean {}?", *near) : "");
}

ArmReading read_arm(const std::string& path, const ReadOptions& options, std::size_t most_rows,
                    const Chain& chain, const StatedJoints& stated) {
    ReadOptions motion = options;
    motion.torque_of_each = false;
    std::vector<Log> all = read_joints_at_once_in_part(path, motion, most_rows);
    std::vector<std::string> there;
    for (const Log& log : all) there.push_back(log.trace.joint);
    const std::string source = all.front().layout.source;
    ArmReading reading{{}, match_joints(chain, there, stated, source), {}};
    for (const std::size_t place : reading.match.of) {
        if (!all[place].trace.view().has_position()) {
            raise<UsageError>(
                "arm: {} has the velocity of '{}' and not its position; gravity depends on it and its "
                "integral "
                "does not tell from where",
                source, there[place]);
        }
        reading.names.push_back(there[place]);
        reading.logs.push_back(std::move(all[place]));
    }
    return reading;
}

}  // namespace ripplenotch
