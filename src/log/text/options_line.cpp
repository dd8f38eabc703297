// SPDX-License-Identifier: MIT
// The option line that would force a reading, ready to paste: what was decided, in the words the user would
// have used.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "log/columns/decide_layout.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch::layout_detail {
namespace {

// A name that --columns can carry, else the column's number.
std::string handle(const ColumnFacts& facts, std::size_t column) {
    if (facts.names.empty() || facts.names[column].empty()) return std::to_string(column + 1);
    const std::string& name = facts.names[column];
    const bool awkward = name.find_first_of(",=") != std::string::npos ||
                         std::count(facts.names.begin(), facts.names.end(), name) > 1;
    return awkward ? std::to_string(column + 1) : name;
}

std::string quoted(const std::string& word) {
    if (word.find_first_of(" \t;'\"()[]*&|<>$#") == std::string::npos) return word;
    std::string out = "'";
    for (const char c : word) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return out + "'";
}

}  // namespace

std::string options_line(const Layout& layout, const ColumnFacts& facts, const ReadOptions& options) {
    std::vector<std::string> words = {"--format " + layout.format};
    if (!facts.dialect_options.empty()) words.push_back(facts.dialect_options);
    std::vector<std::string> columns, units;
    for (const auto& column :
         {layout.chosen.time, layout.chosen.velocity, layout.chosen.torque, layout.chosen.position}) {
        if (!column) continue;
        const Column& c = layout.columns[*column];
        columns.push_back(fmt::format("{}={}", role_name(c.role), handle(facts, *column)));
        units.push_back("--unit " + quoted(fmt::format("{}={}", role_name(c.role), c.unit)));
    }
    std::vector<std::string> sides;
    for (const auto& column : {layout.chosen.velocity, layout.chosen.position}) {
        if (column && layout.columns[*column].side == Shaft::motor)
            sides.push_back(fmt::format("{}=motor", role_name(layout.columns[*column].role)));
    }
    if (!columns.empty()) words.push_back("--columns " + quoted(fmt::format("{}", fmt::join(columns, ","))));
    words.insert(words.end(), units.begin(), units.end());
    if (!sides.empty()) words.push_back(fmt::format("--side {}", fmt::join(sides, ",")));
    if (!layout.chosen.joint.empty()) words.push_back("--joint " + quoted(layout.chosen.joint));
    if (layout.stated_rate) words.push_back("--sample-rate " + shortest(layout.stated_rate->value()) + "Hz");
    if (options.constant_speed)
        words.push_back("--constant-speed " + shortest(options.constant_speed->value()) + "deg/s");
    if (options.nm_per_ampere) words.push_back("--kt " + shortest(*options.nm_per_ampere));
    if (options.skip_lines > 0) words.push_back(fmt::format("--skip-lines {}", options.skip_lines));
    if (options.hold_bad_values) words.push_back("--hold-bad-values");
    return fmt::format("{}", fmt::join(words, " "));
}

}  // namespace ripplenotch::layout_detail
