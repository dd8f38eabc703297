// SPDX-License-Identifier: MIT
#include "arm/readers/xml_tree.hpp"

#include <algorithm>
#include <cmath>
#include <pugixml.hpp>

#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {
namespace {

constexpr std::size_t deepest = 100, max_elements = 200'000;  // chosen, not derived: docs/reliability.md

class Lines {
  public:
    explicit Lines(std::string_view text) : text_(text) {}
    // Offsets are requested in the order of the document.
    std::size_t of(std::ptrdiff_t offset) {
        const auto end =
            std::clamp<std::size_t>(offset < 0 ? 0 : static_cast<std::size_t>(offset), at_, text_.size());
        line_ += static_cast<std::size_t>(std::count(text_.begin() + static_cast<std::ptrdiff_t>(at_),
                                                     text_.begin() + static_cast<std::ptrdiff_t>(end), '\n'));
        at_ = end;
        return line_;
    }
    [[nodiscard]] std::size_t column() const {
        return at_ - (at_ == 0 ? 0 : text_.rfind('\n', at_ - 1) + 1) + 1;
    }

  private:
    std::string_view text_;
    std::size_t at_ = 0, line_ = 1;
};

class Tree {
  public:
    Tree(const std::string& source, std::string_view text) : source_(source), lines_(text) {}

    XmlElement of(const pugi::xml_node& node, std::size_t depth) {
        XmlElement element{node.name(), lines_.of(node.offset_debug()), {}, {}};
        if (depth > deepest || ++count_ > max_elements) {
            raise<DataError>("{}:{}: more than {}; this is no robot's description", source_, element.line,
                             depth > deepest ? fmt::format("{} elements within one another", deepest)
                                             : fmt::format("{} elements", max_elements));
        }
        for (const pugi::xml_attribute& attribute : node.attributes())
            element.attributes.emplace_back(attribute.name(), attribute.value());
        for (const pugi::xml_node& child : node.children()) {
            if (child.type() == pugi::node_element) element.children.push_back(of(child, depth + 1));
        }
        return element;
    }

  private:
    const std::string& source_;
    Lines lines_;
    std::size_t count_ = 0;
};

}  // namespace

std::optional<std::string> XmlElement::attribute(std::string_view wanted) const {
    for (const auto& [name_there, value] : attributes) {
        if (name_there == wanted) return value;
    }
    return std::nullopt;
}

const XmlElement* XmlElement::child(std::string_view wanted) const {
    const auto found = std::find_if(children.begin(), children.end(),
                                    [&](const XmlElement& each) { return each.name == wanted; });
    return found == children.end() ? nullptr : &*found;
}

XmlElement parse_xml(const std::string& source, std::string_view text) {
    pugi::xml_document document;
    const pugi::xml_parse_result result =
        document.load_buffer(text.data(), text.size(), pugi::parse_default, pugi::encoding_utf8);
    if (!result) {
        Lines lines(text);
        const std::size_t line = lines.of(result.offset);
        raise<DataError>("{}:{}:{}: no XML: {}", source, line, lines.column(), result.description());
    }
    return Tree(source, text).of(document.document_element(), 1);
}

std::optional<std::vector<double>> numbers_of(const std::string& source, const XmlElement& element,
                                              std::string_view attribute, std::size_t count,
                                              std::size_t fewest) {
    const auto text = element.attribute(attribute);
    if (!text) return std::nullopt;
    std::vector<double> numbers;
    bool good = true;
    for (std::size_t at = 0; good;) {
        constexpr const char* white = " \t\r\n";
        at = text->find_first_not_of(white, at);
        if (at == std::string::npos) break;
        const std::size_t end = std::min(text->find_first_of(white, at), text->size());
        const auto number = parse_number(std::string_view(*text).substr(at, end - at));
        good = number && std::isfinite(*number) && numbers.size() < count;
        numbers.push_back(number.value_or(0.0));
        at = end;
    }
    if (good && numbers.size() <= count && numbers.size() >= (fewest == 0 ? count : fewest)) return numbers;
    raise<DataError>("{}:{}: {} {}=\"{}\", expected {} finite number{}", source, element.line, element.name,
                     attribute, text->substr(0, 80), count, count == 1 ? "" : "s");
}

Vector3 vector_of(const std::string& source, const XmlElement& element, std::string_view attribute,
                  const Vector3& otherwise) {
    const auto numbers = numbers_of(source, element, attribute, 3);
    return numbers ? Vector3{(*numbers)[0], (*numbers)[1], (*numbers)[2]} : otherwise;
}

std::string name_of(const std::string& source, const XmlElement& element, std::string_view attribute) {
    auto text = element.attribute(attribute);
    if (!text || text->empty())
        raise<DataError>("{}:{}: {} without {}", source, element.line, element.name, attribute);
    return *std::move(text);
}

}  // namespace ripplenotch
