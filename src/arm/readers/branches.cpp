// SPDX-License-Identifier: MIT
#include "arm/readers/branches.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/spec.hpp"

namespace ripplenotch {
namespace {

using Way = std::vector<std::size_t>;

// Walks to the base once per link, and stops at links whose way is known: linear in the size of the tree.
std::vector<std::size_t> depths(const std::string& source, const LinkTree& tree) {
    constexpr std::size_t unknown = 0, walking = static_cast<std::size_t>(-1);  // no depth
    std::vector<std::size_t> depth(tree.names.size(), unknown);
    for (std::size_t start = 0; start < depth.size(); ++start) {
        Way walked;
        std::optional<std::size_t> link = start;
        while (link && depth[*link] == unknown) {
            depth[*link] = walking;
            walked.push_back(*link);
            link = tree.parent[*link];
        }
        if (link && depth[*link] == walking)
            raise<DataError>("{}: the way from '{}' to the base goes round in a circle", source,
                             tree.names[*link]);
        std::size_t above = link ? depth[*link] : 0;
        for (auto each = walked.rbegin(); each != walked.rend(); ++each) depth[*each] = ++above;
    }
    return depth;
}

Way way_to(const LinkTree& tree, std::size_t tip) {
    Way way;
    for (std::optional<std::size_t> link = tip; link; link = tree.parent[*link]) way.push_back(*link);
    std::reverse(way.begin(), way.end());
    return way;
}

// The last moving link on the way from the base, the link itself included.
std::optional<std::size_t> last_moving(const LinkTree& tree, std::optional<std::size_t> link) {
    while (link && !tree.moves[*link]) link = tree.parent[*link];
    return link;
}

// Moving links behind which nothing moves.
Way moving_ends(const LinkTree& tree) {
    std::vector<bool> goes_on(tree.names.size());
    for (std::size_t link = 0; link < tree.names.size(); ++link) {
        if (!tree.moves[link]) continue;
        if (const auto before = last_moving(tree, tree.parent[link])) goes_on[*before] = true;
    }
    Way ends;
    for (std::size_t link = 0; link < tree.names.size(); ++link)
        if (tree.moves[link] && !goes_on[link]) ends.push_back(link);
    return ends;
}

[[noreturn]] void refuse(const std::string& source, const LinkTree& tree, const Way& ends, const char* what) {
    std::vector<std::string> names;
    for (const std::size_t end : ends) {
        if (names.size() < 8) names.push_back(tree.names[end]);
    }
    Way common = way_to(tree, ends.front());
    for (const std::size_t end : ends) {
        const Way other = way_to(tree, end);
        const auto [mine, theirs] = std::mismatch(common.begin(), common.end(), other.begin(), other.end());
        common.erase(mine, common.end());
    }
    const bool before = !common.empty() && last_moving(tree, common.back());
    raise<UsageError>("arm: {} has more than one end ({}{}); say at which {} with tip={}{}", source,
                      fmt::join(names, ", "), ends.size() > names.size() ? ", ..." : "", what, names.front(),
                      before ? fmt::format(", or tip={}, before they part", tree.names[common.back()]) : "");
}

}  // namespace

std::vector<std::size_t> way_to_tip(const std::string& source, const LinkTree& tree,
                                    const std::optional<std::string>& tip, const char* what) {
    (void)depths(source, tree);  // refuses circles, in which the walks below would not end
    if (tip) {
        const auto found = std::find(tree.names.begin(), tree.names.end(), *tip);
        if (found != tree.names.end())
            return way_to(tree, static_cast<std::size_t>(found - tree.names.begin()));
        const auto near = nearest_name(*tip, tree.names);
        raise<UsageError>("arm: {} has no {} '{}'{}", source, what, *tip,
                          near ? fmt::format("; did you mean {}?", *near) : "");
    }
    const Way ends = moving_ends(tree);
    if (ends.empty()) return {};
    if (ends.size() > 1) refuse(source, tree, ends, what);
    return way_to(tree, ends.front());
}

}  // namespace ripplenotch
