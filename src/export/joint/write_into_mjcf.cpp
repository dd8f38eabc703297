// SPDX-License-Identifier: MIT
// Writes a joint's friction and motors into an existing MuJoCo file, whose text otherwise stays as it is.
#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "export/joint/joint_mjcf.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {
namespace {

// MuJoCo's step turns over where the speed is the acceleration times half of this time (s): five times sooner
// than by default, and still slower than two steps of 2 ms, which MuJoCo requires.
constexpr std::string_view quick_step = "0.004 1";

struct XmlAttribute {
    std::string_view name, value;
    std::size_t from = 0, to = 0;  ///< range of the value in the file
};

// One start tag of a file; the reader of chains has read the file, so that it is sound.
struct XmlTag {
    std::string_view name;
    std::size_t from = 0, name_end = 0, end = 0;  ///< at '<', behind the name, behind '>'
    std::vector<XmlAttribute> attributes;

    [[nodiscard]] const XmlAttribute* find(std::string_view wanted) const {
        for (const XmlAttribute& one : attributes)
            if (one.name == wanted) return &one;
        return nullptr;
    }
};

XmlTag tag_at(std::string_view text, std::size_t at) {
    XmlTag tag;
    tag.from = at;
    const std::size_t name = at + 1;
    tag.name_end = std::min(text.find_first_of(" \t\r\n/>", name), text.size());
    tag.name = text.substr(name, tag.name_end - name);
    std::size_t place = tag.name_end;
    while (place < text.size() && text[place] != '>') {
        const std::size_t quote = text.find_first_of("\"'>", place);
        if (quote == std::string_view::npos || text[quote] == '>') {
            place = std::min(quote, text.size());
            break;
        }
        const std::size_t close = std::min(text.find(text[quote], quote + 1), text.size());
        const std::size_t equals = std::min(text.rfind('=', quote), quote);
        const std::size_t last = text.find_last_not_of(" \t\r\n", equals == 0 ? 0 : equals - 1);
        const std::size_t first = text.find_last_of(" \t\r\n", last) + 1;
        tag.attributes.push_back({text.substr(first, last + 1 - first),
                                  text.substr(quote + 1, close - quote - 1), quote + 1, close});
        place = close + 1;
    }
    tag.end = std::min(place + 1, text.size());
    return tag;
}

// The first tag that matches, ignoring comments.
template <class IsIt>
std::optional<XmlTag> first_tag(std::string_view text, const IsIt& is_it) {
    for (std::size_t at = text.find('<'); at != std::string_view::npos; at = text.find('<', at)) {
        if (text.substr(at, 4) == "<!--") {
            at = std::min(text.find("-->", at), text.size() - 1);
            continue;
        }
        XmlTag tag = tag_at(text, at);
        at = tag.end;
        if (is_it(tag)) return tag;
    }
    return std::nullopt;
}

// The joint of this name within the worldbody.
std::optional<XmlTag> joint_tag(std::string_view text, std::string_view joint) {
    bool within = false;
    const std::string written = xml_words(joint);
    return first_tag(text, [&](const XmlTag& tag) {
        if (tag.name == "worldbody") within = true;
        if (tag.name == "/worldbody") within = false;
        const XmlAttribute* const name = tag.find("name");
        return within && tag.name == "joint" && name != nullptr &&
               (name->value == joint || name->value == written);
    });
}

// The tag's attributes with these values; those that are not there yet follow the tag's name.
std::string joint_with_values(std::string_view text, const XmlTag& tag,
                              std::span<const std::pair<std::string_view, std::string>> values) {
    std::string changed(text);
    std::vector<std::pair<XmlAttribute, std::string>> there;
    std::string added;
    for (const auto& [name, value] : values) {
        if (const XmlAttribute* const known = tag.find(name))
            there.emplace_back(*known, value);
        else
            added += fmt::format(" {}=\"{}\"", name, value);
    }
    // From behind, so that places hold.
    std::sort(there.begin(), there.end(),
              [](const auto& a, const auto& b) { return a.first.from > b.first.from; });
    for (const auto& [known, value] : there) changed.replace(known.from, known.to - known.from, value);
    return changed.insert(tag.name_end, added);
}

// Names of motors that the file has not yet.
std::string free_ending(const JointMjcf& mjcf, std::string_view text, std::string_view joint) {
    std::string ending = fmt::format("_{}", joint);
    const auto taken = [&] {
        const std::string tail = xml_words(ending) + "\"";
        for (const MjcfWave& wave : mjcf.waves)
            if (text.find("\"" + wave.name + tail) != std::string_view::npos) return true;
        for (const MjcfBristle& one : mjcf.bristles)
            if (text.find("\"" + one.name + tail) != std::string_view::npos) return true;
        return false;
    };
    while (taken()) ending += "_again";
    return ending;
}

}  // namespace

std::string write_into_mjcf(const JointMjcf& mjcf, std::string_view text, const std::string& source,
                            std::string_view joint, std::span<const std::string> heading) {
    const auto tag = joint_tag(text, joint);
    const std::size_t end = text.rfind("</mujoco");
    if (!tag || end == std::string_view::npos)
        raise<UsageError>(
            "{}: there is no joint with name=\"{}\" in its worldbody to be written into; give the "
            "joint its name, or write the improved model as .json",
            source, joint);
    std::string changed(text);
    const std::string motors = mjcf_motors(mjcf, joint, free_ending(mjcf, text, joint));
    if (!motors.empty()) changed.insert(end, "  <actuator>\n" + motors + "  </actuator>\n");
    const std::pair<std::string_view, std::string> values[] = {
        {"damping", damping_words(mjcf)},
        {"frictionloss", shortest(mjcf.frictionloss_nm)},
        {"solreffriction", std::string(quick_step)}};
    changed = joint_with_values(changed, *tag, values);
    // Before the root, behind a declaration, which has to be first.
    const auto root = first_tag(changed, [](const XmlTag& one) { return one.name == "mujoco"; });
    return changed.insert(root ? root->from : 0, mjcf_comment(mjcf, heading));
}

}  // namespace ripplenotch
