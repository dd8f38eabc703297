// SPDX-License-Identifier: MIT
#include "cli/options/number_list.hpp"

#include <filesystem>

#include "ripplenotch/core/error.hpp"

namespace ripplenotch {
namespace {

bool is_quantity(const std::string& text, Dimension dimension) {
    try {
        static_cast<void>(parse_quantity(text, dimension, ""));
        return true;
    } catch (const UsageError&) {
        return false;
    }
}

}  // namespace

std::vector<std::string> split_commas(const std::string& text) {
    std::vector<std::string> pieces(1);
    for (const char c : text) {
        if (c == ',') {
            pieces.emplace_back();
        } else {
            pieces.back() += c;
        }
    }
    return pieces;
}

void refuse_other_marks(const std::string& option, const std::string& text, Dimension dimension) {
    std::string list, piece;
    for (const char c : text + ' ') {
        if (std::string_view(" :;,").find(c) == std::string_view::npos) {
            piece += c;
        } else if (!piece.empty()) {
            if (!is_quantity(piece, dimension)) return;
            list += (list.empty() ? "" : ",") + piece;
            piece.clear();
        }
    }
    if (list.empty()) return;
    raise<UsageError>("{0} {1}: a list is written with commas and without spaces, {0} {2}", option, text,
                      list);
}

void refuse_split_list(const std::vector<std::string>& words, const std::string& option,
                       Dimension dimension) {
    for (std::size_t i = 0; i + 2 < words.size(); ++i) {
        if (words[i] != option || words[i + 2].empty() || words[i + 2].front() == '-') continue;
        std::string first = words[i + 1];
        if (!first.empty() && first.back() == ',') first.pop_back();
        if (!is_quantity(first, dimension) || !is_quantity(words[i + 2], dimension)) continue;
        if (!std::filesystem::exists(words[i + 2]))
            refuse_other_marks(option, words[i + 1] + ' ' + words[i + 2], dimension);
    }
}

}  // namespace ripplenotch
