// SPDX-License-Identifier: MIT
#include "figure/same_bytes.hpp"

#include <algorithm>
#include <string_view>

namespace ripplenotch {
namespace {

// The value in brackets after `name`, overwritten: what fits of `with`, then blanks.
void overwrite(std::string& pdf, std::string_view name, std::string_view with) {
    const std::size_t found = pdf.find(name);
    if (found == std::string::npos) return;
    const std::size_t from = found + name.size();
    std::size_t to = from, depth = 1;
    for (; to < pdf.size(); ++to) {
        if (pdf[to] == '(') ++depth;
        if (pdf[to] == ')' && --depth == 0) break;
    }
    for (std::size_t i = from; i < to; ++i) pdf[i] = i - from < with.size() ? with[i - from] : ' ';
}

// gnuplot opens a group at every change of pen, most of them for nothing: a third of a picture's bytes.
std::string without_empty_groups(const std::string& svg) {
    std::string result, held;
    for (std::size_t from = 0; from < svg.size();) {
        const std::size_t end = std::min(svg.find('\n', from), svg.size() - 1) + 1;
        const std::string_view line = std::string_view(svg).substr(from, end - from);
        from = end;
        if (!held.empty() && line == "</g>\n") {
            held.clear();
            continue;
        }
        result += held;
        held.clear();
        (line.rfind("<g fill=\"none\" color=", 0) == 0 ? held : result) += line;
    }
    return result + held;
}

}  // namespace

std::string same_svg(std::string svg) {
    const std::size_t from = svg.find("<desc>");
    const std::size_t to = svg.find("</desc>");
    if (from != std::string::npos && to != std::string::npos && from < to)
        svg.erase(from, to + std::string_view("</desc>").size() - from);
    constexpr std::string_view unlawful = "]]>";
    for (std::size_t at = svg.find(unlawful); at != std::string::npos; at = svg.find(unlawful, at))
        svg.replace(at, unlawful.size(), "]]&gt;");
    return without_empty_groups(svg);
}

std::string same_pdf(std::string pdf) {
    overwrite(pdf, "/CreationDate (", "D:19700101000000Z");
    overwrite(pdf, "/Producer (", "cairo");
    return pdf;
}

}  // namespace ripplenotch
