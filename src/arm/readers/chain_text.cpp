// SPDX-License-Identifier: MIT
// Denavit-Hartenberg tables, axis strings, and the bytes of any description.

#include "arm/readers/xml_tree.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "arm/chain/chain.hpp"
#include "ripplenotch/arm/chain.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/files.hpp"
#include "ripplenotch/core/number.hpp"
#include "ripplenotch/core/spec.hpp"

namespace ripplenotch {

namespace {

using Way = std::vector<std::size_t>;

// Follows each link to the base, and stops at links whose path is known: linear in the size of the tree.
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
    raise<UsageError>("arm: {} has more than one end ({}{}); state at which {} with tip={}{}", source,
                      fmt::join(names, ", "), ends.size() > names.size() ? ", ..." : "", what, names.front(),
                      before ? fmt::format(", or tip={}, before they part", tree.names[common.back()]) : "");
}

}  // namespace

std::vector<std::size_t> way_to_tip(const std::string& source, const LinkTree& tree,
                                    const std::optional<std::string>& tip, const char* what) {
    (void)depths(source, tree);  // refuses circles, in which the loops below would not end
    if (tip) {
        const auto found = std::find(tree.names.begin(), tree.names.end(), *tip);
        if (found != tree.names.end())
            return way_to(tree, static_cast<std::size_t>(found - tree.names.begin()));
        raise<UsageError>("arm: {} has no {} '{}'{}", source, what, *tip, did_you_mean(*tip, tree.names));
    }
    const Way ends = moving_ends(tree);
    if (ends.empty()) return {};
    if (ends.size() > 1) refuse(source, tree, ends, what);
    return way_to(tree, ends.front());
}

namespace {

constexpr std::size_t most_bytes = std::size_t{16} << 20;  // chosen, not derived
constexpr std::array<std::string_view, 5> known = {"a_m", "alpha_deg", "d_m", "theta_deg", "joint"};
constexpr std::size_t numeric = 4;  // d, a, alpha, theta

struct DhRow {
    double a_m, alpha_deg, d_m, theta_deg;
    std::string name;
};

std::string_view trimmed(std::string_view text) {
    constexpr std::string_view white = " \t\r\"";
    const std::size_t first = text.find_first_not_of(white);
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(white) - first + 1);
}

std::vector<std::string_view> cells_of(std::string_view line) {
    std::vector<std::string_view> cells;
    while (true) {
        const std::size_t comma = line.find(',');
        cells.push_back(trimmed(line.substr(0, comma)));
        if (comma == std::string_view::npos || cells.size() > known.size()) return cells;
        line.remove_prefix(comma + 1);
    }
}

class DhTable {
  public:
    DhTable(const std::string& source, std::string_view text) : source_(source) {
        for (std::size_t number = 1; !text.empty(); ++number) {
            const std::size_t end = std::min(text.find('\n'), text.size());
            const std::string_view line = trimmed(text.substr(0, end));
            text.remove_prefix(std::min(end + 1, text.size()));
            if (line.empty() || line.front() == '#') continue;
            places_.empty() ? read_header(number, cells_of(line)) : read_row(number, cells_of(line));
            if (rows.size() > max_chain_joints)
                raise<DataError>("{}:{}: more than {} joints", source_, number, max_chain_joints);
        }
        if (places_.empty()) raise<DataError>("{}: empty, expected the header {}", source_, header());
    }

    std::vector<DhRow> rows;

  private:
    static std::string header() { return "a_m,alpha_deg,d_m,theta_deg"; }

    void read_header(std::size_t number, const std::vector<std::string_view>& cells) {
        places_.assign(known.size(), cells.size());
        for (std::size_t c = 0; c < cells.size(); ++c) {
            const auto found = std::find(known.begin(), known.end(), cells[c]);
            if (found == known.end()) {
                raise<DataError>(
                    "{}:{}: read the column '{}', expected the header {} (and joint, if you like)", source_,
                    number, cells[c].substr(0, 40), header());
            }
            places_[static_cast<std::size_t>(found - known.begin())] = c;
        }
        for (std::size_t k = 0; k < numeric; ++k) {
            if (places_[k] == cells.size())
                raise<DataError>("{}:{}: the header has no {}, expected {}", source_, number, known[k],
                                 header());
        }
        columns_ = cells.size();
    }

    void read_row(std::size_t number, const std::vector<std::string_view>& cells) {
        if (cells.size() != columns_)
            raise<DataError>("{}:{}: {} cells, expected {}", source_, number, cells.size(), columns_);
        std::array<double, numeric> values{};
        for (std::size_t k = 0; k < numeric; ++k) {
            const auto value = parse_number(cells[places_[k]]);
            if (!value || !std::isfinite(*value)) {
                raise<DataError>("{}:{}: {} is '{}', expected a finite number", source_, number, known[k],
                                 cells[places_[k]].substr(0, 40));
            }
            values[k] = *value;
        }
        const std::size_t name = places_[numeric];
        rows.push_back(
            {values[0], values[1], values[2], values[3],
             name < cells.size() ? std::string(cells[name]) : fmt::format("j{}", rows.size() + 1)});
    }

    const std::string& source_;
    std::vector<std::size_t> places_;
    std::size_t columns_ = 0;
};

// Turn about the joint's axis by the offset and go along it; a link's frame lies there in both conventions,
// and then the next joint's is behind a and alpha.
ChainJoint dh_joint(const DhRow& row, const space::Frame& before) {
    const Vector3 along = space::outward(before.rotation, {0.0, 0.0, row.d_m});
    return {row.name, JointKind::revolute, space::operator+(before.origin_m, along),
            space::times(before.rotation, space::about({0, 0, 1}, row.theta_deg))};
}

space::Frame across(const DhRow& row) {
    return {{row.a_m, 0.0, 0.0}, space::about({1, 0, 0}, row.alpha_deg)};
}

}  // namespace

Chain chain_of_dh(const std::string& source, std::string_view text) {
    Chain chain{.source = source, .joints = {}};
    space::Frame before;
    for (const DhRow& row : DhTable(source, text).rows) {
        chain.joints.push_back(dh_joint(row, before));
        before = across(row);
    }
    settle_chain(chain);
    return chain;
}

Chain chain_of_mdh(const std::string& source, std::string_view text) {
    Chain chain{.source = source, .joints = {}};
    for (const DhRow& row : DhTable(source, text).rows) chain.joints.push_back(dh_joint(row, across(row)));
    settle_chain(chain);
    return chain;
}

Chain chain_of_axes(std::string_view word, double length_m) {
    constexpr std::string_view letters = "xyzXYZ";
    Chain chain{.source = fmt::format("axes {}", word.substr(0, 2 * max_chain_joints)), .joints = {}};
    chain.lengths_are_guessed = true;
    if (word.empty() || word.size() > max_chain_joints) {
        raise<UsageError>("arm: axes, word: {} letters, expected one a joint, at most {}", word.size(),
                          max_chain_joints);
    }
    for (const char letter : word) {
        const std::size_t place = letters.find(letter);
        if (place == std::string_view::npos) {
            raise<UsageError>(
                "arm: axes, word: '{}' in {} is none of x, y, z (the axis points that way when all positions "
                "are 0), X, Y, Z (the other way)",
                letter, word);
        }
        ChainJoint joint{fmt::format("j{}", chain.size() + 1)};
        joint.origin_m = {0.0, 0.0, chain.joints.empty() ? 0.0 : length_m};
        joint.axis = {};
        joint.axis[place % 3] = place < 3 ? 1.0 : -1.0;
        chain.joints.push_back(joint);
    }
    settle_chain(chain);
    return chain;
}

std::string read_chain_file(const std::string& path) {
    ByteSource file(path);
    std::string text;
    std::vector<char> piece(1 << 16);
    while (const std::size_t count = file.read(piece.data(), piece.size())) {
        text.append(piece.data(), count);
        if (text.size() > most_bytes)
            raise<DataError>("{}: larger than {} MB; this is no robot's description", path, most_bytes >> 20);
    }
    return text;
}

}  // namespace ripplenotch
