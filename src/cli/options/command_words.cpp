// SPDX-License-Identifier: MIT
#include "cli/options/options_implementation.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <optional>
#include <string_view>

#include "ripplenotch/core/error.hpp"

namespace ripplenotch {

std::string shell_quoted(const std::string& word) {
    const auto plain = [](char c) {
        return std::isalnum(static_cast<unsigned char>(c)) != 0 ||
               std::string_view("-_=./:,@+%").find(c) != std::string_view::npos;
    };
    if (!word.empty() && std::all_of(word.begin(), word.end(), plain)) return word;
    std::string quoted = "'";
    for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return quoted + "'";
}

namespace {

namespace fs = std::filesystem;

std::optional<struct stat> status_of(const std::string& path) {
    struct stat status {};
    if (::stat(path.c_str(), &status) != 0) return std::nullopt;
    return status;
}

// Of a file that is not there yet: its folder may have two names.
fs::path spelled_out(const std::string& path) {
    std::error_code failed;
    const fs::path whole = fs::weakly_canonical(fs::absolute(path, failed), failed);
    return failed ? fs::path(path).lexically_normal() : whole;
}

bool same_file(const std::string& a, const std::string& b) {
    if (a.empty() || b.empty()) return false;
    const auto one = status_of(a), other = status_of(b);
    if (one && other)
        return S_ISREG(one->st_mode) && one->st_dev == other->st_dev && one->st_ino == other->st_ino;
    return !one && !other && spelled_out(a) == spelled_out(b);
}

}  // namespace

void refuse_collisions(std::span<const NamedFile> read, std::span<const NamedFile> written) {
    std::vector<NamedFile> all;  // that are read
    for (const NamedFile& one : read) {
        all.push_back(one);
        for (std::size_t at = one.text.find('='); at != std::string::npos; at = one.text.find('=', at + 1))
            all.push_back({one.text.substr(at + 1, one.text.find(',', at) - at - 1), one.as});
    }
    for (std::size_t i = 0; i < written.size(); ++i) {
        const NamedFile& out = written[i];
        if (out.text == "-") continue;
        for (const NamedFile& other : written.first(i))
            if (same_file(out.text, other.text))
                raise<UsageError>("{} and {} both name {}: one would overwrite the other; name two files",
                                  other.as, out.as, out.text);
        for (const NamedFile& in : all)
            if (same_file(out.text, in.text))
                raise<UsageError>(
                    "{} {}: that file is read too ({}), and would be gone for good; name another file",
                    out.as, out.text, in.as);
    }
}

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
