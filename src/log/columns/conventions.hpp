// SPDX-License-Identifier: MIT
#pragma once
// Units and sides that the names of known loggers imply, from one list (conventions.def).

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ripplenotch/log/layout.hpp"

namespace ripplenotch {

struct Convention {
    std::string_view family;  ///< who writes such names: "libfranka"
    std::string_view beside;  ///< a name that another column of the log has to have; may be empty
    std::string_view name;    ///< as conventions.def explains
    Role role = Role::other;
    std::string_view unit;
    Shaft side = Shaft::joint;
    std::string_view source;  ///< where it is written down
};

[[nodiscard]] std::span<const Convention> conventions();

/// The first convention that `name` follows as a column of this role, in a log with all these `names`; null
/// when there is none. With Role::other: in whatever role.
[[nodiscard]] const Convention* convention_of(std::string_view name, Role role,
                                              const std::vector<std::string>& names);

}  // namespace ripplenotch
