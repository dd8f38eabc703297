// SPDX-License-Identifier: MIT
#pragma once
// Units and sides of velocity and position where the log does not state them: from names, from how far the
// position goes in the time of the velocity, and from what a joint can do. The one place that decides.

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "log/columns/column_name.hpp"
#include "log/columns/decide_layout.hpp"
#include "ripplenotch/log/layout.hpp"

namespace ripplenotch {

// What the values of a joint's motion say about their units, as they stand in the file.

struct MotionEvidence {
    /// Change of position over velocity times time, in the file's units, magnitude; empty where there is no
    /// position, too little motion, or no agreement between the two.
    std::optional<double> scale;
    std::optional<double> wrap;  ///< the position starts again after so much
    double fastest = 0.0;        ///< largest magnitude of the velocity; without one, of the position's slope
    double farthest = 0.0;       ///< largest magnitude of the position
    bool velocity_counts = false, position_counts = false;  ///< they are whole numbers throughout
};

/// What is known of a velocity or position column before its values are looked at.
struct MotionColumn {
    Role role = Role::velocity;
    std::size_t column = 0;
    bool unit_is_stated = false;
    bool named_motor = false;
    const Convention* convention = nullptr;
    std::optional<Shaft> stated_side;
};

/// The columns of a velocity and a position.
using MotionPlace = std::pair<std::optional<std::size_t>, std::optional<std::size_t>>;

/// The motion of one joint; one of the two may be missing.
struct MotionColumns {
    std::string joint;
    std::optional<MotionColumn> velocity, position;
    bool chosen = false;
    /// Those that there are.
    [[nodiscard]] std::vector<MotionColumn> all() const {
        std::vector<MotionColumn> found;
        for (const auto& column : {velocity, position})
            if (column) found.push_back(*column);
        return found;
    }
    [[nodiscard]] MotionPlace place() const {
        const auto column = [](const auto& one) { return one ? std::optional(one->column) : std::nullopt; };
        return {column(velocity), column(position)};
    }
    /// That which tells the speed: the velocity, where there is one.
    [[nodiscard]] const MotionColumn& of_speed() const { return velocity ? *velocity : *position; }
};

/// The motions of the joints that are read, and of the file's others whose columns nobody has to choose
/// between.
[[nodiscard]] std::vector<MotionColumns> motions_of(const KnownColumns& known,
                                                    const std::vector<JointGroup>& groups,
                                                    const std::vector<bool>& unit_is_stated,
                                                    const ReadOptions& options, const Layout& layout);

/// What was found out of motions, by the bytes of the opening that were looked at: the same joints are asked
/// for again where each is read alone.
struct MotionsSeen {
    struct Opening {
        std::map<MotionPlace, MotionEvidence> of;
        bool whole = false;  ///< as MotionSample::whole
    };
    std::map<std::size_t, Opening> openings;
};

/// Sets unit, factor and side of the velocity and position columns of all `joints` alike, and says in
/// `layout` what was inferred, what stays assumed, and which other readings are as possible.
void infer_motion(const ColumnFacts& facts, const ReadOptions& options,
                  const std::vector<MotionColumns>& joints, MotionsSeen& seen, Layout& layout);

}  // namespace ripplenotch
