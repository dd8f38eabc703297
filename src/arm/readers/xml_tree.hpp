// SPDX-License-Identifier: MIT
#pragma once
// A small XML document as a tree: elements, attributes and the lines they stand on. What else XML has
// (entities of its own, types, text) does not count here. The library behind it stays in the .cpp.

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

}  // namespace ripplenotch
