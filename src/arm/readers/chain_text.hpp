// SPDX-License-Identifier: MIT
#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace ripplenotch {

// A robot's description is a tree of links; a chain is one way through it, from the base to a tip.

/// A tree as parents; each link has one way to the base.
struct LinkTree {
    std::vector<std::string> names;                  ///< names of the links
    std::vector<std::optional<std::size_t>> parent;  ///< link before it; none for a base
    std::vector<bool> moves;                         ///< against its parent
};

/// The links from the base to the requested tip, or to the only end behind which nothing moves.
/// Throws DataError where links go round in a circle, and UsageError where there are several ends, or no link
/// with that name; `what` is "link" or "body".
[[nodiscard]] std::vector<std::size_t> way_to_tip(const std::string& source, const LinkTree& tree,
                                                  const std::optional<std::string>& tip, const char* what);

}  // namespace ripplenotch
