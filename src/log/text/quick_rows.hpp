// SPDX-License-Identifier: MIT
#pragma once
// Rows of a text log into numbers, one by one or many at once.

#include <cstddef>
#include <functional>
#include <optional>
#include <string_view>
#include <vector>

#include "log/clock/stamp.hpp"
#include "log/text/text_cells.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/log/format.hpp"

namespace ripplenotch {

// Internal to the log room: which number of a row goes where.

/// Where a row's numbers go: time first, then velocity, torque and position of each joint.
enum RowSlot : std::size_t { time_slot, velocity_slot, torque_slot, position_slot };  // of the first joint
inline constexpr std::size_t slots_a_joint = 3;
constexpr std::size_t slot_of(RowSlot of_first, std::size_t joint) {
    return of_first == time_slot ? time_slot : of_first + slots_a_joint * joint;
}
constexpr std::size_t joint_of(std::size_t slot) { return (slot - velocity_slot) / slots_a_joint; }
constexpr bool is_torque(std::size_t slot) { return slot % slots_a_joint == torque_slot; }
constexpr bool is_position(std::size_t slot) {
    return slot != time_slot && slot % slots_a_joint == position_slot % slots_a_joint;
}
constexpr std::size_t slot_count(std::size_t joints) { return 1 + slots_a_joint * joints; }

/// One wanted column: its place in the row and where its number goes.
struct WantedColumn {
    std::size_t column = 0;
    std::size_t slot = 0;
    bool fraction = false;  ///< nanoseconds, to be added to the seconds of another column
};

/// Where a slot's numbers are kept.
inline std::vector<double>& numbers_of(RowBlock& block, std::size_t slot) {
    if (slot == time_slot) return block.time_s;
    JointRows& joint = block.joints[joint_of(slot)];
    const std::size_t of_first = slot - slots_a_joint * joint_of(slot);
    return of_first == velocity_slot ? joint.velocity_deg_s
           : of_first == torque_slot ? joint.torque_nm
                                     : joint.position_deg;
}

inline constexpr double seconds_per_nanosecond = 1e-9;

/// Those that tell a row's time; none where a rate was stated.
[[nodiscard]] std::vector<WantedColumn> time_columns(const Layout& layout);
/// Every column that is wanted of a layout, with its slot, in the order of the slots.
[[nodiscard]] std::vector<WantedColumn> wanted_columns(const Layout& layout);
[[nodiscard]] StampRule stamp_rule(const Layout& layout, char decimal_mark);
/// What the numbers of each slot are multiplied with to be in the tool's units.
[[nodiscard]] std::vector<double> slot_factors(const Layout& layout, const std::vector<WantedColumn>& wanted);

/// The numbers of a row and the places of the torque cells.
struct ParsedRow {
    struct Place {
        const char* begin = nullptr;
        const char* end = nullptr;
    };
    explicit ParsedRow(std::size_t joints = 1) : values(slot_count(joints), not_a_number), torques(joints) {}

    std::vector<double> values;         ///< by slot; not a number where no column is wanted
    std::vector<Place> torques;         ///< by joint; null without a torque column
    const char* content_end = nullptr;  ///< just past the last cell
};

/// What a time that comes in parts begins with: a time of -0 stays one.
constexpr double nothing_yet = -0.0;

/// What rows look like and where their numbers go.
struct RowPlan {
    CellRules rules;
    std::size_t columns = 0;
    std::vector<WantedColumn> wanted;
    std::vector<double> factors =
        std::vector<double>(slot_count(1), 1.0);  ///< into the tool's units, by slot

    StampRule stamp = {};

    [[nodiscard]] std::size_t joints() const { return factors.size() / slots_a_joint; }

    [[nodiscard]] std::optional<std::size_t> column_of(std::size_t slot) const {
        for (const WantedColumn& one : wanted) {
            if (one.slot == slot) return one.column;
        }
        return std::nullopt;
    }
    /// Positions that the log has not leave their vector empty; other numbers are then not a number.
    [[nodiscard]] bool stores(std::size_t slot) const {
        return !is_position(slot) || column_of(slot).has_value();
    }
};

/// While it lives, parsers that are made take every row the careful way: a test holds the quick ways to it.
class CarefulRows {
  public:
    CarefulRows() noexcept;
    ~CarefulRows();
    CarefulRows(const CarefulRows&) = delete;
    CarefulRows& operator=(const CarefulRows&) = delete;

  private:
    bool before_;
};

/// Rows of text into numbers. The quick ways accept only what is certainly well formed; whatever else is left
/// to the careful way, which also finds the words for what is wrong.
class RowParser {
  public:
    explicit RowParser(RowPlan plan);

    /// With the columns that are wanted in the order of the file.
    [[nodiscard]] const RowPlan& plan() const { return plan_; }

    /// Many at once: appends the rows of block.bytes from offset `begin` to the block, as long as each is
    /// certainly well formed and its time not before the one above it (`time_before`, in the file's unit).
    /// Returns where it stopped: the beginning of a line, or the end. The numbers are those of parse(), bit
    /// for bit.
    std::size_t read(RowBlock& block, std::size_t begin, double time_before) const;

    /// One line. True when every wanted cell held a plain finite number and the row has the right number of
    /// cells, without quotes. `row` has room for the slots that are wanted.
    [[nodiscard]] bool parse(std::string_view line, ParsedRow& row) const;

    /// What stands for the number of a cell that holds none, or one that is no reading; may throw.
    using Other = std::function<std::optional<double>(const Cell& cell, const WantedColumn& wanted,
                                                      std::optional<double> number)>;
    /// The careful way, of a line that is cut into as many cells as a row has; false where `other` gives
    /// none.
    [[nodiscard]] bool parse_cells(std::string_view line, const CellSplit& split, ParsedRow& row,
                                   const Other& other) const;
    /// The quick way, else the careful one; false where the line has not as many cells as a row, too.
    [[nodiscard]] bool parse_any(std::string_view line, ParsedRow& row, CellSplit& split,
                                 const Other& other) const;

  private:
    [[nodiscard]] std::optional<CellNumber> number(std::string_view text, const WantedColumn& wanted) const;
    [[nodiscard]] bool in_parts(const WantedColumn& wanted) const {
        return plan_.stamp.careful && wanted.slot == time_slot;
    }
    std::size_t read_by_lines(RowBlock& block, std::size_t begin, double time_before) const;

    RowPlan plan_;
    bool careful_, vectorised_;
};

}  // namespace ripplenotch
