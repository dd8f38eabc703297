// SPDX-License-Identifier: MIT
#include "cli/text_table.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "ripplenotch/core/visible_text.hpp"

namespace ripplenotch {

std::string text_table(const std::vector<std::vector<std::string>>& cells, std::string_view alignment) {
    std::vector<std::vector<std::string>> rows = cells;
    for (auto& row : rows)
        for (std::string& cell : row) cell = visible_text(cell);
    std::vector<std::size_t> widths;
    for (const auto& row : rows) {
        widths.resize(std::max(widths.size(), row.size()));
        for (std::size_t c = 0; c < row.size(); ++c) widths[c] = std::max(widths[c], row[c].size());
    }
    std::string text;
    for (const auto& row : rows) {
        std::string line;
        for (std::size_t c = 0; c < row.size(); ++c) {
            if (c > 0) line += "  ";
            const bool left = alignment[std::min(c, alignment.size() - 1)] == 'l';
            line +=
                left ? fmt::format("{:<{}}", row[c], widths[c]) : fmt::format("{:>{}}", row[c], widths[c]);
        }
        line.erase(line.find_last_not_of(' ') + 1);
        text += line + "\n";
    }
    return text;
}

}  // namespace ripplenotch
