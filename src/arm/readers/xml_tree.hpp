// SPDX-License-Identifier: MIT
#pragma once
// A small XML document as a tree: elements, attributes and the lines they stand on. What else XML has
// (entities of its own, types, text) does not count here. The library behind it stays in the .cpp.

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "ripplenotch/arm/chain.hpp"

namespace ripplenotch {

struct XmlElement {
    std::string name;
    std::size_t line = 0;
    std::vector<std::pair<std::string, std::string>> attributes;
    std::vector<XmlElement> children;

    /// Empty where it is not there.
    [[nodiscard]] std::optional<std::string> attribute(std::string_view wanted) const;
    [[nodiscard]] const XmlElement* child(std::string_view wanted) const;
};

/// The root element. Throws DataError: no XML, with file, line and column; deeper than 100 elements within
/// one another; more than 200,000 of them.
[[nodiscard]] XmlElement parse_xml(const std::string& source, std::string_view text);

/// The numbers of an attribute; empty where it is not there. Throws DataError where they are not `count`
/// finite numbers (`fewest` of them may do).
[[nodiscard]] std::optional<std::vector<double>> numbers_of(const std::string& source,
                                                            const XmlElement& element,
                                                            std::string_view attribute, std::size_t count,
                                                            std::size_t fewest = 0);
/// Three of them, or `otherwise` where the attribute is missing.
[[nodiscard]] Vector3 vector_of(const std::string& source, const XmlElement& element,
                                std::string_view attribute, const Vector3& otherwise);
/// Throws DataError where the attribute is missing or empty.
[[nodiscard]] std::string name_of(const std::string& source, const XmlElement& element,
                                  std::string_view attribute);

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
