// SPDX-License-Identifier: MIT
#include "export/joint/mjcf_elements.hpp"

#include <fmt/format.h>

#include "export/text.hpp"
#include "ripplenotch/core/number.hpp"

namespace ripplenotch {
namespace {

// Two hyphens end a comment.
std::string without_ends(std::string line) {
    for (std::size_t at = 0; (at = line.find("--", at)) != std::string::npos;) line.replace(at, 2, "- -");
    return line;
}

constexpr std::string_view motor_words = R"(input="none" motorconst="1e-9" resistance="1")";

}  // namespace

std::string mjcf_comment(const JointMjcf& mjcf, std::span<const std::string> heading) {
    std::vector<std::string> lines(heading.begin(), heading.end());
    for (const MjcfPart& part : mjcf.holds)
        lines.push_back(fmt::format("held: {}, as {}", part.effect, part.words));
    for (const MjcfPart& part : mjcf.not_held)
        lines.push_back(fmt::format("not held: {}: {}", part.effect, part.words));
    lines.emplace_back(
        "A torque sensor shows qfrc_inverse, plus the force of ripple_*, less that of friction_*.");
    for (std::string& line : lines) line = without_ends(std::move(line));
    return "<!--\n" + comment_lines(lines, "  ") + "-->\n";
}

std::string damping_words(const JointMjcf& mjcf) {
    std::string words = shortest(mjcf.damping);
    if (mjcf.quadratic_damping != 0.0) words += " " + shortest(mjcf.quadratic_damping);
    return words;
}

std::string mjcf_motors(const JointMjcf& mjcf, std::string_view joint, std::string_view ending) {
    std::string text;
    const auto motor = [&](const std::string& name, const std::string& words) {
        text += fmt::format("    <dcmotor name=\"{}{}\" joint=\"{}\" {} {}/>\n", name, xml_words(ending),
                            xml_words(joint), motor_words, words);
    };
    for (const MjcfWave& wave : mjcf.waves)
        motor(wave.name, fmt::format("cogging=\"{} {} {}\"", shortest(wave.amplitude_nm),
                                     shortest(wave.poles), shortest(wave.phase_rad)));
    for (const MjcfBristle& bristle : mjcf.bristles)
        motor(bristle.name, fmt::format("lugre=\"{} 0 {} {} 1\"", shortest(bristle.stiffness_nm_rad),
                                        shortest(bristle.friction_nm), shortest(bristle.friction_nm)));
    return text;
}

std::string xml_words(std::string_view text) {
    std::string words;
    for (const char c : text) {
        if (c == '&')
            words += "&amp;";
        else if (c == '<')
            words += "&lt;";
        else if (c == '"')
            words += "&quot;";
        else
            words += c;
    }
    return words;
}

}  // namespace ripplenotch
