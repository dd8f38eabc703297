// SPDX-License-Identifier: MIT
#include "cli/recommend/command_lines.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "cli/options/shell_word.hpp"
#include "cli/recommend/pasted.hpp"

namespace ripplenotch {

std::vector<std::string> CommandLines::of(const MethodFigures& figures) const {
    const TriedMethods& tried = about_.tried;
    const auto contender = std::find_if(tried.contenders.begin(), tried.contenders.end(),
                                        [&](const Contender& one) { return one.text == figures.method; });
    std::vector<std::string> lines;
    if (contender->method->part == MethodPart::control) return lines;
    for (const MadeFile& file : tried.files) {
        const auto& files = contender->files;
        if (std::find(files.begin(), files.end(), file.name) != files.end()) lines.push_back(file.command);
    }
    lines.push_back(fmt::format("ripplenotch filter {}{} --method {} -o {}", shell_quoted(about_.log),
                                log_words(about_.whole), shell_quoted(figures.method),
                                filtered_name(about_.log)));
    if (!about_.target) return lines;
    // A target that does not hold the whole map is given the map all the same.
    if (contender->method->name == "map" && contender->files.empty() && !tried.files.empty())
        lines.insert(lines.begin(), tried.files.front().command);
    lines.push_back(about_.target->command(*contender, about_.sample_rate));
    return lines;
}

std::string CommandLines::check(const std::vector<const JudgedMethod*>& methods) const {
    std::string line = fmt::format("ripplenotch compare {}{}{}", shell_quoted(about_.log),
                                   log_words(about_.judged), gear_words(about_.gear));
    for (const JudgedMethod* method : methods)
        if (method != nullptr) line += " --method " + shell_quoted(method->figures.method);
    return line;
}

}  // namespace ripplenotch
