// SPDX-License-Identifier: MIT
#include "cli/arm/arm_option.hpp"

#include <fmt/format.h>

#include <array>
#include <optional>
#include <vector>

#include "ripplenotch/arm/chain.hpp"
#include "ripplenotch/core/error.hpp"
#include "ripplenotch/core/spec.hpp"

namespace ripplenotch {
namespace {

constexpr Key file_key{.name = "file", .kind = KeyKind::text, .required = true, .help = "the description"};
constexpr Key tip_key{.name = "tip", .kind = KeyKind::text, .help = "the link at which the chain ends"};
constexpr Key gravity_key{
    .name = "gravity", .kind = KeyKind::list, .help = "in m/s2, in the frame of the base: 0:0:-9.81"};
constexpr Key joints_key{.name = "joints",
                         .kind = KeyKind::text,
                         .help = "NAME:NAME IN THE LOG, NAME:=0deg for one that is still"};
constexpr Key word_key{
    .name = "word", .kind = KeyKind::text, .required = true, .help = "a letter a joint: x y z X Y Z"};
constexpr Key length_key{
    .name = "length", .kind = KeyKind::text, .default_text = "0.3m", .help = "of all links"};

constexpr std::array described = {file_key, tip_key, gravity_key, joints_key};
constexpr std::array tabled = {file_key, gravity_key, joints_key};
constexpr std::array guessed = {word_key, length_key, gravity_key, joints_key};

struct Source {
    std::string_view name;
    std::span<const Key> keys;
    Chain (*read)(const Settings& settings);
};

std::optional<std::string> tip_of(const Settings& settings) {
    if (!settings.has("tip")) return std::nullopt;
    return settings.text("tip");
}

double in_metres(std::string text, std::string_view what) {
    if (text.ends_with("m")) text.pop_back();
    return parse_quantity(text, Dimension::none, what);
}

template <Chain (*of)(const std::string&, std::string_view, const std::optional<std::string>&)>
Chain of_description(const Settings& settings) {
    const std::string file = settings.text("file");
    return of(file, read_chain_file(file), tip_of(settings));
}

template <Chain (*of)(const std::string&, std::string_view)>
Chain of_table(const Settings& settings) {
    const std::string file = settings.text("file");
    return of(file, read_chain_file(file));
}

Chain of_axes(const Settings& settings) {
    return chain_of_axes(settings.text("word"), in_metres(settings.text("length"), "--arm axes, length"));
}

constexpr std::array<Source, 5> sources = {Source{"urdf", described, of_description<chain_of_urdf>},
                                           {"mjcf", described, of_description<chain_of_mjcf>},
                                           {"mdh", tabled, of_table<chain_of_mdh>},
                                           {"dh", tabled, of_table<chain_of_dh>},
                                           {"axes", guessed, of_axes}};

const Source& source_of(const std::string& name) {
    for (const Source& source : sources)
        if (source.name == name) return source;
    raise<UsageError>(
        "--arm: '{}' is none of urdf, mjcf, mdh, dh, axes; for example --arm urdf,file=robot.urdf{}", name,
        name.ends_with(".urdf") || name.ends_with(".xml") ? ", where the file is named with file=" : "");
}

// "a:1|b:2|c:=90deg"
void take_joint(std::string_view piece, ArmOption& option) {
    const std::size_t colon = piece.find(':');
    if (colon == std::string_view::npos || colon == 0 || colon + 1 == piece.size()) {
        raise<UsageError>(
            "--arm, joints: '{}' is neither NAME:NAME IN THE LOG nor NAME:=0deg; several are parted by |",
            piece);
    }
    const std::string name(piece.substr(0, colon)), partner(piece.substr(colon + 1));
    if (partner.front() != '=') {
        option.stated.emplace_back(name, partner);
        return;
    }
    const std::string what = fmt::format("--arm, joints, {}", name), position = partner.substr(1);
    const auto place = option.chain.find(name);
    const bool slides = place && option.chain.joints[*place].kind == JointKind::prismatic;
    option.chain =
        hold_joint(option.chain, name,
                   slides ? in_metres(position, what) : parse_quantity(position, Dimension::angle, what));
}

}  // namespace

ArmOption read_arm_option(std::string_view words) {
    const Spec spec = parse_spec(words);
    const Source& source = source_of(spec.name);
    const Settings settings(fmt::format("--arm {}", spec.name), spec, source.keys);
    ArmOption option{source.read(settings), {}, spec.text()};
    if (settings.has("file")) option.file = settings.text("file");
    if (settings.has("gravity")) {
        const std::vector<double> gravity = settings.list("gravity");
        if (gravity.size() != 3)
            raise<UsageError>("--arm, gravity: {} numbers, expected 3, for example 0:0:-9.81",
                              gravity.size());
        option.chain.gravity_m_s2 = {gravity[0], gravity[1], gravity[2]};
        settle_chain(option.chain);
    }
    if (!settings.has("joints")) return option;
    const std::string joints = settings.text("joints");
    for (std::string_view rest = joints;;) {
        const std::size_t bar = rest.find('|');
        take_joint(rest.substr(0, bar), option);
        if (bar == std::string_view::npos) return option;
        rest.remove_prefix(bar + 1);
    }
}

}  // namespace ripplenotch
