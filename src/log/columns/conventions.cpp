// SPDX-License-Identifier: MIT
#include "log/columns/conventions.hpp"

#include <algorithm>
#include <array>
#include <cctype>

namespace ripplenotch {
namespace {

constexpr std::array all_conventions = {
#define CONVENTION(family, beside, name, role, unit, side, source) \
    Convention{family, beside, name, Role::role, unit, Shaft::side, source},
#include "log/columns/conventions.def"
#undef CONVENTION
};

bool is_decimal_digit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

// ".joint.states.j1.velocity." of "/joint_states/j1/velocity"
std::string in_words(std::string_view name) {
    std::string words = ".";
    for (const char c : name) {
        if (std::isalnum(static_cast<unsigned char>(c)) != 0)
            words += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
        else if (words.back() != '.')
            words += '.';
    }
    if (words.back() != '.') words += '.';
    return words;
}

// Whether `word` is the next one at `at`, perhaps with a number glued to it.
bool word_at(std::string_view words, std::size_t at, std::string_view word) {
    if (words.substr(at, word.size()) != word) return false;
    std::size_t end = at + word.size();
    while (end < words.size() && is_decimal_digit(words[end])) ++end;
    return end < words.size() && words[end] == '.';
}

// All words of the pattern, in this order, others between them allowed: a joint's name stands there.
bool follows(std::string_view words, std::string_view pattern) {
    if (!pattern.empty() && pattern.front() == '=')
        return words.substr(1, words.size() - 2) == pattern.substr(1);
    std::size_t at = 0;
    while (!pattern.empty()) {
        const std::string_view word = pattern.substr(0, pattern.find('.'));
        pattern.remove_prefix(std::min(pattern.size(), word.size() + 1));
        while (at != std::string_view::npos && !word_at(words, at + 1, word)) at = words.find('.', at + 1);
        if (at == std::string_view::npos) return false;
        at = words.find('.', at + 1);
    }
    return true;
}

bool stands_beside(std::string_view pattern, const std::vector<std::string>& names) {
    return std::any_of(names.begin(), names.end(),
                       [&](const std::string& name) { return follows(in_words(name), pattern); });
}

}  // namespace

std::span<const Convention> conventions() { return all_conventions; }

const Convention* convention_of(std::string_view name, Role role, const std::vector<std::string>& names) {
    const std::string words = in_words(name);
    for (const Convention& known : all_conventions) {
        if (role != Role::other && known.role != role) continue;
        if (follows(words, known.name) && (known.beside.empty() || stands_beside(known.beside, names)))
            return &known;
    }
    return nullptr;
}

}  // namespace ripplenotch
