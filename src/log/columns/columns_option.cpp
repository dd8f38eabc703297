// SPDX-License-Identifier: MIT
// --columns: by place "time,velocity,torque" ("-" skips one), or by name "torque=tau_J" or number "torque=3".

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "log/columns/decide_layout.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {

std::string column_label(const std::vector<std::string>& names, std::size_t column) {
    if (names.empty() || names[column].empty()) return fmt::format("column {}", column + 1);
    return fmt::format("'{}' (column {})", names[column], column + 1);
}

namespace layout_detail {
namespace {

std::optional<Role> role_of(std::string_view word) {
    for (const Role role : {Role::time, Role::velocity, Role::torque, Role::position}) {
        if (role_name(role) == word) return role;
    }
    return std::nullopt;
}

std::size_t column_named(const std::string& source, const ColumnFacts& facts, const std::string& name) {
    std::vector<std::size_t> found;
    for (std::size_t c = 0; c < facts.names.size(); ++c) {
        if (facts.names[c] == name) found.push_back(c);
    }
    if (found.size() == 1) return found.front();
    if (found.size() > 1) {
        raise<DataError>(
            "{}: the name '{}' of --columns stands over columns {} and {}; give the number instead, as in "
            "torque={}",
            source, name, found[0] + 1, found[1] + 1, found[0] + 1);
    }
    std::string_view digits = name;
    if (digits.substr(0, 7) == "column ") digits.remove_prefix(7);
    if (const auto number = parse_number(digits);
        number && *number >= 1.0 && *number <= static_cast<double>(facts.columns) &&
        *number == static_cast<double>(static_cast<std::size_t>(*number))) {
        return static_cast<std::size_t>(*number) - 1;
    }
    raise<UsageError>("--columns: {} has no column '{}'; it has {}", source, name,
                      facts.names.empty() ? fmt::format("{} columns without names", facts.columns)
                                          : fmt::format("{}", fmt::join(facts.names, ", ")));
}

}  // namespace

std::optional<std::size_t> Forced::column_of(Role role) const {
    const auto at = std::find(roles.begin(), roles.end(), std::optional<Role>(role));
    if (at == roles.end()) return std::nullopt;
    return static_cast<std::size_t>(at - roles.begin());
}

Forced read_columns_option(const std::string& source, const ColumnFacts& facts, const ReadOptions& options) {
    Forced forced;
    forced.roles.resize(facts.columns);
    std::size_t place = 0;
    for (const std::string& entry : options.columns) {
        const std::size_t equals = entry.find('=');
        const std::string word = entry.substr(0, equals);
        const auto role = role_of(word);
        if (!role && !(equals == std::string::npos && word == "-")) {
            raise<UsageError>(
                "--columns: '{}' is none of time, velocity, torque, position, or - to skip a column", word);
        }
        if (role && forced.column_of(*role)) raise<UsageError>("--columns: '{}' is given twice", word);
        if (equals != std::string::npos) {
            forced.roles[column_named(source, facts, entry.substr(equals + 1))] = role;
            continue;
        }
        forced.by_place = true;
        if (place >= facts.columns) {
            raise<UsageError>("--columns: names {} columns, {} has {}", options.columns.size(), source,
                              facts.columns);
        }
        forced.roles[place++] = role ? *role : Role::other;
    }
    if (forced.by_place) {
        for (auto& role : forced.roles) {
            if (!role) role = Role::other;
        }
    }
    return forced;
}

}  // namespace layout_detail
}  // namespace ripplenotch
